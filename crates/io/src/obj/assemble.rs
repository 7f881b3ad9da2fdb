//! The parts of an OBJ file.
//!
//! A file is one mesh, or one for each object `o` where no vertex serves the faces of two. Lines and points of an object
//! are parts of their own, with copies of their vertices. Groups, smoothing groups and, where a part has several,
//! materials are columns of its faces.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Loss, Place, Severity};
use shapeloom_mesh::{
    AttributeError, Blend, COLOR, Column, Domain, GROUP, GeometricGraph, MATERIAL, MeshError, NORMAL, PointCloud,
    Polyline, SMOOTHING, TEXCOORD, TransformRule, TriMesh, Values,
};
use shapeloom_shape::{Geometry, Part, Shape};

use super::labels::{Run, Statements};
use super::mtl;
use super::read::Whole;
use super::statements::{NONE, Side};
use crate::color::linear;
use crate::cut::cut;
use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError, ReadShape, audit};

/// The column of a vertex's rational weight, which polygons do not use.
pub(super) const WEIGHT: &str = "weight";
/// The column of the object that a face belongs to, where objects share vertices.
pub(super) const OBJECT: &str = "object";
/// A part takes about a kilobyte: beyond this many, and one for every 32 bytes of the file, they would take memory out of
/// proportion to it. An object with a triangle of its own takes more text.
const MANY_PARTS: usize = 1 << 14;
/// No part has the vertex.
const NOBODY: u32 = u32::MAX;

pub(super) fn assemble(
    mut whole: Whole<'_>,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let mut losses = Vec::new();
    let statements = Statements::read(&whole, memory, findings)?;
    let most = MANY_PARTS + whole.text.len() / 32;
    if statements.objects.len() > most {
        let found = format!("{} objects", statements.objects.len() - 1);
        let fault = Fault::new("E-obj-limit", Place::Whole, found, format!("at most {most} in a file of this length"));
        return Err(fault.category(Category::OverLimit).into());
    }
    let materials = mtl::materials(&statements, context, findings, &mut losses)?;
    // Columns of colours and weights; those of normals and texture coordinates; the copy that cutting makes.
    memory.take(whole.positions.len(), 4 * size_of::<DVec3>())?;
    memory.take(whole.face_normals.len(), 2 * size_of::<DVec3>())?;
    memory.take(whole.face_texcoords.len(), 2 * size_of::<[f64; 2]>())?;
    let columns = VertexColumns::take(&mut whole, findings)?;
    if whole.deep_texcoords {
        losses.push(Loss::new("third texture coordinates", "shapes keep two"));
    }
    if whole.line_texcoords {
        losses.push(Loss::new("texture coordinates of lines", "lines keep what their vertices have"));
    }
    unused(&whole, &mut losses);

    if whole.faces.is_empty() && (!whole.lines.is_empty() || !whole.points.is_empty()) {
        let mut used = vec![false; whole.positions.len()];
        whole.lines.iter().chain(&whole.points).for_each(|&vertex| used[vertex as usize] = true);
        let unused = used.iter().filter(|used| !**used).count();
        if unused > 0 {
            losses.push(Loss::new(format!("{unused} vertices"), "no line and no point names them"));
        }
    }
    let mut sides = Sides { whole: &whole, columns: &columns, parts: Vec::new() };
    sides.read(&statements, memory)?;
    let side_parts = sides.parts;
    let mut shape = Shape { materials, ..Shape::default() };
    let mut mesh_parts = Vec::new();
    if !whole.faces.is_empty() {
        let owners = Owners::find(&whole, &statements, memory)?;
        if owners.copied > 0 {
            let what = format!("{} vertices shared between faces and lines or points", owners.copied);
            losses.push(Loss::new(what, "each of these parts has its own copies"));
        }
        let colorless = columns.colorless;
        let mesh = whole_mesh(&mut whole, columns.list, findings)?;
        let place = |face| whole.face_in_text(face);
        audit::degenerate_faces(&mesh, "W-obj-degenerate", &context.exec, findings, place)?;
        mesh_parts = owners.cut(mesh, &colorless, memory)?;
        for (_, faces, geometry) in &mut mesh_parts {
            labelled(geometry, faces, &owners, &statements, memory)?;
        }
    } else if side_parts.is_empty() {
        // Vertices alone are points.
        let name = statements.objects.last().cloned().unwrap_or_default();
        let mut cloud = PointCloud::new(std::mem::take(&mut whole.positions));
        columns.list.into_iter().try_for_each(|column| cloud.insert_attribute(column)).map_err(unfit)?;
        shape.parts.push(Part::new(cloud).named(name));
    }
    // Runs stand in the order of the objects.
    let first_material = |runs: &[Run], object: u32| {
        let first = runs.partition_point(|run| run.labels.object < object);
        runs.get(first).and_then(|run| run.labels.material.checked_sub(1))
    };
    let mut placed: Vec<(u32, Part)> = Vec::new();
    for (object, faces, geometry) in mesh_parts {
        let material = single_material(&faces);
        let part = Part { material, ..Part::new(geometry) };
        placed.push((object, part));
    }
    for (object, runs_of, geometry) in side_parts {
        let runs = if runs_of == Domain::Face { &statements.lines } else { &statements.points };
        placed.push((object, Part { material: first_material(runs, object), ..Part::new(geometry) }));
    }
    // In the order of the objects, meshes before lines before points.
    placed.sort_by_key(|(object, _)| *object);
    shape.parts.extend(placed.into_iter().map(|(object, part)| {
        let name = statements.objects.get(object as usize).cloned().unwrap_or_default();
        part.named(name)
    }));
    Ok(ReadShape { losses, ..ReadShape::new(shape) })
}

