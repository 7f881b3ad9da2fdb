//! Rows of elements put together to a shape.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Loss, Place, Severity};
use shapeloom_mesh::{
    Attributes, Blend, Column, Domain, GeometricGraph, ListColumn, PointCloud, TEXCOORD, TransformRule, Values,
};
use shapeloom_shape::{Geometry, Part, Shape, Table};

use super::header::{Element, short};
use super::plan::{CORNERS, ENDS, Meaning, Plan, Role};
use super::rows::{Rows, index_fault};
use super::types::{Number, with_values};
use super::{color, strips};
use crate::audit::degenerate_faces;
use crate::faces::Faces;
use crate::memory::Memory;
use crate::placed::insert_column;
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// What a shape is built from, and what was noticed on the way.
pub(super) struct Builder<'a, 'm> {
    pub vertices: usize,
    pub context: &'a ReadContext,
    pub memory: &'a mut Memory<'m>,
    /// Where a row of an element is.
    pub place: &'a dyn Fn(usize, usize) -> Place,
    pub findings: Findings,
    pub losses: Vec<Loss>,
    pub shape: Shape,
}

/// The columns of one kind of element.
#[derive(Default)]
struct Columns {
    columns: Vec<Column>,
    lists: Vec<ListColumn>,
}

impl Columns {
    fn names(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(Column::name).chain(self.lists.iter().map(ListColumn::name))
    }

    fn take(&mut self, name: &str) -> Option<Column> {
        let found = self.columns.iter().position(|column| column.name() == name)?;
        Some(self.columns.remove(found))
    }

    /// Those of the elements of these numbers.
    fn gathered(&self, elements: &[u32]) -> Self {
        Self {
            columns: self.columns.iter().map(|column| column.gathered(elements)).collect(),
            lists: self.lists.iter().map(|list| list.gathered(elements)).collect(),
        }
    }

    fn memory_bytes(&self) -> usize {
        let columns: usize = self.columns.iter().map(Column::memory_bytes).sum();
        columns + self.lists.iter().map(ListColumn::memory_bytes).sum::<usize>()
    }
}

/// The faces of a file.
#[derive(Default)]
struct FaceRows {
    /// Which element they are.
    index: usize,
    /// Whether there is such an element, though it may have no rows.
    there: bool,
    /// How many of the faces have a row there; others are of strips.
    rows: usize,
    skipped: Vec<u32>,
    faces: Faces,
    columns: Columns,
    wedge: Option<Column>,
}

impl Builder<'_, '_> {
    /// The shape of the rows of all elements.
    pub fn build(mut self, elements: &[Element], plans: &[Plan], all: Vec<Rows>) -> Result<ReadShape, ReadError> {
        let mut points = Vec::new();
        let mut vertex = Columns::default();
        let mut face = FaceRows::default();
        let mut edges = None;
        let mut strips = Vec::new();
        for (index, ((element, plan), mut rows)) in elements.iter().zip(plans).zip(all).enumerate() {
            match plan.role {
                Role::Vertex => {
                    points = std::mem::take(&mut rows.positions);
                    vertex = self.columns(element, plan, rows)?;
                }
                Role::Face => {
                    face.index = index;
                    face.there = true;
                    face.rows = rows.len;
                    face.skipped = std::mem::take(&mut rows.skipped);
                    face.faces = std::mem::take(&mut rows.faces);
                    face.columns = self.columns(element, plan, rows)?;
                }
                Role::Edge => {
                    let columns = self.columns(element, plan, rows)?;
                    if element.rows > 0 {
                        edges = Some(self.edges(index, columns)?);
                    }
                }
                Role::Strips => strips.push((index, element, plan, rows)),
                Role::Table => {
                    if ["face", "edge", "tristrips"].contains(&element.name.as_str()) && element.rows > 0 {
                        let message =
                            format!("\"{}\" does not say which vertices: it was kept as a table", element.name);
                        self.findings.push("W-ply-table", Severity::Warning, Place::line(element.line), message);
                    }
                    let mut table = Table { name: element.name.clone(), columns: Attributes::new(rows.len) };
                    let found = self.columns(element, plan, rows)?;
                    found.columns.into_iter().try_for_each(|column| table.columns.insert(column)).map_err(wrong)?;
                    found.lists.into_iter().try_for_each(|list| table.columns.insert_list(list)).map_err(wrong)?;
                    self.shape.tables.push(table);
                }
            }
        }
        self.skipped_faces(&face);
        self.wedge(&mut face)?;
        for (index, element, plan, rows) in strips {
            self.strips(index, element, plan, rows, &mut face)?;
        }
        self.parts(points, vertex, face, edges)?;
        Ok(ReadShape { shape: self.shape, findings: self.findings, losses: self.losses })
    }

