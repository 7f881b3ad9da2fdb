//! Removing a vertex, and what becomes of the hole.

use super::{HalfEdgeMesh, Illegal, NONE};
use crate::structures::{FaceId, HalfEdgeId, VertexId};

/// What becomes of the hole that a removed vertex leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hole {
    /// One polygon.
    Polygon,
    /// Triangles, by new edges that double none.
    Triangles,
}

/// Vertex removal.
impl HalfEdgeMesh {
    /// Whether [`HalfEdgeMesh::remove_vertex`] is possible.
    ///
    /// # Errors
    /// No such vertex; a hole with a vertex twice, or a border vertex whose neighbours on the border are joined
    /// already; a face with the same corners as another; for triangles, a hole that cannot be cut without doubling an
    /// edge, beyond 64 corners one that no fan cuts so.
    pub fn can_remove_vertex(&self, vertex: VertexId, hole: Hole) -> Result<(), Illegal> {
        self.plan_removal(vertex, hole).map(drop)
    }

    /// Deletes a vertex with its edges. Its faces become one polygon with the number of one of them, or triangles. At
    /// the border the neighbours along it are joined by a new border edge. An isolated vertex just goes. Gives the face
    /// with the first corner of the hole; none for an isolated vertex.
    ///
    /// Cost: the corners of the faces around it, times the logarithm of their number; for triangles also the valences
    /// of the corners, and where no fan will do, the third power of up to 64 corners.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_remove_vertex`].
    pub fn remove_vertex(&mut self, vertex: VertexId, hole: Hole) -> Result<Option<FaceId>, Illegal> {
        let ears = self.plan_removal(vertex, hole)?;
        Ok(self.remove_with(vertex, &ears))
    }

    /// Deletes a vertex and cuts the hole into ears, without being asked whether it is allowed.
    pub(crate) fn remove_with(&mut self, vertex: VertexId, ears: &[[u32; 3]]) -> Option<FaceId> {
        let Some(face) = self.merge_faces_around(vertex.0) else {
            self.delete_vertex(vertex.0);
            return None;
        };
        self.cut_ears(face, ears);
        Some(FaceId(face))
    }

    /// The half-edges around the hole, the one of a new border edge not among them, from the one that will be first.
    pub(super) fn hole_sides(&self, vertex: u32) -> Vec<u32> {
        let mut sides = Vec::new();
        for out in self.fan(vertex).filter(|out| self.left(out.0) != NONE) {
            let chain = self.cycle(self.after(out.0)).map(|side| side.0);
            sides.extend(chain.take_while(|&side| self.end(side) != vertex));
        }
        sides
    }

    /// The vertices around the hole.
    pub(crate) fn hole_corners(&self, vertex: u32) -> Vec<u32> {
        let sides = self.hole_sides(vertex);
        let mut corners: Vec<u32> = sides.iter().map(|&side| self.start(side)).collect();
        if self.is_border_vertex(VertexId(vertex)) {
            corners.extend(sides.last().map(|&side| self.end(side)));
        }
        corners
    }

    /// The ears that the hole is cut into; none where it stays a polygon.
    fn plan_removal(&self, vertex: VertexId, hole: Hole) -> Result<Vec<[u32; 3]>, Illegal> {
        let corners = self.removal(vertex)?;
        if hole == Hole::Triangles && corners.len() > 3 {
            return self.plan_ears(&corners);
        }
        self.refuse_double_hole(vertex.0)?;
        Ok(Vec::new())
    }

    /// Checks all but how the hole is filled. Its corners; none if the vertex is isolated.
    pub(crate) fn removal(&self, vertex: VertexId) -> Result<Vec<u32>, Illegal> {
        self.known_vertex(vertex)?;
        let corners = self.hole_corners(vertex.0);
        let valence = self.valence(vertex) as u32;
        if valence == 0 {
            return Ok(corners);
        }
        if corners.len() < 3 {
            return Err(Illegal::ValenceTooLow { vertex, valence });
        }
        let mut sorted = corners.clone();
        sorted.sort_unstable();
        if let Some(pair) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(Illegal::RepeatedCorner { vertex: VertexId(pair[0]) });
        }
        let ends = [corners[corners.len() - 1], corners[0]];
        if self.is_border_vertex(vertex) && self.between(ends[0], ends[1]).is_some() {
            return Err(Illegal::DuplicateEdge { vertices: ends.map(VertexId) });
        }
        Ok(corners)
    }

    /// Refuses a hole that, filled by one face, has the corners of another face.
    pub(crate) fn refuse_double_hole(&self, vertex: u32) -> Result<(), Illegal> {
        if self.is_border_vertex(VertexId(vertex)) {
            return Ok(());
        }
        self.refuse_double(self.hole_sides(vertex).into_iter())
    }

    /// Makes one polygon of the faces around a vertex, which is deleted; none if there are none. The polygon starts at
    /// the first of [`HalfEdgeMesh::hole_corners`].
    fn merge_faces_around(&mut self, vertex: u32) -> Option<u32> {
        let spokes: Vec<HalfEdgeId> = self.fan(vertex).collect();
        let mut sides = self.hole_sides(vertex);
        let (&first, &last) = (sides.first()?, sides.last()?);
        let face = self.left(first);
        for spoke in &spokes {
            let lost = self.left(spoke.0);
            if lost != NONE && lost != face {
                self.delete_face(lost);
            }
        }
        let border = spokes.last().map(|spoke| spoke.0).filter(|&spoke| self.left(spoke) == NONE);
        if let Some(border) = border {
            // The edge to the one neighbour on the border is moved to the other.
            let incoming = self.before(border);
            let (from, to) = (self.start(incoming), self.end(border));
            let before = self.before(incoming);
            self.origin[border as usize] = from;
            self.link(before, border);
            self.relieve(from, incoming, border);
            debug_assert_eq!([self.start(first), self.end(last)], [from, to]);
            sides.push(border ^ 1);
        }
        for (i, &side) in sides.iter().enumerate() {
            let start = self.start(side);
            // What left along a spoke towards the vertex leaves along the hole.
            let leaving = self.leaving[start as usize];
            if self.end(leaving) == vertex {
                self.leaving[start as usize] = side;
            }
            self.face[side as usize] = face;
            self.link(side, sides[if i + 1 == sides.len() { 0 } else { i + 1 }]);
        }
        for spoke in spokes.iter().filter(|spoke| Some(spoke.0) != border) {
            self.delete_edge(spoke.0);
        }
        self.delete_vertex(vertex);
        self.first[face as usize] = first;
        Some(face)
    }
}
