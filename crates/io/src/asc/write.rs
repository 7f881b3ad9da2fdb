//! Writing ESRI ASCII grids.

use std::io::Write;

use shapeloom_core::Report;
use shapeloom_shape::Shape;

use super::FORMAT;
use crate::heights::Level;
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::text::{push_number, shortest};
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let level = Level::try_new(shape, &FORMAT)?;
    let mut report = Report::exact("write-asc", "the shortest decimal numbers that read back to the same bits");
    report.losses = frame_losses(shape, &FORMAT);
    // Its height field is put where the part is, which loses nothing.
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let hole = hole_value(&level, context)?;
    let (spacing, origin) = (level.spacing, level.south_west);
    let mut sink = Sink::new(out, &context.exec);
    sink.text(format_args!("ncols {}\nnrows {}\n", level.columns(), level.rows()))?;
    // Corners are what most programs write. They are not exact everywhere: a middle is.
    let corner = origin - spacing / 2.0;
    if corner.is_finite() && corner + spacing / 2.0 == origin {
        sink.text(format_args!("xllcorner {}\nyllcorner {}\n", shortest(corner.x), shortest(corner.y)))?;
    } else {
        sink.text(format_args!("xllcenter {}\nyllcenter {}\n", shortest(origin.x), shortest(origin.y)))?;
    }
    if spacing.x == spacing.y {
        sink.text(format_args!("cellsize {}\n", shortest(spacing.x)))?;
    } else {
        sink.text(format_args!("dx {}\ndy {}\n", shortest(spacing.x), shortest(spacing.y)))?;
    }
    sink.text(format_args!("NODATA_value {}\n", shortest(hole)))?;
    let mut holes = 0u64;
    for row in 0..level.rows() {
        for (column, height) in level.row(row).enumerate() {
            holes += u64::from(height.is_nan());
            sink.piece(|line| {
                if column > 0 {
                    line.push(b' ');
                }
                push_number(line, if height.is_nan() { hole } else { height });
            })?;
        }
        sink.bytes(b"\n")?;
    }
    sink.finish()?;
    report.figure("samples", f64::from(level.columns()) * f64::from(level.rows()));
    report.figure("holes", holes as f64);
    Ok(report)
}

/// A number that no height is, to stand for holes: the customary one where that is free, else one with more nines.
fn hole_value(level: &Level<'_>, context: &WriteContext) -> Result<f64, WriteError> {
    'candidates: for digits in 4..16 {
        let hole = 1.0 - 10f64.powi(digits);
        for row in 0..level.rows() {
            context.exec.check()?;
            if level.row(row).any(|height| height == hole) {
                continue 'candidates;
            }
        }
        return Ok(hole);
    }
    Ok(f64::MIN)
}