    /// The columns of some rows.
    fn columns(&mut self, element: &Element, plan: &Plan, rows: Rows) -> Result<Columns, ReadError> {
        let mut found = Columns::default();
        for (group, values) in plan.columns.iter().zip(rows.columns) {
            let width = group.properties.len();
            let name = group.name.as_str();
            let column = |values: Values| Column::try_new(name, width, values).map_err(wrong);
            found.columns.push(match group.meaning {
                Meaning::Normal => column(values)?.with_blend(Blend::Direction).with_transform(TransformRule::Normal),
                Meaning::Texcoord | Meaning::Color => column(values)?,
                Meaning::FloatColor => column(self.linear(&values, width)?)?,
                // Whole numbers are labels, which are copied and never mixed.
                Meaning::Plain if group.kind.is_floating() => column(values)?,
                Meaning::Plain => column(values)?.with_blend(Blend::Copy),
            });
        }
        for (&property, list) in plan.lists.iter().zip(rows.lists) {
            let name = element.properties.get(property).map_or("", |property| &property.name);
            self.memory.take(list.ends.len() + 1, size_of::<u32>())?;
            let starts = std::iter::once(0).chain(list.ends).collect();
            found.lists.push(ListColumn::try_new(name, starts, list.values).map_err(wrong)?);
        }
        Ok(found)
    }

    /// Colours in sRGB as linear intensities; the fourth is no colour and stays.
    fn linear(&mut self, values: &Values, width: usize) -> Result<Values, ReadError> {
        self.memory.take(values.len(), size_of::<f64>())?;
        Ok(Values::F64(with_values!(values, values => values
            .iter()
            .enumerate()
            .map(|(at, value)| {
                let fraction = value.to_f64();
                if at % width < 3 { color::linear(fraction) } else { fraction }
            })
            .collect(), Vec::new())))
    }

    fn edges(&mut self, index: usize, mut columns: Columns) -> Result<(Vec<[u32; 2]>, Columns), ReadError> {
        let ends = ENDS.map(|name| columns.take(name));
        let [Some(first), Some(second)] = ends else { return Ok((Vec::new(), columns)) };
        self.memory.take(first.len(), size_of::<[u32; 2]>())?;
        let mut edges = vec![[0; 2]; first.len()];
        for (end, column) in [first, second].iter().enumerate() {
            with_values!(column.values(), values => {
                for (row, (edge, number)) in edges.iter_mut().zip(values).enumerate() {
                    let index_found = number.index();
                    if index_found as usize >= self.vertices {
                        let place = (self.place)(index, row);
                        let fault = index_fault(place, row, number.to_f64(), self.vertices);
                        return Err(fault.within(format!("edge {row}")).into());
                    }
                    edge[end] = index_found;
                }
            }, ());
        }
        Ok((edges, columns))
    }

    fn skipped_faces(&mut self, face: &FaceRows) {
        let rows: Vec<usize> = face.skipped.iter().take(Findings::PLACES_KEPT).map(|&row| row as usize).collect();
        let message = "a face of fewer than three corners was left out";
        self.rows_left_out("W-ply-skipped", face.index, &rows, face.skipped.len(), message);
    }

    /// Remarks on so many rows, of which the first are named.
    fn rows_left_out(&mut self, code: &'static str, index: usize, rows: &[usize], count: usize, message: &str) {
        for (rank, &row) in rows.iter().take(Findings::PLACES_KEPT).enumerate() {
            let seen = if rank == 0 { count + 1 - rows.len().min(Findings::PLACES_KEPT) } else { 1 };
            let place = (self.place)(index, row);
            self.findings.push_many(code, Severity::Warning, place, message, seen as u64);
        }
    }

