//! Walks around vertices, faces and border loops.

use super::{GONE, HalfEdgeMesh};
use crate::structures::{FaceId, HalfEdgeId, VertexId};

/// The half-edges that leave a vertex, counter-clockwise.
#[derive(Clone, Debug)]
pub struct AroundVertex<'a> {
    mesh: &'a HalfEdgeMesh,
    start: u32,
    at: u32,
}

impl Iterator for AroundVertex<'_> {
    type Item = HalfEdgeId;

    fn next(&mut self) -> Option<HalfEdgeId> {
        if self.at >= GONE {
            return None;
        }
        let found = self.at;
        // The other side of the face at this corner; on the border, the other side of the gap.
        let turned = self.mesh.before(found) ^ 1;
        self.at = if turned == self.start { GONE } else { turned };
        Some(HalfEdgeId(found))
    }
}

/// The half-edges of a loop: around a face, or along a border.
#[derive(Clone, Debug)]
pub struct AroundFace<'a> {
    mesh: &'a HalfEdgeMesh,
    start: u32,
    at: u32,
}

impl Iterator for AroundFace<'_> {
    type Item = HalfEdgeId;

    fn next(&mut self) -> Option<HalfEdgeId> {
        if self.at >= GONE {
            return None;
        }
        let found = self.at;
        let next = self.mesh.after(found);
        self.at = if next == self.start { GONE } else { next };
        Some(HalfEdgeId(found))
    }
}

/// Walks. All panic on numbers that the mesh does not have; deleted and isolated elements have nothing around them.
impl HalfEdgeMesh {
    /// The half-edges that leave a vertex, counter-clockwise seen from outside. At the border it starts at the first
    /// edge of the fan and ends with the half-edge that has no face, so that every face at the vertex is met.
    pub fn around_vertex(&self, vertex: VertexId) -> AroundVertex<'_> {
        self.fan(vertex.0)
    }

    pub(super) fn fan(&self, vertex: u32) -> AroundVertex<'_> {
        let leaving = self.leaving[vertex as usize];
        // The edge after the gap, counter-clockwise.
        let start =
            if leaving < GONE && self.left(leaving) == super::NONE { self.before(leaving) ^ 1 } else { leaving };
        AroundVertex { mesh: self, start, at: start }
    }

    /// The half-edges around a face, from its first corner on.
    pub fn around_face(&self, face: FaceId) -> AroundFace<'_> {
        self.cycle(self.first[face.index()])
    }

    /// The half-edges of the loop that a half-edge is in, from this one on: those of its face, or of its border.
    pub fn around_loop(&self, half_edge: HalfEdgeId) -> AroundFace<'_> {
        assert!(self.has_half_edge(half_edge), "there is no {half_edge}");
        self.cycle(half_edge.0)
    }

    pub(super) fn cycle(&self, start: u32) -> AroundFace<'_> {
        AroundFace { mesh: self, start, at: start }
    }

    /// The vertices of a face, from its first corner on.
    pub fn corners(&self, face: FaceId) -> impl Iterator<Item = VertexId> + '_ {
        self.around_face(face).map(|half_edge| self.origin(half_edge))
    }

    /// One half-edge of each border loop. Cost: linear in the number of edges.
    pub fn border_loops(&self) -> Vec<HalfEdgeId> {
        let mut seen = vec![false; self.origin.len()];
        let mut loops = Vec::new();
        for h in 0..self.origin.len() as u32 {
            if self.left(h) == super::NONE && !seen[h as usize] {
                loops.push(HalfEdgeId(h));
                self.cycle(h).for_each(|side| seen[side.index()] = true);
            }
        }
        loops
    }

    /// How many edges a vertex has.
    pub fn valence(&self, vertex: VertexId) -> usize {
        self.around_vertex(vertex).count()
    }

    /// The half-edge from one vertex to another. Cost: the smaller of their valences.
    pub fn find(&self, from: VertexId, to: VertexId) -> Option<HalfEdgeId> {
        self.between(from.0, to.0).map(HalfEdgeId)
    }

    pub(super) fn between(&self, from: u32, to: u32) -> Option<u32> {
        // Both fans at once, so that a vertex of very many edges costs nothing beside one of few.
        let (mut out, mut back) = (self.fan(from), self.fan(to));
        loop {
            let (Some(one), Some(other)) = (out.next(), back.next()) else { return None };
            if self.end(one.0) == to {
                return Some(one.0);
            }
            if self.end(other.0) == from {
                return Some(other.0 ^ 1);
            }
        }
    }

    /// Whether a loop has exactly this many sides; looks at no more than one side more.
    pub(super) fn has_sides(&self, h: u32, count: usize) -> bool {
        self.cycle(h).take(count + 1).count() == count
    }
}
