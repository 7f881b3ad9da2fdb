//! Otsu's threshold.

use shapeloom_core::{ConvertError, Exec};

use crate::{Slabs, sample_range};

/// A threshold between two classes of samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Otsu {
    /// The threshold: samples above it are one class.
    pub threshold: f64,
    /// The part of the variance that lies between the classes, from 0 to 1: how well two classes describe the samples.
    pub separability: f64,
}

/// How many bins the histogram has.
const BINS: usize = 1024;

/// The threshold that parts the finite samples into two classes of largest variance between them (Otsu 1979), on a histogram of 1024
/// bins between the smallest and the largest. Where whole bins are empty between the classes it lies in their middle. Samples that
/// are all equal have their value as threshold, and 0 is that of samples of which none is finite. Cost: two passes.
///
/// # Errors
/// A slab cannot be had, or the reason to stop.
pub fn otsu_threshold<S: Slabs + ?Sized>(slabs: &S, exec: &Exec) -> Result<Otsu, ConvertError> {
    let mut buffer = Vec::new();
    let slab_count = slabs.lattice().dimensions()[2];
    let [low, high] = sample_range(slabs, exec)?.finite.unwrap_or([0.0; 2]).map(f64::from);
    if low == high {
        return Ok(Otsu { threshold: low, separability: 0.0 });
    }
    let mut counts = vec![0u64; BINS];
    // Halved, so that the range of single precision does not overflow.
    let scale = (BINS - 1) as f64 / (high * 0.5 - low * 0.5);
    for k in 0..slab_count {
        exec.check()?;
        for &sample in slabs.slab(k, &mut buffer)?.iter().filter(|sample| sample.is_finite()) {
            let bin = (f64::from(sample) * 0.5 - low * 0.5) * scale;
            counts[(bin + 0.5) as usize] += 1;
        }
    }
    let (bin, separability) = between(&counts);
    Ok(Otsu { threshold: low + bin / (BINS - 1) as f64 * (high - low), separability })
}

/// The place between the bins that parts them best, and the part of the variance between the classes.
fn between(counts: &[u64]) -> (f64, f64) {
    let total: u64 = counts.iter().sum();
    let moment: f64 = counts.iter().enumerate().map(|(bin, &count)| bin as f64 * count as f64).sum();
    let mean = moment / total as f64;
    let variance: f64 =
        counts.iter().enumerate().map(|(bin, &count)| (bin as f64 - mean).powi(2) * count as f64).sum::<f64>();
    let (mut below, mut moment_below) = (0u64, 0.0);
    let (mut best, mut place) = (-1.0f64, 0.0);
    for (bin, &count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        below += count;
        moment_below += bin as f64 * count as f64;
        let above = total - below;
        if above == 0 {
            break;
        }
        let gap = moment_below / below as f64 - (moment - moment_below) / above as f64;
        let variance_between = below as f64 * (above as f64 / total as f64) * gap * gap;
        if variance_between > best {
            best = variance_between;
            let next = (bin + 1..counts.len()).find(|&next| counts[next] > 0).unwrap_or(bin);
            place = (bin + next) as f64 * 0.5;
        }
    }
    (place, if variance > 0.0 { (best / variance).clamp(0.0, 1.0) } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: the weighted sum of the variances within both classes is smallest.
    #[test]
    fn no_other_place_has_less_variance_within_the_classes() {
        let mut state = 7u64;
        for _ in 0..200 {
            let counts: Vec<u64> = (0..12)
                .map(|_| {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    (state >> 60) % 7
                })
                .collect();
            if counts.iter().filter(|&&count| count > 0).count() < 2 {
                continue;
            }
            let within = |split: f64| {
                let class = |upper: bool| {
                    let bins = counts.iter().enumerate().filter(|(bin, _)| (*bin as f64 > split) == upper);
                    let (n, sum) = bins.clone().fold((0.0, 0.0), |(n, sum), (bin, &count)| {
                        (n + count as f64, sum + bin as f64 * count as f64)
                    });
                    let mean = if n > 0.0 { sum / n } else { 0.0 };
                    bins.map(|(bin, &count)| (bin as f64 - mean).powi(2) * count as f64).sum::<f64>()
                };
                class(false) + class(true)
            };
            let (place, _) = between(&counts);
            let found = within(place);
            for bin in 0..11 {
                assert!(found <= within(bin as f64 + 0.5) + 1e-9, "{counts:?}: {place} {bin}");
            }
        }
    }
}
