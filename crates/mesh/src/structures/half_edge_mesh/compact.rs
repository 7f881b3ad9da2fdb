//! Closing the gaps that deleted elements left.

use super::{GONE, HalfEdgeMesh, NONE};
use crate::Origins;

/// New numbers for elements of one kind.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Renumbering {
    old: Vec<u32>,
    new: Vec<u32>,
}

impl Renumbering {
    /// Numbers those that are kept in their order.
    fn of(kept: impl Iterator<Item = bool>) -> Self {
        let mut renumbering = Self::default();
        for (old, kept) in kept.enumerate() {
            renumbering.new.push(if kept { renumbering.old.len() as u32 } else { NONE });
            if kept {
                renumbering.old.push(old as u32);
            }
        }
        renumbering
    }

    /// The old number of each new element, rising.
    pub fn old(&self) -> &[u32] {
        &self.old
    }

    /// The new number of an old element; none if it was deleted or never there.
    pub fn new_of(&self, old: u32) -> Option<u32> {
        self.new.get(old as usize).copied().filter(|&new| new != NONE)
    }

    /// Where the new elements come from, for [`carry`](crate::carry).
    pub fn origins(&self) -> Origins {
        Origins::Copies(self.old.clone())
    }
}

/// New numbers for all elements.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Compacted {
    /// Of vertices.
    pub vertices: Renumbering,
    /// Of edges; half-edge `2e` of an old edge becomes `2e` of the new one, `2e + 1` likewise.
    pub edges: Renumbering,
    /// Of faces.
    pub faces: Renumbering,
}

/// Compaction.
impl HalfEdgeMesh {
    /// Gives the elements new numbers without gaps, in the order of the old, and tells which became which. Cost:
    /// linear.
    pub fn compact(&mut self) -> Compacted {
        let live = |slots: &[u32]| Renumbering::of(slots.iter().map(|&slot| slot != GONE));
        let (vertices, faces) = (live(&self.leaving), live(&self.first));
        let edges = Renumbering::of(self.origin.iter().step_by(2).map(|&origin| origin != GONE));
        let half = |h: u32| if h < GONE { edges.new[h as usize / 2] * 2 + h % 2 } else { h };
        let face = |face: u32| if face < GONE { faces.new[face as usize] } else { face };
        let halves = || edges.old.iter().flat_map(|&edge| [2 * edge as usize, 2 * edge as usize + 1]);
        *self = Self {
            origin: halves().map(|h| vertices.new[self.origin[h] as usize]).collect(),
            next: halves().map(|h| half(self.next[h])).collect(),
            previous: halves().map(|h| half(self.previous[h])).collect(),
            face: halves().map(|h| face(self.face[h])).collect(),
            leaving: vertices.old.iter().map(|&vertex| half(self.leaving[vertex as usize])).collect(),
            first: faces.old.iter().map(|&face| half(self.first[face as usize])).collect(),
            counts: self.counts,
        };
        Compacted { vertices, edges, faces }
    }
}