fn unfit(error: AttributeError) -> ReadError {
    Fault::new("E-obj-mesh", Place::Whole, error.to_string(), "a mesh").into()
}

fn no_mesh(error: MeshError) -> ReadError {
    Fault::new("E-obj-mesh", Place::Whole, error.to_string(), "a mesh").into()
}

/// Colours and weights as columns of all vertices.
struct VertexColumns {
    list: Vec<Column>,
    /// The vertices without a colour, where others have one; else empty.
    colorless: Vec<bool>,
}

impl VertexColumns {
    fn take(whole: &mut Whole<'_>, findings: &mut Findings) -> Result<Self, ReadError> {
        let mut list = Vec::new();
        let mut colorless = Vec::new();
        let mut colors = std::mem::take(&mut whole.colors);
        let missing = |color: &[f64; 4]| color.iter().any(|number| !number.is_finite());
        if !colors.values.is_empty() {
            let count = colors.values.as_slice().iter().filter(|color| missing(color)).count();
            if count > 0 {
                let message =
                    format!("{count} vertices have no colour, or one that is not finite, where others have one");
                findings.push("W-obj-color", Severity::Note, Place::Whole, message);
                colorless = colors.values.as_slice().iter().map(missing).collect();
                colors
                    .values
                    .as_mut_slice()
                    .iter_mut()
                    .filter(|color| missing(color))
                    .for_each(|color| *color = [1.0; 4]);
            }
            list.push(color_column(&colors, findings)?);
        }
        let weights = std::mem::take(&mut whole.weights).values.into_vec();
        if weights.iter().any(|&weight| weight != 1.0) {
            list.push(Column::try_new(WEIGHT, 1, Values::F64(weights)).map_err(unfit)?);
        }
        Ok(Self { list, colorless })
    }

    /// The columns that a part of these vertices has: no colours where none of them has one.
    fn of(&self, vertices: &[u32]) -> impl Iterator<Item = &Column> {
        let plain = all_colorless(&self.colorless, vertices);
        self.list.iter().filter(move |column| !(plain && column.name() == COLOR))
    }
}

fn all_colorless(colorless: &[bool], vertices: &[u32]) -> bool {
    !colorless.is_empty() && vertices.iter().all(|&vertex| colorless[vertex as usize])
}

