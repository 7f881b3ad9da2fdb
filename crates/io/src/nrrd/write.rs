//! Writing NRRD.

use std::io::Write;

use flate2::write::GzEncoder;
use shapeloom_core::Report;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::Shape;
use shapeloom_voxels::{Quantity, Samples};

use super::frame::UNITS;
use super::{FORMAT, SPACE};
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::volumes::{OneGrid, plain, three};
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let one = OneGrid::try_new(shape, &FORMAT)?;
    let mut report = Report::exact("write-nrrd", "samples, steps and origin to the same bits");
    report.losses = frame_losses(shape, &FORMAT);
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let packed = context.options.compress;
    out.write_all(header(shape, &one, packed).as_bytes())?;
    if packed {
        // Its tables and windows.
        let _memory = context.exec.reserve(1 << 19)?;
        // Without a time of writing, so that the same shape gives the same bytes.
        let mut encoder = GzEncoder::new(out, flate2::Compression::default());
        let mut sink = Sink::new(&mut encoder, &context.exec);
        one.put_samples(&mut sink, false)?;
        sink.finish()?;
        encoder.finish()?;
    } else {
        let mut sink = Sink::new(out, &context.exec);
        one.put_samples(&mut sink, false)?;
        sink.finish()?;
    }
    report.figure("samples", one.lattice.samples() as f64);
    Ok(report)
}

fn header(shape: &Shape, one: &OneGrid<'_>, packed: bool) -> String {
    let [x, y, z] = one.lattice.dimensions();
    let kind = match one.grid.samples() {
        Samples::Bits(_) | Samples::U8(_) => "uint8",
        Samples::U16(_) => "uint16",
        Samples::F32(_) => "float",
    };
    let mut text = format!("NRRD0004\ntype: {kind}\ndimension: 3\n");
    // A space that files name; without one its dimension alone.
    let known = |name: &&str| !name.is_empty() && !name.contains(['\n', '\r']) && name.trim() == *name;
    let space = shape.comments.iter().find_map(|comment| comment.strip_prefix(SPACE)).filter(known);
    match space {
        Some(name) => text += &format!("space: {name}\n"),
        None => text += "space dimension: 3\n",
    }
    let vector = |vector: DVec3| format!("({})", three(vector).replace(' ', ","));
    let steps = one.lattice.steps().map(vector);
    text += &format!("sizes: {x} {y} {z}\nspace directions: {}\nkinds: domain domain domain\n", steps.join(" "));
    if one.size() > 1 {
        text += "endian: little\n";
    }
    text += if packed { "encoding: gzip\n" } else { "encoding: raw\n" };
    text += &format!("space origin: {}\n", vector(one.origin()));
    if let Some(units) = shape.units {
        let word = UNITS.iter().find(|(_, meters)| *meters == units.meters());
        let word = word.map_or_else(|| format!("{} m", plain(units.meters())), |(name, _)| (*name).to_owned());
        text += &format!("space units: \"{word}\" \"{word}\" \"{word}\"\n");
    }
    if one.grid.quantity() != Quantity::Density {
        text += &format!("quantity:={}\n", one.grid.quantity().name());
    }
    for comment in shape.comments.iter().filter(|comment| !comment.starts_with(SPACE)) {
        for line in comment.split(['\n', '\r']) {
            // Pairs of a file that was read stay such.
            let pair = line.split_once(":=").is_some_and(|(key, _)| !key.is_empty() && !key.contains([':', '#']));
            let pair = pair && !line.starts_with("quantity:=") && line.trim() == line;
            text += &if pair { format!("{line}\n") } else { format!("# {line}\n") };
        }
    }
    text + "\n"
}
