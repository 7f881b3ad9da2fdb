//! Writing STL.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Deviation, Report};
use shapeloom_mesh::{COLOR, Column, Domain, TriMesh, Values};
use shapeloom_shape::{Geometry, Part, Shape};

use super::color::{narrowed, rounding};
use super::{COUNT, FACET, FORMAT};
use crate::placed::{Losses, columns_of, frame_losses, placed_part};
use crate::sink::Sink;
use crate::text::{push_number, push_single};
use crate::{Encoding, Format, Keeps, WriteContext, WriteError};

/// What a binary file keeps: it has no names and one list of facets.
const BINARY: Format = Format { keeps: &[Keeps::Colors], ..FORMAT };

/// What a text keeps.
const TEXT: Format = Format { keeps: &[Keeps::Names, Keeps::Parts], ..FORMAT };

/// What the header of a binary file begins with.
pub(super) const WORDS: &[u8] = b"binary STL written by shapeloom";

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).sum())?;
    let placed: Result<Vec<Arc<Geometry>>, WriteError> =
        shape.parts.iter().enumerate().map(|(index, part)| placed_part(FORMAT.id, index, part)).collect();
    let parts = placed?;
    let facets: usize = meshes(&parts).map(|mesh| mesh.triangles().len()).sum();
    let text = context.options.encoding == Encoding::Ascii;
    let mut losses = Losses::from(frame_losses(shape, if text { &TEXT } else { &BINARY }));
    lone_vertices(&parts, &mut losses);
    let mut report = if text {
        write_text(shape, &parts, context, out, &mut losses)?;
        Report::exact("write-stl", "the shortest decimal numbers that read back to the same bits")
    } else {
        if context.options.encoding == Encoding::BinaryBigEndian {
            losses.push("big endian", "binary STL is little endian");
        }
        let rounding = write_binary(shape, &parts, context, out, facets, &mut losses)?;
        if rounding > 0.0 {
            losses.push("positions", format!("they were rounded to single precision, by at most {rounding:e}"));
            let basis = "the largest rounding of a position to single precision, measured";
            Report::new("write-stl", Deviation::AtMost(rounding), basis)
        } else {
            Report::exact("write-stl", "every position is a number of single precision")
        }
    };
    report.losses = losses.into_vec();
    report.figure("facets", facets as f64);
    Ok(report)
}

fn meshes(parts: &[Arc<Geometry>]) -> impl Iterator<Item = &TriMesh> {
    parts.iter().filter_map(|part| match &**part {
        Geometry::TriMesh(mesh) => Some(mesh),
        _ => None,
    })
}

fn lone_vertices(parts: &[Arc<Geometry>], losses: &mut Losses) {
    for mesh in meshes(parts) {
        let mut used = vec![false; mesh.positions().len()];
        mesh.triangles().as_flattened().iter().for_each(|&corner| used[corner as usize] = true);
        let lone = used.iter().filter(|used| !**used).count();
        if lone > 0 {
            losses.push(format!("{lone} vertices without triangles"), "STL holds triangles alone");
        }
    }
}

/// The unit normal of a facet by the order of its corners; zero where it has none.
fn normal([a, b, c]: [DVec3; 3]) -> DVec3 {
    let (first, second) = (b - a, c - a);
    let cross = first.cross(second);
    let square = cross.length_squared();
    if (1e-280..1e280).contains(&square) {
        return cross / square.sqrt();
    }
    // Squares of tiny or huge numbers vanish or overflow: in units of the longest components they do not.
    let unit = |edge: DVec3| edge / edge.abs().max_element();
    let cross = unit(first).cross(unit(second));
    let size = cross.abs().max_element();
    if size > 0.0 && size.is_finite() { (cross / size).normalize_or_zero() } else { DVec3::ZERO }
}

/// Writes all facets behind one another. Returns how far a position was moved at most.
fn write_binary(
    shape: &Shape,
    parts: &[Arc<Geometry>],
    context: &WriteContext,
    out: &mut dyn Write,
    facets: usize,
    losses: &mut Losses,
) -> Result<f64, WriteError> {
    let Ok(count) = u32::try_from(facets) else {
        let (found, max) = (facets as u64, u64::from(u32::MAX));
        return Err(WriteError::TooLarge { format: FORMAT.id, what: "facets", found, max });
    };
    // A header that begins with the word solid would be taken for text.
    let mut header = [b' '; COUNT];
    header[..WORDS.len()].copy_from_slice(WORDS);
    let colored = parts.iter().any(|part| byte_colors(part).is_some());
    let mut sink = Sink::new(out, &context.exec);
    let mut largest = 0.0f64;
    sink.bytes(&header)?;
    sink.bytes(&count.to_le_bytes())?;
    for (index, (part, placed)) in shape.parts.iter().zip(parts).enumerate() {
        lose_columns(placed, true, losses);
        let Geometry::TriMesh(mesh) = &**placed else { continue };
        largest = largest.max(check_rounding(index, part, mesh)?);
        let colors = byte_colors(placed);
        if colored && colors.is_none() && !mesh.triangles().is_empty() {
            losses.push("part without colours among others that have them", "its facets have no colour of their own");
        }
        let mut facet = [0u8; FACET];
        for face in 0..mesh.triangles().len() {
            let corners = mesh.corners(face);
            put(&mut facet, 0, normal(corners));
            for (corner, at) in corners.iter().zip([12, 24, 36]) {
                put(&mut facet, at, *corner);
            }
            let word = colors.map_or(0, |(width, bytes)| packed(&bytes[face * width..face * width + 3]));
            facet[FACET - 2..].copy_from_slice(&word.to_le_bytes());
            sink.bytes(&facet)?;
        }
    }
    sink.finish()?;
    Ok(largest)
}

