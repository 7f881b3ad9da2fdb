//! The cells between two slices that the surface passes through, and the numbers of their vertices.

use multiversion::multiversion;

use super::cell_tables::PIECES;
use super::sign_slice::{Frame, SignSlice};

/// The cells of a layer with a vertex.
///
/// Cells whose crossed edges all lie on an open border have none: no quad would use it. The first vertex of each such cell has the number of cells before it, row by row; further vertices follow all of those.
#[derive(Default)]
pub(super) struct CellLayer {
    /// A bit for each cell that the surface passes through.
    pub(super) active: Vec<u64>,
    /// The number of the first vertex of the first such cell of each word.
    pub(super) first: Vec<u32>,
    /// A bit for each cell with more than one vertex.
    pub(super) several: Vec<u64>,
    /// Those cells, in order.
    pub(super) splits: Vec<SplitCell>,
}

/// A cell with more than one vertex.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitCell {
    /// The place of its bit.
    pub(super) key: u64,
    /// Its entry in the table of pieces.
    pub(super) pieces: u16,
    /// The number of its second vertex; others follow.
    pub(super) second: u32,
}

impl CellLayer {
    /// Finds the cells of layer `k` between two slices; returns how many there are, numbered from 0.
    pub(super) fn find(&mut self, frame: &Frame, k: usize, lower: &SignSlice, upper: &SignSlice) -> u64 {
        let words = frame.cells(1) * frame.stride;
        for vector in [&mut self.active, &mut self.several] {
            vector.clear();
            vector.resize(words, 0);
        }
        self.first.clear();
        self.first.resize(words, 0);
        self.splits.clear();
        find(frame, k, &lower.words, &upper.words, &mut self.active, &mut self.first)
    }

    /// Sets where numbers start.
    pub(super) fn number_from(&mut self, start: u32) {
        if start > 0 {
            self.first.iter_mut().for_each(|first| *first = first.wrapping_add(start));
        }
    }

