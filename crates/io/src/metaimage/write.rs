//! Writing MetaImage.

use std::io::Write;

use flate2::write::ZlibEncoder;
use shapeloom_core::{Deviation, Loss, Report};
use shapeloom_shape::Shape;
use shapeloom_voxels::{Quantity, Samples};

use super::FORMAT;
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::volumes::{OneGrid, rounding_words, three};
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let one = OneGrid::try_new(shape, &FORMAT)?;
    let (spacing, directions, error) = one.spacing_and_directions();
    let deviation = if error == 0.0 { Deviation::Exact } else { Deviation::AtMost(error) };
    let mut report = Report::new("write-mha", deviation, rounding_words(error));
    report.losses = frame_losses(shape, &FORMAT);
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let unit = shape.units.map(|units| (units.meters(), unit_word(units.meters())));
    if let Some((meters, None)) = unit {
        let what = format!("unit of length ({meters} m)");
        report.losses.push(Loss::new(what, "MetaImage knows millimetres, centimetres and micrometres"));
    }
    let [x, y, z] = one.lattice.dimensions();
    let kind = match one.grid.samples() {
        Samples::Bits(_) | Samples::U8(_) => "MET_UCHAR",
        Samples::U16(_) => "MET_USHORT",
        Samples::F32(_) => "MET_FLOAT",
    };
    // Some programs compare with other spellings of the two words.
    let packed = if context.options.compress { "True" } else { "False" };
    let mut text = format!(
        "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = {packed}\n"
    );
    for comment in &shape.comments {
        for line in comment.split(['\n', '\r']) {
            text += &format!("Comment = {line}\n");
        }
    }
    if one.grid.quantity() != Quantity::Density {
        text += &format!("Comment = quantity={}\n", one.grid.quantity().name());
    }
    let [i, j, k] = directions.map(three);
    text += &format!("TransformMatrix = {i} {j} {k}\nOffset = {}\n", three(one.origin()));
    if let Some((_, Some(word))) = unit {
        text += &format!("DistanceUnits = {word}\n");
    }
    text += &format!("ElementSpacing = {}\nDimSize = {x} {y} {z}\nElementType = {kind}\n", three(spacing));
    out.write_all(text.as_bytes())?;
    if context.options.compress {
        // Its tables and windows. Readers need the number of packed bytes before them: packing twice takes time instead of
        // memory for the whole.
        let _memory = context.exec.reserve(1 << 19)?;
        let mut counter = Counter(0);
        pack(&one, &mut counter, context)?;
        out.write_all(format!("CompressedDataSize = {}\nElementDataFile = LOCAL\n", counter.0).as_bytes())?;
        pack(&one, out, context)?;
    } else {
        out.write_all(b"ElementDataFile = LOCAL\n")?;
        let mut sink = Sink::new(out, &context.exec);
        one.put_samples(&mut sink, false)?;
        sink.finish()?;
    }
    report.figure("samples", one.lattice.samples() as f64);
    Ok(report)
}

/// How many bytes were written.
struct Counter(u64);

impl Write for Counter {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 += bytes.len() as u64;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// The samples, compressed.
fn pack(one: &OneGrid<'_>, out: &mut dyn Write, context: &WriteContext) -> Result<(), WriteError> {
    let mut encoder = ZlibEncoder::new(out, flate2::Compression::default());
    let mut sink = Sink::new(&mut encoder, &context.exec);
    one.put_samples(&mut sink, false)?;
    sink.finish()?;
    encoder.finish()?;
    Ok(())
}

fn unit_word(meters: f64) -> Option<&'static str> {
    [("um", 1e-6), ("mm", 1e-3), ("cm", 1e-2)].into_iter().find(|(_, known)| *known == meters).map(|(word, _)| word)
}
