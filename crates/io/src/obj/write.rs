//! Writing OBJ.

use std::collections::HashMap;
use std::io::Write;

use shapeloom_core::Report;
use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, TEXCOORD, Values};
use shapeloom_shape::{Geometry, Part, Shape};

use super::FORMAT;
use crate::placed::{Losses, columns_of, frame_losses, placed_part, points_of};
use crate::ply::srgb;
use crate::sink::Sink;
use crate::text::shortest;
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    let mut writer =
        Writer { sink: Sink::new(out, &context.exec), texcoords: Pool::default(), normals: Pool::default(), first: 1 };
    writer.sink.bytes(b"# written by shapeloom\n")?;
    for (index, part) in shape.parts.iter().enumerate() {
        // The placed copy, and the pools of texture coordinates and normals.
        let _memory = context.exec.reserve(part.geometry.memory_bytes() as u64 * 4)?;
        let geometry = placed_part(FORMAT.id, index, part)?;
        writer.name(index, part, shape.parts.len(), &mut losses)?;
        writer.part(&geometry, &mut losses)?;
    }
    let vertices = writer.first - 1;
    writer.sink.finish()?;
    let mut report = Report::exact("write-obj", "the shortest decimal numbers that read back to the same bits");
    report.losses = losses.into_vec();
    report.figure("vertices", vertices as f64);
    Ok(report)
}

/// Tuples of numbers written so far, each with its index from 1.
#[derive(Default)]
struct Pool(HashMap<Vec<u64>, usize>);

struct Writer<'o> {
    sink: Sink<'o>,
    texcoords: Pool,
    normals: Pool,
    /// The index of the part's first vertex, from 1.
    first: usize,
}

impl Writer<'_> {
    fn name(&mut self, index: usize, part: &Part, parts: usize, losses: &mut Losses) -> Result<(), WriteError> {
        let clean: String = part.name.chars().map(|c| if c.is_control() { '_' } else { c }).collect();
        let clean = clean.trim();
        if clean != part.name {
            losses
                .push(format!("part name \"{}\"", part.name.escape_debug()), format!("in the file it is \"{clean}\""));
        }
        match clean {
            "" if parts < 2 => Ok(()),
            "" => self.sink.text(format_args!("o part_{index}\n")),
            name => self.sink.text(format_args!("o {name}\n")),
        }
    }

    fn part(&mut self, geometry: &Geometry, losses: &mut Losses) -> Result<(), WriteError> {
        let points = points_of(geometry).unwrap_or(&[]);
        let vertex = |name: &str, width: usize| floating(geometry, Domain::Vertex, name, width);
        let wedge = |name: &str, width: usize| floating(geometry, Domain::Wedge, name, width);
        let colors =
            columns_of(geometry, Domain::Vertex).and_then(|columns| columns.get(COLOR)).filter(|c| is_color(c));
        for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
            for column in columns_of(geometry, domain).into_iter().flatten() {
                lose(geometry, domain, column, losses);
            }
        }
        for (index, &point) in points.iter().enumerate() {
            let DVec3 { x, y, z } = point;
            self.sink.text(format_args!("v {} {} {}", shortest(x), shortest(y), shortest(z)))?;
            if let Some(colors) = colors {
                let [r, g, b] = [0, 1, 2].map(|i| shortest(fraction(colors, index, i)));
                self.sink.text(format_args!(" {r} {g} {b}"))?;
            }
            self.sink.bytes(b"\n")?;
        }
        let faces: Box<dyn Iterator<Item = &[u32]> + '_> = match geometry {
            Geometry::TriMesh(mesh) => Box::new(mesh.triangles().iter().map(|corners| &corners[..])),
            Geometry::PolyMesh(mesh) => Box::new(mesh.faces()),
            _ => Box::new(std::iter::empty()),
        };
        let corners: Vec<u32> = match geometry {
            Geometry::TriMesh(mesh) => mesh.triangles().as_flattened().to_vec(),
            Geometry::PolyMesh(mesh) => mesh.wedge_vertices().to_vec(),
            _ => Vec::new(),
        };
        let sink = &mut self.sink;
        let vt = indices("vt", vertex(TEXCOORD, 2), wedge(TEXCOORD, 2), &corners, &mut self.texcoords, sink)?;
        let vn = indices("vn", vertex(NORMAL, 3), wedge(NORMAL, 3), &corners, &mut self.normals, sink)?;
        let mut at = 0;
        for face in faces {
            sink.bytes(b"f")?;
            for &corner in face {
                let v = self.first + corner as usize;
                match (vt.get(at), vn.get(at)) {
                    (None, None) => sink.text(format_args!(" {v}"))?,
                    (Some(vt), None) => sink.text(format_args!(" {v}/{vt}"))?,
                    (None, Some(vn)) => sink.text(format_args!(" {v}//{vn}"))?,
                    (Some(vt), Some(vn)) => sink.text(format_args!(" {v}/{vt}/{vn}"))?,
                }
                at += 1;
            }
            sink.bytes(b"\n")?;
        }
        match geometry {
            Geometry::Polyline(line) if points.len() > 1 => {
                sink.bytes(b"l")?;
                let closing = line.is_closed().then_some(0);
                for index in (0..points.len()).chain(closing) {
                    sink.text(format_args!(" {}", self.first + index))?;
                }
                sink.bytes(b"\n")?;
            }
            Geometry::GeometricGraph(graph) => {
                for ends in graph.edges() {
                    let [a, b] = ends.map(|end| self.first + end as usize);
                    sink.text(format_args!("l {a} {b}\n"))?;
                }
            }
            Geometry::PointCloud(_) => {
                for index in 0..points.len() {
                    sink.text(format_args!("p {}\n", self.first + index))?;
                }
            }
            _ => {}
        }
        self.first += points.len();
        Ok(())
    }
}

