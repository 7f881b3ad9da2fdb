//! The topology of the trilinear interpolant in a cell.
//!
//! Where a face is ambiguous, the value at the saddle of its bilinear interpolant tells which corners are joined across it
//! (Nielson and Hamann 1991). Inside the cell the interpolant is looked at in slices of constant `z`: each is bilinear, and its
//! four corners run along the cell's edges in `z`. A piece of the inside, or of the outside, of a slice that
//! touches the slice's border in two places can only be a slice whose corners are inside and outside in turn, so only there can
//! parts of the boundary be joined through the cell. With corners `A B C D` around a slice the inside `A` and `C` are joined where
//! `AC - BD`, a quadratic polynomial in `z`, is positive, and the outside `B` and `D` where it is negative. Such slices
//! form an interval of `z`. At its ends the join is one on the boundary of the cell: of a face, or around an edge that the surface crosses
//! there. So there is something that the boundary does not tell only if the polynomial has the same sign at both ends and the other
//! one between: a tunnel, which joins two cycles of crossed edges by an annulus. All other cycles bound discs.
//! As a quadratic polynomial changes its sign twice at most, a cell has one tunnel at most.
//!
//! At each of the two roots the slice has two lines of the surface, parallel to the axes; where they meet those in
//! slices of the other two directions they form a hexagon on the surface around the tunnel (Grosso 2016), which the annulus
//! goes through.

use crate::cube_cycles::{CUBE_EDGES, CUBE_FACES, INNER, Outlines, ambiguous_faces, disc};

/// The corners of a cell: the samples less the iso value, negative inside; none of samples that are no finite numbers or not there.
pub(crate) type Corners = [Option<f64>; 8];

/// The vertices of the hexagon in a tunnel.
const RING: usize = 6;

/// A tunnel through a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tunnel {
    /// Crossed edges in the two cycles that it joins.
    edges: [u8; 2],
    /// The hexagon on the surface around it, in coordinates of the cell.
    hexagon: [[f64; 3]; RING],
}

/// The ambiguous faces of a cell whose inside corners are joined across the face, a bit each. A saddle that equals the iso value
/// separates them, and so does a sample that is not finite.
pub(crate) fn joined_faces(mask: u8, corners: &Corners) -> u8 {
    let ambiguous = ambiguous_faces(mask);
    CUBE_FACES.iter().enumerate().fold(0, |joined, (face, around)| {
        let [Some(a), Some(b), Some(c), Some(d)] = around.map(|corner| corners[corner as usize]) else { return joined };
        let (even, odd) = (a * c, b * d);
        let inside_joined = if mask >> around[0] & 1 == 1 { even > odd } else { odd > even };
        joined | u8::from(ambiguous >> face & 1 == 1 && inside_joined) << face
    })
}

/// The corners below and above the four edges in `z`, around the cell.
const COLUMNS: [(u8, u8); 4] = [(0, 4), (1, 5), (3, 7), (2, 6)];

/// The tunnel through a cell, if there is one.
pub(crate) fn tunnel(mask: u8, joined: u8, corners: &Corners) -> Option<Tunnel> {
    if corners.iter().any(Option::is_none) {
        return None;
    }
    let values = corners.map(Option::unwrap_or_default);
    (0..2).find_map(|first_inside| tunnel_between(mask, joined, &values, first_inside))
}

