//! Cutting a face in two along a new edge, and joining two faces by deleting their edge.

use super::{HalfEdgeMesh, Illegal};
use crate::structures::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// Edges inside faces.
impl HalfEdgeMesh {
    /// Whether [`HalfEdgeMesh::cut_face`] is possible. Cost: the corners of the face and the smaller valence.
    ///
    /// # Errors
    /// No such half-edges, half-edges of different faces or of none, corners that are neighbours, or an edge between
    /// them.
    pub fn can_cut_face(&self, from: HalfEdgeId, to: HalfEdgeId) -> Result<(), Illegal> {
        for half in [from, to] {
            self.known_half_edge(half)?;
        }
        let (u, w) = (self.start(from.0), self.start(to.0));
        let neighbours = from == to || self.after(from.0) == to.0 || self.after(to.0) == from.0;
        if self.face(from).is_none() || self.left(from.0) != self.left(to.0) || neighbours {
            return Err(Illegal::NotApart { vertices: [VertexId(u), VertexId(w)] });
        }
        if self.between(u, w).is_some() {
            return Err(Illegal::DuplicateEdge { vertices: [VertexId(u), VertexId(w)] });
        }
        self.room(0, 1, 1)
    }

    /// Cuts a face by a new edge between the corners at which two of its half-edges start. The part with `from` keeps
    /// the face's number, the part with `to` is new. Gives the new half-edge from the corner of `to` to that of `from`,
    /// which lies in the old face. [`HalfEdgeMesh::join_faces`] undoes it. Cost: the corners of the face.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_cut_face`].
    pub fn cut_face(&mut self, from: HalfEdgeId, to: HalfEdgeId) -> Result<HalfEdgeId, Illegal> {
        self.can_cut_face(from, to)?;
        Ok(HalfEdgeId(self.cut(from.0, to.0)))
    }

    /// The same without being asked whether it is allowed. Cost: the corners of the part with `to`.
    pub(super) fn cut(&mut self, from: u32, to: u32) -> u32 {
        let (old, new) = (self.left(from), self.add_face(to));
        let h = self.add_edge(self.start(to), self.start(from));
        let (before_from, before_to) = (self.before(from), self.before(to));
        self.link(before_to, h);
        self.link(h, from);
        self.link(before_from, h ^ 1);
        self.link(h ^ 1, to);
        self.face[h as usize] = old;
        let mut side = to;
        loop {
            self.face[side as usize] = new;
            self.restart(old, side, from);
            side = self.after(side);
            if side == to {
                return h;
            }
        }
    }

    /// Whether [`HalfEdgeMesh::join_faces`] is possible. Cost: the corners of both faces.
    ///
    /// # Errors
    /// No such edge, a border edge, faces that share more than this edge, or another face with all corners of the
    /// result.
    pub fn can_join_faces(&self, edge: EdgeId) -> Result<(), Illegal> {
        let [h, t] = self.inner_edge(edge)?;
        let mut corners: Vec<u32> = self.cycle(h).map(|side| self.start(side.0)).collect();
        // The ends of the edge are corners of both, and once in the result.
        corners.extend(self.cycle(t).map(|side| self.start(side.0)));
        corners.sort_unstable();
        let ends = [self.start(h), self.start(t)];
        let mut twice = corners.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]);
        if let Some(vertex) = twice.find(|vertex| !ends.contains(vertex)) {
            return Err(Illegal::RepeatedCorner { vertex: VertexId(vertex) });
        }
        let outside = self.cycle(h).chain(self.cycle(t)).map(|side| side.0).filter(|&side| side != h && side != t);
        self.refuse_double(outside)
    }

    /// Deletes an edge between two faces, which become one polygon with the number of the face of the edge's first
    /// half. Undoes [`HalfEdgeMesh::cut_face`]. Cost: the corners of both faces.
    ///
    /// # Errors
    /// As [`HalfEdgeMesh::can_join_faces`].
    pub fn join_faces(&mut self, edge: EdgeId) -> Result<FaceId, Illegal> {
        self.can_join_faces(edge)?;
        let (h, t) = (2 * edge.0, 2 * edge.0 + 1);
        let (a, b) = (self.start(h), self.start(t));
        let (kept, lost) = (self.left(h), self.left(t));
        let sides: Vec<HalfEdgeId> = self.cycle(t).collect();
        for side in sides {
            self.face[side.index()] = kept;
        }
        let (before_h, after_h, before_t, after_t) = (self.before(h), self.after(h), self.before(t), self.after(t));
        self.relieve(a, h, after_t);
        self.relieve(b, t, after_h);
        self.restart(kept, h, after_t);
        self.link(before_h, after_t);
        self.link(before_t, after_h);
        self.delete_edge(h);
        self.delete_face(lost);
        Ok(FaceId(kept))
    }

    /// Refuses a face with these sides if one other face has all of them: the two would have the same corners.
    pub(super) fn refuse_double(&self, mut sides: impl Iterator<Item = u32>) -> Result<(), Illegal> {
        let Some(first) = sides.next() else { return Ok(()) };
        let other = self.left(first ^ 1);
        if other == super::NONE {
            return Ok(());
        }
        let mut count = 1;
        for side in sides {
            if self.left(side ^ 1) != other {
                return Ok(());
            }
            count += 1;
        }
        if self.has_sides(first ^ 1, count) { Err(Illegal::DuplicateFace { face: FaceId(other) }) } else { Ok(()) }
    }

    pub(super) fn known_half_edge(&self, half: HalfEdgeId) -> Result<(), Illegal> {
        if self.has_half_edge(half) { Ok(()) } else { Err(Illegal::Gone { kind: "half-edge", index: half.0 }) }
    }

    pub(super) fn known_face(&self, face: FaceId) -> Result<(), Illegal> {
        if self.has_face(face) { Ok(()) } else { Err(Illegal::Gone { kind: "face", index: face.0 }) }
    }

    pub(super) fn known_vertex(&self, vertex: VertexId) -> Result<(), Illegal> {
        if self.has_vertex(vertex) { Ok(()) } else { Err(Illegal::Gone { kind: "vertex", index: vertex.0 }) }
    }
}
