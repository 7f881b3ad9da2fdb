//! Mean distances from anything that can be sampled to anything that knows its closest points.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ClosestPoint, Exec, Stop, parallel};

use super::{Estimate, MeanDistance};

/// A sample of a shape: a place that stands for a cell of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// A point of the shape.
    pub position: DVec3,
    /// How much of the shape the cell holds: its area, length or number of points.
    pub weight: f64,
    /// The largest distance of a point of the cell from the position; 0 for a point that stands for itself.
    pub radius: f64,
}

/// The mean distance from the samples of one shape to another, which only has to know its closest points.
///
/// The bounds are proven, up to the rounding of the closest points: a distance changes no faster than the place does, so
/// it differs from the sample's by no more than the radius anywhere in the cell. None where there is no sample with a
/// weight, or nothing to be near to.
///
/// # Errors
/// The reason to stop.
pub fn distance_from_samples(
    samples: &[Sample],
    to: &dyn ClosestPoint,
    exec: &Exec,
) -> Result<Option<MeanDistance>, Stop> {
    let sums = parallel::map_chunks(exec, samples.len(), 256, |range| {
        let mut sums = Some(Sums::default());
        for sample in &samples[range] {
            let distance = to.closest(sample.position).map(|closest| closest.distance_squared.sqrt());
            sums = sums.zip(distance).map(|(sums, distance)| sums.with(sample, distance));
        }
        Ok::<_, Stop>(sums)
    })?;
    let total = sums.into_iter().try_fold(Sums::default(), |total, part| part.map(|part| total.plus(&part)));
    Ok(total.filter(|total| total.weight > 0.0).map(|total| total.mean()))
}

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
    fn with(self, sample: &Sample, distance: f64) -> Self {
        let (lower, upper) = ((distance - sample.radius).max(0.0), distance + sample.radius);
        let triple = [distance, lower, upper];
        self.add(sample.weight, triple, triple.map(|distance| distance * distance), distance)
    }

    /// Adds a cell's mean distance and mean square, each as found, at least and at most.
    pub(super) fn add(mut self, weight: f64, distance: [f64; 3], square: [f64; 3], largest: f64) -> Self {
        self.weight += weight;
        for i in 0..3 {
            self.distance[i] += weight * distance[i];
            self.square[i] += weight * square[i];
        }
        self.largest = self.largest.max(largest);
        self.samples += 1;
        self
    }

    pub(super) fn plus(mut self, other: &Self) -> Self {
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
    pub(super) fn mean(&self) -> MeanDistance {
        let rounding = (self.samples as f64 + 64.0) / (1u64 << 52) as f64;
        let estimate = |sums: [f64; 3], root: bool| {
            let [value, lower, upper] = sums.map(|sum| sum / self.weight);
            let [value, lower, upper] = [value, lower * (1.0 - rounding), upper * (1.0 + rounding)];
            let all = [value, lower, upper].map(|x| if root { x.sqrt() } else { x });
            Estimate { value: all[0].clamp(all[1], all[2]), lower: all[1], upper: all[2] }
        };
        MeanDistance {
            mean: estimate(self.distance, false),
            rms: estimate(self.square, true),
            largest_sampled: self.largest,
            samples: self.samples,
        }
    }
}
