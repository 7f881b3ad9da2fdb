//! Writing PLY.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::Report;
use shapeloom_mesh::{Column, Domain, TEXCOORD};
use shapeloom_shape::{Geometry, Shape};

use super::FORMAT;
use super::properties::{Property, Type, properties};
use crate::placed::{Losses, columns_of, frame_losses, placed_part, points_of};
use crate::sink::Sink;
use crate::{WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).sum())?;
    let placed: Result<Vec<Arc<Geometry>>, WriteError> =
        shape.parts.iter().enumerate().map(|(index, part)| placed_part(FORMAT.id, index, part)).collect();
    let parts = placed?;
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    let layout = Layout::new(&parts, &mut losses)?;

    let mut sink = Sink::new(out, &context.exec);
    layout.header(&mut sink)?;
    let mut row = Vec::new();
    for part in &parts {
        let columns = chosen(part, Domain::Vertex, &layout.vertex);
        for (index, point) in points_of(part).unwrap_or(&[]).iter().enumerate() {
            row.clear();
            for coordinate in point.to_array() {
                layout.position.put(coordinate, &mut row);
            }
            put_columns(&layout.vertex, &columns, index, &mut row);
            sink.bytes(&row)?;
        }
    }
    layout.faces(&parts, &mut sink)?;
    let mut first = 0;
    for part in &parts {
        let mut edge = |ends: [usize; 2]| {
            row.clear();
            ends.into_iter().for_each(|end| Type::Int.put((first + end) as f64, &mut row));
            sink.bytes(&row)
        };
        match &**part {
            Geometry::Polyline(line) => {
                let count = line.points().len();
                (0..line.segments().count()).try_for_each(|start| edge([start, (start + 1) % count]))?;
            }
            Geometry::GeometricGraph(graph) => {
                graph.edges().iter().try_for_each(|ends| edge(ends.map(|end| end as usize)))?;
            }
            _ => {}
        }
        first += points_of(part).map_or(0, <[_]>::len);
    }
    sink.finish()?;
    let mut report = Report::exact("write-ply", "positions keep all of their bits");
    report.losses = losses.into_vec();
    report.figure("vertices", layout.vertices as f64);
    report.figure("faces", layout.faces as f64);
    Ok(report)
}

/// What the header says.
struct Layout {
    vertices: usize,
    faces: usize,
    edges: usize,
    position: Type,
    /// The type of the number of corners.
    corners: Type,
    vertex: Vec<Property>,
    face: Vec<Property>,
    /// The type of the texture coordinates of corners and of their number, if there are any.
    wedge: Option<(Type, Type)>,
}

impl Layout {
    fn new(parts: &[Arc<Geometry>], losses: &mut Losses) -> Result<Self, WriteError> {
        let vertices: usize = parts.iter().filter_map(|part| points_of(part)).map(<[_]>::len).sum();
        if vertices > i32::MAX as usize {
            let (found, max) = (vertices as u64, i32::MAX as u64);
            return Err(WriteError::TooLarge { format: FORMAT.id, what: "vertices", found, max });
        }
        let coordinates = parts.iter().filter_map(|part| points_of(part)).flatten().flat_map(|point| point.to_array());
        let most = parts.iter().map(|part| most_corners(part)).max().unwrap_or(0);
        let count_type = |most: usize| if most <= usize::from(u8::MAX) { Type::Uchar } else { Type::Uint };
        let meshes = || parts.iter().filter(|part| face_count(part) > 0);
        for column in meshes().flat_map(|part| columns_of(part, Domain::Wedge).into_iter().flatten()) {
            if column.name() != TEXCOORD || column.width() != 2 {
                losses.column(Domain::Wedge, column.name(), "PLY has no customary place for values of corners");
            }
        }
        let texcoords: Vec<Option<&Column>> = meshes().map(|part| corner_texcoords(part)).collect();
        let all: Option<Vec<&Column>> = texcoords.iter().copied().collect();
        if all.is_none() && texcoords.iter().any(Option::is_some) {
            losses.column(Domain::Wedge, TEXCOORD, "not every part has it");
        }
        let wedge = all.filter(|all| !all.is_empty()).map(|all| {
            let numbers = all.iter().flat_map(|uv| (0..uv.len()).flat_map(|i| [uv.number(i, 0), uv.number(i, 1)]));
            (count_type(most * 2), Type::of_floats(numbers))
        });
        Ok(Self {
            vertices,
            faces: parts.iter().map(|part| face_count(part)).sum(),
            edges: parts.iter().map(|part| edge_count(part)).sum(),
            position: Type::of_floats(coordinates),
            corners: count_type(most),
            vertex: properties(parts, Domain::Vertex, losses),
            face: properties(parts, Domain::Face, losses),
            wedge,
        })
    }

