//! Writing SVG.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::{Aabb, Deviation, Report};
use shapeloom_mesh::Domain;
use shapeloom_shape::{Geometry, Shape};

use super::FORMAT;
use crate::placed::{Losses, columns_of, frame_losses, placed_part};
use crate::sink::Sink;
use crate::text::{push_number, shortest};
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).sum())?;
    let placed: Result<Vec<Arc<Geometry>>, WriteError> =
        shape.parts.iter().enumerate().map(|(index, part)| placed_part(FORMAT.id, index, part)).collect();
    let parts = placed?;
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    for part in &parts {
        for column in columns_of(part, Domain::Vertex).into_iter().flat_map(|columns| columns.iter()) {
            losses.column(Domain::Vertex, column.name(), "SVG has no place for it");
        }
    }
    let bounds = parts.iter().fold(Aabb::EMPTY, |all, part| all.union(part.bounds()));
    let height = if bounds.is_empty() { 0.0 } else { bounds.min.z.abs().max(bounds.max.z.abs()) };
    let mut report = if height > 0.0 {
        losses.push("z", format!("SVG is flat: points moved by at most {height:e}"));
        Report::new("write-svg", Deviation::AtMost(height), "the largest z, which is left out")
    } else {
        Report::exact("write-svg", "the shortest decimal numbers that read back to the same bits, y turned")
    };
    let mut sink = Sink::new(out, &context.exec);
    header(&mut sink, &bounds, shape)?;
    let mut points = 0;
    for (part, named) in parts.iter().zip(&shape.parts) {
        let Geometry::Polyline(line) = &**part else { continue };
        sink.text(format_args!("<path d=\""))?;
        for (i, point) in line.points().iter().enumerate() {
            sink.piece(|text| {
                text.push(if i == 0 { b'M' } else { b'L' });
                push_number(text, point.x);
                text.push(b' ');
                push_number(text, 0.0 - point.y);
            })?;
        }
        points += line.points().len();
        let end = if line.is_closed() && !line.points().is_empty() { "Z" } else { "" };
        if named.name.is_empty() {
            sink.text(format_args!("{end}\"/>\n"))?;
        } else {
            sink.text(format_args!("{end}\"><title>{}</title></path>\n", escaped(&named.name)))?;
        }
    }
    sink.bytes(b"</g>\n</svg>\n")?;
    sink.finish()?;
    report.losses = losses.into_vec();
    report.figure("paths", parts.len() as f64);
    report.figure("points", points as f64);
    Ok(report)
}

fn header(sink: &mut Sink<'_>, bounds: &Aabb, shape: &Shape) -> Result<(), WriteError> {
    let size = bounds.size();
    // A twentieth on each side, so that strokes at the border are seen; shapes without extent get a unit.
    let longest = size.x.max(size.y);
    let margin = if longest > 0.0 { longest * 0.05 } else { 0.5 };
    let (width, height) = (size.x + 2.0 * margin, size.y + 2.0 * margin);
    let (left, top) = if bounds.is_empty() { (-0.5, -0.5) } else { (bounds.min.x - margin, -bounds.max.y - margin) };
    sink.text(format_args!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\""))?;
    if let Some(units) = shape.units {
        let millimeters = |length: f64| shortest(length * units.meters() * 1e3);
        sink.text(format_args!(" width=\"{}mm\" height=\"{}mm\"", millimeters(width), millimeters(height)))?;
    }
    sink.text(format_args!(
        " viewBox=\"{} {} {} {}\">\n<g fill=\"none\" stroke=\"black\" stroke-width=\"{}\" stroke-linejoin=\"round\">\n",
        shortest(left),
        shortest(top),
        shortest(width),
        shortest(height),
        shortest(longest.max(margin) / 400.0),
    ))
}

/// Text that XML may hold: its own marks written out, control characters left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() || matches!(c, '\u{FFFE}' | '\u{FFFF}') => {}
            c => out.push(c),
        }
    }
    out
}
