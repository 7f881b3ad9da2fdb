//! What writers of formats without scenes share: parts put where they are, and the losses that the format's table entry
//! implies.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Loss};
use shapeloom_mesh::{AttributeError, Attributes, Column, Domain};
use shapeloom_shape::{Geometry, Part, Shape};

use crate::{Format, Keeps, WriteError};

/// The one part of a shape, for formats that hold one of `what`.
///
/// # Errors
/// No part, or several.
pub(crate) fn only_part<'a>(shape: &'a Shape, format: &Format, what: &'static str) -> Result<&'a Part, WriteError> {
    match shape.parts.as_slice() {
        [] => Err(WriteError::Empty { format: format.id }),
        [part] => Ok(part),
        several => Err(WriteError::TooLarge { format: format.id, what, found: several.len() as u64, max: 1 }),
    }
}

/// The losses that the format's table entry implies: names, parts, instances, materials, units, up axis, tables and
/// comments, and columns of lists and of edges, where the format does not keep them. A writer that says it keeps lists or
/// edge columns names those that it does not.
pub(crate) fn frame_losses(shape: &Shape, format: &Format) -> Vec<Loss> {
    let mut losses = Losses::default();
    let keeps = |what: Keeps| format.keeps.contains(&what);
    let name = format.name;
    if !keeps(Keeps::Parts) && shape.parts.len() > 1 {
        let count = shape.parts.len();
        losses.push(format!("{count} separate parts"), format!("{name} holds one: they were put together"));
    }
    if !keeps(Keeps::Names) {
        for part in shape.parts.iter().filter(|part| !part.name.is_empty()) {
            losses.push(format!("part name \"{}\"", part.name), format!("{name} has no place for it"));
        }
    }
    if !keeps(Keeps::Instances) {
        let placed = shape.parts.iter().filter(|part| part.placement != Affine::IDENTITY).count();
        if placed > 0 {
            let why = format!("{name} has none: they were applied to the coordinates");
            losses.push(format!("placements of {placed} parts"), why);
        }
        let mut seen = HashSet::new();
        let repeated = shape.parts.iter().filter(|part| !seen.insert(Arc::as_ptr(&part.geometry))).count();
        if repeated > 0 {
            let why = format!("{name} has none: each was written out");
            losses.push(format!("{repeated} instances of shared geometries"), why);
        }
    }
    if !keeps(Keeps::Materials) {
        for material in &shape.materials {
            let why = format!("{name} has no place for it");
            losses.push(format!("material \"{}\"", material.name), why);
        }
    }
    if let Some(units) = shape.units.filter(|_| !keeps(Keeps::Units)) {
        let why = format!("{name} has no place for it");
        losses.push(format!("unit of length ({} m)", units.meters()), why);
    }
    if let Some(up) = shape.up.filter(|_| !keeps(Keeps::UpAxis)) {
        losses.push(format!("up axis ({})", up.name()), format!("{name} has no place for it"));
    }
    if !keeps(Keeps::Tables) {
        for table in &shape.tables {
            losses.push(format!("table \"{}\"", table.name), format!("{name} has no place for it"));
        }
    }
    if !keeps(Keeps::Comments) && !shape.comments.is_empty() {
        let count = shape.comments.len();
        let what = if count == 1 { "1 comment".to_owned() } else { format!("{count} comments") };
        losses.push(what, format!("{name} has no place for them"));
    }
    for part in &shape.parts {
        column_losses(&part.geometry, format, &mut losses);
    }
    losses.into_vec()
}

/// Columns of lists and of edges that the format does not keep.
fn column_losses(geometry: &Geometry, format: &Format, losses: &mut Losses) {
    let edges = edge_columns_of(geometry);
    if !format.keeps.contains(&Keeps::EdgeColumns) {
        for column in edges.into_iter().flatten() {
            losses
                .push(format!("edge attribute \"{}\"", column.name()), format!("{} has no place for it", format.name));
        }
    }
    if format.keeps.contains(&Keeps::Lists) {
        return;
    }
    let why = || format!("{} has no place for lists", format.name);
    for domain in [Domain::Vertex, Domain::Face, Domain::Wedge] {
        for list in columns_of(geometry, domain).map_or(&[][..], Attributes::lists) {
            losses.push(format!("{domain} list \"{}\"", list.name()), why());
        }
    }
    for list in edges.map_or(&[][..], Attributes::lists) {
        losses.push(format!("edge list \"{}\"", list.name()), why());
    }
}

