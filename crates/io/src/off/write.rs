//! Writing OFF.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Deviation, Report};
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, TEXCOORD, Values};
use shapeloom_shape::{Geometry, Shape};

use super::{COLORMAP, FORMAT, NO_INDEX};
use crate::color::linear;
use crate::placed::{Losses, columns_of, frame_losses, moved, placed_part, points_of};
use crate::sink::Sink;
use crate::text::{push_count, push_number};
use crate::{Encoding, WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).sum())?;
    let placed: Result<Vec<Arc<Geometry>>, WriteError> =
        shape.parts.iter().enumerate().map(|(index, part)| placed_part(FORMAT.id, index, part)).collect();
    let parts = placed?;
    let binary = matches!(context.options.encoding, Encoding::Binary | Encoding::BinaryBigEndian);
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    let layout = Layout::new(&parts, binary, &mut losses)?;
    let mut writer =
        Writer { sink: Sink::new(out, &context.exec), layout, row: Vec::new(), rounding: 0.0, rounded: false };
    writer.header()?;
    for (index, part) in parts.iter().enumerate() {
        writer.vertices(index, &shape.parts[index].name, part)?;
    }
    let mut first = 0;
    for part in &parts {
        writer.faces(part, first)?;
        first += points_of(part).map_or(0, <[_]>::len) as u32;
    }
    let Writer { sink, layout, rounding, rounded, .. } = writer;
    sink.finish()?;
    let mut report = if rounding > 0.0 {
        losses.push("positions", format!("they were rounded to single precision, by at most {rounding:e}"));
        let basis = "the largest rounding of a position to single precision, measured";
        Report::new("write-off", Deviation::AtMost(rounding), basis)
    } else if binary {
        Report::exact("write-off", "every position is a number of single precision")
    } else {
        Report::exact("write-off", "the shortest decimal numbers that read back to the same bits")
    };
    if binary && [layout.vertex_color, layout.face_color].iter().flatten().any(|channels| channels.bytes) {
        losses.push("colours in bytes", "binary OFF has fractions, as which they were written, linear");
    }
    if rounded {
        losses.push("values of vertices and faces", "they were rounded to single precision");
    }
    report.losses = losses.into_vec();
    report.figure("vertices", layout.vertices as f64);
    report.figure("faces", layout.faces as f64);
    Ok(report)
}

/// What the file holds.
struct Layout {
    binary: bool,
    vertices: usize,
    faces: usize,
    normal: bool,
    texcoord: bool,
    /// The channels of the colours of vertices.
    vertex_color: Option<Channels>,
    /// The channels of the colours of faces, where there are any.
    face_color: Option<Channels>,
    /// Whether faces without a colour have an index into a colour map.
    index: bool,
}

/// How colours are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Channels {
    width: usize,
    bytes: bool,
}

impl Layout {
    fn new(parts: &[Arc<Geometry>], binary: bool, losses: &mut Losses) -> Result<Self, WriteError> {
        let vertices: usize = parts.iter().filter_map(|part| points_of(part)).map(<[_]>::len).sum();
        let faces: usize = parts.iter().map(|part| face_count(part)).sum();
        for (what, found) in [("vertices", vertices), ("faces", faces)] {
            let (found, max) = (found as u64, i32::MAX as u64);
            if found > max {
                return Err(WriteError::TooLarge { format: FORMAT.id, what, found, max });
            }
        }
        let vertex =
            |name: &str, width: usize| everywhere(parts, Domain::Vertex, name, |column| floating(column, width));
        let normal = vertex(NORMAL, 3);
        let texcoord = vertex(TEXCOORD, 2);
        let vertex_color = channels(parts, Domain::Vertex, losses);
        let face_color = channels(parts, Domain::Face, losses);
        let index = face_color.is_none() && everywhere(parts, Domain::Face, COLORMAP, is_index);
        for part in parts {
            for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
                for column in columns_of(part, domain).into_iter().flatten() {
                    let why = match (domain, column.name()) {
                        (Domain::Vertex, NORMAL) if normal => continue,
                        (Domain::Vertex, TEXCOORD) if texcoord => continue,
                        (Domain::Vertex, COLOR) if vertex_color.is_some() => continue,
                        (Domain::Face, COLOR) if face_color.is_some() => continue,
                        (Domain::Face, COLORMAP) if index => continue,
                        (Domain::Face, COLORMAP) if face_color.is_some() => "faces have colours instead",
                        (Domain::Vertex, NORMAL | TEXCOORD | COLOR) | (Domain::Face, COLOR | COLORMAP) => {
                            "OFF takes it if every part has it in the same type, and finite"
                        }
                        _ => "OFF has no place for it",
                    };
                    losses.column(domain, column.name(), why);
                }
            }
        }
        Ok(Self { binary, vertices, faces, normal, texcoord, vertex_color, face_color, index })
    }
}

