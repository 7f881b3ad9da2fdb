//! What marching tells, and its surface as a mesh.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Deviation, Exec, Report};
use shapeloom_mesh::{Domain, MeshError, TriMesh};

use crate::lattice_bits::LatticeBits;
use crate::marching::Surface;
use crate::result::{cell_bound, normal_column};
use crate::{IsoWords, Level, Slabs};

/// The report on a surface.
pub(crate) fn told<S: Slabs + ?Sized>(
    name: &'static str,
    slabs: &S,
    level: Level,
    how: &IsoWords,
    bits: &LatticeBits,
    surface: &Surface,
    exec: &Exec,
) -> Result<Report, ConvertError> {
    let (deviation, basis) = match bits.not_finite {
        0 => {
            let bound = cell_bound(slabs.lattice());
            (Deviation::AtMost(bound), "the diagonal of a cell, against the trilinear interpolant")
        }
        _ => (Deviation::Unknown, "samples that are not finite have no interpolant"),
    };
    let mut report = Report::new(name, deviation, format!("{how}; {basis}"));
    report.figure("vertices", surface.positions.len() as f64);
    report.figure("triangles", surface.triangles.len() as f64);
    let working = bits.memory_bytes() as u64 + surface.working_bytes;
    report.figure("bytes_a_sample", working as f64 / slabs.lattice().samples() as f64);
    level.tell(slabs, how, bits.not_finite, surface.triangles.len() as u64, &mut report, exec)?;
    Ok(report)
}

/// The mesh.
pub(crate) fn finish(surface: Surface) -> Result<TriMesh, MeshError> {
    // In place: three numbers are a vector.
    let positions = surface.positions.into_iter().map(DVec3::from_array).collect();
    let mut mesh = TriMesh::try_new(positions, surface.triangles)?;
    if let Some(normals) = surface.normals {
        mesh.insert_attribute(Domain::Vertex, normal_column(normals)?)?;
    }
    Ok(mesh)
}
