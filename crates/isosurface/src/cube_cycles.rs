//! The outlines of the surface in a cell: cycles of crossed edges, traced over the faces of the cell, and their triangles.
//!
//! A corner of a cell has the number `x + 2y + 4z`. A face whose corners are inside and outside in turn is ambiguous: either each
//! inside corner is cut off by itself (separated) or each outside corner is (joined). A face's rule depends on nothing but the face,
//! so both cells at it draw the same segments there.

/// The edges of a cell: the corner that they start from and their direction as a corner's number.
pub(crate) const CUBE_EDGES: [(u8, u8); 12] =
    [(0, 1), (2, 1), (4, 1), (6, 1), (0, 2), (1, 2), (4, 2), (5, 2), (0, 4), (1, 4), (2, 4), (3, 4)];

/// The faces of a cell, their corners counter-clockwise seen from outside the cell: x = 0, x = 1, y = 0, y = 1, z = 0, z = 1.
pub(crate) const CUBE_FACES: [[u8; 4]; 6] =
    [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

/// No edge.
const NONE: u8 = u8::MAX;

/// The surface in a cell with given corners inside and given faces joined.
#[derive(Clone, Debug, Default)]
pub(crate) struct Outlines {
    /// Crossed edges, so that the surface lies to the left, seen from outside.
    pub(crate) cycles: Vec<Vec<u8>>,
    /// Triangles that fill the cycles: crossed edges, and from [`INNER`] on vertices inside the cell.
    pub(crate) triangles: Vec<[u8; 3]>,
    /// For each vertex inside the cell the cycle in the middle of which it lies.
    pub(crate) inner: Vec<u8>,
}

/// The number of the first vertex inside the cell.
pub(crate) const INNER: u8 = 12;

/// The edge between two neighbouring corners.
fn edge_between(a: u8, b: u8) -> u8 {
    let wanted = (a.min(b), a ^ b);
    CUBE_EDGES.iter().position(|&edge| edge == wanted).map_or(NONE, |at| at as u8)
}

/// The ambiguous faces of a cell, a bit each.
pub(crate) fn ambiguous_faces(mask: u8) -> u8 {
    let inside = |corner: u8| mask >> corner & 1;
    CUBE_FACES.iter().enumerate().fold(0, |faces, (face, &[a, b, c, d])| {
        let ambiguous = inside(a) == inside(c) && inside(b) == inside(d) && inside(a) != inside(b);
        faces | u8::from(ambiguous) << face
    })
}

/// The faces that an edge lies in, a bit each.
fn faces_of(edge: u8) -> u8 {
    let (from, direction) = CUBE_EDGES[edge as usize];
    (0..3).filter(|axis| direction >> axis & 1 == 0).fold(0, |faces, axis| faces | 1 << (2 * axis + (from >> axis & 1)))
}

/// The squared distance between the middles of two edges, in quarters.
fn distance_squared(a: u8, b: u8) -> u32 {
    let middle = |edge: u8, axis: u8| {
        let (from, direction) = CUBE_EDGES[edge as usize];
        i32::from(2 * (from >> axis & 1) + (direction >> axis & 1))
    };
    (0..3).map(|axis| (middle(a, axis) - middle(b, axis)).unsigned_abs().pow(2)).sum()
}

/// The cycles of crossed edges of a cell: corner `c` is inside where bit `c` of `mask` is set, ambiguous face `f` is joined where bit
/// `f` of `joined` is.
fn cycles(mask: u8, joined: u8) -> Vec<Vec<u8>> {
    let inside = |corner: u8| mask >> corner & 1 == 1;
    let mut next = [NONE; 12];
    for (face, corners) in CUBE_FACES.iter().enumerate() {
        // Walking around the face, each crossing inwards is the start of a segment. It ends where the walk leaves the inside
        // next, or, if inside corners are joined, where it left the inside last.
        let enters = |at: usize| !inside(corners[at % 4]) && inside(corners[(at + 1) % 4]);
        let leaves = |at: usize| inside(corners[at % 4]) && !inside(corners[(at + 1) % 4]);
        let edge = |at: usize| edge_between(corners[at % 4], corners[(at + 1) % 4]);
        for at in (0..4).filter(|&at| enters(at)) {
            let steps = if joined >> face & 1 == 1 { [3, 2, 1] } else { [1, 2, 3] };
            if let Some(step) = steps.into_iter().find(|step| leaves(at + step)) {
                next[edge(at) as usize] = edge(at + step);
            }
        }
    }
    let mut seen = [false; 12];
    let mut cycles = Vec::new();
    for start in 0..12u8 {
        let mut cycle = Vec::new();
        let mut edge = start;
        while edge != NONE && next[edge as usize] != NONE && !seen[edge as usize] {
            seen[edge as usize] = true;
            cycle.push(edge);
            edge = next[edge as usize];
        }
        if !cycle.is_empty() {
            cycles.push(cycle);
        }
    }
    cycles
}

/// Triangles that fill a cycle without a diagonal in a face of the cell, which the neighbour could draw too: an edge of four
/// triangles. Of all such the one with the shortest diagonals. None where there is none.
fn fill(cycle: &[u8]) -> Option<Vec<[u8; 3]>> {
    let count = cycle.len();
    let side = |i: usize, j: usize| {
        let neighbours = j - i == 1 || j - i == count - 1;
        match neighbours {
            true => Some(0),
            false => (faces_of(cycle[i]) & faces_of(cycle[j]) == 0).then(|| distance_squared(cycle[i], cycle[j])),
        }
    };
    // best[i][j]: the cost of filling the corners from i to j, and the third corner of the triangle at side i-j.
    let mut best = [[Some((0u32, 0usize)); 12]; 12];
    for span in 2..count {
        for i in 0..count - span {
            let j = i + span;
            let ways = (i + 1..j).filter_map(|k| {
                let ((left, _), (right, _)) = (best[i][k]?, best[k][j]?);
                Some((left + right + side(i, k)? + side(k, j)?, k))
            });
            best[i][j] = ways.min();
        }
    }
    best[0][count - 1]?;
    let mut triangles = Vec::new();
    let mut open = vec![(0, count - 1)];
    while let Some((i, j)) = open.pop() {
        if j - i >= 2 {
            let (_, k) = best[i][j]?;
            triangles.push([cycle[i], cycle[k], cycle[j]]);
            open.extend([(i, k), (k, j)]);
        }
    }
    Some(triangles)
}

/// Triangles that fill a cycle, and whether they need a vertex in its middle, which has the number `inner`.
pub(crate) fn disc(cycle: &[u8], inner: u8) -> (Vec<[u8; 3]>, bool) {
    match fill(cycle) {
        Some(triangles) => (triangles, false),
        None => ((0..cycle.len()).map(|at| [cycle[at], cycle[(at + 1) % cycle.len()], inner]).collect(), true),
    }
}

impl Outlines {
    /// The surface in a cell with these corners inside and these ambiguous faces joined, each cycle filled with a disc.
    pub(crate) fn new(mask: u8, joined: u8) -> Self {
        let cycles = cycles(mask, joined);
        let mut outlines = Self::default();
        for (number, cycle) in cycles.iter().enumerate() {
            let (triangles, needs_middle) = disc(cycle, INNER + outlines.inner.len() as u8);
            outlines.triangles.extend(triangles);
            outlines.inner.extend(needs_middle.then_some(number as u8));
        }
        Self { cycles, ..outlines }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every mask with every choice for its ambiguous faces.
    fn all() -> impl Iterator<Item = (u8, u8)> {
        (0..=255u8)
            .flat_map(|mask| (0..64u8).map(move |joined| (mask, joined)))
            .filter(|&(mask, joined)| joined & !ambiguous_faces(mask) == 0)
    }

    #[test]
    fn cycles_hold_every_crossed_edge_once() {
        for (mask, joined) in all() {
            let outlines = Outlines::new(mask, joined);
            let mut held: Vec<u8> = outlines.cycles.concat();
            held.sort_unstable();
            let crossed = (0..12u8).filter(|&edge| {
                let (from, direction) = CUBE_EDGES[edge as usize];
                mask >> from & 1 != mask >> (from + direction) & 1
            });
            assert_eq!(held, crossed.collect::<Vec<_>>(), "{mask:08b} {joined:06b}");
        }
    }

    /// The sides of the triangles are the cycles' sides once, and all others twice, in opposite directions and in no face.
    #[test]
    fn triangles_fill_their_cycles() {
        for (mask, joined) in all() {
            let outlines = Outlines::new(mask, joined);
            let mut sides: Vec<[u8; 2]> =
                outlines.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
            sides.sort_unstable();
            assert!(sides.windows(2).all(|pair| pair[0] != pair[1]), "{mask:08b} {joined:06b}");
            let mut outer: Vec<[u8; 2]> =
                sides.iter().copied().filter(|&[a, b]| sides.binary_search(&[b, a]).is_err()).collect();
            let mut wanted: Vec<[u8; 2]> = Vec::new();
            for cycle in &outlines.cycles {
                wanted.extend((0..cycle.len()).map(|at| [cycle[at], cycle[(at + 1) % cycle.len()]]));
            }
            outer.sort_unstable();
            wanted.sort_unstable();
            assert_eq!(outer, wanted, "{mask:08b} {joined:06b}");
            for [a, b] in sides.into_iter().filter(|side| side.iter().all(|&v| v < INNER)) {
                let inner = wanted.binary_search(&[a, b]).is_err() && wanted.binary_search(&[b, a]).is_err();
                assert!(!inner || faces_of(a) & faces_of(b) == 0, "{mask:08b} {joined:06b}: {a} {b}");
            }
        }
    }

    /// With inside corners separated no vertex inside a cell is needed, and a cycle has seven corners at most.
    #[test]
    fn the_fixed_rule_needs_no_inner_vertices() {
        for mask in 0..=255 {
            let outlines = Outlines::new(mask, 0);
            assert!(outlines.inner.is_empty(), "{mask:08b}");
            assert!(outlines.cycles.iter().all(|cycle| cycle.len() <= 7), "{mask:08b}");
        }
    }

    #[test]
    fn a_corner_is_cut_off_outward() {
        assert_eq!(Outlines::new(1, 0).cycles, [[0, 4, 8]]);
        assert_eq!(Outlines::new(254, 0).cycles, [[0, 8, 4]]);
    }
}