struct Writer<'o> {
    sink: Sink<'o>,
    layout: Layout,
    row: Vec<u8>,
    rounding: f64,
    /// Whether numbers other than positions were rounded.
    rounded: bool,
}

impl Writer<'_> {
    fn header(&mut self) -> Result<(), WriteError> {
        let Layout { binary, vertices, faces, normal, texcoord, vertex_color, .. } = self.layout;
        for (there, word) in [(texcoord, "ST"), (vertex_color.is_some(), "C"), (normal, "N")] {
            self.sink.bytes(if there { word.as_bytes() } else { b"" })?;
        }
        if !binary {
            return self.sink.text(format_args!("OFF\n{vertices} {faces} 0\n"));
        }
        self.sink.bytes(b"OFF BINARY\n")?;
        for count in [vertices as i32, faces as i32, 0] {
            self.sink.bytes(&count.to_be_bytes())?;
        }
        Ok(())
    }

    fn vertices(&mut self, index: usize, name: &str, part: &Geometry) -> Result<(), WriteError> {
        let chosen = |there: bool, name: &str| columns_of(part, Domain::Vertex)?.get(name).filter(|_| there);
        let normals = chosen(self.layout.normal, NORMAL);
        let colors = chosen(self.layout.vertex_color.is_some(), COLOR).zip(self.layout.vertex_color);
        let texcoords = chosen(self.layout.texcoord, TEXCOORD);
        for (vertex, &point) in points_of(part).unwrap_or(&[]).iter().enumerate() {
            self.row.clear();
            if self.layout.binary {
                let single = point.as_vec3();
                if !single.is_finite() {
                    let (name, element) = (name.to_owned(), "vertex");
                    return Err(WriteError::NotFinite { format: FORMAT.id, part: index, name, element, index: vertex });
                }
                self.rounding = self.rounding.max(moved(point, single.as_dvec3()));
                single.to_array().iter().for_each(|number| self.row.extend_from_slice(&number.to_be_bytes()));
            } else {
                let DVec3 { x, y, z } = point;
                push_number(&mut self.row, x);
                self.row.push(b' ');
                push_number(&mut self.row, y);
                self.row.push(b' ');
                push_number(&mut self.row, z);
            }
            if let Some(column) = normals {
                (0..3).for_each(|component| self.number(column.number(vertex, component)));
            }
            if let Some((column, channels)) = colors {
                self.color(column, channels, vertex);
            }
            if let Some(column) = texcoords {
                (0..2).for_each(|component| self.number(column.number(vertex, component)));
            }
            self.end_row()?;
        }
        Ok(())
    }

    fn end_row(&mut self) -> Result<(), WriteError> {
        if !self.layout.binary {
            self.row.push(b'\n');
        }
        self.sink.bytes(&self.row)
    }

    /// A number after others on its row.
    fn number(&mut self, number: f64) {
        if self.layout.binary {
            self.rounded |= f64::from(number as f32).to_bits() != number.to_bits();
            self.row.extend_from_slice(&(number as f32).to_be_bytes());
        } else {
            self.row.push(b' ');
            push_number(&mut self.row, number);
        }
    }

    fn color(&mut self, column: &Column, channels: Channels, element: usize) {
        let width = if self.layout.binary { 4 } else { channels.width };
        for component in 0..width {
            let there = component < column.width();
            let full = if channels.bytes { 255.0 } else { 1.0 };
            let number = if there { column.number(element, component) } else { full };
            match (self.layout.binary, channels.bytes) {
                // Binary colours are fractions, and fractions are linear.
                (true, true) if component < 3 => self.number(linear(number / 255.0)),
                (true, bytes) => self.number(if bytes { number / 255.0 } else { number }),
                (false, true) => {
                    self.row.push(b' ');
                    push_count(&mut self.row, number as u64);
                }
                (false, false) => {
                    let start = self.row.len();
                    self.number(number);
                    // A fraction without a point would be read as a byte.
                    if self.row[start..].iter().all(|byte| !matches!(byte, b'.' | b'e')) {
                        self.row.extend_from_slice(b".0");
                    }
                }
            }
        }
    }

    fn faces(&mut self, part: &Geometry, first: u32) -> Result<(), WriteError> {
        let columns = columns_of(part, Domain::Face);
        let colors = columns.and_then(|columns| columns.get(COLOR)).zip(self.layout.face_color);
        let indices = columns.and_then(|columns| columns.get(COLORMAP)).filter(|_| self.layout.index);
        match part {
            Geometry::TriMesh(mesh) if !self.layout.binary && colors.is_none() && indices.is_none() => {
                mesh.triangles().iter().try_for_each(|&[a, b, c]| {
                    self.row.clear();
                    self.row.extend_from_slice(b"3 ");
                    push_count(&mut self.row, u64::from(first + a));
                    self.row.push(b' ');
                    push_count(&mut self.row, u64::from(first + b));
                    self.row.push(b' ');
                    push_count(&mut self.row, u64::from(first + c));
                    self.row.push(b'\n');
                    self.sink.bytes(&self.row)
                })
            }
            Geometry::TriMesh(mesh) => {
                let mut faces = mesh.triangles().iter().enumerate();
                faces.try_for_each(|(face, corners)| self.face(face, corners, first, colors, indices))
            }
            Geometry::PolyMesh(mesh) => {
                let mut faces = mesh.faces().enumerate();
                faces.try_for_each(|(face, corners)| self.face(face, corners, first, colors, indices))
            }
            _ => Ok(()),
        }
    }

    fn face(
        &mut self,
        face: usize,
        corners: &[u32],
        first: u32,
        colors: Option<(&Column, Channels)>,
        indices: Option<&Column>,
    ) -> Result<(), WriteError> {
        self.row.clear();
        let index = indices.map(|column| column.number(face, 0)).filter(|&index| index != f64::from(NO_INDEX));
        if self.layout.binary {
            self.row.extend_from_slice(&(corners.len() as i32).to_be_bytes());
            corners.iter().for_each(|corner| self.row.extend_from_slice(&(first + corner).to_be_bytes()));
            let channels: i32 = if colors.is_some() { 4 } else { i32::from(index.is_some()) };
            self.row.extend_from_slice(&channels.to_be_bytes());
        } else {
            push_count(&mut self.row, corners.len() as u64);
            for corner in corners {
                self.row.push(b' ');
                push_count(&mut self.row, u64::from(first + corner));
            }
        }
        if let Some((column, channels)) = colors {
            self.color(column, channels, face);
        }
        match index {
            Some(index) if self.layout.binary => self.number(index),
            Some(index) => {
                self.row.push(b' ');
                push_count(&mut self.row, index as u64);
            }
            None => {}
        }
        self.end_row()
    }
}

