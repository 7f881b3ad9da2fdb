//! Which samples are inside, a bit each.

use crate::{Inside, Level};

/// Writes for each sample of a row whether it is inside, bit `i % 64` of word `i / 64`, and returns how many samples are not finite.
/// Bits beyond the row are 0.
///
/// # Panics
/// When there are fewer words than the row needs.
pub(crate) fn pack_row(samples: &[f32], level: Level, words: &mut [u64]) -> usize {
    match level.inside {
        Inside::Below => pack(samples, words, |sample| sample < level.iso),
        Inside::Above => pack(samples, words, |sample| sample > level.iso),
    }
}

fn pack(samples: &[f32], words: &mut [u64], holds: impl Fn(f32) -> bool) -> usize {
    let mut finite = 0;
    for (samples, word) in samples.chunks(64).zip(words.iter_mut()) {
        let mut bits = 0u64;
        for (i, &sample) in samples.iter().enumerate() {
            bits |= u64::from(holds(sample) && sample.is_finite()) << i;
            finite += usize::from(sample.is_finite());
        }
        *word = bits;
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
        for count in [0usize, 1, 2, 63, 64, 65, 128, 200] {
            let samples: Vec<f32> = (0..count)
                .map(|_| {
                    state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    special.get(state as usize >> 28).copied().unwrap_or(state as f32 / 4e9 - 0.3)
                })
                .collect();
            for inside in [Inside::Below, Inside::Above] {
                let level = Level { iso: 0.5, inside };
                let mut words = vec![u64::MAX; count.div_ceil(64)];
                let strange = pack_row(&samples, level, &mut words);
                assert_eq!(strange, samples.iter().filter(|sample| !sample.is_finite()).count());
                for i in 0..words.len() * 64 {
                    let expected = samples.get(i).is_some_and(|&sample| level.holds(sample));
                    assert_eq!(words[i / 64] >> (i % 64) & 1 == 1, expected, "{i} of {count}");
                }
            }
        }
    }
}
