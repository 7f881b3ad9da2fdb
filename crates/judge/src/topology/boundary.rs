//! The border of an open mesh.

use super::edges::Edges;
use crate::Faces;
use crate::union_find::DisjointSets;

/// The boundary edges (those with one face) in loops: edges that are joined at vertices belong together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoundaryLoops {
    starts: Vec<u32>,
    edges: Vec<[u32; 2]>,
}

impl BoundaryLoops {
    pub(super) fn new(faces: &Faces<'_>, edges: &Edges) -> Self {
        let border = edges.iter().filter(|uses| uses.len() == 1).map(|uses| faces.side(uses[0]));
        let mut sides: Vec<[u32; 2]> = border.collect();
        if sides.is_empty() {
            return Self::default();
        }
        let mut joined = DisjointSets::new(faces.vertex_count());
        for &[a, b] in &sides {
            joined.join(a, b);
        }
        sides.sort_by_cached_key(|&[a, b]| (joined.find(a), a, b));
        let mut loops = Self { starts: vec![0], edges: Vec::with_capacity(sides.len()) };
        for part in sides.chunk_by(|a, b| joined.find(a[0]) == joined.find(b[0])) {
            walk(part, &mut loops.edges);
            loops.starts.push(loops.edges.len() as u32);
        }
        loops
    }

    /// How many loops there are.
    pub fn len(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Whether the mesh has no border.
    pub fn is_empty(&self) -> bool {
        self.edges.is_empty()
    }

    /// The edges of all loops, one loop after the other.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The edges of each loop, by their smallest vertex. An edge runs as its face has it, and begins where the one before
    /// ended as long as there is such a one. A loop that passes twice through a vertex is still one.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[[u32; 2]]> {
        (0..self.len()).map(|at| &self.edges[self.starts[at] as usize..self.starts[at + 1] as usize])
    }
}

/// Appends the sides, sorted by where they begin, in an order in which each begins where the last ended.
fn walk(sides: &[[u32; 2]], out: &mut Vec<[u32; 2]>) {
    // How many of the sides that begin at a vertex were walked, at the first of them.
    let mut walked = vec![0u32; sides.len()];
    let mut fresh = 0;
    let mut at = None;
    for _ in 0..sides.len() {
        let next = at.and_then(|vertex| {
            let first = sides.partition_point(|side| side[0] < vertex);
            let place = first + *walked.get(first)? as usize;
            (sides.get(place)?[0] == vertex).then_some((first, place))
        });
        let (first, place) = next.unwrap_or_else(|| {
            // The first side that was not walked; those before it never become free again.
            loop {
                let first = sides.partition_point(|side| side[0] < sides[fresh][0]);
                let place = first + walked[first] as usize;
                if sides.get(place).is_some_and(|side| side[0] == sides[first][0]) {
                    return (first, place);
                }
                fresh = place;
            }
        });
        walked[first] += 1;
        out.push(sides[place]);
        at = Some(sides[place][1]);
    }
}
