//! Writing PLY.

use std::io::Write;
use std::sync::Arc;

use shapeloom_core::Report;
use shapeloom_mesh::{Column, Domain, TEXCOORD, Values};
use shapeloom_shape::{Geometry, Shape, Table};

use super::FORMAT;
use super::encode::{Ascii, Big, Laid, Little};
use super::header::OBJ_INFO;
use super::plan::{CORNERS, ENDS};
use super::properties::{Properties, Set, count_type, put_count, safe};
use super::shared::shared_vertices;
use super::types::Type;
use crate::placed::{Losses, columns_of, edge_columns_of, frame_losses, placed_part, points_of};
use crate::sink::Sink;
use crate::{Encoding, WriteContext, WriteError};

pub(super) fn write(shape: &Shape, context: &WriteContext, out: &mut dyn Write) -> Result<Report, WriteError> {
    let _memory = context.exec.reserve(shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).sum())?;
    let placed: Result<Vec<Arc<Geometry>>, WriteError> =
        shape.parts.iter().enumerate().map(|(index, part)| placed_part(FORMAT.id, index, part)).collect();
    let parts = placed?;
    let mut losses = Losses::from(frame_losses(shape, &FORMAT));
    let file = File::new(shape, &parts, &mut losses)?;
    let mut sink = Sink::new(out, &context.exec);
    match context.options.encoding {
        Encoding::Ascii => file.write::<Ascii>(&mut sink)?,
        Encoding::BinaryBigEndian => file.write::<Big>(&mut sink)?,
        Encoding::Automatic | Encoding::Binary => file.write::<Little>(&mut sink)?,
    }
    sink.finish()?;
    let mut report = Report::exact("write-ply", "positions keep all of their bits");
    report.losses = losses.into_vec();
    report.figure("vertices", file.vertices as f64);
    report.figure("faces", file.faces as f64);
    Ok(report)
}

/// What is written.
struct File<'s> {
    parts: &'s [Arc<Geometry>],
    /// The vertices of others that serve a part, where it has none of its own in the file.
    shared: Vec<Option<Vec<u32>>>,
    comments: Vec<&'s str>,
    vertices: usize,
    faces: usize,
    /// Whether some part is a mesh, though it may have no faces: without the element it would come back as points.
    has_faces: bool,
    edges: usize,
    position: Type,
    /// The type of the number of corners.
    corners: Type,
    vertex: Properties,
    face: Properties,
    edge: Properties,
    /// The type of the texture coordinates of corners and of their number, if there are any.
    wedge: Option<(Type, Type)>,
    tables: Vec<(&'s Table, String, Properties)>,
}