/// Fractions that are 255ths up to the digits that programs write are bytes; others are made linear.
fn color_column(colors: &Side<[f64; 4]>, findings: &mut Findings) -> Result<Column, ReadError> {
    let width = usize::from(colors.numbers);
    let numbers = || colors.values.as_slice().iter().flat_map(move |color| color[..width].iter().copied());
    let bytes = |scale: f64, slack: f64| -> Option<Vec<u8>> {
        let byte = |number: f64| {
            let scaled = number * scale;
            let near = scaled.round();
            ((scaled - near).abs() <= slack && (0.0..=255.0).contains(&near)).then_some(near as u8)
        };
        numbers().map(byte).collect()
    };
    let values = if numbers().all(|number| number <= 1.0) {
        // Six digits of a 255th are off by less than this.
        bytes(255.0, 2e-4)
    } else {
        let whole = bytes(1.0, 0.0);
        if whole.is_some() {
            let message = "colours are whole numbers up to 255 instead of fractions, and were taken as such";
            findings.push("W-obj-color", Severity::Warning, Place::Whole, message);
        }
        whole
    };
    let values = values.map(Values::U8).unwrap_or_else(|| {
        let of = |(at, number): (usize, f64)| if at % width == 3 { number } else { linear(number) };
        Values::F64(numbers().enumerate().map(of).collect())
    });
    Column::try_new(COLOR, width, values).map_err(unfit)
}

/// Texture coordinates and normals that no face names.
fn unused(whole: &Whole<'_>, losses: &mut Vec<Loss>) {
    for (count, named, what) in [
        (whole.texcoords.len(), &whole.face_texcoords, "texture coordinates"),
        (whole.normals.len(), &whole.face_normals, "normals"),
    ] {
        let mut used = vec![false; count];
        for &index in named.iter().filter(|&&index| index != NONE) {
            used[index as usize] = true;
        }
        let unused = used.iter().filter(|used| !**used).count();
        if unused > 0 {
            losses.push(Loss::new(format!("{unused} {what}"), "no face names them"));
        }
    }
}

/// All faces over all vertices, with every column but labels.
fn whole_mesh(whole: &mut Whole<'_>, columns: Vec<Column>, findings: &mut Findings) -> Result<Geometry, ReadError> {
    let mut found: Vec<(Domain, Column)> = columns.into_iter().map(|column| (Domain::Vertex, column)).collect();
    let corners = whole.faces.corners();
    let vertices = whole.positions.len();
    if !whole.face_texcoords.is_empty() {
        let uv = &whole.texcoords;
        found.push(corner_column(TEXCOORD, 2, &whole.face_texcoords, corners, vertices, findings, |index, out| {
            out.extend_from_slice(&uv[index]);
        })?);
    }
    if !whole.face_normals.is_empty() {
        let normals = &whole.normals;
        let (domain, column) =
            corner_column(NORMAL, 3, &whole.face_normals, corners, vertices, findings, |index, out| {
                out.extend_from_slice(&normals[index].to_array());
            })?;
        let column = column.with_blend(Blend::Direction).with_transform(TransformRule::Normal);
        found.push((domain, column));
    }
    for large in [&mut whole.face_texcoords, &mut whole.face_normals] {
        *large = Vec::new();
    }
    let positions = std::mem::take(&mut whole.positions);
    let mut mesh = std::mem::take(&mut whole.faces).into_geometry(positions).map_err(no_mesh)?;
    for (domain, column) in found {
        match &mut mesh {
            Geometry::TriMesh(mesh) => mesh.insert_attribute(domain, column).map_err(unfit)?,
            Geometry::PolyMesh(mesh) => mesh.insert_attribute(domain, column).map_err(unfit)?,
            _ => {}
        }
    }
    Ok(mesh)
}

/// Values named by corners: of vertices where all corners at a vertex name the same, else of corners.
fn corner_column(
    name: &str,
    width: usize,
    named: &[u32],
    corners: &[u32],
    vertices: usize,
    findings: &mut Findings,
    put: impl Fn(usize, &mut Vec<f64>),
) -> Result<(Domain, Column), ReadError> {
    let missing = named.iter().filter(|&&index| index == NONE).count();
    if missing > 0 {
        let message = format!("{missing} corners of faces have no {name}: 0 was taken");
        findings.push("W-obj-corner", Severity::Note, Place::Whole, message);
    }
    let mut of_vertex = vec![NONE; vertices];
    let mut used = vec![false; vertices];
    let mut agree = true;
    for (&corner, &index) in corners.iter().zip(named) {
        let corner = corner as usize;
        if used[corner] && of_vertex[corner] != index {
            agree = false;
            break;
        }
        used[corner] = true;
        of_vertex[corner] = index;
    }
    let gather = |indices: &[u32]| {
        let mut values = Vec::with_capacity(indices.len() * width);
        for &index in indices {
            if index == NONE { values.resize(values.len() + width, 0.0) } else { put(index as usize, &mut values) }
        }
        Values::F64(values)
    };
    let (domain, values) = if agree { (Domain::Vertex, gather(&of_vertex)) } else { (Domain::Wedge, gather(named)) };
    Ok((domain, Column::try_new(name, width, values).map_err(unfit)?))
}

