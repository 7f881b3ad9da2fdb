//! Sums of distances over cells, and the means that they come to.

use shapeloom_core::glam::DVec3;

use super::{Estimate, MeanDistance};
use crate::scaled::times_power;

/// Sums over samples: of the distances and their squares, each as found, at least and at most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sums {
    pub weight: f64,
    pub distance: [f64; 3],
    pub square: [f64; 3],
    pub largest: f64,
    pub samples: u64,
}

impl Sums {
    /// Adds a cell's mean distance and mean square, each as found, at least and at most.
    pub fn add(self, weight: f64, distance: [f64; 3], square: [f64; 3], largest: f64) -> Self {
        let [distance, square] = [distance, square].map(|means| means.map(|mean| weight * mean));
        self.plus(&Self { weight, distance, square, largest, samples: 1 })
    }

    pub fn plus(mut self, other: &Self) -> Self {
        self.weight += other.weight;
        for i in 0..3 {
            self.distance[i] += other.distance[i];
            self.square[i] += other.square[i];
        }
        self.largest = self.largest.max(other.largest);
        self.samples += other.samples;
        self
    }

    /// The means. A sum of so many terms that are not negative is rounded by no more than as many units in the last
    /// place, in any order; the bounds are moved outward by twice that.
    pub fn mean(&self) -> MeanDistance {
        let rounding = (self.samples as f64 + 64.0) / (1u64 << 52) as f64;
        let estimate = |sums: [f64; 3], root: bool| {
            let [value, lower, upper] = sums.map(|sum| sum / self.weight);
            let [value, lower, upper] = [value, lower * (1.0 - rounding), upper * (1.0 + rounding)];
            let all = [value, lower, upper].map(|x| if root { x.sqrt() } else { x });
            Estimate { value: all[0].max(all[1]).min(all[2]), lower: all[1], upper: all[2] }
        };
        MeanDistance {
            mean: estimate(self.distance, false),
            rms: estimate(self.square, true),
            largest_sampled: self.largest,
            samples: self.samples,
        }
    }
}

/// Sums in which weights and distances are multiplied by powers of two, so that the largest of each is between 1/2 and
/// 1: then nothing overflows, and what vanishes beside the largest is accounted for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ScaledSums {
    pub sums: Sums,
    /// The exponents of the powers by which weights and distances were multiplied.
    pub weight: i32,
    pub distance: i32,
    /// The largest distance, on its own scale: that of samples without weight counts too.
    pub largest: f64,
}

impl ScaledSums {
    /// The same sums on scales no larger than these.
    fn on(&self, weight: i32, distance: i32) -> Sums {
        let (by_weight, by_distance) = (weight - self.weight, distance - self.distance);
        let sums = &self.sums;
        Sums {
            weight: times(sums.weight, by_weight),
            distance: outward(sums.distance, by_weight + by_distance),
            square: outward(sums.square, by_weight + 2 * by_distance),
            ..*sums
        }
    }

    pub fn plus(&self, other: &Self) -> Self {
        let largest = self.largest.max(other.largest);
        // Without a weight there is nothing in the sums, and no scale of theirs.
        match (self.sums.weight > 0.0, other.sums.weight > 0.0) {
            (false, _) => Self { sums: self.sums.plus(&other.sums), largest, ..*other },
            (_, false) => Self { sums: self.sums.plus(&other.sums), largest, ..*self },
            _ => {
                let (weight, distance) = (self.weight.min(other.weight), self.distance.min(other.distance));
                let sums = self.on(weight, distance).plus(&other.on(weight, distance));
                Self { sums, weight, distance, largest }
            }
        }
    }
}

/// Sums as found, at least and at most, times a power of two that is no more than 1. What vanishes does not vanish from
/// the bound from above.
fn outward(sums: [f64; 3], exponent: i32) -> [f64; 3] {
    let [value, lower, upper] = sums.map(|sum| times(sum, exponent));
    if exponent == 0 { sums } else { [value, down(lower), up(upper, sums[2])] }
}

/// A product that is too small to be a precise number, as a bound from below.
pub(super) fn down(product: f64) -> f64 {
    if product < f64::MIN_POSITIVE { 0.0 } else { product }
}

/// A product, as a bound from above; `factor` is 0 only where it is.
pub(super) fn up(product: f64, factor: f64) -> f64 {
    if factor > 0.0 { product.max(f64::MIN_POSITIVE) } else { product }
}

/// A number times a power of two.
pub(super) fn times(value: f64, exponent: i32) -> f64 {
    // No number is left of any after so small a power.
    times_power(DVec3::X * value, exponent.max(-2000)).x
}
