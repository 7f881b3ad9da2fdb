//! Lines and points as parts of their own.

use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{Domain, GeometricGraph, PointCloud, Polyline};
use shapeloom_shape::Geometry;

use super::assemble::{no_mesh, unfit};
use super::columns::VertexColumns;
use super::labels::{Statements, by_object};
use super::read::Whole;
use super::statements::NONE;
use crate::ReadError;
use crate::memory::Memory;

/// Lines and points as parts: object, face domain for lines and vertex domain for points, geometry.
pub(super) struct Sides<'w, 't> {
    pub whole: &'w Whole<'t>,
    pub columns: &'w VertexColumns,
    pub parts: Vec<(u32, Domain, Geometry)>,
}

impl Sides<'_, '_> {
    pub fn read(&mut self, statements: &Statements, memory: &mut Memory<'_>) -> Result<(), ReadError> {
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
