//! Mean distances by a quadrature with proven bounds.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Stop, parallel};

use super::foot::distance_to_triangle;
use super::side::{Corners, Probe, Scale, Side};
use super::sums::Sums;
use crate::JudgeError;

/// A number with proven bounds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// The true number is no less.
    pub lower: f64,
    /// The true number is no more.
    pub upper: f64,
}

/// The mean distance of the points of one shape from another shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanDistance {
    /// The mean over the area of the shape; over the length where it has no area, over the points where it has neither.
    pub mean: Estimate,
    /// The root of the mean of squares.
    pub rms: Estimate,
    /// The largest distance of a sample.
    pub largest_sampled: f64,
    /// How many cells were sampled.
    pub samples: u64,
}

impl MeanDistance {
    /// The same where no point is farther away than `most`: neither is a mean.
    pub(super) fn at_most(self, most: f64) -> Self {
        let estimate = |found: Estimate| Estimate {
            value: found.value.min(most),
            lower: found.lower.min(most),
            upper: found.upper.min(most),
        };
        Self {
            mean: estimate(self.mean),
            rms: estimate(self.rms),
            largest_sampled: self.largest_sampled.min(most),
            samples: self.samples,
        }
    }

    /// In model units; the bounds are rounded outward.
    pub(super) fn unscaled(self, scale: Scale) -> Self {
        let estimate = |found: Estimate| Estimate {
            value: scale.length(found.value),
            lower: scale.length_down(found.lower),
            upper: scale.length_up(found.upper),
        };
        Self {
            mean: estimate(self.mean),
            rms: estimate(self.rms),
            largest_sampled: scale.length(self.largest_sampled),
            samples: self.samples,
        }
    }
}

/// What a shape is measured by: the largest dimension that it has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Measure {
    Area,
    Length,
    Count,
}

impl Measure {
    pub fn of(self, [a, b, c]: &[DVec3; 3]) -> f64 {
        match self {
            Self::Area => (*b - *a).cross(*c - *a).length() * 0.5,
            // The longest side is the segment itself.
            Self::Length => a.distance(*b).max(b.distance(*c)).max(c.distance(*a)),
            Self::Count => 1.0,
        }
    }

    /// The measure of a shape of so many elements, and how much of it there is.
    pub fn of_shape(
        count: usize,
        corners: impl Fn(u32) -> [DVec3; 3] + Sync,
        exec: &Exec,
    ) -> Result<(Self, f64), Stop> {
        for measure in [Self::Area, Self::Length] {
            let total = parallel::sum(exec, count, |i| measure.of(&corners(i as u32)))?;
            if total > 0.0 {
                return Ok((measure, total));
            }
        }
        Ok((Self::Count, count as f64))
    }

    /// Into how many parts an element of a size is divided, along a side, for cells of about one size.
    pub fn parts(self, size: f64, cell: f64) -> u32 {
        let parts = size / cell;
        match self {
            Self::Area => parts.sqrt().ceil().clamp(1.0, MOST_PARTS) as u32,
            Self::Length => parts.ceil().clamp(1.0, MOST_PARTS) as u32,
            Self::Count => 1,
        }
    }
}

/// The largest number of parts that a side of a triangle is divided into.
const MOST_PARTS: f64 = 512.0;

/// The mean of the distance over `from`, in cells of about the same measure, about as many as asked for and at least one
/// for each triangle.
pub(super) fn mean_distance(
    from: &Side<'_>,
    to: &Side<'_>,
    corners: &Corners,
    samples: u32,
    scale: Scale,
    exec: &Exec,
) -> Result<MeanDistance, JudgeError> {
    let (measure, total) = Measure::of_shape(from.triangles.len(), |i| from.corners(i), exec)?;
    let cell = total / f64::from(samples.max(1));
    let sums = parallel::map_chunks(exec, from.triangles.len(), 64, |range| {
        let mut sums = Sums::default();
        for triangle in range {
            let places = from.corners(triangle as u32);
            let size = measure.of(&places);
            if size == 0.0 {
                continue;
            }
            let probes = from.triangles[triangle].map(|corner| corners.probes[corner as usize]);
            let quadrature = Quadrature { to, places, probes };
            let parts = measure.parts(size, cell);
            match measure {
                Measure::Area => quadrature.triangle(size, parts, &mut sums),
                Measure::Length => quadrature.segment(size, parts, &mut sums),
                Measure::Count => quadrature.point(&mut sums),
            }
            exec.check()?;
        }
        Ok::<_, Stop>(sums)
    })?;
    let total = sums.iter().fold(Sums::default(), |total, part| total.plus(part));
    Ok(total.mean().unscaled(scale))
}

/// One triangle with what is known of its corners.
struct Quadrature<'a> {
    to: &'a Side<'a>,
    places: [DVec3; 3],
    probes: [Probe; 3],
}

