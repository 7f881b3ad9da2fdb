//! Turning an edge inside the two triangles beside it.

use super::{HalfEdgeMesh, Illegal, NONE};
use crate::structures::{EdgeId, FaceId, VertexId};

/// Edge flip.
impl HalfEdgeMesh {
    /// Whether [`HalfEdgeMesh::flip_edge`] is possible. Cost: the smaller valence of the two opposite vertices.
    ///
    /// # Errors
    /// No such edge, a border edge, a face beside it that is no triangle, or an edge between the opposite vertices.
    pub fn can_flip(&self, edge: EdgeId) -> Result<(), Illegal> {
        let [h, t] = self.inner_edge(edge)?;
        for half in [h, t] {
            self.triangle(half)?;
        }
        let opposite = [h, t].map(|half| self.end(self.after(half)));
        if opposite[0] == opposite[1] {
            return Err(Illegal::DuplicateFace { face: FaceId(self.left(h)) });
        }
        if self.between(opposite[0], opposite[1]).is_some() {
            return Err(Illegal::DuplicateEdge { vertices: opposite.map(VertexId) });
        }
        Ok(())
    }

    /// Lets an edge between two triangles join their other two vertices instead. The edge and both faces keep their
    /// numbers. Two flips give back the edge with its faces exchanged, four give back the same half-edges.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_flip`].
    pub fn flip_edge(&mut self, edge: EdgeId) -> Result<(), Illegal> {
        self.can_flip(edge)?;
        // h runs from a to b with c to its left, t from b to a with d to its left; the quadrilateral is a d b c.
        let (h, t) = (2 * edge.0, 2 * edge.0 + 1);
        let (bc, ca, ad, db) = (self.after(h), self.before(h), self.after(t), self.before(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.start(ca), self.start(db));
        let (left, right) = (self.left(h), self.left(t));
        self.relieve(a, h, ad);
        self.relieve(b, t, bc);
        self.origin[h as usize] = d;
        self.origin[t as usize] = c;
        for [one, two, three] in [[h, ca, ad], [t, db, bc]] {
            self.link(one, two);
            self.link(two, three);
            self.link(three, one);
        }
        self.face[ad as usize] = left;
        self.face[bc as usize] = right;
        self.first[left as usize] = h;
        self.first[right as usize] = t;
        Ok(())
    }

    /// The halves of an edge with faces on both sides.
    pub(super) fn inner_edge(&self, edge: EdgeId) -> Result<[u32; 2], Illegal> {
        self.known_edge(edge)?;
        let halves = [2 * edge.0, 2 * edge.0 + 1];
        if halves.iter().any(|&half| self.left(half) == NONE) {
            return Err(Illegal::BorderEdge { vertices: self.ends(edge) });
        }
        Ok(halves)
    }

    pub(super) fn known_edge(&self, edge: EdgeId) -> Result<(), Illegal> {
        if self.has_edge(edge) { Ok(()) } else { Err(Illegal::Gone { kind: "edge", index: edge.0 }) }
    }

    fn triangle(&self, half: u32) -> Result<(), Illegal> {
        if self.has_sides(half, 3) { Ok(()) } else { Err(Illegal::NotTriangle { face: FaceId(self.left(half)) }) }
    }
}
