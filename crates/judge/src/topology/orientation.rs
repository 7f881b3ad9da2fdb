//! Whether faces can be, and are, oriented alike across the edges that two of them share.

use shapeloom_core::{Exec, Stop};

use super::edges::Edges;
use crate::Faces;
use crate::union_find::TwoColoring;

/// What orientation comes to.
#[derive(Debug, Default)]
pub(super) struct Orientation {
    /// Edges whose two sides run the same way, as the first has it.
    pub inconsistent: Vec<[u32; 2]>,
    /// A face of each contradiction; faces in the same component may repeat.
    pub twisted: Vec<u32>,
    /// Faces in a ring, each sharing an edge with the next and the last with the first, after which the first would be
    /// turned over. Empty if there is none.
    pub witness: Vec<u32>,
}

impl Orientation {
    pub fn new(faces: &Faces<'_>, edges: &Edges, exec: &Exec) -> Result<Self, Stop> {
        let mut found = Self::default();
        let mut coloring = TwoColoring::new(faces.len());
        for (edge, uses) in edges.iter().enumerate() {
            if edge.is_multiple_of(1 << 16) {
                exec.check()?;
            }
            let &[one, other] = uses else { continue };
            let same_way = faces.side(one) == faces.side(other);
            if same_way {
                found.inconsistent.push(faces.side(one));
            }
            let [a, b] = [one, other].map(|wedge| faces.face_of(wedge));
            if !coloring.relate(a, b, same_way) {
                found.twisted.push(a);
            }
        }
        if let Some(&start) = found.twisted.first() {
            found.witness = twisted_ring(faces, edges, start);
        }
        Ok(found)
    }
}

/// A shortest ring of faces from `start` back to it that turns it over: breadth first through pairs of a face and
/// whether it is turned over.
fn twisted_ring(faces: &Faces<'_>, edges: &Edges, start: u32) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    // The edge of each wedge, where it has two faces.
    let mut edge_of = vec![NONE; faces.corners().len()];
    for (edge, uses) in edges.iter().enumerate().filter(|(_, uses)| uses.len() == 2) {
        uses.iter().for_each(|&wedge| edge_of[wedge as usize] = edge as u32);
    }
    // From which state each was reached; a state is twice the face, plus one if it is turned over. Twice the number of
    // faces fits, as every face has three wedges or more.
    let mut from = vec![NONE; 2 * faces.len()];
    let mut queue = vec![2 * start];
    from[2 * start as usize] = 2 * start;
    let mut next = 0;
    while next < queue.len() && from[2 * start as usize + 1] == NONE {
        let state = queue[next];
        next += 1;
        for wedge in faces.wedges(state / 2).filter(|&wedge| edge_of[wedge as usize] != NONE) {
            let uses = edges.uses(edge_of[wedge as usize] as usize);
            let other = if uses[0] == wedge { uses[1] } else { uses[0] };
            let turned = u32::from(faces.side(wedge) == faces.side(other));
            let reached = 2 * faces.face_of(other) + ((state % 2) ^ turned);
            if from[reached as usize] == NONE {
                from[reached as usize] = state;
                queue.push(reached);
            }
        }
    }
    let mut ring = Vec::new();
    let mut state = from[2 * start as usize + 1];
    while state != NONE {
        ring.push(state / 2);
        if state == 2 * start {
            break;
        }
        state = from[state as usize];
    }
    ring.reverse();
    ring
}