/// The tunnel in the slices in which the columns `first_inside` and the one opposite are inside, and the others are outside.
fn tunnel_between(mask: u8, joined: u8, values: &[f64; 8], first_inside: usize) -> Option<Tunnel> {
    let inside = |corner: u8| mask >> corner & 1 == 1;
    let (mut low, mut high) = (0.0f64, 1.0f64);
    // Whether inside columns are joined at the ends of the interval.
    let mut ends = [joined >> 4 & 1 == 1, joined >> 5 & 1 == 1];
    for (number, &(below, above)) in COLUMNS.iter().enumerate() {
        let wanted = number % 2 == first_inside;
        let (from, to) = (values[below as usize], values[above as usize]);
        // Where an outside column turns inside, the inside ones beside it are joined around it.
        match (inside(below) == wanted, inside(above) == wanted) {
            (true, true) => {}
            (false, false) => return None,
            (true, false) if from / (from - to) < high => (high, ends[1]) = (from / (from - to), !wanted),
            (false, true) if from / (from - to) > low => (low, ends[0]) = (from / (from - to), !wanted),
            _ => {}
        }
    }
    if ends[0] != ends[1] || low >= high {
        return None;
    }
    let at = |column: usize| values[COLUMNS[(first_inside + column) % 4].0 as usize];
    let slope = |column: usize| values[COLUMNS[(first_inside + column) % 4].1 as usize] - at(column);
    let square = slope(0) * slope(2) - slope(1) * slope(3);
    let linear = at(0) * slope(2) + at(2) * slope(0) - at(1) * slope(3) - at(3) * slope(1);
    let constant = at(0) * at(2) - at(1) * at(3);
    let middle = -linear / (2.0 * square);
    let joined_between = (square * middle + linear) * middle + constant > 0.0;
    if !(low < middle && middle < high) || joined_between == ends[0] {
        return None;
    }
    let half = (linear * linear - 4.0 * square * constant).sqrt() / (2.0 * square).abs();
    let roots = [middle - half, middle + half];
    let saddle = |z: f64| {
        let value = |column: usize| {
            let (below, above) = COLUMNS[column];
            values[below as usize] + (values[above as usize] - values[below as usize]) * z
        };
        let [a, b, c, d] = [0, 1, 2, 3].map(value);
        let sum = a - b + c - d;
        [(a - d) / sum, (a - b) / sum].map(|part| part.clamp(0.0, 1.0))
    };
    if !roots.iter().all(|root| low <= *root && *root <= high) {
        return None;
    }
    let ([x, y], [p, q], [z, r]) = (saddle(roots[0]), saddle(roots[1]), roots);
    // The slice at z has the lines x and y, the one at r the lines p and q: see the test for the order.
    let hexagon = [[x, y, z], [x, q, z], [x, q, r], [p, q, r], [p, y, r], [p, y, z]];
    // A tunnel of the inside joins two columns of the inside.
    let first = if ends[0] { first_inside + 1 } else { first_inside };
    let neighbour = first + 1;
    let edges = [first, first + 2].map(|column| edge_below(mask, values, [column % 4, neighbour % 4], high));
    Some(Tunnel { edges, hexagon })
}

/// The crossed edge at which the contour between two neighbouring columns ends, followed downwards from below `high`.
fn edge_below(mask: u8, values: &[f64; 8], columns: [usize; 2], high: f64) -> u8 {
    let mut found: Option<(f64, u8, u8)> = None;
    for column in columns {
        let (below, above) = COLUMNS[column];
        if (mask >> below ^ mask >> above) & 1 == 1 {
            let (from, to) = (values[below as usize], values[above as usize]);
            let at = from / (from - to);
            if at < high && found.is_none_or(|(best, ..)| at > best) {
                found = Some((at, below, 4));
            }
        }
    }
    let [a, b] = columns.map(|column| COLUMNS[column].0);
    let edge = found.map_or((a.min(b), a ^ b), |(_, from, direction)| (from, direction));
    CUBE_EDGES.iter().position(|&known| known == edge).unwrap_or_default() as u8
}

/// The place of the crossing of an edge, in coordinates of the cell: as the lattice's vertices have it.
fn crossing(mask: u8, edge: u8, corners: &Corners) -> [f64; 3] {
    let (from, direction) = CUBE_EDGES[edge as usize];
    let part = match (corners[from as usize], corners[(from + direction) as usize]) {
        (Some(a), Some(b)) => (a / (a - b)).clamp(0.0, 1.0),
        // What lies beyond the border, or is no number, is cut off at the inside end.
        _ => f64::from(1 - (mask >> from & 1)),
    };
    [0, 1, 2].map(|axis| f64::from(from >> axis & 1) + if direction >> axis & 1 == 1 { part } else { 0.0 })
}

/// The surface in a cell with the topology of the trilinear interpolant: as [`Outlines`] have it, but for a tunnel.
#[derive(Clone, Debug, Default)]
pub(crate) struct CellSurface {
    /// Triangles of crossed edges and, from [`INNER`] on, inner vertices.
    pub(crate) triangles: Vec<[u8; 3]>,
    /// The inner vertices, in coordinates of the cell.
    pub(crate) inner: Vec<[f64; 3]>,
}

