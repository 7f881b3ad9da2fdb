//! Which samples are inside, a bit each.

use crate::{Inside, Level};

/// Samples of this size or larger leave single precision when they are subtracted, or are not finite.
pub(crate) const LARGE: f32 = 1e37;

/// What a row of samples holds beside its bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PackedRow {
    /// How many samples are not finite.
    pub(crate) not_finite: usize,
    /// Whether every sample and the iso value are finite and smaller than [`LARGE`].
    pub(crate) tame: bool,
}

/// Writes for each sample of a row whether it is inside, bit `i % 64` of word `i / 64`. Bits beyond the row are 0.
///
/// Inlined, so that a caller compiled for wider vectors has it so.
///
/// # Panics
/// When there are fewer words than the row needs.
#[inline(always)]
pub(crate) fn pack_row(samples: &[f32], level: Level, words: &mut [u64]) -> PackedRow {
    let tame = level.iso.abs() < LARGE
        && match level.inside {
            Inside::Below => pack(samples, words, |sample| sample < level.iso),
            Inside::Above => pack(samples, words, |sample| sample > level.iso),
        };
    let not_finite = if tame { 0 } else { pack_any(samples, level, words) };
    PackedRow { not_finite, tame }
}

/// The bits of samples that are finite and not large; false where others are met.
#[inline(always)]
fn pack(samples: &[f32], words: &mut [u64], holds: impl Fn(f32) -> bool + Copy) -> bool {
    let large = LARGE.to_bits() as i32;
    let (whole, rest) = samples.as_chunks::<64>();
    for (samples, word) in whole.iter().zip(words.iter_mut()) {
        let (halves, _) = samples.as_chunks::<32>();
        let (low, a) = pack_32(&halves[0], holds);
        let (high, b) = pack_32(&halves[1], holds);
        *word = u64::from(low) | u64::from(high) << 32;
        // Left at once, not after the row: a loop without a way out is vectorised across words, with gathers, and is three times
        // slower.
        if a.max(b) >= large {
            return false;
        }
    }
    let mut bits = 0;
    let mut largest = 0;
    for (i, &sample) in rest.iter().enumerate() {
        bits |= u64::from(holds(sample)) << i;
        largest = largest.max(magnitude(sample));
    }
    if !rest.is_empty() {
        words[whole.len()] = bits;
    }
    largest < large
}

/// The bits of a magnitude: their order is that of the magnitudes, NaN last.
#[inline(always)]
fn magnitude(sample: f32) -> i32 {
    (sample.to_bits() & 0x7fff_ffff) as i32
}

/// Eight lanes, each with the bits of every eighth sample, so that a comparison and two operations do eight samples.
#[inline(always)]
fn pack_32(samples: &[f32; 32], holds: impl Fn(f32) -> bool + Copy) -> (u32, i32) {
    let mut bits = [0u32; 8];
    let mut largest = [0i32; 8];
    for round in 0..4 {
        for lane in 0..8 {
            let sample = samples[round * 8 + lane];
            bits[lane] |= if holds(sample) { 1 << (round * 8 + lane) } else { 0 };
            largest[lane] = largest[lane].max(magnitude(sample));
        }
    }
    (bits.into_iter().fold(0, |all, bits| all | bits), largest.into_iter().fold(0, i32::max))
}

/// The bits of samples of any kind; returns how many are not finite.
#[cold]
fn pack_any(samples: &[f32], level: Level, words: &mut [u64]) -> usize {
    let mut finite = 0;
    for (samples, word) in samples.chunks(64).zip(words) {
        *word = 0;
        for (i, &sample) in samples.iter().enumerate() {
            *word |= u64::from(level.holds(sample)) << i;
            finite += usize::from(sample.is_finite());
        }
    }
    samples.len() - finite
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_say_what_the_level_says() {
        let mut state = 1u32;
        let special = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.5, -0.0, 0.0, f32::MAX, f32::MIN];
        for (count, wild) in [0usize, 1, 2, 63, 64, 65, 128, 200].into_iter().flat_map(|n| [(n, true), (n, false)]) {
            let samples: Vec<f32> = (0..count)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    let strange = special.get(state as usize >> 28).copied().filter(|_| wild);
                    strange.unwrap_or(state as f32 / 4e9 - 0.3)
                })
                .collect();
            for inside in [Inside::Below, Inside::Above] {
                let level = Level { iso: 0.5, inside };
                let mut words = vec![u64::MAX; count.div_ceil(64)];
                let packed = pack_row(&samples, level, &mut words);
                assert_eq!(packed.not_finite, samples.iter().filter(|sample| !sample.is_finite()).count());
                assert_eq!(packed.tame, samples.iter().all(|sample| sample.abs() < LARGE));
                for i in 0..words.len() * 64 {
                    let expected = samples.get(i).is_some_and(|&sample| level.holds(sample));
                    assert_eq!(words[i / 64] >> (i % 64) & 1 == 1, expected, "{i} of {count}");
                }
            }
        }
    }
}