/// Lines and points as parts: object, face domain for lines and vertex domain for points, geometry.
struct Sides<'w, 't> {
    whole: &'w Whole<'t>,
    columns: &'w VertexColumns,
    parts: Vec<(u32, Domain, Geometry)>,
}

impl Sides<'_, '_> {
    fn read(&mut self, statements: &Statements, memory: &mut Memory<'_>) -> Result<(), ReadError> {
        let mut new_of_old = Vec::new();
        for runs in by_object(&statements.lines) {
            let object = runs[0].labels.object;
            let lines = runs.iter().flat_map(|run| run.elements.clone());
            let geometry = self.lines(lines, &mut new_of_old, memory)?;
            self.parts.push((object, Domain::Face, geometry));
        }
        for runs in by_object(&statements.points) {
            let object = runs[0].labels.object;
            let points: Vec<u32> =
                runs.iter().flat_map(|run| self.whole.points[run.elements.clone()].iter().copied()).collect();
            let width: usize = self.columns.list.iter().map(|column| 8 * column.width()).sum();
            memory.take(points.len(), 2 * size_of::<DVec3>() + width)?;
            let mut cloud = PointCloud::new(self.gathered(&points));
            for column in self.columns.of(&points) {
                cloud.insert_attribute(column.gathered(&points)).map_err(unfit)?;
            }
            self.parts.push((object, Domain::Vertex, cloud.into()));
        }
        Ok(())
    }

    fn gathered(&self, vertices: &[u32]) -> Vec<DVec3> {
        vertices.iter().map(|&vertex| self.whole.positions[vertex as usize]).collect()
    }

    /// One line is a polyline; several are a graph.
    fn lines(
        &self,
        mut lines: impl Iterator<Item = usize> + Clone,
        new_of_old: &mut Vec<u32>,
        memory: &mut Memory<'_>,
    ) -> Result<Geometry, ReadError> {
        let ends = &self.whole.line_ends;
        let of = |line: usize| {
            let start = line.checked_sub(1).map_or(0, |before| ends[before] as usize);
            &self.whole.lines[start..ends[line] as usize]
        };
        let width: usize = self.columns.list.iter().map(|column| 8 * column.width()).sum();
        let corners: usize = lines.clone().map(|line| of(line).len()).sum();
        memory.take(corners, 2 * size_of::<DVec3>() + 12 + width)?;
        let mut rest = lines.clone();
        if let (Some(only), None) = (rest.next(), rest.next()) {
            let vertices = of(only);
            let closed = vertices.len() > 3 && vertices.first() == vertices.last();
            let vertices = if closed { &vertices[..vertices.len() - 1] } else { vertices };
            let mut line = Polyline::new(self.gathered(vertices), closed);
            for column in self.columns.of(vertices) {
                line.insert_attribute(column.gathered(vertices)).map_err(unfit)?;
            }
            return Ok(line.into());
        }
        if new_of_old.is_empty() {
            memory.take(self.whole.positions.len(), size_of::<u32>())?;
            new_of_old.resize(self.whole.positions.len(), NONE);
        }
        let mut vertices = Vec::new();
        let mut edges = Vec::new();
        for line in lines.by_ref() {
            let mut before = NONE;
            for &vertex in of(line) {
                let new = &mut new_of_old[vertex as usize];
                if *new == NONE {
                    *new = vertices.len() as u32;
                    vertices.push(vertex);
                }
                if before != NONE {
                    edges.push([before, *new]);
                }
                before = *new;
            }
        }
        // Ready for the next object, whose vertices are few.
        for &vertex in &vertices {
            new_of_old[vertex as usize] = NONE;
        }
        let mut graph = GeometricGraph::try_new(self.gathered(&vertices), edges).map_err(no_mesh)?;
        for column in self.columns.of(&vertices) {
            graph.insert_vertex_attribute(column.gathered(&vertices)).map_err(unfit)?;
        }
        Ok(graph.into())
    }
}