/// The geometry of a part where it is placed, with every position checked.
pub(crate) fn placed_part(format: &'static str, index: usize, part: &Part) -> Result<Arc<Geometry>, WriteError> {
    let geometry = part.placed();
    check_finite(format, index, part, &geometry)?;
    Ok(geometry)
}

/// Refuses positions that are not finite.
pub(crate) fn check_finite(
    format: &'static str,
    index: usize,
    part: &Part,
    geometry: &Geometry,
) -> Result<(), WriteError> {
    let first = |points: &[DVec3]| points.iter().position(|point| !point.is_finite());
    let found = match geometry {
        Geometry::BezierSurface(surface) => {
            let mut before = 0;
            surface.patches.iter().find_map(|patch| {
                let found = first(patch.control_points()).map(|point| before + point);
                before += patch.control_points().len();
                found
            })
        }
        Geometry::BezierCurve(curve) => first(curve.control_points()),
        geometry => points_of(geometry).and_then(first),
    };
    let element = match geometry {
        Geometry::BezierSurface(_) | Geometry::BezierCurve(_) => "control point",
        _ => "vertex",
    };
    match found {
        Some(at) => Err(WriteError::NotFinite { format, part: index, name: part.name.clone(), element, index: at }),
        None => Ok(()),
    }
}

/// How far a point moves, rounded up.
pub(crate) fn moved(from: DVec3, to: DVec3) -> f64 {
    let apart = (to - from).abs();
    let largest = apart.max_element();
    // In units of the largest component, as squares of tiny ones vanish; and the length itself is rounded.
    if largest == 0.0 { 0.0 } else { (apart / largest).length() * largest * (1.0 + 8.0 * f64::EPSILON) }
}

/// The vertices of a geometry made of vertices.
pub(crate) fn points_of(geometry: &Geometry) -> Option<&[DVec3]> {
    match geometry {
        Geometry::PointCloud(cloud) => Some(cloud.positions()),
        Geometry::Polyline(line) => Some(line.points()),
        Geometry::GeometricGraph(graph) => Some(graph.positions()),
        Geometry::PolyMesh(mesh) => Some(mesh.positions()),
        Geometry::TriMesh(mesh) => Some(mesh.positions()),
        _ => None,
    }
}

/// The columns of a geometry on one kind of element.
pub(crate) fn columns_of(geometry: &Geometry, domain: Domain) -> Option<&Attributes> {
    match (geometry, domain) {
        (Geometry::PointCloud(cloud), Domain::Vertex) => Some(cloud.attributes()),
        (Geometry::Polyline(line), Domain::Vertex) => Some(line.attributes()),
        (Geometry::GeometricGraph(graph), Domain::Vertex) => Some(graph.vertex_attributes()),
        (Geometry::PolyMesh(mesh), _) => Some(mesh.attributes().of(domain)),
        (Geometry::TriMesh(mesh), _) => Some(mesh.attributes().of(domain)),
        _ => None,
    }
}

/// The columns of a geometry on its edges.
pub(crate) fn edge_columns_of(geometry: &Geometry) -> Option<&Attributes> {
    match geometry {
        Geometry::GeometricGraph(graph) => Some(graph.edge_attributes()),
        _ => None,
    }
}

/// Adds a column to a geometry that has elements of that kind; to others nothing.
///
/// # Errors
/// It has another number of elements, or its name is taken.
pub(crate) fn insert_column(geometry: &mut Geometry, domain: Domain, column: Column) -> Result<(), AttributeError> {
    match (geometry, domain) {
        (Geometry::TriMesh(mesh), _) => mesh.insert_attribute(domain, column),
        (Geometry::PolyMesh(mesh), _) => mesh.insert_attribute(domain, column),
        (Geometry::PointCloud(cloud), Domain::Vertex) => cloud.insert_attribute(column),
        (Geometry::Polyline(line), Domain::Vertex) => line.insert_attribute(column),
        (Geometry::GeometricGraph(graph), Domain::Vertex) => graph.insert_vertex_attribute(column),
        _ => Ok(()),
    }
}

