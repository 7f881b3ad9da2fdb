//! Writing BPT.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Place, Report, Severity};
use shapeloom_parametric::BezierPatch;
use shapeloom_shape::{Geometry, Part, Shape, UpAxis};

use super::FORMAT;
use crate::placed::{frame_losses, placed_part};
use crate::sink::Sink;
use crate::text::shortest;
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let turn = shape.up.map_or(Affine::IDENTITY, |up| up.rotation_to(UpAxis::Z));
    let mut report = Report::exact("write-bpt", "the shortest decimal numbers that read back to the same bits");
    report.losses = frame_losses(shape, &FORMAT);
    match shape.up {
        Some(UpAxis::Z) => {}
        Some(UpAxis::Y) => {
            let message = "y was up; the coordinates were turned so that z is up, as readers of BPT take it";
            report.findings.push("W-bpt-up", Severity::Note, Place::Whole, message);
        }
        None => {
            let message = "the up axis is not known; the coordinates are as they were, and readers of BPT take z as up";
            report.findings.push("W-bpt-up", Severity::Note, Place::Whole, message);
        }
    }

    let mut sink = Sink::new(out, &context.exec);
    let surfaces = shape.parts.iter().filter_map(|part| match &*part.geometry {
        Geometry::BezierSurface(surface) => Some(surface.patches.len()),
        _ => None,
    });
    let count: usize = surfaces.sum();
    sink.text(format_args!("{count}\n"))?;
    for (index, part) in shape.parts.iter().enumerate() {
        let _memory = context.exec.reserve(part.geometry.memory_bytes() as u64)?;
        let turned = Part { placement: turn * part.placement, geometry: Arc::clone(&part.geometry), ..part.clone() };
        // A product with the identity may turn -0 into 0.
        let turned = if turn == Affine::IDENTITY { part } else { &turned };
        if let Geometry::BezierSurface(surface) = &*placed_part(FORMAT.id, index, turned)? {
            for patch in &surface.patches {
                write_patch(&mut sink, patch)?;
            }
        }
    }
    sink.finish()?;
    report.figure("patches", count as f64);
    Ok(report)
}

fn write_patch(sink: &mut Sink<'_>, patch: &BezierPatch) -> Result<(), WriteError> {
    // Readers expect degrees from 1: a constant direction is written as a linear one with equal ends.
    let repeat = |degree: usize| if degree == 0 { [0, 0].to_vec() } else { (0..=degree).collect() };
    let (columns, rows) = (repeat(patch.degree_u()), repeat(patch.degree_v()));
    sink.text(format_args!("{} {}\n", rows.len() - 1, columns.len() - 1))?;
    for &j in &rows {
        for &i in &columns {
            let DVec3 { x, y, z } = patch.control_point(i, j);
            sink.text(format_args!("{} {} {}\n", shortest(x), shortest(y), shortest(z)))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ReadContext, format_by_id, read, write};
    use shapeloom_core::Deviation;
    use shapeloom_parametric::BezierSurface;
    use shapeloom_shape::Units;

    const TEAPOT: &[u8] = include_bytes!("../../../../data/teapot.bpt");

    fn bytes(shape: &Shape) -> (Vec<u8>, Report) {
        let mut out = Vec::new();
        let report = write(shape, format_by_id("bpt").unwrap(), &WriteContext::default(), &mut out).unwrap();
        (out, report)
    }

    fn bits(shape: &Shape) -> Vec<[u64; 3]> {
        let Geometry::BezierSurface(surface) = &*shape.parts[0].geometry else { panic!("a surface") };
        let points = surface.patches.iter().flat_map(|patch| patch.control_points());
        points.map(|point| point.to_array().map(f64::to_bits)).collect()
    }

    fn again(file: &[u8]) -> Shape {
        read(file, format_by_id("bpt").unwrap(), &ReadContext::default()).unwrap().shape
    }

    #[test]
    fn the_teapot_comes_back_with_the_same_bits() {
        let teapot = again(TEAPOT);
        let (file, report) = bytes(&teapot);
        assert_eq!(bits(&again(&file)), bits(&teapot));
        assert_eq!((report.deviation, report.losses.len()), (Deviation::Exact, 0));
        assert_eq!(report.find("patches"), Some(32.0));
        assert_eq!(bytes(&again(&file)).0, file);
    }

    #[test]
    fn awkward_numbers_and_uneven_degrees_come_back() {
        let control = [-0.0, 1e300, 5e-324, 0.1, 1.0 / 3.0, 123_456_789.125].map(|x| DVec3::new(x, -x, 1.0 + x));
        let patch = BezierPatch::try_new(2, 1, control.to_vec()).unwrap();
        let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(BezierSurface::new(vec![patch]))) };
        assert_eq!(again(&bytes(&shape).0), shape);
        assert_eq!(bits(&again(&bytes(&shape).0)), bits(&shape));
    }

    #[test]
    fn what_does_not_fit_is_said() {
        let constant = BezierPatch::try_new(0, 1, vec![DVec3::X, DVec3::Y]).unwrap();
        let part = Part::new(BezierSurface::new(vec![constant])).named("line");
        let moved = Part { placement: Affine::from_translation(DVec3::Y), ..part.clone() };
        let shape =
            Shape { parts: vec![part, moved], units: Some(Units::INCHES), up: Some(UpAxis::Y), ..Shape::default() };
        let (file, report) = bytes(&shape);
        // y up becomes z up: (x, y, z) to (x, -z, y).
        assert_eq!(String::from_utf8(file).unwrap().lines().nth(4), Some("0 0 1"));
        let whats: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
        assert_eq!(whats.len(), 5, "{whats:?}");
        assert!(whats.contains(&"part name \"line\"") && whats.contains(&"unit of length (0.0254 m)"));
        assert_eq!(report.findings.iter().next().unwrap().code, "W-bpt-up");
    }

    #[test]
    fn placements_that_overflow_are_refused() {
        let patch = BezierPatch::try_new(1, 1, vec![DVec3::splat(1e300); 4]).unwrap();
        let mut part = Part::new(BezierSurface::new(vec![patch])).named("far");
        part.placement = Affine::from_scale(DVec3::splat(1e10));
        let error = write(&Shape::new(part), format_by_id("bpt").unwrap(), &WriteContext::default(), &mut Vec::new());
        assert!(error.unwrap_err().to_string().starts_with("bpt: part 0 \"far\", control point 0: found"));
    }
}
