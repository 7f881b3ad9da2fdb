//! Breadth-first search over faces, along half-edges.

use std::collections::VecDeque;

use super::{HalfEdgeMesh, NONE};
use crate::structures::{EdgeId, FaceId, HalfEdgeId, Visitor};

/// A face that the search came to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// The face.
    pub face: FaceId,
    /// The least number of edges to be crossed from a face of the start.
    pub distance: u32,
    /// The half-edge of this face over which it was first come to; none for a face of the start.
    pub over: Option<HalfEdgeId>,
}

/// The faces around a start, the nearest first, each once.
#[derive(Clone, Debug)]
pub struct BreadthFirst<'a, P> {
    mesh: &'a HalfEdgeMesh,
    may_cross: P,
    queue: VecDeque<Reached>,
    /// A bit for each face.
    met: Vec<u64>,
}

impl<P> BreadthFirst<'_, P> {
    fn meet(&mut self, face: u32) -> bool {
        let (word, bit) = (face as usize / 64, 1 << (face % 64));
        let first = self.met[word] & bit == 0;
        self.met[word] |= bit;
        first
    }
}

impl<P: FnMut(EdgeId) -> bool> Iterator for BreadthFirst<'_, P> {
    type Item = Reached;

    fn next(&mut self) -> Option<Reached> {
        let reached = self.queue.pop_front()?;
        for half in self.mesh.around_face(reached.face) {
            let over = half.0 ^ 1;
            let face = self.mesh.left(over);
            if face != NONE && (self.may_cross)(self.mesh.edge(half)) && self.meet(face) {
                let (face, over) = (FaceId(face), Some(HalfEdgeId(over)));
                self.queue.push_back(Reached { face, distance: reached.distance + 1, over });
            }
        }
        Some(reached)
    }
}

/// Breadth-first search.
impl HalfEdgeMesh {
    /// The faces that can be come to from some faces, the nearest first, each once; it stops at borders. Between
    /// equally near ones the order is that of the start, then of the sides of the faces they were come to from.
    ///
    /// Faces that are named twice, deleted or not there count once or not at all. Takes a bit for each face; the whole
    /// search looks at each side of each face once.
    pub fn breadth_first(&self, start: impl IntoIterator<Item = FaceId>) -> BreadthFirst<'_, fn(EdgeId) -> bool> {
        self.breadth_first_within(start, |_| true)
    }

    /// The same, crossing only edges that `may_cross` allows: what is cut off by the others is not come to.
    pub fn breadth_first_within<P: FnMut(EdgeId) -> bool>(
        &self,
        start: impl IntoIterator<Item = FaceId>,
        may_cross: P,
    ) -> BreadthFirst<'_, P> {
        let met = vec![0; self.first.len().div_ceil(64)];
        let mut search = BreadthFirst { mesh: self, may_cross, queue: VecDeque::new(), met };
        for face in start {
            if self.has_face(face) && search.meet(face.0) {
                search.queue.push_back(Reached { face, distance: 0, over: None });
            }
        }
        search
    }

    /// Calls with each face that [`HalfEdgeMesh::breadth_first_within`] comes to; `Break` ends the search.
    pub fn visit_breadth_first(
        &self,
        start: impl IntoIterator<Item = FaceId>,
        may_cross: impl FnMut(EdgeId) -> bool,
        visit: &mut Visitor<'_, Reached>,
    ) {
        crate::structures::incidence::visit_each(self.breadth_first_within(start, may_cross), visit);
    }
}