/// How the colours of all parts are written, if all have them in one type.
fn channels(parts: &[Arc<Geometry>], domain: Domain, losses: &mut Losses) -> Option<Channels> {
    if !everywhere(parts, domain, COLOR, is_color) {
        return None;
    }
    let columns = || parts.iter().filter_map(|part| columns_of(part, domain)?.get(COLOR));
    let bytes = |column: &Column| matches!(column.values(), Values::U8(_));
    let all_bytes = columns().all(bytes);
    if !all_bytes && columns().any(bytes) {
        return None;
    }
    let mut width = columns().map(Column::width).max()?;
    if columns().any(|column| column.width() < width) {
        losses.column(domain, COLOR, "colours without alpha among others that have it are opaque");
    }
    let dark = |column: &Column| matches!(column.values(), Values::U8(values) if values.iter().all(|&byte| byte <= 1));
    if domain == Domain::Vertex && all_bytes && columns().all(dark) {
        // Whole numbers of vertices up to 1 are read as fractions; an alpha of 255 says that they are bytes.
        width = 4;
    }
    Some(Channels { width, bytes: all_bytes })
}

fn is_color(column: &Column) -> bool {
    let fine = match column.values() {
        Values::U8(_) => true,
        Values::F32(values) => values.iter().all(|value| value.is_finite() && *value >= 0.0),
        Values::F64(values) => values.iter().all(|value| value.is_finite() && *value >= 0.0),
        _ => false,
    };
    fine && (3..=4).contains(&column.width())
}

fn is_index(column: &Column) -> bool {
    column.width() == 1 && matches!(column.values(), Values::U32(_))
}

fn floating(column: &Column, width: usize) -> bool {
    let fine = match column.values() {
        Values::F32(values) => values.iter().all(|value| value.is_finite()),
        Values::F64(values) => values.iter().all(|value| value.is_finite()),
        _ => false,
    };
    fine && column.width() == width
}

/// Whether every part that has such elements has a fitting column of that name, and some part has.
fn everywhere(parts: &[Arc<Geometry>], domain: Domain, name: &str, fits: impl Fn(&Column) -> bool) -> bool {
    let mut having = parts.iter().filter(|part| element_count(part, domain) > 0).peekable();
    having.peek().is_some()
        && having.all(|part| columns_of(part, domain).and_then(|columns| columns.get(name)).is_some_and(&fits))
}

fn element_count(part: &Geometry, domain: Domain) -> usize {
    match domain {
        Domain::Vertex => points_of(part).map_or(0, <[_]>::len),
        _ => face_count(part),
    }
}

fn face_count(part: &Geometry) -> usize {
    match part {
        Geometry::TriMesh(mesh) => mesh.triangles().len(),
        Geometry::PolyMesh(mesh) => mesh.face_count(),
        _ => 0,
    }
}
