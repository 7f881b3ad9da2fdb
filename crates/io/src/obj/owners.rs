//! Which object has which vertices and faces.

use std::ops::Range;

use shapeloom_mesh::{COLOR, Domain, NORMAL, TEXCOORD, TriMesh};
use shapeloom_shape::Geometry;

use super::assemble::no_mesh;
use super::columns::all_colorless;
use super::labels::{Run, Statements, by_object};
use super::read::Whole;
use super::statements::NONE;
use crate::ReadError;
use crate::cut::cut;
use crate::memory::Memory;

/// No part has the vertex.
const NOBODY: u32 = u32::MAX;

/// Which object has which vertices and faces.
pub(super) struct Owners {
    /// The objects with a mesh, by their number.
    pub meshes: Vec<u32>,
    /// The mesh, as an index into `meshes`, that each vertex belongs to; empty where there is one mesh and it has all.
    pub of_vertex: Vec<u32>,
    /// Whether there is one mesh although several objects have faces.
    pub together: bool,
    pub copied: usize,
    pub face_runs: Vec<Run>,
}

impl Owners {
    pub fn find(whole: &Whole<'_>, statements: &Statements, memory: &mut Memory<'_>) -> Result<Self, ReadError> {
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
    pub fn cut(
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
