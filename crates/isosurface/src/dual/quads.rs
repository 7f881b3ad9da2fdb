//! A quad for each edge of the lattice that the surface crosses, between the cells around it.

use std::ops::Range;

use multiversion::multiversion;
use shapeloom_core::glam::DVec3;

use super::cell_layer::CellLayer;
use super::sign_slice::{Frame, SignSlice};

/// What quads of a layer are made from.
pub(super) struct Around<'a> {
    pub(super) frame: Frame,
    /// The slices below and above the layer.
    pub(super) lower: &'a SignSlice,
    pub(super) upper: &'a SignSlice,
    /// The layer, and the one below it if there is one.
    pub(super) layer: &'a CellLayer,
    pub(super) below: Option<&'a CellLayer>,
    /// Where the vertices lie.
    pub(super) positions: &'a [DVec3],
    /// Whether the placement mirrors.
    pub(super) mirrored: bool,
}

/// The edges of the four cells around an edge of the lattice, by their numbers along its axis, counter-clockwise.
const TURN: [usize; 4] = [3, 2, 0, 1];

/// Adds the quads, two triangles each, of rows of a layer: of edges along x and y in its lower slice, and along z between its slices.
/// Only edges between four cells have one.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
pub(super) fn add_quads(around: &Around<'_>, rows: Range<usize>, triangles: &mut Vec<[u32; 3]>) {
    let Around { frame, layer, positions, mirrored, .. } = around;
    let stride = frame.stride;
    let (low, up) = (&around.lower.words, &around.upper.words);
    for row in rows {
        for word in 0..stride {
            let f = row * stride + word;
            // An edge between four cells has all of them active; the last in order has the edge's own bit.
            let active = layer.active[f];
            if active == 0 {
                continue;
            }
            let signs = low[f];
            let inner = if word == 0 { !1 } else { !0 };
            if let Some(below) = around.below {
                if row > 0 {
                    let next = if word + 1 < stride { low[f + 1] } else { 0 };
                    let mut crossed = (signs ^ (signs >> 1 | next << 63)) & active;
                    let cells = [(below, f - stride), (below, f), (*layer, f), (*layer, f - stride)];
                    let several = cells.iter().fold(0, |all, (layer, f)| all | layer.several[*f]);
                    while crossed != 0 {
                        let bit = crossed.trailing_zeros();
                        crossed &= crossed - 1;
                        let corners = match several >> bit & 1 == 0 {
                            true => cells.map(|(layer, f)| rank(layer, f, bit)),
                            false => {
                                let mut corners = [0; 4];
                                for ((corner, (layer, f)), n) in corners.iter_mut().zip(cells).zip(TURN) {
                                    *corner = layer.vertex(f, bit, n);
                                }
                                corners
                            }
                        };
                        add(positions, corners, (signs >> bit & 1 == 0) != *mirrored, triangles);
                    }
                }
                let mut crossed = (signs ^ low[f + stride]) & active & inner;
                let several = before(below, word, f) | before(layer, word, f);
                while crossed != 0 {
                    let bit = crossed.trailing_zeros();
                    crossed &= crossed - 1;
                    let corners = match several >> bit & 1 == 0 {
                        // Cells side by side have numbers that follow each other.
                        true => {
                            let (p, q) = (rank(below, f, bit), rank(layer, f, bit));
                            [p.wrapping_sub(1), q.wrapping_sub(1), q, p]
                        }
                        false => {
                            let (g, left) = if bit == 0 { (f - 1, 63) } else { (f, bit - 1) };
                            [
                                below.vertex(g, left, 4 + TURN[0]),
                                layer.vertex(g, left, 4 + TURN[1]),
                                layer.vertex(f, bit, 4 + TURN[2]),
                                below.vertex(f, bit, 4 + TURN[3]),
                            ]
                        }
                    };
                    add(positions, corners, (signs >> bit & 1 == 0) != *mirrored, triangles);
                }
            }
            if row > 0 {
                let mut crossed = (signs ^ up[f]) & active & inner;
                let several = before(layer, word, f - stride) | before(layer, word, f);
                while crossed != 0 {
                    let bit = crossed.trailing_zeros();
                    crossed &= crossed - 1;
                    let corners = match several >> bit & 1 == 0 {
                        true => {
                            let (p, q) = (rank(layer, f - stride, bit), rank(layer, f, bit));
                            [p.wrapping_sub(1), p, q, q.wrapping_sub(1)]
                        }
                        false => {
                            let (g, left) = if bit == 0 { (f - 1, 63) } else { (f, bit - 1) };
                            [
                                layer.vertex(g - stride, left, 8 + TURN[0]),
                                layer.vertex(f - stride, bit, 8 + TURN[1]),
                                layer.vertex(f, bit, 8 + TURN[2]),
                                layer.vertex(g, left, 8 + TURN[3]),
                            ]
                        }
                    };
                    add(positions, corners, (signs >> bit & 1 == 0) != *mirrored, triangles);
                }
            }
        }
    }
}

/// The number of the first vertex of a cell that the surface passes through.
#[inline(always)]
fn rank(layer: &CellLayer, f: usize, bit: u32) -> u32 {
    layer.first[f].wrapping_add((layer.active[f] & ((1 << bit) - 1)).count_ones())
}

/// The cells with several vertices, and those right of one.
#[inline(always)]
fn before(layer: &CellLayer, word: usize, f: usize) -> u64 {
    let several = layer.several[f];
    let carried = if word > 0 { layer.several[f - 1] >> 63 } else { 0 };
    several | several << 1 | carried
}

/// Cuts a quad along its shorter diagonal, between equal ones along that from the first corner. Its corners are counter-clockwise seen
/// from the upper end of the edge.
#[inline(always)]
fn add(positions: &[DVec3], [a, b, c, d]: [u32; 4], turned: bool, triangles: &mut Vec<[u32; 3]>) {
    let (b, d) = if turned { (d, b) } else { (b, d) };
    let [pa, pb, pc, pd] = [a, b, c, d].map(|vertex| positions[vertex as usize]);
    let first = pa.distance_squared(pc) <= pb.distance_squared(pd);
    let (e, g) = if first { (c, a) } else { (d, b) };
    triangles.extend_from_slice(&[[a, b, e], [g, c, d]]);
}
