//! Collapsing an edge into a vertex.

use super::{HalfEdgeMesh, Illegal, NONE};
use crate::structures::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// Edge collapse.
impl HalfEdgeMesh {
    /// Whether [`HalfEdgeMesh::collapse_half_edge`] is possible: the link condition (Dey, Edelsbrunner, Guha and
    /// Nekhayev 1999), said for surfaces of polygons with a border.
    ///
    /// A vertex that edges join to both ends must be the third corner of a triangle beside the edge; a face that has
    /// both ends must be beside it; the ends may lie on the border both only if the edge does, and then not in a loop
    /// of three edges; and no two faces may come to have the same corners, as on a tetrahedron.
    ///
    /// Cost: the valences of both ends, times the logarithm of one.
    ///
    /// # Errors
    /// No such half-edge, or the condition that it breaks.
    pub fn can_collapse(&self, half_edge: HalfEdgeId) -> Result<(), Illegal> {
        self.known_half_edge(half_edge)?;
        let h = half_edge.0;
        let (a, b) = (self.start(h), self.end(h));
        let faces = [h, h ^ 1].map(|half| self.left(half));
        for half in [h, h ^ 1] {
            if self.left(half) == NONE && self.has_sides(half, 3) {
                return Err(Illegal::ClosesBorder { vertex: VertexId(self.end(self.after(half))) });
            }
        }
        let both = [a, b].iter().all(|&vertex| self.is_border_vertex(VertexId(vertex)));
        if both && !faces.contains(&NONE) {
            return Err(Illegal::PinchesBorder { vertices: [VertexId(a), VertexId(b)] });
        }
        // The third corners of the triangles beside the edge.
        let apex = [h, h ^ 1].map(|half| {
            let triangle = self.left(half) != NONE && self.has_sides(half, 3);
            if triangle { self.end(self.after(half)) } else { NONE }
        });
        if apex[0] != NONE && apex[0] == apex[1] {
            return Err(Illegal::DuplicateFace { face: FaceId(faces[0]) });
        }
        let mut near: Vec<u32> = self.fan(a).map(|out| self.end(out.0)).collect();
        near.sort_unstable();
        let common = |vertex: &u32| !apex.contains(vertex) && near.binary_search(vertex).is_ok();
        if let Some(vertex) = self.fan(b).map(|out| self.end(out.0)).find(common) {
            return Err(Illegal::LinkCondition { vertex: VertexId(vertex) });
        }
        let mut around: Vec<u32> = self.fan(a).map(|out| self.left(out.0)).collect();
        around.sort_unstable();
        let shared = |face: &u32| *face != NONE && !faces.contains(face) && around.binary_search(face).is_ok();
        if let Some(face) = self.fan(b).map(|out| self.left(out.0)).find(shared) {
            return Err(Illegal::SharedFace { face: FaceId(face) });
        }
        self.refuse_double_around(h, apex)
    }

    /// Refuses if the vertex that is left would have two faces alone and both the same corners.
    fn refuse_double_around(&self, h: u32, apex: [u32; 2]) -> Result<(), Illegal> {
        let vanishes =
            |out: &HalfEdgeId| (0..2).any(|i| apex[i] != NONE && self.left(out.0) == self.left(h ^ i as u32));
        let ends = [self.start(h), self.end(h)];
        // A half-edge from either end in each face that stays; those are neighbours in a face with both.
        let mut stay: Vec<u32> = Vec::with_capacity(3);
        for out in ends.iter().flat_map(|&end| self.fan(end)).filter(|out| !vanishes(out)) {
            if self.left(out.0) == NONE {
                return Ok(());
            }
            if !stay.iter().any(|&known| self.left(known) == self.left(out.0)) {
                stay.push(out.0);
            }
            if stay.len() > 2 {
                return Ok(());
            }
        }
        let &[one, other] = stay.as_slice() else { return Ok(()) };
        let others = |side| -> Vec<u32> {
            let corners = self.cycle(side).map(|side| self.start(side.0));
            corners.filter(|corner| !ends.contains(corner)).collect()
        };
        if others(one).iter().eq(others(other).iter().rev()) {
            Err(Illegal::DuplicateFace { face: FaceId(self.left(one)) })
        } else {
            Ok(())
        }
    }

    /// Moves the vertex that a half-edge leaves into the one that it leads to, which stays. Triangles beside the edge
    /// vanish; larger polygons lose a corner. Of the two sides of a triangle that become one, the one of the vertex
    /// that stays keeps its number. Gives the vertex that stays.
    ///
    /// Cost: the valences of both ends.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_collapse`].
    pub fn collapse_half_edge(&mut self, half_edge: HalfEdgeId) -> Result<VertexId, Illegal> {
        self.can_collapse(half_edge)?;
        let h = half_edge.0;
        let (a, b) = (self.start(h), self.end(h));
        let out: Vec<HalfEdgeId> = self.fan(a).collect();
        for half in out {
            self.origin[half.index()] = b;
        }
        // On the one side the edge from b on stays, on the other the edge to b.
        let kept = self.after(h);
        for half in [h, h ^ 1] {
            let (before, after) = (self.before(half), self.after(half));
            self.restart(self.left(half), half, after);
            self.link(before, after);
            if self.left(half) != NONE && self.after(after) == before {
                let (stays, goes) = if half == h { (after, before) } else { (before, after) };
                self.zip(stays, goes);
            }
        }
        self.delete_edge(h);
        self.delete_vertex(a);
        let border = self.fan_from(kept).find(|&half| self.left(half) == NONE);
        self.leaving[b as usize] = border.unwrap_or(kept);
        Ok(VertexId(b))
    }

    /// Deletes a face of two sides: one edge stays and takes the other's place.
    fn zip(&mut self, stays: u32, goes: u32) {
        let (from, to) = (self.start(goes), self.end(goes));
        let outside = goes ^ 1;
        self.delete_face(self.left(stays));
        // `stays` runs as `outside` does, and takes its place in the next face.
        let face = self.left(outside);
        self.face[stays as usize] = face;
        self.restart(face, outside, stays);
        let (before, after) = (self.before(outside), self.after(outside));
        self.link(before, stays);
        self.link(stays, after);
        self.relieve(from, goes, stays ^ 1);
        self.relieve(to, outside, stays);
        self.delete_edge(goes);
    }

    /// The half-edges that leave the vertex of one, counter-clockwise.
    fn fan_from(&self, start: u32) -> impl Iterator<Item = u32> + '_ {
        let turn = move |&h: &u32| Some(self.before(h) ^ 1).filter(|&turned| turned != start);
        std::iter::successors(Some(start), turn)
    }

    /// Collapses an edge: the vertex where its second half starts stays. To where it moves is a matter of coordinates.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_collapse`].
    pub fn collapse_edge(&mut self, edge: EdgeId) -> Result<VertexId, Illegal> {
        self.known_edge(edge)?;
        self.collapse_half_edge(HalfEdgeId(2 * edge.0))
    }
}
