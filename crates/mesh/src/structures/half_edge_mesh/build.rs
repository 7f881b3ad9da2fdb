//! Half-edges of lists of faces, and back.

use shapeloom_core::Exec;

use super::{Counts, GONE, HalfEdgeMesh, NONE};
use crate::MeshError;
use crate::structures::face_list::FaceList;
use crate::structures::triangle_half_edges::{EdgeFaults, refuse_repeated_corners};
use crate::structures::{IndexedPolygons, StructureError, sides};

/// Faces or half-edges that are looked at between two polls.
const CHUNK: usize = 1 << 14;

impl HalfEdgeMesh {
    /// The half-edges of polygons. Faces keep their numbers and first corners, vertices their numbers.
    ///
    /// Takes 32 bytes a corner beside the result while it runs. Cost: linear, but for the sorting of edges at one
    /// vertex.
    ///
    /// # Errors
    /// What half-edges cannot hold, with the elements at fault: a face that has a vertex twice, an edge of more than
    /// two faces, an edge that two faces pass in the same direction, a vertex with several fans of faces; more
    /// half-edges than 32 bits can tell apart, the budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        exec.check()?;
        let corners = faces.all_corners().len();
        let vertices = faces.vertex_total();
        // Without common edges a corner has two half-edges; beside them stand its pair and its half-edge's number.
        let _memory = exec.reserve_elements(corners as u64, 2 * 16 + 8 + 4)?;
        let _more = exec.reserve_elements(vertices as u64 + faces.face_total() as u64, 8)?;
        refuse_repeated_corners(faces, exec)?;
        let pairs = pair_sides(faces, exec)?;
        if pairs.len() >= GONE as usize / 2 {
            return Err(MeshError::TooMany { kind: "half-edges", found: 2 * pairs.len() as u64 }.into());
        }
        let mut mesh = Self {
            origin: vec![NONE; 2 * pairs.len()],
            next: vec![NONE; 2 * pairs.len()],
            previous: vec![NONE; 2 * pairs.len()],
            face: vec![NONE; 2 * pairs.len()],
            leaving: vec![NONE; vertices],
            first: vec![NONE; faces.face_total()],
            counts: Counts { vertices: vertices as u32, edges: pairs.len() as u32, faces: faces.face_total() as u32 },
        };
        let mut side = vec![NONE; corners];
        for (edge, pair) in pairs.iter().enumerate() {
            for (half, &corner) in pair.iter().enumerate() {
                if corner != NONE {
                    side[corner as usize] = (2 * edge + half) as u32;
                }
            }
        }
        drop(pairs);
        mesh.link_faces(faces, &side, exec)?;
        drop(side);
        mesh.link_vertices(exec)?;
        Ok(mesh)
    }

    fn link_faces(&mut self, faces: &IndexedPolygons, side: &[u32], exec: &Exec) -> Result<(), StructureError> {
        for face in 0..faces.face_total() as u32 {
            if (face as usize).is_multiple_of(CHUNK) {
                exec.check()?;
            }
            let range = faces.corner_range(face);
            self.first[face as usize] = side[range.start];
            let mut before = side[range.end - 1];
            for corner in range {
                let h = side[corner];
                self.origin[h as usize] = faces.all_corners()[corner];
                self.face[h as usize] = face;
                self.link(before, h);
                before = h;
            }
        }
        // Border half-edges start where their twins end, which is where the one after the twin starts.
        for h in 0..self.origin.len() {
            if self.face[h] == NONE {
                self.origin[h] = self.origin[self.next[h ^ 1] as usize];
            }
        }
        Ok(())
    }

    /// Finds a half-edge for each vertex and links the borders, or tells at which vertices fans are several.
    fn link_vertices(&mut self, exec: &Exec) -> Result<(), StructureError> {
        let mut valence = vec![0u32; self.leaving.len()];
        for (h, &origin) in self.origin.iter().enumerate() {
            valence[origin as usize] += 1;
            let leaving = &mut self.leaving[origin as usize];
            if *leaving == NONE || self.face[h] == NONE {
                *leaving = h as u32;
            }
        }
        let mut pinched = Vec::new();
        let mut work = 0;
        for vertex in 0..valence.len() as u32 {
            let leaving = self.leaving[vertex as usize];
            if leaving == NONE {
                continue;
            }
            work += valence[vertex as usize];
            if work > CHUNK as u32 {
                exec.check()?;
                work = 0;
            }
            // Clockwise, from the border if there is one to the border on the other side.
            let (mut h, mut met) = (leaving, 1);
            while self.left(h ^ 1) != NONE {
                let turned = self.after(h ^ 1);
                if turned == leaving {
                    break;
                }
                (h, met) = (turned, met + 1);
            }
            if met != valence[vertex as usize] {
                pinched.push(vertex);
            } else if self.left(leaving) == NONE {
                self.link(h ^ 1, leaving);
            }
        }
        match pinched.first() {
            None => Ok(()),
            Some(&vertex) => {
                let fans = self.count_fans(vertex);
                Err(StructureError::NonManifoldVertex { vertex, fans, count: pinched.len() })
            }
        }
    }

    /// How many fans meet at a vertex of half-made half-edges: each closed ring and each fan with a border is one.
    fn count_fans(&self, vertex: u32) -> usize {
        let mut leaving: Vec<u32> =
            (0..self.origin.len() as u32).filter(|&h| self.origin[h as usize] == vertex).collect();
        // Border half-edges first: walks from inside a fan would stop at its border.
        leaving.sort_by_key(|&h| (self.left(h) != NONE, h));
        let mut seen = std::collections::HashSet::new();
        let mut fans = 0;
        for start in leaving {
            let mut h = start;
            if !seen.insert(h) {
                continue;
            }
            fans += 1;
            while self.left(h ^ 1) != NONE {
                h = self.after(h ^ 1);
                if !seen.insert(h) {
                    break;
                }
            }
        }
        fans
    }
}