    fn header(&self, sink: &mut Sink<'_>) -> Result<(), WriteError> {
        sink.bytes(b"ply\nformat binary_little_endian 1.0\ncomment written by shapeloom\n")?;
        sink.text(format_args!("element vertex {}\n", self.vertices))?;
        for axis in ["x", "y", "z"] {
            sink.text(format_args!("property {} {axis}\n", self.position.name()))?;
        }
        declare(&self.vertex, sink)?;
        if self.faces > 0 {
            sink.text(format_args!("element face {}\n", self.faces))?;
            sink.text(format_args!("property list {} int vertex_indices\n", self.corners.name()))?;
            if let Some((count, number)) = self.wedge {
                sink.text(format_args!("property list {} {} texcoord\n", count.name(), number.name()))?;
            }
            declare(&self.face, sink)?;
        }
        if self.edges > 0 {
            sink.text(format_args!("element edge {}\nproperty int vertex1\nproperty int vertex2\n", self.edges))?;
        }
        sink.bytes(b"end_header\n")
    }

    fn faces(&self, parts: &[Arc<Geometry>], sink: &mut Sink<'_>) -> Result<(), WriteError> {
        let mut row = Vec::new();
        let mut first = 0;
        for part in parts {
            let columns = chosen(part, Domain::Face, &self.face);
            let texcoords = self.wedge.zip(corner_texcoords(part));
            let mut wedge = 0;
            let mut put = |index: usize, corners: &[u32]| {
                row.clear();
                self.corners.put(corners.len() as f64, &mut row);
                for &corner in corners {
                    Type::Int.put((first + corner as usize) as f64, &mut row);
                }
                if let Some(((count, number), column)) = texcoords {
                    count.put(corners.len() as f64 * 2.0, &mut row);
                    for corner in wedge..wedge + corners.len() {
                        number.put(column.number(corner, 0), &mut row);
                        number.put(column.number(corner, 1), &mut row);
                    }
                }
                wedge += corners.len();
                put_columns(&self.face, &columns, index, &mut row);
                sink.bytes(&row)
            };
            match &**part {
                Geometry::TriMesh(mesh) => {
                    mesh.triangles().iter().enumerate().try_for_each(|(index, corners)| put(index, corners))?;
                }
                Geometry::PolyMesh(mesh) => {
                    mesh.faces().enumerate().try_for_each(|(index, corners)| put(index, corners))?;
                }
                _ => {}
            }
            first += points_of(part).map_or(0, <[_]>::len);
        }
        Ok(())
    }
}

fn declare(properties: &[Property], sink: &mut Sink<'_>) -> Result<(), WriteError> {
    for property in properties {
        for name in &property.names {
            sink.text(format_args!("property {} {name}\n", property.kind.name()))?;
        }
    }
    Ok(())
}

fn chosen<'g>(part: &'g Geometry, domain: Domain, properties: &[Property]) -> Vec<Option<&'g Column>> {
    let columns = columns_of(part, domain);
    properties.iter().map(|property| columns?.get(&property.column)).collect()
}

fn put_columns(properties: &[Property], columns: &[Option<&Column>], element: usize, row: &mut Vec<u8>) {
    for (property, column) in properties.iter().zip(columns) {
        for component in 0..property.names.len() {
            let number = column.map_or(0.0, |column| property.number(column, element, component));
            property.kind.put(number, row);
        }
    }
}

fn face_count(part: &Geometry) -> usize {
    match part {
        Geometry::TriMesh(mesh) => mesh.triangles().len(),
        Geometry::PolyMesh(mesh) => mesh.face_count(),
        _ => 0,
    }
}

fn edge_count(part: &Geometry) -> usize {
    match part {
        Geometry::Polyline(line) => line.segments().count(),
        Geometry::GeometricGraph(graph) => graph.edges().len(),
        _ => 0,
    }
}

fn most_corners(part: &Geometry) -> usize {
    match part {
        Geometry::TriMesh(_) => 3,
        Geometry::PolyMesh(mesh) => mesh.faces().map(<[_]>::len).max().unwrap_or(0),
        _ => 0,
    }
}

fn corner_texcoords(part: &Geometry) -> Option<&Column> {
    columns_of(part, Domain::Wedge)?.get(TEXCOORD).filter(|column| column.width() == 2)
}
