//! New vertices on edges and in faces.

use super::{HalfEdgeMesh, Illegal, NONE};
use crate::structures::{EdgeId, FaceId, VertexId};

/// Splits.
impl HalfEdgeMesh {
    /// Puts a vertex on an edge: both faces get a corner more. The edge keeps its number on the side where its first
    /// half starts. Collapsing the new half-edge towards either end undoes it.
    ///
    /// # Errors
    /// No such edge, or numbers run out.
    pub fn insert_on_edge(&mut self, edge: EdgeId) -> Result<VertexId, Illegal> {
        self.known_edge(edge)?;
        self.room(1, 1, 0)?;
        // h from a to b becomes h from a to the vertex and k on to b.
        let (h, t) = (2 * edge.0, 2 * edge.0 + 1);
        let b = self.start(t);
        let (after_h, before_t) = (self.after(h), self.before(t));
        let vertex = self.add_vertex(NONE);
        let k = self.add_edge(vertex, b);
        self.origin[t as usize] = vertex;
        self.link(h, k);
        self.link(k, after_h);
        self.link(before_t, k ^ 1);
        self.link(k ^ 1, t);
        self.face[k as usize] = self.left(h);
        self.face[k as usize ^ 1] = self.left(t);
        self.relieve(b, t, k ^ 1);
        self.restart(self.left(t), t, k ^ 1);
        self.leaving[vertex as usize] = if self.left(t) == NONE { t } else { k };
        Ok(VertexId(vertex))
    }

    /// Whether [`HalfEdgeMesh::split_edge`] is possible.
    ///
    /// # Errors
    /// No such edge, or numbers run out.
    pub fn can_split_edge(&self, edge: EdgeId) -> Result<(), Illegal> {
        self.known_edge(edge)?;
        self.room(1, 3, 2)
    }

    /// Puts a vertex on an edge and joins it to the opposite corners of the triangles beside it, each of which becomes
    /// two. Larger polygons get a corner more. The halves with the edge's second vertex of the face to its left, and
    /// with the first of the one to its right, keep the faces' numbers. Collapsing the new half-edge towards either end
    /// undoes it.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_split_edge`].
    pub fn split_edge(&mut self, edge: EdgeId) -> Result<VertexId, Illegal> {
        self.can_split_edge(edge)?;
        let triangles = self.halves(edge).map(|half| self.face(half).is_some() && self.has_sides(half.0, 3));
        let vertex = self.insert_on_edge(edge)?;
        // Of each face, the half-edge that leaves the new vertex.
        let leaving = [self.after(2 * edge.0), 2 * edge.0 + 1];
        for (half, triangle) in leaving.into_iter().zip(triangles) {
            if triangle {
                self.cut(half, self.after(self.after(half)));
            }
        }
        Ok(vertex)
    }

    /// Whether [`HalfEdgeMesh::split_face`] is possible.
    ///
    /// # Errors
    /// No such face, or numbers run out.
    pub fn can_split_face(&self, face: FaceId) -> Result<(), Illegal> {
        self.known_face(face)?;
        let corners = self.around_face(face).count();
        self.room(1, corners, corners - 1)
    }

    /// Puts a vertex into a face and joins it to every corner: a triangle for each side. The one at the face's first
    /// side keeps its number. Removing the vertex, with [`Hole::Polygon`](super::Hole::Polygon), undoes it.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_split_face`].
    pub fn split_face(&mut self, face: FaceId) -> Result<VertexId, Illegal> {
        self.can_split_face(face)?;
        let sides: Vec<u32> = self.around_face(face).map(|side| side.0).collect();
        let vertex = self.add_vertex(NONE);
        let spokes: Vec<u32> = sides.iter().map(|&side| self.add_edge(vertex, self.start(side))).collect();
        self.leaving[vertex as usize] = spokes[0];
        for (i, &side) in sides.iter().enumerate() {
            let (out, back) = (spokes[i], spokes[if i + 1 == spokes.len() { 0 } else { i + 1 }] ^ 1);
            let own = if i == 0 { face.0 } else { self.add_face(side) };
            self.link(side, back);
            self.link(back, out);
            self.link(out, side);
            for half in [side, back, out] {
                self.face[half as usize] = own;
            }
        }
        Ok(VertexId(vertex))
    }
}