    /// The number of the vertex of the piece that crosses an edge of a cell.
    #[cold]
    pub(super) fn vertex(&self, word: usize, bit: u32, edge: usize) -> u32 {
        let below = self.active[word] & ((1 << bit) - 1);
        let first = self.first[word].wrapping_add(below.count_ones());
        let key = word as u64 * 64 + u64::from(bit);
        match self.splits.binary_search_by_key(&key, |split| split.key) {
            Ok(at) => {
                let split = self.splits[at];
                match PIECES[usize::from(split.pieces)].at(edge) {
                    0 => first,
                    piece => split.second + u32::from(piece) - 1,
                }
            }
            Err(_) => first,
        }
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn find(frame: &Frame, k: usize, lower: &[u64], upper: &[u64], active: &mut [u64], first: &mut [u32]) -> u64 {
    let (stride, words) = (frame.stride, active.len());
    // The four rows around each word of cells, and the words after them: the slices end with a word of zeros.
    let here = [&lower[..words], &lower[stride..][..words], &upper[..words], &upper[stride..][..words]];
    let next =
        [&lower[1..][..words], &lower[stride + 1..][..words], &upper[1..][..words], &upper[stride + 1..][..words]];
    for (f, active) in active.iter_mut().enumerate() {
        let both = |rows: &[&[u64]; 4]| {
            let [a, b, c, d] = [rows[0][f], rows[1][f], rows[2][f], rows[3][f]];
            (a | b | c | d, a & b & c & d)
        };
        let ((any, all), (any_next, all_next)) = (both(&here), both(&next));
        *active = (any | any >> 1 | any_next << 63) & !(all & (all >> 1 | all_next << 63));
    }
    if frame.pad == 0 {
        for row in 0..frame.cells(1) {
            // Inside of the layer only the first and the last cell of a row are at the border.
            let step = if frame.at_end(1, row) || frame.at_end(2, k) { 1 } else { (stride - 1).max(1) };
            for word in (0..stride).step_by(step) {
                active[row * stride + word] &= with_quads(frame, [word, row, k], lower, upper);
            }
        }
    }
    let mut count = 0u64;
    let last = frame.cells(0).div_ceil(64);
    for (active, first) in active.chunks_exact_mut(stride).zip(first.chunks_exact_mut(stride)) {
        for (word, active) in active.iter_mut().enumerate().skip(last.saturating_sub(1)) {
            *active &= frame.mask(word, frame.cells(0));
        }
        for (active, first) in active.iter().zip(first) {
            *first = count as u32;
            count += u64::from(active.count_ones());
        }
    }
    count
}

/// The cells of a word that have a crossed edge which is not on the border of the lattice.
#[inline(always)]
fn with_quads(frame: &Frame, [word, row, k]: [usize; 3], lower: &[u64], upper: &[u64]) -> u64 {
    let (stride, f) = (frame.stride, row * frame.stride + word);
    // Samples that are not on a border across the row, and the bits of the next word where it belongs to the row.
    let first = if word == 0 { !1 } else { !0 };
    let across = [frame.mask(word, frame.padded(0) - 1) & first, frame.mask(word + 1, frame.padded(0) - 1)];
    let (mut along, mut others) = (0, [0; 2]);
    for (slice, samples) in [lower, upper].into_iter().enumerate() {
        let inner_slice = !frame.on_border(2, k + slice);
        for side in [0, 1] {
            let at = f + side * stride;
            if inner_slice && !frame.on_border(1, row + side) {
                along |= samples[at] ^ (samples[at] >> 1 | samples[at + 1] << 63);
            }
        }
        for (next, other) in others.iter_mut().enumerate().filter(|_| inner_slice) {
            *other |= samples[f + next] ^ samples.get(f + stride + next).copied().unwrap_or(0);
        }
    }
    for side in [0, 1].into_iter().filter(|&side| !frame.on_border(1, row + side)) {
        for (next, other) in others.iter_mut().enumerate() {
            let at = f + side * stride + next;
            *other |= lower[at] ^ upper[at];
        }
    }
    let [here, next] = [others[0] & across[0], others[1] & across[1]];
    along | here | here >> 1 | next << 63
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Inside, Level};

    /// Whether a crossed edge of the cell has four cells around it, edge by edge.
    fn has_quad(inside: &dyn Fn([usize; 3]) -> bool, size: [usize; 3], cell: [usize; 3]) -> bool {
        (0..3).any(|axis| {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            (0..4).any(|side| {
                let mut from = cell;
                from[b] += side & 1;
                from[c] += side >> 1;
                let mut to = from;
                to[axis] += 1;
                let inner = |axis: usize| from[axis] > 0 && from[axis] + 1 < size[axis];
                inner(b) && inner(c) && inside(from) != inside(to)
            })
        })
    }

    #[test]
    fn cells_at_an_open_border_have_vertices_where_quads_use_them() {
        let level = Level { iso: 0.0, inside: Inside::Below };
        let mut state = 1u32;
        for columns in [2u32, 3, 5, 63, 64, 65, 66, 128, 129, 130] {
            for (rows, slabs, sparse) in [(2, 2, 2), (4, 4, 2), (5, 3, 11), (3, 2, 3)] {
                let frame = Frame::new([columns, rows, slabs], false);
                let size = [columns, rows, slabs].map(|count| count as usize);
                let sample = |_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    if (state >> 16).is_multiple_of(sparse) { -1.0f32 } else { 1.0 }
                };
                let samples: Vec<f32> = (0..columns * rows * slabs).map(sample).collect();
                let inside = |[i, j, k]: [usize; 3]| samples[(k * size[1] + j) * size[0] + i] < 0.0;
                let mut slices = vec![SignSlice::default(); size[2]];
                for (slice, samples) in slices.iter_mut().zip(samples.chunks(size[0] * size[1])) {
                    slice.fill(samples, level, &frame);
                }
                let mut layer = CellLayer::default();
                for k in 0..size[2] - 1 {
                    let count = layer.find(&frame, k, &slices[k], &slices[k + 1]);
                    let mut found = 0;
                    for (row, i) in (0..size[1] - 1).flat_map(|row| (0..frame.stride * 64).map(move |i| (row, i))) {
                        let expected = i + 1 < size[0] && has_quad(&inside, size, [i, row, k]);
                        let active = layer.active[row * frame.stride + i / 64] >> (i % 64) & 1 == 1;
                        let within =
                            i > 0 && row > 0 && k > 0 && i + 2 < size[0] && row + 2 < size[1] && k + 2 < size[2];
                        assert!(active == expected || within, "{size:?}: {i} {row} {k}");
                        found += u64::from(active);
                    }
                    assert_eq!(found, count);
                }
            }
        }
    }
}