/// Losses gathered so that each is said once, however many parts have it.
#[derive(Default)]
pub(crate) struct Losses {
    list: Vec<Loss>,
    said: HashSet<(String, String)>,
    /// How often each reason was given.
    alike: HashMap<String, u64>,
}

/// Each of so many losses of one reason has a line; those beyond are counted in one more.
const MANY: u64 = 100;

/// What was lost, cut where names make it long.
fn shortened(what: String) -> String {
    match what.char_indices().nth(200) {
        Some((end, _)) => format!("{}... ({} bytes)", &what[..end], what.len()),
        None => what,
    }
}

impl Losses {
    pub(crate) fn from(losses: Vec<Loss>) -> Self {
        let mut all = Self::default();
        losses.into_iter().for_each(|loss| all.push(loss.what, loss.why));
        all
    }

    pub(crate) fn push(&mut self, what: impl Into<String>, why: impl Into<String>) {
        let loss = Loss::new(shortened(what.into()), why);
        if self.said.contains(&(loss.what.clone(), loss.why.clone())) {
            return;
        }
        let alike = self.alike.entry(loss.why.clone()).or_insert(0);
        *alike += 1;
        if *alike <= MANY {
            self.said.insert((loss.what.clone(), loss.why.clone()));
            self.list.push(loss);
        }
    }

    pub(crate) fn column(&mut self, domain: Domain, name: &str, why: impl Into<String>) {
        self.push(format!("{domain} attribute \"{name}\""), why);
    }

    pub(crate) fn into_vec(mut self) -> Vec<Loss> {
        let mut more: Vec<(String, u64)> = self.alike.into_iter().filter(|(_, count)| *count > MANY).collect();
        more.sort();
        for (why, count) in more {
            self.list.push(Loss::new(format!("{} more of the same kind", count - MANY), why));
        }
        self.list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FORMATS, WriteContext, write};
    use shapeloom_mesh::{GeometricGraph, ListColumn, TriMesh, Values};
    use shapeloom_shape::{Kind, Table};

    fn list(name: &str, elements: usize) -> ListColumn {
        let starts = (0..=elements as u32).collect();
        ListColumn::try_new(name, starts, Values::U8(vec![1; elements])).unwrap()
    }

    #[test]
    fn no_writer_forgets_lists_tables_and_comments() {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let mut mesh = TriMesh::try_new(positions.clone(), vec![[0, 1, 2]]).unwrap();
        for (domain, elements) in [(Domain::Vertex, 3), (Domain::Face, 1), (Domain::Wedge, 3)] {
            mesh.insert_list(domain, list("tree", elements)).unwrap();
        }
        let mut graph = GeometricGraph::try_new(positions, vec![[0, 1], [2, 1]]).unwrap();
        graph.insert_vertex_list(list("leaf", 3)).unwrap();
        graph.insert_edge_list(list("twig", 2)).unwrap();
        graph.insert_edge_attribute(Column::labels("street", vec![1, 2])).unwrap();
        let parts = vec![Part::new(mesh), Part::new(graph)];
        let tables = vec![Table { name: "rows".into(), columns: Attributes::new(4) }];
        let shape = Shape { parts, tables, comments: vec!["one".into(), "two".into()], ..Shape::default() };
        let takes = |format: &&Format| format.holds(Kind::TriMesh) && format.holds(Kind::GeometricGraph);
        for format in FORMATS.iter().filter(|format| format.writes.is_some()).filter(takes) {
            let report = write(&shape, format, &WriteContext::default(), &mut Vec::new()).unwrap();
            let said = |what: &str| report.losses.iter().any(|loss| loss.what == what);
            for (keeps, what) in [
                (Keeps::Lists, "vertex list \"tree\""),
                (Keeps::Lists, "face list \"tree\""),
                (Keeps::Lists, "wedge list \"tree\""),
                (Keeps::Lists, "vertex list \"leaf\""),
                (Keeps::Lists, "edge list \"twig\""),
                (Keeps::EdgeColumns, "edge attribute \"street\""),
                (Keeps::Tables, "table \"rows\""),
                (Keeps::Comments, "2 comments"),
            ] {
                assert!(format.keeps.contains(&keeps) || said(what), "{}: {what} in {:?}", format.id, report.losses);
            }
        }
    }
}