    /// The texture coordinates of corners, if the list of that name has two numbers for each.
    fn wedge(&mut self, face: &mut FaceRows) -> Result<(), ReadError> {
        let Some(found) = face.columns.lists.iter().position(|list| list.name() == TEXCOORD) else { return Ok(()) };
        if face.faces.is_empty() {
            return Ok(());
        }
        let list = &face.columns.lists[found];
        let fits = |row: usize| list.range(row).end == 2 * face.faces.range(row).end;
        if let Some(row) = (0..face.rows).find(|&row| !fits(row)) {
            let place = (self.place)(face.index, row_in_file(&face.skipped, row));
            let message = "texture coordinates that are not two for each corner were kept as lists of the faces";
            self.findings.push("W-ply-texcoord", Severity::Warning, place, message);
            return Ok(());
        }
        let list = face.columns.lists.remove(found);
        self.memory.take(list.memory_bytes(), 1)?;
        face.wedge = Some(Column::try_new(TEXCOORD, 2, list.values().clone()).map_err(wrong)?);
        Ok(())
    }

    /// Adds the triangles of strips behind the faces.
    fn strips(
        &mut self,
        index: usize,
        element: &Element,
        plan: &Plan,
        mut rows: Rows,
        face: &mut FaceRows,
    ) -> Result<(), ReadError> {
        let corners = element.find_list(&CORNERS);
        let Some(list) = plan.lists.iter().position(|&list| Some(list) == corners) else { return Ok(()) };
        let list = rows.lists.swap_remove(list);
        let before = face.faces.len();
        let place = |row: usize| (self.place)(index, row);
        let short_strips = strips::triangles(&list, self.vertices, &mut face.faces, self.memory, place)?;
        let message = "a strip of one or two vertices was left out";
        self.rows_left_out("W-ply-strips", index, &short_strips, short_strips.len(), message);
        if element.rows > 0 {
            for (_, property) in element.properties.iter().enumerate().filter(|(at, _)| Some(*at) != corners) {
                let what = format!("\"{}\" of triangle strips", short(&property.name));
                self.losses.push(Loss::new(what, "a strip is many faces"));
            }
        }
        if face.faces.len() > before && before > 0 {
            let columns = std::mem::take(&mut face.columns);
            let names = columns.names().chain(face.wedge.iter().map(Column::name));
            for name in names {
                let what = format!("face attribute \"{}\"", short(name));
                self.losses.push(Loss::new(what, "the faces of triangle strips do not have it"));
            }
            face.wedge = None;
        }
        Ok(())
    }

    fn parts(
        &mut self,
        points: Vec<DVec3>,
        vertex: Columns,
        face: FaceRows,
        edges: Option<(Vec<[u32; 2]>, Columns)>,
    ) -> Result<(), ReadError> {
        let mut graph = None;
        if let Some((edges, columns)) = edges {
            if face.faces.is_empty() {
                self.shape.parts.push(Part::new(graph_of(points, edges, vertex, columns)?));
                return Ok(());
            }
            graph = Some(self.graph_beside(&points, &vertex, edges, columns)?);
        }
        let (rows, index, skipped) = (face.rows, face.index, face.skipped);
        let geometry = if points.is_empty() {
            let message = "the file has no vertices";
            self.findings.push("W-ply-empty", Severity::Warning, Place::Whole, message);
            mesh_of(points, face.faces, vertex, Columns::default(), None)?
        } else if face.faces.is_empty() && !face.there {
            cloud_of(points, vertex)?
        } else {
            mesh_of(points, face.faces, vertex, face.columns, face.wedge)?
        };
        let place = |face: usize| match face < rows {
            true => (self.place)(index, row_in_file(&skipped, face)),
            // A triangle of a strip.
            false => Place::element("face", face as u64),
        };
        degenerate_faces(&geometry, "W-ply-degenerate", &self.context.exec, &mut self.findings, place)?;
        self.shape.parts.push(Part::new(geometry));
        self.shape.parts.extend(graph.map(Part::new));
        Ok(())
    }