#[inline]
fn put(facet: &mut [u8; FACET], at: usize, vector: DVec3) {
    for (number, bytes) in vector.to_array().iter().zip(facet[at..at + 12].as_chunks_mut::<4>().0) {
        *bytes = (*number as f32).to_le_bytes();
    }
}

/// The colour of a facet as VisCAM and SolidView have it.
fn packed(rgb: &[u8]) -> u16 {
    // The one at the start ends up in the bit that says that there is a colour.
    rgb.iter().fold(1, |word, &channel| (word << 5) | narrowed(channel))
}

/// How far positions of a mesh move in single precision, rounded up.
fn check_rounding(part: usize, named: &Part, mesh: &TriMesh) -> Result<f64, WriteError> {
    let mut largest = 0.0f64;
    for (index, &point) in mesh.positions().iter().enumerate() {
        let single = point.as_vec3();
        if !single.is_finite() {
            let (name, element) = (named.name.clone(), "vertex");
            return Err(WriteError::NotFinite { format: FORMAT.id, part, name, element, index });
        }
        largest = largest.max(crate::placed::moved(point, single.as_dvec3()));
    }
    Ok(largest)
}

/// The colours of faces in bytes, and how many a face has.
fn byte_colors(geometry: &Geometry) -> Option<(usize, &[u8])> {
    let column = columns_of(geometry, Domain::Face)?.get(COLOR)?;
    match column.values() {
        Values::U8(values) if (3..=4).contains(&column.width()) => Some((column.width(), values)),
        _ => None,
    }
}

/// Says what of the columns is not written, and how colours change.
fn lose_columns(geometry: &Geometry, binary: bool, losses: &mut Losses) {
    for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
        for column in columns_of(geometry, domain).into_iter().flatten() {
            let colors = byte_colors(geometry).filter(|_| binary && domain == Domain::Face && column.name() == COLOR);
            match colors {
                Some((width, bytes)) => lose_bits(column, width, bytes, losses),
                None => losses.column(domain, column.name(), why(domain, column, binary)),
            }
        }
    }
}

fn why(domain: Domain, column: &Column, binary: bool) -> &'static str {
    match (domain, column.name(), binary) {
        (Domain::Face, COLOR, false) => "text STL has no place for it; binary STL has",
        (Domain::Face, COLOR, true) => "STL takes colours of faces in bytes",
        _ => "STL has no place for it",
    }
}

fn lose_bits(column: &Column, width: usize, bytes: &[u8], losses: &mut Losses) {
    let channels = bytes.chunks_exact(width).flat_map(|color| &color[..3]);
    let largest = channels.map(|&channel| rounding(channel)).max().unwrap_or(0);
    if largest > 0 {
        let why = format!("channels were rounded to five bits, by at most {largest} of 255");
        losses.column(Domain::Face, column.name(), why);
    }
    if width == 4 {
        losses.column(Domain::Face, column.name(), "STL has no alpha for facets");
    }
}

/// Writes each part as a solid.
fn write_text(
    shape: &Shape,
    parts: &[Arc<Geometry>],
    context: &WriteContext,
    out: &mut dyn Write,
    losses: &mut Losses,
) -> Result<(), WriteError> {
    let mut sink = Sink::new(out, &context.exec);
    let mut row = Vec::new();
    for (part, placed) in shape.parts.iter().zip(parts) {
        lose_columns(placed, false, losses);
        let name: String = part.name.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
        let name = name.trim();
        if name != part.name {
            let what = format!("part name \"{}\"", part.name.escape_debug());
            losses.push(what, format!("in the file it is \"{name}\""));
        }
        // Some readers look for the space even where no name follows.
        sink.text(format_args!("solid {name}\n"))?;
        if let Geometry::TriMesh(mesh) = &**placed {
            for face in 0..mesh.triangles().len() {
                row.clear();
                let corners = mesh.corners(face);
                row.extend_from_slice(b"facet normal");
                // Readers take it from the corners: seven digits are many.
                push_vector(&mut row, normal(corners), |out, number| push_single(out, number as f32));
                row.extend_from_slice(b"\n outer loop\n");
                for corner in corners {
                    row.extend_from_slice(b"  vertex");
                    push_vector(&mut row, corner, push_number);
                    row.push(b'\n');
                }
                row.extend_from_slice(b" endloop\nendfacet\n");
                sink.bytes(&row)?;
            }
        }
        sink.text(format_args!("endsolid {name}\n"))?;
    }
    sink.finish()
}

#[inline]
fn push_vector(out: &mut Vec<u8>, vector: DVec3, push: impl Fn(&mut Vec<u8>, f64)) {
    for number in vector.to_array() {
        out.push(b' ');
        push(out, number);
    }
}
