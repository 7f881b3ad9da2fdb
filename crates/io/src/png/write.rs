//! Writing PNG.

use std::io::Write;

use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};
use shapeloom_core::{Deviation, Loss, Report, Words};
use shapeloom_shape::{Shape, Units};

use super::FORMAT;
use super::calibration::{Calibration, PixelSize};
use crate::heights::Level;
use crate::placed::frame_losses;
use crate::{WriteContext, WriteError};

/// White.
const FULL: u32 = 65535;

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let level = Level::try_new(shape, &FORMAT)?;
    let (low, high) = level.range(&context.exec)?.unwrap_or((0.0, 0.0));
    if !(high - low).is_finite() {
        let (format, name) = (FORMAT.id, String::new());
        return Err(WriteError::NotFinite { format, part: 0, name, element: "sample", index: 0 });
    }
    let calibration = Calibration { base: low, range: high - low, full: FULL };
    let holes = level.has_holes();
    let color = if holes { ColorType::GrayscaleAlpha } else { ColorType::Grayscale };
    let unit = shape.units;

    let mut encoder = Encoder::new(&mut *out, level.columns(), level.rows());
    encoder.set_color(color);
    encoder.set_depth(BitDepth::Sixteen);
    encoder.set_compression(Compression::Balanced);
    let mut writer = encoder.write_header().map_err(told)?;
    writer.write_chunk(png::chunk::ChunkType(*b"pCAL"), &calibration.to_chunk(unit_name(unit))).map_err(told)?;
    let metres = unit == Some(Units::METERS);
    if metres {
        writer.write_chunk(png::chunk::ChunkType(*b"sCAL"), &PixelSize(level.spacing).to_chunk()).map_err(told)?;
    }
    let bytes = level.columns() as usize * if holes { 4 } else { 2 };
    let _memory = context.exec.reserve(8 * bytes as u64 + (1 << 20))?;
    let mut stream = writer.stream_writer().map_err(told)?;
    let mut line = Vec::with_capacity(bytes);
    for row in 0..level.rows() {
        context.exec.check()?;
        line.clear();
        for height in level.row(row) {
            line.extend(stored(height, &calibration).to_be_bytes());
            if holes {
                line.extend(if height.is_nan() { [0; 2] } else { [0xff; 2] });
            }
        }
        stream.write_all(&line)?;
    }
    stream.finish().map_err(told)?;
    writer.finish().map_err(told)?;
    Ok(report(shape, &level, &calibration))
}

/// The sample of a height; 0 for a hole.
fn stored(height: f64, calibration: &Calibration) -> u16 {
    if height.is_nan() || calibration.range <= 0.0 {
        return 0;
    }
    // In a range near the smallest numbers the quotient may be a little above 1.
    ((height - calibration.base) / calibration.range * f64::from(FULL)).round().clamp(0.0, f64::from(FULL)) as u16
}

fn unit_name(unit: Option<Units>) -> &'static str {
    if unit == Some(Units::METERS) { "m" } else { "" }
}

fn report(shape: &Shape, level: &Level<'_>, calibration: &Calibration) -> Report {
    let step = calibration.range / f64::from(FULL);
    // Half a step, and what is rounded on the way there and back: a few units in the last place of the largest number, and
    // the smallest number where all are near it.
    let size = calibration.base.abs().max((calibration.base + calibration.range).abs());
    let bound = (step / 2.0 + 8.0 * f64::EPSILON * size) * (1.0 + 1e-12) + 5e-324;
    let deviation = if calibration.range == 0.0 { Deviation::Exact } else { Deviation::AtMost(bound) };
    let basis = format!(
        "half of one of 65535 steps from {} to {}",
        Words(calibration.base),
        Words(calibration.base + calibration.range)
    );
    let mut report = Report::new("write-png", deviation, basis);
    report.losses = frame_losses(shape, &FORMAT);
    // Its height field is put where the part is; what of that is lost is said below.
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let place = level.south_west;
    if place != shapeloom_core::glam::DVec2::ZERO {
        let what = format!("place of the south-western sample ({}, {})", Words(place.x), Words(place.y));
        report.losses.push(Loss::new(what, "PNG has none: the picture begins at the origin"));
    }
    if shape.units != Some(Units::METERS) {
        let spacing = level.spacing;
        if spacing.min_element() != 1.0 || spacing.max_element() != 1.0 {
            let what = format!("distance of samples ({}, {})", Words(spacing.x), Words(spacing.y));
            report.losses.push(Loss::new(what, "PNG has it in metres only: say it with --set spacing=... on reading"));
        }
        if let Some(units) = shape.units {
            let what = format!("unit of length ({} m)", units.meters());
            report.losses.push(Loss::new(what, "PNG has a place for metres only"));
        }
    }
    report.figure("samples", f64::from(level.columns()) * f64::from(level.rows()));
    report.figure("step", step);
    report.figure("lowest", calibration.base);
    report.figure("highest", calibration.base + calibration.range);
    report
}

fn told(error: EncodingError) -> WriteError {
    match error {
        EncodingError::IoError(error) => error.into(),
        other => std::io::Error::other(other.to_string()).into(),
    }
}
