//! Writing VTI.

use std::io::Write;

use shapeloom_core::glam::DMat3;
use shapeloom_core::{Deviation, Report};
use shapeloom_shape::Shape;
use shapeloom_voxels::Samples;

use super::FORMAT;
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::volumes::{OneGrid, rounding_words, three};
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let one = OneGrid::try_new(shape, &FORMAT)?;
    let (spacing, directions, error) = one.spacing_and_directions();
    let deviation = if error == 0.0 { Deviation::Exact } else { Deviation::AtMost(error) };
    let mut report = Report::new("write-vti", deviation, rounding_words(error));
    report.losses = frame_losses(shape, &FORMAT);
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let last = one.lattice.dimensions().map(|count| count - 1);
    let extent = format!("0 {} 0 {} 0 {}", last[0], last[1], last[2]);
    let rows = DMat3::from_cols(directions[0], directions[1], directions[2]).transpose();
    let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(three).join(" ");
    let kind = match one.grid.samples() {
        Samples::Bits(_) | Samples::U8(_) => "UInt8",
        Samples::U16(_) => "UInt16",
        Samples::F32(_) => "Float32",
    };
    let name = one.grid.quantity().name();
    let mut sink = Sink::new(out, &context.exec);
    sink.text(format_args!(
        "<?xml version=\"1.0\"?>\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  \
         <ImageData WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{rows}\">\n    \
         <Piece Extent=\"{extent}\">\n      <PointData Scalars=\"{name}\">\n        \
         <DataArray type=\"{kind}\" Name=\"{name}\" format=\"appended\" offset=\"0\"/>\n      </PointData>\n    \
         </Piece>\n  </ImageData>\n  <AppendedData encoding=\"raw\">\n   _",
        three(one.origin()),
        three(spacing),
    ))?;
    sink.bytes(&(one.lattice.samples() * one.size()).to_le_bytes())?;
    one.put_samples(&mut sink, false)?;
    sink.bytes(b"\n  </AppendedData>\n</VTKFile>\n")?;
    sink.finish()?;
    report.figure("samples", one.lattice.samples() as f64);
    Ok(report)
}
