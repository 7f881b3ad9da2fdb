//! Both kinds of distances, both ways.

use shapeloom_core::{Bounds, Exec, OptionError, Options, options};

use super::hausdorff::{self, DirectedHausdorff};
use super::mean::mean_distance;
use super::side::{Scale, Side};
use super::{Hausdorff, MeanDistance, Simplices};
use crate::JudgeError;

options! {
    /// Measures how far two shapes are apart: the Hausdorff distance from both sides, and mean distances.
    ///
    /// Bounds are true for the coordinates as given, rounding accounted for. They do not depend on the number of threads.
    /// Where both shapes have the same elements in the same order all distances are 0, exactly, however elements overlap;
    /// the same elements in another order are 0 away within rounding. No mean is above the Hausdorff distance's bound.
    /// Closest points are those of hierarchies that are built here, whose rounding is known: bounds from below count how
    /// far a computed foot may be from the true one. Other implementors of
    /// [`ClosestPoint`](shapeloom_core::ClosestPoint) take part in
    /// [`distances_from_samples`](crate::distances_from_samples), which says what it takes from them.
    ///
    /// Cost: about two closest points for each triangle, and for the Hausdorff distance more where the shapes are nearly
    /// at their largest distance. Memory, all of it reserved: of both shapes 24 bytes a position and a
    /// [`TriangleBvh`](shapeloom_spatial::TriangleBvh); of the one that is measured from, 57 bytes a position and 256 a
    /// triangle, and 256 more for each piece beyond the triangles that waits to be cut.
    pub struct Distances("distances") {
        required {}
        optional {
            /// How far the bounds of the Hausdorff distance may be apart, as a fraction of the upper one.
            relative_gap: f64 [Bounds::closed(0.0, 1.0)] = 0.01,
            /// How far they may be apart in any case, as a fraction of the diagonal of the first shape's bounding box.
            absolute_gap: f64 [Bounds::closed(0.0, 1.0)] = 1e-6,
            /// How many pieces may be cut, each way, before the search ends with the bounds that it has.
            max_splits: u32 = 20_000_000,
            /// How many cells the means are taken over, at least one for each triangle.
            samples: u32 [Bounds::closed(1.0, 1e9)] = 20_000,
        }
    }
}

/// How far two shapes are apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The Hausdorff distance.
    pub hausdorff: Hausdorff,
    /// The mean distance of the first shape's points from the second.
    pub a_to_b: MeanDistance,
    /// The mean distance of the second shape's points from the first.
    pub b_to_a: MeanDistance,
    /// The diagonal of the first shape's bounding box; of the second's if the first is a point.
    pub diagonal: f64,
}

impl Measured {
    /// The chamfer distance: the mean of both directed mean distances.
    pub fn chamfer(&self) -> f64 {
        chamfer(&self.a_to_b, &self.b_to_a)[0]
    }

    /// The chamfer distance of squares: the mean of both directed mean squared distances.
    pub fn chamfer_squared(&self) -> f64 {
        chamfer(&self.a_to_b, &self.b_to_a)[1]
    }
}

/// The mean of both means, and of both mean squares.
pub(super) fn chamfer(there: &MeanDistance, back: &MeanDistance) -> [f64; 2] {
    let [there_squared, back_squared] = [there, back].map(|way| way.rms.value * way.rms.value);
    [there.mean.value.midpoint(back.mean.value), there_squared.midpoint(back_squared)]
}

impl Distances {
    /// Measures two shapes.
    ///
    /// # Errors
    /// An option out of range; a shape without triangles, an index out of range, a position that is not finite; too
    /// little memory for the hierarchies, or the reason to stop. Where the search itself runs out of memory or of splits
    /// its bounds are wider, which is no error.
    pub fn measure(&self, a: &Simplices<'_>, b: &Simplices<'_>, exec: &Exec) -> Result<Measured, JudgeError> {
        let pair = Pair::new(self, a, b, exec)?;
        let way = |from: &Side<'_>, to: &Side<'_>, exec: &Exec| {
            let corners = to.probe_corners(from, &exec.part(0.0, 0.2))?;
            let mean = mean_distance(from, to, &corners, self.samples, pair.scale, &exec.part(0.2, 0.5))?;
            let farthest =
                hausdorff::directed(from, to, &corners, self, (pair.absolute, pair.scale), &exec.part(0.5, 1.0))?;
            Ok::<_, JudgeError>((farthest, mean.at_most(farthest.upper)))
        };
        let [a, b] = &pair.sides;
        let (there, a_to_b) = way(a, b, &exec.part(0.2, 0.6))?;
        let (back, b_to_a) = way(b, a, &exec.part(0.6, 1.0))?;
        let hausdorff = Hausdorff { a_to_b: there, b_to_a: back };
        Ok(Measured { hausdorff, a_to_b, b_to_a, diagonal: pair.scale.length(pair.diagonal) })
    }

    /// The Hausdorff distance alone.
    ///
    /// # Errors
    /// As [`Distances::measure`].
    pub fn hausdorff(&self, a: &Simplices<'_>, b: &Simplices<'_>, exec: &Exec) -> Result<Hausdorff, JudgeError> {
        let pair = Pair::new(self, a, b, exec)?;
        let way = |from: &Side<'_>, to: &Side<'_>, exec: &Exec| -> Result<DirectedHausdorff, JudgeError> {
            let corners = to.probe_corners(from, &exec.part(0.0, 0.3))?;
            hausdorff::directed(from, to, &corners, self, (pair.absolute, pair.scale), &exec.part(0.3, 1.0))
        };
        let [a, b] = &pair.sides;
        let a_to_b = way(a, b, &exec.part(0.2, 0.6))?;
        Ok(Hausdorff { a_to_b, b_to_a: way(b, a, &exec.part(0.6, 1.0))? })
    }
}

/// Two shapes made ready.
struct Pair<'a> {
    sides: [Side<'a>; 2],
    scale: Scale,
    /// In scaled units.
    diagonal: f64,
    absolute: f64,
}

impl<'a> Pair<'a> {
    fn new(options: &Distances, a: &'a Simplices<'_>, b: &'a Simplices<'_>, exec: &Exec) -> Result<Self, JudgeError> {
        if let Err(OptionError::OutOfBounds { name, found, bounds, .. }) = options.validate() {
            return Err(JudgeError::OutOfBounds { name, found, bounds });
        }
        let scale = Scale::of([a, b]);
        let sides = [Side::new(a, 0, scale, &exec.part(0.0, 0.1))?, Side::new(b, 1, scale, &exec.part(0.1, 0.2))?];
        let diagonal = if sides[0].diagonal > 0.0 { sides[0].diagonal } else { sides[1].diagonal };
        Ok(Self { sides, scale, diagonal, absolute: options.absolute_gap * diagonal })
    }
}