impl<'s> File<'s> {
    fn new(shape: &'s Shape, parts: &'s [Arc<Geometry>], losses: &mut Losses) -> Result<Self, WriteError> {
        let shared = shared_vertices(parts);
        let own = || parts.iter().zip(&shared).filter(|(_, shared)| shared.is_none()).map(|(part, _)| part);
        let vertices: usize = own().filter_map(|part| points_of(part)).map(<[_]>::len).sum();
        if vertices > i32::MAX as usize {
            let (found, max) = (vertices as u64, i32::MAX as u64);
            return Err(WriteError::TooLarge { format: FORMAT.id, what: "vertices", found, max });
        }
        let coordinates = parts.iter().filter_map(|part| points_of(part)).flatten().flat_map(|point| point.to_array());
        let most = parts.iter().map(|part| most_corners(part)).max().unwrap_or(0);
        let sets = |count: fn(&Geometry) -> usize, domain: Domain| -> Vec<Set<'_>> {
            parts.iter().map(|part| (count(part), columns_of(part, domain))).collect()
        };
        let edge_sets: Vec<Set<'_>> = parts.iter().map(|part| (edge_count(part), edge_columns_of(part))).collect();
        let point_count = |part: &Arc<Geometry>| points_of(part).map_or(0, <[_]>::len);
        let vertex_sets: Vec<Set<'_>> =
            own().map(|part| (point_count(part), columns_of(part, Domain::Vertex))).collect();
        let wedge = wedge_types(parts, losses);
        let face_names: &[&str] =
            if wedge.is_some() { &[CORNERS[0], CORNERS[1], TEXCOORD] } else { &[CORNERS[0], CORNERS[1]] };
        let mut file = Self {
            parts,
            shared: Vec::new(),
            comments: Vec::new(),
            vertices,
            faces: parts.iter().map(|part| face_count(part)).sum(),
            has_faces: parts.iter().any(|part| match &**part {
                Geometry::TriMesh(mesh) => !mesh.positions().is_empty(),
                Geometry::PolyMesh(mesh) => !mesh.positions().is_empty(),
                _ => false,
            }),
            edges: parts.iter().map(|part| edge_count(part)).sum(),
            position: Type::of_floats(coordinates),
            corners: count_type(most),
            vertex: Properties::new(&vertex_sets, "vertex", &["x", "y", "z"], losses),
            face: Properties::new(&sets(face_count, Domain::Face), "face", face_names, losses),
            edge: Properties::new(&edge_sets, "edge", &ENDS, losses),
            wedge,
            tables: Vec::new(),
        };
        file.shared = shared;
        for comment in &shape.comments {
            let before = file.comments.len();
            file.comments.extend(comment.split(['\n', '\r']).filter(|line| !line.is_empty() || comment.is_empty()));
            if file.comments.len() != before + 1 || file.comments.last() != Some(&comment.as_str()) {
                losses.push("line ends in comments", "each line is a comment of its own");
            }
        }
        for table in &shape.tables {
            file.table(table, losses);
        }
        Ok(file)
    }

    fn table(&mut self, table: &'s Table, losses: &mut Losses) {
        let name = safe(&table.name);
        let has_list = |names: &[&str]| names.iter().any(|name| table.columns.list(name).is_some());
        let taken = match name.as_str() {
            "" | "vertex" => true,
            "face" => self.has_faces || has_list(&CORNERS),
            "tristrips" => has_list(&CORNERS),
            "edge" => self.edges > 0 || ENDS.iter().all(|name| table.columns.get(name).is_some()),
            _ => false,
        };
        if taken || self.tables.iter().any(|(_, other, _)| *other == name) {
            losses.push(format!("table \"{}\"", table.name), "another element of the file has its name");
            return;
        }
        if name != table.name {
            losses.push(format!("table \"{}\"", table.name), format!("its name in the file is \"{name}\""));
        }
        let set = (table.columns.len().max(1), Some(&table.columns));
        let properties = Properties::new(&[set], &format!("table \"{name}\""), &[], losses);
        self.tables.push((table, name, properties));
    }

    fn write<L: Laid>(&self, sink: &mut Sink<'_>) -> Result<(), WriteError> {
        sink.bytes(self.header(L::NAME).as_bytes())?;
        let parts = || self.parts.iter().zip(&self.shared);
        for (part, _) in parts().filter(|(_, shared)| shared.is_none()) {
            self.vertices::<L>(part, sink)?;
        }
        let count = |part: &Geometry| points_of(part).map_or(0, <[_]>::len) as u32;
        let mut first = 0;
        for (part, shared) in parts() {
            self.faces::<L>(part, first, sink)?;
            first += if shared.is_none() { count(part) } else { 0 };
        }
        let mut first = 0;
        for (part, shared) in parts() {
            self.edges::<L>(part, first, shared.as_deref(), sink)?;
            first += if shared.is_none() { count(part) } else { 0 };
        }
        for (table, _, properties) in &self.tables {
            let sources = properties.of(Some(&table.columns));
            if properties.columns.is_empty() && properties.lists.is_empty() {
                continue;
            }
            for row in 0..table.columns.len() {
                sink.piece(|out| {
                    sources.put::<L>(row, out);
                    L::end_row(out);
                })?;
            }
        }
        Ok(())
    }

    fn header(&self, layout: &str) -> String {
        let mut out = format!("ply\nformat {layout} 1.0\n");
        for comment in &self.comments {
            match comment.strip_prefix(OBJ_INFO) {
                Some(_) => out.push_str(comment),
                None if comment.is_empty() => out.push_str("comment"),
                None => {
                    out.push_str("comment ");
                    out.push_str(comment);
                }
            }
            out.push('\n');
        }
        out.push_str(&format!("element vertex {}\n", self.vertices));
        for axis in ["x", "y", "z"] {
            out.push_str(&format!("property {} {axis}\n", self.position.name()));
        }
        self.vertex.declare(&mut out);
        if self.has_faces {
            out.push_str(&format!("element face {}\n", self.faces));
            out.push_str(&format!("property list {} int vertex_indices\n", self.corners.name()));
            if let Some((count, number)) = self.wedge {
                out.push_str(&format!("property list {} {} texcoord\n", count.name(), number.name()));
            }
            self.face.declare(&mut out);
        }
        if self.edges > 0 {
            out.push_str(&format!("element edge {}\nproperty int vertex1\nproperty int vertex2\n", self.edges));
            self.edge.declare(&mut out);
        }
        for (table, name, properties) in &self.tables {
            out.push_str(&format!("element {name} {}\n", table.columns.len()));
            properties.declare(&mut out);
        }
        out + "end_header\n"
    }

    fn vertices<L: Laid>(&self, part: &Geometry, sink: &mut Sink<'_>) -> Result<(), WriteError> {
        let sources = self.vertex.of(columns_of(part, Domain::Vertex));
        let floats = self.position == Type::Float;
        for (index, point) in points_of(part).unwrap_or(&[]).iter().enumerate() {
            sink.piece(|out| {
                for number in point.to_array() {
                    if floats { L::put(number as f32, out) } else { L::put(number, out) }
                }
                sources.put::<L>(index, out);
                L::end_row(out);
            })?;
        }
        Ok(())
    }

    /// Writes the faces of a part whose vertices begin with that number.
    fn faces<L: Laid>(&self, part: &Geometry, first: u32, sink: &mut Sink<'_>) -> Result<(), WriteError> {
        let sources = self.face.of(columns_of(part, Domain::Face));
        let texcoords = self.wedge.zip(corner_texcoords(part));
        let mut wedge = 0;
        let mut put = |index: usize, corners: &[u32]| {
            sink.piece(|out| {
                put_count::<L>(self.corners, corners.len(), out);
                // Vertices are no more than an int counts.
                corners.iter().for_each(|corner| L::put((first + corner) as i32, out));
                if let Some(((count, kind), column)) = texcoords {
                    put_count::<L>(count, 2 * corners.len(), out);
                    put_texcoords::<L>(column, 2 * wedge..2 * (wedge + corners.len()), kind, out);
                }
                wedge += corners.len();
                sources.put::<L>(index, out);
                L::end_row(out);
            })
        };
        match part {
            Geometry::TriMesh(mesh) => {
                mesh.triangles().iter().enumerate().try_for_each(|(index, corners)| put(index, corners))
            }
            Geometry::PolyMesh(mesh) => mesh.faces().enumerate().try_for_each(|(index, corners)| put(index, corners)),
            _ => Ok(()),
        }
    }

    fn edges<L: Laid>(
        &self,
        part: &Geometry,
        first: u32,
        shared: Option<&[u32]>,
        sink: &mut Sink<'_>,
    ) -> Result<(), WriteError> {
        let number = |end: u32| shared.map_or(first + end, |shared| shared[end as usize]);
        let sources = self.edge.of(edge_columns_of(part));
        let mut put = |index: usize, ends: [u32; 2]| {
            sink.piece(|out| {
                ends.into_iter().for_each(|end| L::put(number(end) as i32, out));
                sources.put::<L>(index, out);
                L::end_row(out);
            })
        };
        match part {
            Geometry::Polyline(line) => {
                let count = line.points().len() as u32;
                (0..line.segments().count() as u32)
                    .try_for_each(|start| put(start as usize, [start, (start + 1) % count]))
            }
            Geometry::GeometricGraph(graph) => {
                graph.edges().iter().enumerate().try_for_each(|(index, &ends)| put(index, ends))
            }
            _ => Ok(()),
        }
    }
}

