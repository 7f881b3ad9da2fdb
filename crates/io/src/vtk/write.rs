//! Writing legacy VTK.

use std::io::Write;

use shapeloom_core::Report;
use shapeloom_shape::Shape;
use shapeloom_voxels::Samples;

use super::{FORMAT, NO_TITLE};
use crate::placed::frame_losses;
use crate::sink::Sink;
use crate::volumes::{OneGrid, three};
use crate::{WriteContext, WriteError};

/// The longest title that the format allows, without its line end.
const TITLE: usize = 255;

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let one = OneGrid::try_new(shape, &FORMAT)?;
    let part = &shape.parts[0];
    let turned = || WriteError::Turned { format: FORMAT.id, part: 0, name: part.name.clone() };
    let spacing = one.along_axes().ok_or_else(turned)?;
    let mut report = Report::exact("write-vtk", "samples, spacing and origin to the same bits");
    report.losses = frame_losses(shape, &FORMAT);
    report.losses.retain(|loss| !loss.what.starts_with("placements of"));
    let title: String = match shape.comments.as_slice() {
        [] => NO_TITLE.into(),
        [first, rest @ ..] => {
            let line: String = first.chars().map(|char| if char.is_control() { ' ' } else { char }).collect();
            let line = line.trim();
            let end = (0..=line.len().min(TITLE)).rev().find(|end| line.is_char_boundary(*end)).unwrap_or(0);
            let what = match (rest.is_empty(), end < line.len()) {
                (true, false) => None,
                (true, true) => Some(format!("the comment beyond its first {TITLE} bytes")),
                (false, false) => Some("comments after the first".to_owned()),
                (false, true) => Some(format!("comments after the first, and that beyond its first {TITLE} bytes")),
            };
            if let Some(what) = what {
                let why = "legacy VTK has one line for words, its title";
                report.losses.push(shapeloom_core::Loss::new(what, why));
            }
            line[..end].to_owned()
        }
    };
    let [x, y, z] = one.lattice.dimensions();
    let kind = match one.grid.samples() {
        Samples::Bits(_) | Samples::U8(_) => "unsigned_char",
        Samples::U16(_) => "unsigned_short",
        Samples::F32(_) => "float",
    };
    let name = one.grid.quantity().name();
    let mut sink = Sink::new(out, &context.exec);
    sink.text(format_args!(
        "# vtk DataFile Version 3.0\n{title}\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS {x} {y} {z}\nORIGIN {}\n\
         SPACING {}\nPOINT_DATA {}\nSCALARS {name} {kind} 1\nLOOKUP_TABLE default\n",
        three(one.origin()),
        three(spacing),
        one.lattice.samples(),
    ))?;
    one.put_samples(&mut sink, true)?;
    sink.bytes(b"\n")?;
    sink.finish()?;
    report.figure("samples", one.lattice.samples() as f64);
    Ok(report)
}