/// Runs of the same object in a row.
fn by_object(runs: &[Run]) -> impl Iterator<Item = &[Run]> {
    runs.chunk_by(|a, b| a.labels.object == b.labels.object)
}

/// Which object has which vertices and faces.
struct Owners {
    /// The objects with a mesh, by their number.
    meshes: Vec<u32>,
    /// The mesh, as an index into `meshes`, that each vertex belongs to; empty where there is one mesh and it has all.
    of_vertex: Vec<u32>,
    /// Whether there is one mesh although several objects have faces.
    together: bool,
    copied: usize,
    face_runs: Vec<Run>,
}

impl Owners {
    fn find(whole: &Whole<'_>, statements: &Statements, memory: &mut Memory<'_>) -> Result<Self, ReadError> {
        let mut meshes: Vec<u32> = by_object(&statements.faces).map(|runs| runs[0].labels.object).collect();
        let sides = !whole.lines.is_empty() || !whole.points.is_empty();
        let mut face_runs = statements.faces.clone();
        for run in &mut face_runs {
            let Range { start, end } = run.elements;
            let corners = whole.faces.range(start).start..whole.faces.range(end - 1).end;
            run.bare = [&whole.face_texcoords, &whole.face_normals]
                .map(|named| named.get(corners.clone()).is_none_or(|named| named.iter().all(|&index| index == NONE)));
        }
        if meshes.len() == 1 && !sides {
            return Ok(Self { meshes, of_vertex: Vec::new(), together: false, copied: 0, face_runs });
        }
        memory.take(whole.positions.len(), 2 * size_of::<u32>())?;
        let mut of_vertex = vec![NOBODY; whole.positions.len()];
        let mut together = false;
        for (mesh, runs) in by_object(&statements.faces).enumerate() {
            let faces = runs[0].elements.start..runs[runs.len() - 1].elements.end;
            let corners = whole.faces.range(faces.start).start..whole.faces.range(faces.end - 1).end;
            for &corner in &whole.faces.corners()[corners] {
                let owner = &mut of_vertex[corner as usize];
                together |= *owner != NOBODY && *owner != mesh as u32;
                *owner = mesh as u32;
            }
        }
        if together {
            // The mesh of no object alone.
            meshes = vec![0];
            of_vertex.iter_mut().filter(|owner| **owner != NOBODY).for_each(|owner| *owner = 0);
        }
        let mut side = vec![false; if sides { whole.positions.len() } else { 0 }];
        let mut copied = 0;
        for &vertex in whole.lines.iter().chain(&whole.points) {
            let vertex = vertex as usize;
            copied += usize::from(!side[vertex] && of_vertex[vertex] != NOBODY);
            side[vertex] = true;
        }
        // Vertices of nothing go where they were written, or else to the first mesh.
        for run in &statements.vertices {
            let mesh = meshes.binary_search(&run.labels.object).unwrap_or(0) as u32;
            for vertex in run.elements.clone() {
                if of_vertex[vertex] == NOBODY && !side.get(vertex).copied().unwrap_or(false) {
                    of_vertex[vertex] = mesh;
                }
            }
        }
        Ok(Self { meshes, of_vertex, together, copied, face_runs })
    }

