//! Every edge of a list of faces with the sides on it.

use shapeloom_core::{Exec, Reservation};

use crate::poly_mesh::check_count;

use super::StructureError;
use super::face_list::FaceList;
use super::lists::Lists;
use super::sides::by_edge;
use super::triangle_half_edges::{EdgeFaults, refuse_repeated_corners};

/// The edges by their smaller and then their larger vertex, and the corners at which the sides on each start, rising.
pub(crate) struct EdgeTable {
    pub(crate) vertices: Vec<[u32; 2]>,
    pub(crate) sides: Lists,
    faults: Vec<EdgeFaults>,
    _memory: Reservation,
}

impl EdgeTable {
    /// The edges of any faces.
    pub(crate) fn new(faces: &impl FaceList, exec: &Exec) -> Result<Self, StructureError> {
        // At worst every side has an edge of its own; parts are put together, and for that moment all is there twice.
        let memory = exec.reserve_elements(faces.all_corners().len() as u64, 2 * (8 + 4 + 4))?;
        let parts = by_edge(faces, exec, |bucket| {
            let (mut vertices, mut counts, mut corners) = (Vec::new(), Vec::new(), Vec::new());
            let mut faults = EdgeFaults::default();
            bucket.for_each_edge(|edge| {
                vertices.push(edge.vertices);
                counts.push(edge.len() as u32);
                corners.extend(edge.corners());
                faults.note(&edge, faces);
            });
            Ok::<_, StructureError>((vertices, counts, corners, faults))
        })?;
        let (mut vertices, mut starts, mut corners) = (Vec::new(), vec![0], Vec::new());
        let (mut faults, mut end) = (Vec::new(), 0);
        for (own, counts, sides, fault) in parts {
            exec.check()?;
            vertices.extend(own);
            starts.extend(counts.iter().map(|count| {
                end += count;
                end
            }));
            corners.extend(sides);
            faults.push(fault);
        }
        Ok(Self { vertices, sides: Lists::new(starts, corners), faults, _memory: memory })
    }

    /// The edges of faces that have different corners, at most two to an edge and these in opposite directions.
    pub(crate) fn oriented(faces: &impl FaceList, exec: &Exec) -> Result<Self, StructureError> {
        refuse_repeated_corners(faces, exec)?;
        let mut table = Self::new(faces, exec)?;
        EdgeFaults::refuse(std::mem::take(&mut table.faults))?;
        check_count("sides of edges", table.vertices.len().saturating_mul(2))?;
        Ok(table)
    }

    /// The edge on which the side from each corner lies. Every side must lie on one: corners differ.
    pub(crate) fn edge_of_corners(&self, exec: &Exec) -> Result<(Vec<u32>, Reservation), StructureError> {
        let memory = exec.reserve_elements(self.sides.items().len() as u64, 4)?;
        let mut edges = vec![0; self.sides.items().len()];
        for edge in 0..self.vertices.len() as u32 {
            if edge.is_multiple_of(1 << 16) {
                exec.check()?;
            }
            for &corner in self.sides.of(edge) {
                edges[corner as usize] = edge;
            }
        }
        Ok((edges, memory))
    }
}