/// The types of the texture coordinates of corners and of their number; none where they cannot be written.
fn wedge_types(parts: &[Arc<Geometry>], losses: &mut Losses) -> Option<(Type, Type)> {
    let meshes = || parts.iter().filter(|part| face_count(part) > 0);
    for columns in meshes().filter_map(|part| columns_of(part, Domain::Wedge)) {
        let why = "PLY has no customary place for values of corners";
        for column in columns.iter().filter(|column| column.name() != TEXCOORD || !is_texcoord(column)) {
            losses.column(Domain::Wedge, column.name(), why);
        }
        for list in columns.lists() {
            losses.push(format!("wedge list \"{}\"", list.name()), why);
        }
    }
    let texcoords: Vec<Option<&Column>> = meshes().map(|part| corner_texcoords(part)).collect();
    let all: Option<Vec<&Column>> = texcoords.iter().copied().collect();
    if all.is_none() && texcoords.iter().any(Option::is_some) {
        losses.column(Domain::Wedge, TEXCOORD, "not every part has it");
    }
    let all = all.filter(|all| !all.is_empty())?;
    let most = parts.iter().map(|part| most_corners(part)).max().unwrap_or(0);
    let double = all.iter().any(|column| match column.values() {
        Values::F64(values) => Type::of_floats(values.iter().copied()) == Type::Double,
        _ => false,
    });
    Some((count_type(2 * most), if double { Type::Double } else { Type::Float }))
}

#[inline]
fn put_texcoords<L: Laid>(column: &Column, range: std::ops::Range<usize>, kind: Type, out: &mut Vec<u8>) {
    match (column.values(), kind) {
        (Values::F32(values), Type::Float) => {
            values.get(range).unwrap_or(&[]).iter().for_each(|&value| L::put(value, out));
        }
        (Values::F32(values), _) => {
            values.get(range).unwrap_or(&[]).iter().for_each(|&value| L::put(f64::from(value), out));
        }
        (Values::F64(values), Type::Float) => {
            values.get(range).unwrap_or(&[]).iter().for_each(|&value| L::put(value as f32, out));
        }
        (Values::F64(values), _) => values.get(range).unwrap_or(&[]).iter().for_each(|&value| L::put(value, out)),
        // No other values are texture coordinates.
        _ => {}
    }
}

fn is_texcoord(column: &Column) -> bool {
    column.width() == 2 && matches!(column.values(), Values::F32(_) | Values::F64(_))
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
    columns_of(part, Domain::Wedge)?.get(TEXCOORD).filter(|column| is_texcoord(column))
}
