//! The parts of an OBJ file.
//!
//! A file is one mesh, or one for each object `o` where no vertex serves the faces of two. Lines and points of an object
//! are parts of their own, with copies of their vertices. Groups, smoothing groups and, where a part has several,
//! materials are columns of its faces.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Loss, Place};
use shapeloom_mesh::{AttributeError, Column, Domain, GROUP, MATERIAL, MeshError, PointCloud, SMOOTHING, Values};
use shapeloom_shape::{Geometry, Part, Shape};

use super::columns::{VertexColumns, whole_mesh};
use super::labels::{Run, Statements};
use super::mtl;
use super::owners::Owners;
use super::read::Whole;
use super::sides::Sides;
use super::statements::NONE;
use crate::memory::Memory;
use crate::parts::most_parts;
use crate::placed::insert_column;
use crate::{Fault, ReadContext, ReadError, ReadShape, audit};

/// The column of a vertex's rational weight, which polygons do not use.
pub(super) const WEIGHT: &str = "weight";
/// The column of the object that a face belongs to, where objects share vertices.
pub(super) const OBJECT: &str = "object";

pub(super) fn assemble(
    mut whole: Whole<'_>,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let mut losses = Vec::new();
    let statements = Statements::read(&whole, memory, findings)?;
    let most = most_parts(whole.text.len());
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
    if whole.comments {
        losses.push(Loss::new("comments", "those of OBJ stand between statements, for which shapes have no place"));
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

pub(super) fn unfit(error: AttributeError) -> ReadError {
    Fault::new("E-obj-mesh", Place::Whole, error.to_string(), "a mesh").into()
}

pub(super) fn no_mesh(error: MeshError) -> ReadError {
    Fault::new("E-obj-mesh", Place::Whole, error.to_string(), "a mesh").into()
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
    columns.into_iter().try_for_each(|column| insert_column(geometry, Domain::Face, column)).map_err(unfit)
}