    /// The graph of edges that stand beside faces: it has copies of the vertices that it uses.
    fn graph_beside(
        &mut self,
        points: &[DVec3],
        vertex: &Columns,
        mut edges: Vec<[u32; 2]>,
        columns: Columns,
    ) -> Result<Geometry, ReadError> {
        self.memory.take(points.len(), 2 * size_of::<u32>() + size_of::<DVec3>())?;
        self.memory.take(vertex.memory_bytes(), 1)?;
        let mut used = vec![false; points.len()];
        edges.iter().flatten().for_each(|&end| used[end as usize] = true);
        let kept: Vec<u32> = (0..points.len() as u32).filter(|&vertex| used[vertex as usize]).collect();
        let mut renumbered = vec![0; points.len()];
        for (new, &old) in kept.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        edges.iter_mut().flatten().for_each(|end| *end = renumbered[*end as usize]);
        let positions = kept.iter().map(|&vertex| points[vertex as usize]).collect();
        let message = "edges beside faces became a part of their own, with copies of the vertices that they join";
        self.findings.push("W-ply-edges", Severity::Note, Place::Whole, message);
        graph_of(positions, edges, vertex.gathered(&kept), columns)
    }
}

fn wrong(error: impl ToString) -> ReadError {
    Fault::new("E-read-elements", Place::Whole, error.to_string(), "columns and faces that fit together").into()
}

/// The row of the file that became the face of that number.
fn row_in_file(skipped: &[u32], face: usize) -> usize {
    let mut row = face;
    for &skipped in skipped {
        if skipped as usize > row {
            break;
        }
        row += 1;
    }
    row
}

fn graph_of(points: Vec<DVec3>, edges: Vec<[u32; 2]>, vertex: Columns, edge: Columns) -> Result<Geometry, ReadError> {
    let mut graph = GeometricGraph::try_new(points, edges).map_err(wrong)?;
    for column in vertex.columns {
        graph.insert_vertex_attribute(column).map_err(wrong)?;
    }
    for list in vertex.lists {
        graph.insert_vertex_list(list).map_err(wrong)?;
    }
    for column in edge.columns {
        graph.insert_edge_attribute(column).map_err(wrong)?;
    }
    for list in edge.lists {
        graph.insert_edge_list(list).map_err(wrong)?;
    }
    Ok(graph.into())
}

fn cloud_of(points: Vec<DVec3>, vertex: Columns) -> Result<Geometry, ReadError> {
    let mut cloud = PointCloud::new(points);
    for column in vertex.columns {
        cloud.insert_attribute(column).map_err(wrong)?;
    }
    for list in vertex.lists {
        cloud.insert_list(list).map_err(wrong)?;
    }
    Ok(cloud.into())
}

fn mesh_of(
    points: Vec<DVec3>,
    faces: Faces,
    vertex: Columns,
    face: Columns,
    wedge: Option<Column>,
) -> Result<Geometry, ReadError> {
    let mut geometry = faces.into_geometry(points).map_err(wrong)?;
    let mut insert = |domain: Domain, column: Column| insert_column(&mut geometry, domain, column);
    for (domain, columns) in [(Domain::Vertex, vertex.columns), (Domain::Face, face.columns)] {
        columns.into_iter().try_for_each(|column| insert(domain, column)).map_err(wrong)?;
    }
    wedge.into_iter().try_for_each(|column| insert(Domain::Wedge, column)).map_err(wrong)?;
    let mut insert = |domain: Domain, list: ListColumn| match &mut geometry {
        Geometry::TriMesh(mesh) => mesh.insert_list(domain, list),
        Geometry::PolyMesh(mesh) => mesh.insert_list(domain, list),
        _ => Ok(()),
    };
    for (domain, lists) in [(Domain::Vertex, vertex.lists), (Domain::Face, face.lists)] {
        lists.into_iter().try_for_each(|list| insert(domain, list)).map_err(wrong)?;
    }
    Ok(geometry)
}
