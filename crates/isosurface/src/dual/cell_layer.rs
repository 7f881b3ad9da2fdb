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
