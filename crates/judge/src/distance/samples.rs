//! Mean distances between anything that can be sampled and that knows its closest points.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ClosestPoint, Exec, parallel};

use super::MeanDistance;
use super::measure::chamfer;
use super::side::Scale;
use super::sums::{ScaledSums, Sums, down, times, up};
use crate::JudgeError;
use crate::scaled::{exponent_of, times_power};

/// A sample of a shape: a place that stands for a cell of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// A point of the shape.
    pub position: DVec3,
    /// How much of the shape the cell holds: its area, length or number of points, in any unit that all samples share.
    pub weight: f64,
    /// The largest distance of a point of the cell from the position; 0 for a point that stands for itself.
    pub radius: f64,
}

/// A shape that is cut into cells, each with a sample that stands for it.
///
/// Laws: the cells cover the shape and their weights are their shares of it; no point of a cell is farther from its
/// sample than the radius; samples are the same each time and however they are asked for.
pub trait Samples: Send + Sync {
    /// How many samples there are.
    fn count(&self) -> usize;

    /// Writes the samples from the one numbered `first` on; there are as many as `out` has places.
    fn fill(&self, first: usize, out: &mut [Sample]);
}

impl Samples for [Sample] {
    fn count(&self) -> usize {
        self.len()
    }

    fn fill(&self, first: usize, out: &mut [Sample]) {
        out.copy_from_slice(&self[first..first + out.len()]);
    }
}

impl Samples for Vec<Sample> {
    fn count(&self) -> usize {
        self.len()
    }

    fn fill(&self, first: usize, out: &mut [Sample]) {
        self.as_slice().fill(first, out);
    }
}

/// A shape of any form: its samples, and its closest points.
#[derive(Clone, Copy)]
pub struct Sampled<'a> {
    /// Where the distance from the shape is looked at.
    pub samples: &'a dyn Samples,
    /// What distances to the shape are measured to.
    pub closest: &'a dyn ClosestPoint,
}

/// The mean distances between two shapes, both ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDistances {
    /// The mean distance of the first shape's points from the second.
    pub a_to_b: MeanDistance,
    /// The mean distance of the second shape's points from the first.
    pub b_to_a: MeanDistance,
}

impl MeanDistances {
    /// The chamfer distance: the mean of both directed mean distances.
    pub fn chamfer(&self) -> f64 {
        chamfer(&self.a_to_b, &self.b_to_a)[0]
    }

    /// The chamfer distance of squares: the mean of both directed mean squared distances.
    pub fn chamfer_squared(&self) -> f64 {
        chamfer(&self.a_to_b, &self.b_to_a)[1]
    }
}

/// The mean distances between two shapes, whatever they are. None where either has no sample with a weight, or no points.
///
/// Guarantees, errors and cost are those of [`distance_from_samples`], which does the work of each way.
///
/// # Errors
/// As [`distance_from_samples`]; the sample that is named may be of either shape.
pub fn distances_from_samples(
    a: Sampled<'_>,
    b: Sampled<'_>,
    exec: &Exec,
) -> Result<Option<MeanDistances>, JudgeError> {
    let a_to_b = distance_from_samples(a.samples, b.closest, &exec.part(0.0, 0.5))?;
    let b_to_a = distance_from_samples(b.samples, a.closest, &exec.part(0.5, 1.0))?;
    Ok(a_to_b.zip(b_to_a).map(|(a_to_b, b_to_a)| MeanDistances { a_to_b, b_to_a }))
}

