//! Writing.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::{Exec, Report};
use shapeloom_shape::Shape;

use crate::{Format, SiblingOutputs, WriteError, WriteOptions};

/// What a writer needs beside the shape.
#[derive(Clone, Default)]
pub struct WriteContext {
    /// How it runs: memory is reserved before it is allocated in proportion to the shape, and cancelling is polled.
    pub exec: Exec,
    /// How files are written where there is a choice.
    pub options: WriteOptions,
    /// The file name of the output, from which files beside it get theirs; empty for a stream.
    pub name: String,
    /// Where files beside the output go; none for an output that stands alone: what they would hold is lost then.
    pub siblings: Option<Arc<dyn SiblingOutputs>>,
}

/// Writes a shape as a file.
///
/// The report says how far positions were rounded, in the units of the shape, and has a line for everything that the
/// format does not hold. Writers do many small writes: hand in a buffered output. After an error the output holds a
/// part of a file.
///
/// # Errors
/// A format without a writer, a part that the format cannot hold, positions that are not finite, more than the format
/// can count, a failing output, budgets passed, cancelled.
pub fn write(
    shape: &Shape,
    format: &Format,
    context: &WriteContext,
    out: &mut dyn Write,
) -> Result<Report, WriteError> {
    let writer = format.writes.ok_or(WriteError::NoWriter { format: format.id })?;
    for (part, kind) in shape.parts.iter().map(|part| part.geometry.kind()).enumerate() {
        if !format.holds(kind) {
            return Err(WriteError::Unsupported { format: format.id, part, kind, holds: format.kinds });
        }
    }
    context.exec.check()?;
    let report = writer(shape, context, out)?;
    out.flush()?;
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FORMATS, format_by_id};
    use shapeloom_core::glam::{DVec2, DVec3};
    use shapeloom_core::{CancelFlag, Category, Diagnostic, Stop};
    use shapeloom_mesh::{HeightField, PolyMesh, TriMesh};
    use shapeloom_parametric::{BezierPatch, BezierSurface};
    use shapeloom_shape::{Kind, Part};
    use shapeloom_voxels::isosurface::Lattice;
    use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

    fn surface() -> Part {
        let control = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
        Part::new(BezierSurface::new(vec![BezierPatch::try_new(1, 1, control).unwrap()]))
    }

    fn triangle() -> Part {
        Part::new(TriMesh::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap())
    }

    fn heights() -> Part {
        Part::new(HeightField::try_new(2, 2, DVec2::ONE, vec![0.0, 1.0, 2.0, 3.0]).unwrap())
    }

    fn grid() -> Part {
        let lattice = Lattice::along_axes([2, 2, 2], DVec3::ZERO, DVec3::ONE).unwrap();
        Part::new(VoxelGrid::try_new(lattice, Samples::U8(vec![7; 8]), Quantity::Density).unwrap())
    }

    fn ball() -> Part {
        Part::new(shapeloom_implicit::Implicit::new(shapeloom_implicit::Tree::sphere(1.0)).unwrap())
    }

    fn line() -> Part {
        Part::new(shapeloom_mesh::Polyline::new(vec![DVec3::ZERO, DVec3::X], false))
    }

    fn polygon() -> Part {
        Part::new(PolyMesh::from_faces(vec![DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2]]).unwrap())
    }

    fn attempt(part: Part, id: &str) -> Result<Report, WriteError> {
        write(&Shape::new(part), format_by_id(id).unwrap(), &WriteContext::default(), &mut Vec::new())
    }

    #[test]
    fn kinds_that_do_not_fit_are_refused_with_advice() {
        for (part, id) in [(surface(), "glb"), (polygon(), "glb"), (surface(), "ply"), (triangle(), "bpt")] {
            let error = attempt(part, id).unwrap_err();
            assert_eq!((error.code(), error.category()), ("E-write-kind", Category::Unsupported));
            assert!(error.advice().unwrap().contains("first"), "{error}");
        }
        let text = attempt(polygon(), "glb").unwrap_err().to_string();
        assert!(text.starts_with("glb: part 0: found a poly-mesh, expected one of: "), "{text}");
        let mute = Format { writes: None, ..crate::ply::FORMAT };
        let error = write(&Shape::new(triangle()), &mute, &WriteContext::default(), &mut Vec::new());
        assert!(matches!(error, Err(WriteError::NoWriter { format: "ply" })));
    }

    #[test]
    fn every_writer_passes_on_failing_outputs_and_stops_when_cancelled() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(std::io::Error::new(std::io::ErrorKind::StorageFull, "no space left"))
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        let flag = CancelFlag::default();
        flag.cancel();
        let cancelled = WriteContext { exec: Exec::default().with_cancel(&flag), ..WriteContext::default() };
        for format in FORMATS.iter().filter(|format| format.writes.is_some()) {
            let shape = Shape::new(match format.kinds {
                kinds if kinds.contains(&Kind::TriMesh) => triangle(),
                kinds if kinds.contains(&Kind::Polyline) => line(),
                kinds if kinds.contains(&Kind::HeightField) => heights(),
                kinds if kinds.contains(&Kind::VoxelGrid) => grid(),
                kinds if kinds.contains(&Kind::Implicit) => ball(),
                _ => surface(),
            });
            let error = write(&shape, format, &WriteContext::default(), &mut Full).unwrap_err();
            assert_eq!((error.code(), error.category()), ("E-write-io", Category::CannotWrite), "{}", format.id);
            let stopped = write(&shape, format, &cancelled, &mut Vec::new());
            assert_eq!(stopped, Err(WriteError::Stop(Stop::Cancelled)), "{}", format.id);
        }
    }
}
