//! Which samples of a lattice are inside, a bit each.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use multiversion::multiversion;
use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{ConvertError, Exec, OverBudget, Reservation};

use crate::inside_bits::pack_row;
use crate::{Border, Lattice, Level, Slabs};

/// How many slabs are packed at a time.
const SLABS: usize = 4;

/// How many samples lie between two looks whether to stop.
const SAMPLES_PER_CHECK: usize = 1 << 20;

/// Which samples are inside, in rows of whole words. Where the border is closed the lattice has a layer of outside samples around
/// it: sample `i` of the lattice is then sample `i + 1` here.
#[derive(Debug)]
pub(crate) struct LatticeBits {
    words: Vec<u64>,
    words_per_row: usize,
    /// The samples in each direction, with those around.
    pub(crate) dimensions: [usize; 3],
    /// The layers around the lattice: 0 or 1.
    pub(crate) margin: usize,
    /// How many samples are NaN or infinite.
    pub(crate) not_finite: u64,
    /// Whether all samples read so far are finite and small enough to be subtracted.
    pub(crate) tame: bool,
    _memory: Reservation,
}

impl LatticeBits {
    /// Room for the bits of a lattice.
    pub(crate) fn new(lattice: &Lattice, border: Border, exec: &Exec) -> Result<Self, OverBudget> {
        let margin = usize::from(border == Border::Closed);
        let dimensions = lattice.dimensions().map(|count| count as usize + 2 * margin);
        let words_per_row = dimensions[0].div_ceil(64);
        let words = (words_per_row as u64 * dimensions[1] as u64).saturating_mul(dimensions[2] as u64);
        let memory = exec.reserve_elements(words, 8)?;
        let words = vec![0u64; words as usize];
        Ok(Self { words, words_per_row, dimensions, margin, not_finite: 0, tame: true, _memory: memory })
    }

    /// Reads planes, counted with the margin.
    pub(crate) fn read<S: Slabs + ?Sized>(
        &mut self,
        slabs: &S,
        level: Level,
        planes: Range<usize>,
        exec: &Exec,
    ) -> Result<(), ConvertError> {
        let [columns, _, slab_count] = slabs.lattice().dimensions().map(|count| count as usize);
        let (margin, words_per_row) = (self.margin, self.words_per_row);
        let slab_words = words_per_row * self.dimensions[1];
        let (not_finite, wild) = (AtomicU64::new(0), AtomicU64::new(0));
        let words = &mut self.words[planes.start * slab_words..planes.end * slab_words];
        fill_chunks(exec, words, SLABS * slab_words, |first, part| {
            let mut buffer = Vec::new();
            for (at, part) in part.chunks_mut(slab_words).enumerate() {
                let plane = planes.start + first / slab_words + at;
                let Some(k) = plane.checked_sub(margin).filter(|&k| k < slab_count) else { continue };
                let slab = slabs.slab(k as u32, &mut buffer)?;
                let at_once = (SAMPLES_PER_CHECK / columns).max(1);
                let packed = part[margin * words_per_row..].chunks_mut(at_once * words_per_row);
                for (words, samples) in packed.zip(slab.chunks(at_once * columns)) {
                    exec.check()?;
                    let [strange, untame] = pack_rows(samples, columns, level, words, (words_per_row, margin));
                    not_finite.fetch_add(strange, Ordering::Relaxed);
                    wild.fetch_add(untame, Ordering::Relaxed);
                }
            }
            Ok::<(), ConvertError>(())
        })?;
        self.not_finite += not_finite.into_inner();
        self.tame &= wild.into_inner() == 0;
        Ok(())
    }

    /// The row of samples `(.., j, k)`.
    #[inline(always)]
    pub(crate) fn row(&self, j: usize, k: usize) -> &[u64] {
        let start = (k * self.dimensions[1] + j) * self.words_per_row;
        &self.words[start..start + self.words_per_row]
    }

    /// The memory that the bits take, in bytes.
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(self.words.as_slice())
    }
}

/// Packs rows of samples, moves their bits up by the margin, and returns how many samples are not finite, and how many rows have
/// some that are not tame.
#[multiversion(targets("x86_64+avx+avx2+bmi1+bmi2+lzcnt+popcnt"))]
fn pack_rows(
    samples: &[f32],
    columns: usize,
    level: Level,
    words: &mut [u64],
    (words_per_row, margin): (usize, usize),
) -> [u64; 2] {
    let (mut not_finite, mut wild) = (0, 0);
    for (samples, row) in samples.chunks(columns).zip(words.chunks_mut(words_per_row)) {
        let packed = pack_row(samples, level, row);
        not_finite += packed.not_finite as u64;
        wild += u64::from(!packed.tame);
        if margin == 1 {
            shift_up(row);
        }
    }
    [not_finite, wild]
}

/// Moves each bit to the next place.
fn shift_up(row: &mut [u64]) {
    let mut carry = 0;
    for word in row {
        let next = *word >> 63;
        *word = *word << 1 | carry;
        carry = next;
    }
}