/// The mean distance from the samples of one shape to another, which only has to know its closest points. None where
/// there is no sample with a weight, or nothing to be near to.
///
/// The closest points are taken at their word. The bound from above is true where they are points of the shape, be they
/// the closest or not; that from below is true where no other is closer. A shape whose closest points are off it by at
/// most `e`, or whose distance they overstate by at most `e`, makes that bound false by at most `e`. Beyond that both are
/// proven, rounding of the sums included: a distance changes no faster than the place does, so that in the cell it
/// differs from the sample's by no more than the radius. Sizes from 1e-300 to 1e300 lose nothing, and the number of threads
/// changes no bit.
///
/// Cost: a closest point a sample; memory does not grow with their number but by 100 bytes for each 256.
///
/// # Errors
/// A position that is not finite; a weight or a radius that is negative or not finite; a closest point that is not finite
/// or farther away than there are numbers, each with the number of its sample; or the reason to stop.
pub fn distance_from_samples(
    samples: &(impl Samples + ?Sized),
    to: &(impl ClosestPoint + ?Sized),
    exec: &Exec,
) -> Result<Option<MeanDistance>, JudgeError> {
    let sums = parallel::map_chunks(exec, samples.count(), BATCH, |range| {
        let mut batch = [Sample::default(); BATCH];
        let batch = &mut batch[..range.len()];
        samples.fill(range.start, batch);
        sums_of(range.start as u64, batch, to)
    })?;
    exec.progress(1.0);
    let total = sums.into_iter().try_fold(ScaledSums::default(), |total, part| part.map(|part| total.plus(&part)));
    let total = total.filter(|total| total.sums.weight > 0.0);
    Ok(total.map(|total| {
        let mean = total.sums.mean().unscaled(Scale::by(total.distance));
        MeanDistance { largest_sampled: total.largest, ..mean }
    }))
}

/// How many samples are asked for at a time.
const BATCH: usize = 256;

/// The sums over one batch; none where there is nothing to be near to.
fn sums_of(first: u64, batch: &[Sample], to: &(impl ClosestPoint + ?Sized)) -> Result<Option<ScaledSums>, JudgeError> {
    let mut distances = [0.0; BATCH];
    let (mut heaviest, mut farthest, mut largest) = (0.0f64, 0.0f64, 0.0f64);
    for (index, (sample, distance)) in (first..).zip(batch.iter().zip(&mut distances)) {
        check(index, sample)?;
        let Some(closest) = to.closest(sample.position) else { return Ok(None) };
        *distance = length(closest.point - sample.position);
        if !distance.is_finite() {
            return Err(JudgeError::Sample { sample: index, name: "distance", found: *distance });
        }
        largest = largest.max(*distance);
        if sample.weight > 0.0 {
            heaviest = heaviest.max(sample.weight);
            farthest = farthest.max(*distance).max(sample.radius);
        }
    }
    let exponent = |largest: f64| if largest > 0.0 { -(exponent_of(largest) + 1) } else { 0 };
    let (weight, distance) = (exponent(heaviest), exponent(farthest));
    let mut sums = Sums::default();
    for (sample, found) in batch.iter().zip(distances).filter(|(sample, _)| sample.weight > 0.0) {
        // Anything that vanishes here is too little from below, and something from above.
        let any = found.max(sample.radius);
        let [found, radius] = [found, sample.radius].map(|length| times(length, distance));
        let share = times(sample.weight, weight);
        let least = (found * (1.0 - LENGTH) - radius).max(0.0);
        let most = up((found + radius) * (1.0 + LENGTH), any);
        let any = any.min(sample.weight);
        let linear = [share * found, down(share * least), up(share * most, any)];
        let square =
            [share * (found * found), down(share * down(least * least)), up(share * up(most * most, any), any)];
        sums = sums.plus(&Sums { weight: share, distance: linear, square, largest: 0.0, samples: 1 });
    }
    sums.samples = batch.len() as u64;
    Ok(Some(ScaledSums { sums, weight, distance, largest }))
}

/// The relative rounding of a difference's length, with room to spare.
const LENGTH: f64 = 1.0 / (1u64 << 50) as f64;

fn check(index: u64, sample: &Sample) -> Result<(), JudgeError> {
    let coordinates = sample.position.to_array();
    if let Some(&found) = coordinates.iter().find(|x| !x.is_finite()) {
        return Err(JudgeError::Sample { sample: index, name: "position", found });
    }
    for (name, found) in [("weight", sample.weight), ("radius", sample.radius)] {
        if !(found >= 0.0 && found.is_finite()) {
            return Err(JudgeError::Sample { sample: index, name, found });
        }
    }
    Ok(())
}

/// The length of a vector of any size: squares neither overflow nor vanish. Not finite where the vector is not.
fn length(v: DVec3) -> f64 {
    if !v.is_finite() {
        return f64::NAN;
    }
    let largest = v.abs().max_element();
    if largest == 0.0 {
        return 0.0;
    }
    // A power of two, so that nothing is rounded.
    let exponent = -exponent_of(largest);
    times(times_power(v, exponent).length(), -exponent)
}