/// The mean of a cycle's corners.
fn middle(cycle: &[u8], place: impl Fn(u8) -> [f64; 3]) -> [f64; 3] {
    let places: Vec<_> = cycle.iter().map(|&edge| place(edge)).collect();
    [0, 1, 2].map(|axis| places.iter().map(|place| place[axis]).sum::<f64>() / places.len() as f64)
}

impl CellSurface {
    pub(crate) fn new(mask: u8, joined: u8, outlines: &Outlines, corners: &Corners) -> Self {
        let place = |edge: u8| crossing(mask, edge, corners);
        let cycle_of = |edge: u8| outlines.cycles.iter().position(|cycle| cycle.contains(&edge));
        let joins = tunnel(mask, joined, corners).and_then(|tunnel| {
            let [Some(a), Some(b)] = tunnel.edges.map(cycle_of) else { return None };
            (a != b).then_some((tunnel, [a, b]))
        });
        let mut surface = Self::default();
        let Some((tunnel, [a, b])) = joins else {
            surface.inner.extend(outlines.inner.iter().map(|&cycle| middle(&outlines.cycles[cycle as usize], place)));
            surface.triangles.clone_from(&outlines.triangles);
            return surface;
        };
        surface.inner.extend(tunnel.hexagon);
        for (_, cycle) in outlines.cycles.iter().enumerate().filter(|&(number, _)| number != a && number != b) {
            let inner = INNER + surface.inner.len() as u8;
            let (triangles, needs_middle) = disc(cycle, inner);
            surface.triangles.extend(triangles);
            surface.inner.extend(needs_middle.then(|| middle(cycle, place)));
        }
        let strips = |reversed: bool| {
            let ring = |reversed: bool| {
                let mut ring: [u8; RING] = [0, 1, 2, 3, 4, 5].map(|at| INNER + at);
                if reversed {
                    ring.reverse();
                }
                ring
            };
            let (one, of_one) = strip(&outlines.cycles[a], &ring(reversed), &tunnel.hexagon, place);
            let (other, of_other) = strip(&outlines.cycles[b], &ring(!reversed), &tunnel.hexagon, place);
            (of_one + of_other, [one, other].concat())
        };
        let (forward, backward) = (strips(false), strips(true));
        surface.triangles.extend(if backward.0 < forward.0 { backward.1 } else { forward.1 });
        surface
    }
}

/// Triangles between a cycle and a ring that runs around the same way, with short sides; and the sum of their squares.
fn strip(
    cycle: &[u8],
    ring: &[u8; RING],
    hexagon: &[[f64; 3]; RING],
    place: impl Fn(u8) -> [f64; 3],
) -> (Vec<[u8; 3]>, f64) {
    let places: Vec<[f64; 3]> = cycle.iter().map(|&edge| place(edge)).collect();
    let count = cycle.len();
    let apart = |i: usize, j: usize| {
        let (a, b) = (places[i % count], hexagon[(ring[j % RING] - INNER) as usize]);
        (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>()
    };
    let from = |start: usize| {
        let (mut i, mut j, mut run, mut cost) = (0, 0, 0, 0.0);
        let mut triangles = Vec::new();
        // The first and the last step go along the cycle, and those along the ring leave from two of its corners at least: else a
        // side would be used twice.
        while i < count || j < RING {
            let along_cycle = i < count && (i + 1 < count || j == RING) && (i + 2 != count || j > 0);
            let along_ring = i > 0 && j < RING && run < RING - 1;
            let (u, r) = (cycle[i % count], ring[(start + j) % RING]);
            if along_ring && (!along_cycle || apart(i, start + j + 1) < apart(i + 1, start + j)) {
                triangles.push([u, ring[(start + j + 1) % RING], r]);
                (j, run) = (j + 1, run + 1);
            } else {
                triangles.push([u, cycle[(i + 1) % count], r]);
                (i, run) = (i + 1, 0);
            }
            cost += apart(i, start + j);
        }
        (triangles, cost)
    };
    let mut best = from(0);
    for start in 1..RING {
        let next = from(start);
        if next.1 < best.1 {
            best = next;
        }
    }
    best
}