    /// The mesh of each object: its number, its faces as runs of the file's, and the mesh.
    fn cut(
        &self,
        mesh: Geometry,
        colorless: &[bool],
        memory: &mut Memory<'_>,
    ) -> Result<Vec<(u32, Vec<Run>, Geometry)>, ReadError> {
        if self.of_vertex.is_empty() || (self.meshes.len() == 1 && !self.of_vertex.contains(&NOBODY)) {
            return Ok(vec![(self.meshes[0], self.face_runs.clone(), mesh)]);
        }
        memory.take(1, mesh.memory_bytes())?;
        let mut vertices: Vec<Vec<u32>> = vec![Vec::new(); self.meshes.len()];
        let mut new_of_old = vec![NONE; self.of_vertex.len()];
        for (vertex, &owner) in self.of_vertex.iter().enumerate() {
            if let Some(list) = vertices.get_mut(owner as usize) {
                new_of_old[vertex] = list.len() as u32;
                list.push(vertex as u32);
            }
        }
        let groups: Vec<Vec<Run>> = if self.together {
            vec![self.face_runs.clone()]
        } else {
            by_object(&self.face_runs).map(<[Run]>::to_vec).collect()
        };
        let mut parts = Vec::with_capacity(groups.len());
        for ((runs, vertices), &object) in groups.into_iter().zip(vertices).zip(&self.meshes) {
            let faces = runs.iter().flat_map(|run| run.elements.clone()).map(|face| face as u32).collect();
            let plain = all_colorless(colorless, &vertices);
            let Some(mut part) = cut(&mesh, vertices, faces, &new_of_old).map_err(no_mesh)? else { continue };
            let bare = |slot: usize| runs.iter().all(|run| run.bare[slot]);
            for (absent, name) in [(plain, COLOR), (bare(0), TEXCOORD), (bare(1), NORMAL)] {
                for domain in [Domain::Vertex, Domain::Wedge] {
                    match &mut part {
                        Geometry::TriMesh(part) if absent => drop(part.remove_attribute(domain, name)),
                        Geometry::PolyMesh(part) if absent => drop(part.remove_attribute(domain, name)),
                        _ => {}
                    }
                }
            }
            // A part may have triangles alone where the file has not.
            let part = match part {
                Geometry::PolyMesh(part) if part.triangle_count() == part.face_count() => {
                    TriMesh::try_from(part).map_err(no_mesh)?.into()
                }
                part => part,
            };
            parts.push((object, runs, part));
        }
        Ok(parts)
    }
}

/// The material of all of these faces, if it is one and named.
fn single_material(runs: &[Run]) -> Option<u32> {
    let first = runs.first()?.labels.material;
    if runs.iter().all(|run| run.labels.material == first) { first.checked_sub(1) } else { None }
}

/// Adds the labels of faces as columns, where they tell faces apart or say something of all.
fn labelled(
    geometry: &mut Geometry,
    runs: &[Run],
    owners: &Owners,
    statements: &Statements,
    memory: &mut Memory<'_>,
) -> Result<(), ReadError> {
    let count: usize = runs.iter().map(|run| run.elements.len()).sum();
    let mut columns = Vec::new();
    let mut text = |name: &str, of: &dyn Fn(&Run) -> u32, names: &[String]| -> Result<(), ReadError> {
        memory.take(count, size_of::<u32>())?;
        // Only the names that occur here, in the order in which they do.
        let mut own: Vec<String> = Vec::new();
        let mut own_of = std::collections::HashMap::new();
        let mut index = Vec::with_capacity(count);
        for run in runs {
            let id = of(run);
            let next = own.len() as u32;
            let own_id = *own_of.entry(id).or_insert(next);
            if own_id == next {
                own.push(names[id as usize].clone());
            }
            index.resize(index.len() + run.elements.len(), own_id);
        }
        columns.push(Column::try_new(name, 1, Values::Text { names: own, index }).map_err(unfit)?);
        Ok(())
    };
    let several = |of: &dyn Fn(&Run) -> u32| runs.iter().any(|run| of(run) != of(&runs[0]));
    if owners.together {
        text(OBJECT, &|run| run.labels.object, &statements.objects)?;
    }
    if runs.iter().any(|run| run.labels.group != 0) {
        text(GROUP, &|run| run.labels.group, &statements.groups.list)?;
    }
    if several(&|run| run.labels.material) {
        text(MATERIAL, &|run| run.labels.material, &statements.materials.list)?;
    }
    if runs.iter().any(|run| run.labels.smoothing != 0) {
        memory.take(count, size_of::<u32>())?;
        let mut numbers = Vec::with_capacity(count);
        runs.iter().for_each(|run| numbers.resize(numbers.len() + run.elements.len(), run.labels.smoothing));
        columns.push(Column::labels(SMOOTHING, numbers));
    }
    for column in columns {
        match geometry {
            Geometry::TriMesh(mesh) => mesh.insert_attribute(Domain::Face, column).map_err(unfit)?,
            Geometry::PolyMesh(mesh) => mesh.insert_attribute(Domain::Face, column).map_err(unfit)?,
            _ => {}
        }
    }
    Ok(())
}