/// The corners at which the two sides of each edge start; `NONE` for the second on the border.
fn pair_sides(faces: &IndexedPolygons, exec: &Exec) -> Result<Vec<[u32; 2]>, StructureError> {
    let parts = sides::by_edge(faces, exec, |bucket| {
        let (mut pairs, mut faults) = (Vec::new(), EdgeFaults::default());
        bucket.for_each_edge(|edge| {
            faults.note(&edge, faces);
            pairs.push([edge.corner(0), if edge.len() == 1 { NONE } else { edge.corner(1) }]);
        });
        Ok::<_, StructureError>((pairs, faults))
    })?;
    let (parts, faults): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    EdgeFaults::refuse(faults)?;
    let mut pairs = Vec::with_capacity(parts.iter().map(Vec::len).sum());
    for part in parts {
        pairs.extend(part);
    }
    Ok(pairs)
}

/// [`HalfEdgeMesh::try_build`] with the default [`Exec`].
impl TryFrom<&IndexedPolygons> for HalfEdgeMesh {
    type Error = StructureError;

    fn try_from(faces: &IndexedPolygons) -> Result<Self, StructureError> {
        Self::try_build(faces, &Exec::default())
    }
}

/// Exact: the faces with their numbers and first corners, isolated vertices too. Deleted vertices become isolated ones,
/// the numbers of deleted faces close up; [`HalfEdgeMesh::compact`] before tells which is which.
impl From<&HalfEdgeMesh> for IndexedPolygons {
    fn from(mesh: &HalfEdgeMesh) -> Self {
        let mut starts = vec![0];
        let mut corners = Vec::with_capacity(2 * mesh.counts.edges as usize);
        for face in mesh.live_faces() {
            corners.extend(mesh.corners(face).map(|vertex| vertex.0));
            starts.push(corners.len() as u32);
        }
        Self::trusted(mesh.leaving.len() as u32, starts, corners)
    }
}
