//! The signs of a slab, a bit a sample.

use multiversion::multiversion;

use super::cell_tables::FACE_EDGES;
use crate::Level;
use crate::inside_bits::pack_row;

/// Lattice sizes as the dual grid sees them: with a layer of outside samples around it where the border is closed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Samples of the lattice in each direction.
    pub(super) samples: [usize; 3],
    /// 1 with a layer of outside samples around, else 0: sample `i` is at `i + pad`.
    pub(super) pad: usize,
    /// Words of a row of signs.
    pub(super) stride: usize,
}

impl Frame {
    pub(super) fn new(dimensions: [u32; 3], closed: bool) -> Self {
        let pad = usize::from(closed);
        let samples = dimensions.map(|count| count as usize);
        Self { samples, pad, stride: (samples[0] + 2 * pad).div_ceil(64) }
    }

    /// Samples in a direction, those around the lattice too.
    pub(super) fn padded(&self, axis: usize) -> usize {
        self.samples[axis] + 2 * self.pad
    }

    /// Cells in a direction.
    pub(super) fn cells(&self, axis: usize) -> usize {
        self.padded(axis) - 1
    }

    /// Words of a slice of signs: its rows, and a word of zeros.
    pub(super) fn slice_words(&self) -> usize {
        self.padded(1) * self.stride + 1
    }

    /// The edges of a cell that lie on an open border, a bit each: those have no four cells around them.
    pub(super) fn edges_at_border(&self, cell: [usize; 3]) -> u16 {
        if self.pad > 0 {
            return 0;
        }
        let mut edges = 0;
        for (axis, at) in cell.into_iter().enumerate() {
            edges |= if at == 0 { FACE_EDGES[2 * axis] } else { 0 };
            edges |= if at + 1 == self.cells(axis) { FACE_EDGES[2 * axis + 1] } else { 0 };
        }
        edges
    }

    /// Whether cells at this place along an axis are the first or the last ones.
    pub(super) fn at_end(&self, axis: usize, cell: usize) -> bool {
        cell == 0 || cell + 1 == self.cells(axis)
    }

    /// Whether samples at this place along an axis are the first or the last ones.
    pub(super) fn on_border(&self, axis: usize, sample: usize) -> bool {
        sample == 0 || sample + 1 == self.padded(axis)
    }

    /// The slab of a slice, if it is not one of those around the lattice.
    pub(super) fn slab(&self, slice: usize) -> Option<u32> {
        slice.checked_sub(self.pad).filter(|&k| k < self.samples[2]).map(|k| k as u32)
    }

    /// The bits of a word that stand for the first `count` places of a row.
    pub(super) fn mask(&self, word: usize, count: usize) -> u64 {
        match count.saturating_sub(word * 64) {
            0 => 0,
            left if left < 64 => (1 << left) - 1,
            _ => u64::MAX,
        }
    }
}

/// The signs of a slice: 1 for inside.
#[derive(Clone, Debug, Default)]
pub(super) struct SignSlice {
    /// Row by row.
    pub(super) words: Vec<u64>,
    /// For each row, whether its samples are finite and not large.
    pub(super) tame: Vec<bool>,
}

impl SignSlice {
    /// A slice without anything inside.
    pub(super) fn clear(&mut self, frame: &Frame) {
        self.words.clear();
        self.words.resize(frame.slice_words(), 0);
        self.tame.clear();
        self.tame.resize(frame.padded(1), true);
    }

    /// Takes the signs of a slab; returns how many samples are not finite.
    pub(super) fn fill(&mut self, samples: &[f32], level: Level, frame: &Frame) -> u64 {
        if self.words.len() != frame.slice_words() {
            self.clear(frame);
        }
        fill(samples, level, frame, &mut self.words, &mut self.tame)
    }

    /// The sign at a place of a row.
    pub(super) fn at(&self, frame: &Frame, i: usize, row: usize) -> bool {
        self.words.get(row * frame.stride + i / 64).is_some_and(|word| word >> (i % 64) & 1 == 1)
    }
}

#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn fill(samples: &[f32], level: Level, frame: &Frame, words: &mut [u64], tame: &mut [bool]) -> u64 {
    let (columns, pad, stride) = (frame.samples[0], frame.pad, frame.stride);
    let mut not_finite = 0;
    let rows = words.chunks_exact_mut(stride).zip(tame.iter_mut()).skip(pad);
    for (samples, (words, tame)) in samples.chunks_exact(columns).zip(rows) {
        let packed = pack_row(samples, level, words);
        not_finite += packed.not_finite as u64;
        *tame = packed.tame;
        if pad == 1 {
            // The last word of a longer row holds nothing of this one yet.
            if columns.div_ceil(64) < stride {
                words[stride - 1] = 0;
            }
            let mut carried = 0;
            for word in words {
                let next = *word >> 63;
                *word = *word << 1 | carried;
                carried = next;
            }
        }
    }
    not_finite
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Inside;

    #[test]
    fn signs_are_where_the_samples_are() {
        let level = Level { iso: 0.0, inside: Inside::Below };
        for closed in [false, true] {
            for columns in [1u32, 2, 62, 63, 64, 65, 126, 127, 128, 130] {
                let frame = Frame::new([columns, 3, 1], closed);
                let mut slice = SignSlice::default();
                let sample = |i: u32| if (i * 7 + i / 5).is_multiple_of(3) { -1.0 } else { 1.0 };
                // Twice, so that nothing of the first time is left.
                slice.fill(&vec![-1.0; 3 * columns as usize], level, &frame);
                slice.fill(&(0..3 * columns).map(sample).collect::<Vec<f32>>(), level, &frame);
                for row in 0..frame.padded(1) {
                    for i in 0..frame.stride * 64 {
                        let place = (i.checked_sub(frame.pad), row.checked_sub(frame.pad));
                        let expected = match place {
                            (Some(i), Some(j)) if i < columns as usize && j < 3 => {
                                sample(j as u32 * columns + i as u32) < 0.0
                            }
                            _ => false,
                        };
                        assert_eq!(slice.at(&frame, i, row), expected, "{closed} {columns} {i} {row}");
                    }
                }
            }
        }
    }
}