/// The index of each corner's tuple, from 1; new tuples are written as they are met. Values of corners come before
/// those of vertices.
fn indices(
    word: &str,
    vertex: Option<&Column>,
    wedge: Option<&Column>,
    corners: &[u32],
    pool: &mut Pool,
    sink: &mut Sink<'_>,
) -> Result<Vec<usize>, WriteError> {
    let mut found = Vec::new();
    let Some(column) = wedge.or(vertex) else {
        return Ok(found);
    };
    for (index, &corner) in corners.iter().enumerate() {
        let element = if wedge.is_some() { index } else { corner as usize };
        let numbers: Vec<f64> = (0..column.width()).map(|component| column.number(element, component)).collect();
        let next = pool.0.len() + 1;
        let known = *pool.0.entry(numbers.iter().map(|number| number.to_bits()).collect()).or_insert(next);
        if known == next {
            sink.bytes(word.as_bytes())?;
            for &number in &numbers {
                sink.text(format_args!(" {}", shortest(number)))?;
            }
            sink.bytes(b"\n")?;
        }
        found.push(known);
    }
    Ok(found)
}

/// A column of finite floating numbers of that name and width.
fn floating<'g>(geometry: &'g Geometry, domain: Domain, name: &str, width: usize) -> Option<&'g Column> {
    let column = columns_of(geometry, domain)?.get(name)?;
    let floating = match column.values() {
        Values::F32(values) => values.iter().all(|value| value.is_finite()),
        Values::F64(values) => values.iter().all(|value| value.is_finite()),
        _ => false,
    };
    (floating && column.width() == width).then_some(column)
}

fn is_color(column: &Column) -> bool {
    let known = matches!(column.values(), Values::F32(_) | Values::F64(_) | Values::U8(_) | Values::U16(_));
    known && (3..=4).contains(&column.width())
}

/// A colour as fraction in sRGB.
fn fraction(column: &Column, element: usize, component: usize) -> f64 {
    let number = column.number(element, component);
    match column.values() {
        Values::U8(_) => number / f64::from(u8::MAX),
        Values::U16(_) => number / f64::from(u16::MAX),
        // Four digits more than bytes have; NaN becomes 0.
        _ => (srgb(number.clamp(0.0, 1.0).max(0.0)) * 1e6).round() / 1e6,
    }
}

/// Says what of a column is not written.
fn lose(geometry: &Geometry, domain: Domain, column: &Column, losses: &mut Losses) {
    let name = column.name();
    let has_faces = matches!(geometry, Geometry::TriMesh(_) | Geometry::PolyMesh(_));
    let width = if name == NORMAL { 3 } else { 2 };
    match (name, domain) {
        (COLOR, Domain::Vertex) if is_color(column) => {
            if column.width() == 4 {
                losses.column(domain, name, "OBJ has no alpha for vertices");
            }
            if matches!(column.values(), Values::F32(_) | Values::F64(_)) {
                losses.column(domain, name, "linear colours were written as sRGB in six digits");
            }
        }
        (NORMAL | TEXCOORD, Domain::Vertex | Domain::Wedge) if has_faces => {
            if floating(geometry, domain, name, width).is_none() {
                losses.column(domain, name, format!("OBJ takes {width} finite floating numbers"));
            } else if domain == Domain::Vertex && floating(geometry, Domain::Wedge, name, width).is_some() {
                losses.column(domain, name, "the wedge attribute of that name was written");
            }
        }
        _ => losses.column(domain, name, "OBJ has no place for it"),
    }
}