impl Quadrature<'_> {
    /// A triangle as `parts²` congruent ones.
    fn triangle(&self, area: f64, parts: u32, sums: &mut Sums) {
        let weight = area / f64::from(parts * parts);
        let [a, b, c] = self.places;
        let (u, v) = ((b - a) / f64::from(parts), (c - a) / f64::from(parts));
        let at = |i: u32, j: u32| match (i, j) {
            (0, 0) => (a, self.probes[0]),
            (i, 0) if i == parts => (b, self.probes[1]),
            (0, j) if j == parts => (c, self.probes[2]),
            (i, j) => {
                let place = a + u * f64::from(i) + v * f64::from(j);
                (place, self.to.probe(place))
            }
        };
        let mut row: Vec<(DVec3, Probe)> = (0..=parts).map(|i| at(i, 0)).collect();
        for j in 0..parts {
            let next: Vec<(DVec3, Probe)> = (0..parts - j).map(|i| at(i, j + 1)).collect();
            for i in 0..(parts - j) as usize {
                self.cell([row[i], row[i + 1], next[i]], weight, sums);
                if i + 1 < next.len() {
                    self.cell([row[i + 1], next[i + 1], next[i]], weight, sums);
                }
            }
            row = next;
        }
    }

    /// A triangle without area: its longest side in equal parts.
    fn segment(&self, length: f64, parts: u32, sums: &mut Sums) {
        let ends = [(0, 1), (1, 2), (2, 0)];
        let side = ends.into_iter().find(|&(i, j)| self.places[i].distance(self.places[j]) == length);
        let (i, j) = side.unwrap_or((0, 1));
        let (start, end) = (self.places[i], self.places[j]);
        let at = |k: u32| match k {
            0 => (start, self.probes[i]),
            k if k == parts => (end, self.probes[j]),
            k => {
                let place = start + (end - start) * (f64::from(k) / f64::from(parts));
                (place, self.to.probe(place))
            }
        };
        let mut from = at(0);
        for k in 0..parts {
            let to = at(k + 1);
            self.cell([from, to, to], length / f64::from(parts), sums);
            from = to;
        }
    }

    fn point(&self, sums: &mut Sums) {
        let Probe { distance, lower, upper, .. } = self.probes[0];
        let triple = [distance, lower, upper];
        *sums = sums.add(1.0, triple, triple.map(|x| x * x), distance);
    }

    /// A cell, as a triangle or a segment `[a, b, b]`.
    ///
    /// The estimate weighs the middle three quarters and each corner a twelfth (for segments two thirds and a sixth), which
    /// is exact for quadratic functions. From above, the distance to one triangle is convex, so that its mean is at most
    /// that of the corners; from both sides, it changes no faster than the place, whose root mean square distance from the
    /// middle is a sixth of the root of the sum of the sides' squares.
    fn cell(&self, corners: [(DVec3, Probe); 3], weight: f64, sums: &mut Sums) {
        let [a, b, c] = corners.map(|corner| corner.0);
        let segment = b == c;
        let middle = if segment { (a + b) * 0.5 } else { (a + b + c) / 3.0 };
        let probe = self.to.probe(middle);
        let squares = (b - a).length_squared() + (c - b).length_squared() + (a - c).length_squared();
        let (spread, ends, inner) = match segment {
            // Of a segment of length l the root mean square distance from the middle is l / √12; squares are 2 l².
            true => ((squares / 24.0).sqrt(), [1.0 / 2.0, 1.0 / 2.0, 0.0], 2.0 / 3.0),
            false => (squares.sqrt() / 6.0, [1.0 / 3.0; 3], 3.0 / 4.0),
        };
        let spread = spread * (1.0 + 1e-14) + 1e-15;
        let along = |values: [f64; 3]| values.iter().zip(ends).map(|(value, end)| value * end).sum::<f64>();
        let mut most = probe.upper + spread;
        let mut most_squared = probe.upper * probe.upper + 2.0 * probe.upper * spread + spread * spread;
        let elements = [probe.element, corners[0].1.element, corners[1].1.element, corners[2].1.element];
        for (i, &element) in elements.iter().enumerate() {
            if elements[..i].contains(&element) {
                continue;
            }
            let triangle = self.to.corners(element);
            let [d, e, f] = [a, b, c].map(|corner| distance_to_triangle(&triangle, corner));
            most = most.min(along([d, e, f]));
            let squared = match segment {
                true => (d * d + d * e + e * e) / 3.0,
                false => (d * d + e * e + f * f + d * e + e * f + f * d) / 6.0,
            };
            most_squared = most_squared.min(squared);
        }
        let (most, most_squared) = (most * (1.0 + 1e-14), most_squared * (1.0 + 1e-14));
        let least = (probe.lower - spread).max(0.0).min(most);
        let values = corners.map(|corner| corner.1.distance);
        let value = probe.distance * inner + along(values) * (1.0 - inner);
        let square = probe.distance * probe.distance * inner + along(values.map(|x| x * x)) * (1.0 - inner);
        let largest = values.into_iter().fold(probe.distance, f64::max);
        let least_squared = (least * least).min(most_squared);
        let distance = [value.clamp(least, most), least, most];
        let square = [square.clamp(least_squared, most_squared), least_squared, most_squared];
        *sums = sums.add(weight, distance, square, largest);
    }
}
