//! Grids as fields.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, ConvertError, Exec, Field, Interval, choice};
use shapeloom_isosurface::{Inside, Lattice, Level, Slabs};

use crate::VoxelError;

choice! {
    /// What lies between samples.
    pub enum Interpolation {
        /// Linear along each direction: continuous, with a gradient that jumps at the sides of cells.
        Trilinear = "trilinear",
        /// Cubic along each direction (Catmull and Rom 1974): goes through the samples, with a continuous gradient;
        /// overshoots.
        Tricubic = "tricubic",
    }
}

/// A grid as a field: negative inside, by the samples less the iso value, and interpolated in between.
///
/// Outside of the lattice the value is that of the nearest point of its border in lattice coordinates. The cubic
/// interpolant repeats the border's samples beyond it. The gradient is the interpolant's own; where the trilinear one
/// jumps, that of the cell with the larger coordinates; outside the lattice it has no part across the border.
///
/// [`range`](Field::range) is an outer bound, from the smallest and the largest sample of all cells that may meet the
/// box, through a pyramid of such pairs: 64 of them at most are read. A linear interpolant never leaves its samples'
/// range; a cubic one exceeds it by at most (5/4)³ of its half, as the weights along a direction sum to 1 and their
/// sizes to 5/4.
///
/// Memory: 4 bytes a sample, and 8/7 of two more numbers for each 8 samples.
#[derive(Clone, Debug)]
pub struct GridField {
    lattice: Lattice,
    to_lattice: Affine,
    interpolation: Interpolation,
    values: Vec<f32>,
    levels: Vec<Ranges>,
    steepest: f64,
}

/// The smallest and largest values of blocks of samples.
#[derive(Clone, Debug)]
struct Ranges {
    counts: [u32; 3],
    ranges: Vec<[f32; 2]>,
}

impl GridField {
    /// The field of samples, with `level` telling where its surface is.
    ///
    /// # Errors
    /// A sample that is NaN or infinite, a placement that cannot be inverted, a slab that cannot be had, too little
    /// memory, or the reason to stop.
    pub fn try_new<S: Slabs + ?Sized>(
        slabs: &S,
        level: Level,
        interpolation: Interpolation,
        exec: &Exec,
    ) -> Result<Self, ConvertError> {
        exec.check()?;
        let lattice = *slabs.lattice();
        let to_lattice = lattice.placement().inverse()?;
        let _memory = exec.reserve_elements(lattice.samples(), 8)?;
        let mut values = Vec::with_capacity(lattice.samples() as usize);
        let mut buffer = Vec::new();
        for k in 0..lattice.dimensions()[2] {
            exec.check()?;
            values.extend(slabs.slab(k, &mut buffer)?.iter().map(|&sample| match level.inside {
                Inside::Below => sample - level.iso,
                Inside::Above => level.iso - sample,
            }));
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(VoxelError::NotFinite { sample: lattice.coordinates(at as u64), found: values[at] }.into());
        }
        let mut field = Self { lattice, to_lattice, interpolation, values, levels: Vec::new(), steepest: 0.0 };
        field.fill_levels(exec)?;
        field.steepest = field.steepest_slope(exec)?;
        Ok(field)
    }

    /// Halves the blocks' counts until one is left.
    fn fill_levels(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let mut counts = self.lattice.dimensions();
        while counts != [1; 3] {
            let below = self.levels.len();
            let halves = counts.map(|count| count.div_ceil(2));
            let mut ranges = Vec::with_capacity(halves.iter().map(|&count| count as usize).product());
            for k in 0..halves[2] {
                for j in 0..halves[1] {
                    exec.check()?;
                    for i in 0..halves[0] {
                        let mut range = [f32::INFINITY, f32::NEG_INFINITY];
                        for child in 0..8 {
                            let at = [2 * i + (child & 1), 2 * j + (child >> 1 & 1), 2 * k + (child >> 2)];
                            if (0..3).all(|axis| at[axis] < counts[axis]) {
                                let [low, high] = self.block(below, at);
                                range = [range[0].min(low), range[1].max(high)];
                            }
                        }
                        ranges.push(range);
                    }
                }
            }
            self.levels.push(Ranges { counts: halves, ranges });
            counts = halves;
        }
        Ok(())
    }

    /// The range of a block of 2^level samples a side.
    fn block(&self, level: usize, [i, j, k]: [u32; 3]) -> [f32; 2] {
        if level == 0 {
            return [self.values[self.lattice.index([i, j, k]) as usize]; 2];
        }
        let Ranges { counts: [x, y, _], ranges } = &self.levels[level - 1];
        ranges[(k as usize * *y as usize + j as usize) * *x as usize + i as usize]
    }

    /// A bound of the trilinear gradient's length in space: of each direction the largest difference of neighbours.
    fn steepest_slope(&self, exec: &Exec) -> Result<f64, ConvertError> {
        let mut largest = DVec3::ZERO;
        for index in 0..self.lattice.samples() {
            if index % 4096 == 0 {
                exec.check()?;
            }
            let here = self.lattice.coordinates(index);
            for axis in 0..3 {
                let mut next = here;
                next[axis] += 1;
                if next[axis] < self.lattice.dimensions()[axis] {
                    let step = self.sample(next) - self.sample(here);
                    largest[axis] = largest[axis].max(step.abs());
                }
            }
        }
        Ok(largest.length() * self.to_lattice.stretch_bound() * (1.0 + 1e-14))
    }

    fn sample(&self, at: [u32; 3]) -> f64 {
        f64::from(self.values[self.lattice.index(at) as usize])
    }

    /// Where the samples are.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// What lies between them.
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The cell around a point and the place in it from 0 to 1, moved to the border from outside; by axis whether it
    /// was moved.
    fn locate(&self, point: DVec3) -> ([u32; 3], DVec3, [bool; 3]) {
        let at = self.to_lattice.point(point);
        let mut cell = [0u32; 3];
        let (mut part, mut moved) = (DVec3::ZERO, [false; 3]);
        for axis in 0..3 {
            let last = self.lattice.dimensions()[axis] - 1;
            let clamped = at[axis].max(0.0).min(f64::from(last));
            moved[axis] = clamped != at[axis];
            cell[axis] = (clamped as u32).min(last.saturating_sub(1));
            part[axis] = clamped - f64::from(cell[axis]);
        }
        (cell, part, moved)
    }

    /// The weighted sum of the samples around a cell; weights of the four samples from one before the cell on, by axis.
    fn weighted(&self, cell: [u32; 3], weights: &[[f64; 4]; 3]) -> f64 {
        let dimensions = self.lattice.dimensions();
        let sample = |axis: usize, n: usize| (cell[axis] + n as u32).saturating_sub(1).min(dimensions[axis] - 1);
        let mut sum = 0.0;
        for (c, wz) in weights[2].iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
            for (b, wy) in weights[1].iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                for (a, wx) in weights[0].iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
                    sum += wx * wy * wz * self.sample([sample(0, a), sample(1, b), sample(2, c)]);
                }
            }
        }
        sum
    }

    fn weights(&self, t: f64) -> [f64; 4] {
        match self.interpolation {
            Interpolation::Trilinear => [0.0, 1.0 - t, t, 0.0],
            Interpolation::Tricubic => [
                t * (-0.5 + t * (1.0 - 0.5 * t)),
                1.0 + t * t * (1.5 * t - 2.5),
                t * (0.5 + t * (2.0 - 1.5 * t)),
                t * t * (0.5 * t - 0.5),
            ],
        }
    }

    /// The weights' derivatives.
    fn slopes(&self, t: f64) -> [f64; 4] {
        match self.interpolation {
            Interpolation::Trilinear => [0.0, -1.0, 1.0, 0.0],
            Interpolation::Tricubic => {
                [-0.5 + t * (2.0 - 1.5 * t), t * (4.5 * t - 5.0), 0.5 + t * (4.0 - 4.5 * t), t * (1.5 * t - 1.0)]
            }
        }
    }
}

impl Field for GridField {
    fn value(&self, point: DVec3) -> f64 {
        if point.is_nan() {
            return f64::NAN;
        }
        let (cell, part, _) = self.locate(point);
        self.weighted(cell, &part.to_array().map(|t| self.weights(t)))
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        let (cell, part, moved) = self.locate(point);
        let weights = part.to_array().map(|t| self.weights(t));
        let mut gradient = DVec3::ZERO;
        for axis in (0..3).filter(|&axis| !moved[axis] && self.lattice.dimensions()[axis] > 1) {
            let mut weights = weights;
            weights[axis] = self.slopes(part[axis]);
            gradient[axis] = self.weighted(cell, &weights);
        }
        self.to_lattice.linear.transpose() * gradient
    }

    fn range(&self, region: &Aabb) -> Interval {
        if region.is_empty() || region.min.is_nan() || region.max.is_nan() {
            return Interval::ALL;
        }
        let there = region.transformed(&self.to_lattice);
        let reach = region.min.abs().max(region.max.abs()).max_element();
        let dimensions = self.lattice.dimensions();
        // Rounding of the map, in lattice coordinates.
        let sizes = |row: DVec3| row.abs().dot(DVec3::splat(reach));
        let rows = self.to_lattice.linear.transpose();
        let mut ends = [[0u32; 3]; 2];
        let support = u32::from(self.interpolation == Interpolation::Tricubic);
        for axis in 0..3 {
            let (row, last) = (rows.col(axis), dimensions[axis] - 1);
            let slack = 1e-14 * (sizes(row) + self.to_lattice.translation[axis].abs() + 1.0);
            let place = |at: f64| at.max(0.0).min(f64::from(last));
            // NaN, of an endless box, becomes 0 and would be wrong above.
            let (low, high) = (there.min[axis] - slack, there.max[axis] + slack);
            let (low, high) = if low.is_nan() || high.is_nan() { (0.0, f64::MAX) } else { (low, high) };
            ends[0][axis] = (place(low).floor() as u32).min(last.saturating_sub(1)).saturating_sub(support);
            ends[1][axis] = (place(high).floor() as u32).saturating_add(1 + support).min(last);
        }
        let blocks = |level: usize| (0..3).map(move |axis| (ends[1][axis] >> level) - (ends[0][axis] >> level) + 1);
        let level = (0..=self.levels.len()).find(|&level| blocks(level).all(|count| count <= 4));
        let level = level.unwrap_or(self.levels.len());
        let [from, to] = ends.map(|end| end.map(|at| at >> level));
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for k in from[2]..=to[2] {
            for j in from[1]..=to[1] {
                for i in from[0]..=to[0] {
                    let [least, most] = self.block(level, [i, j, k]);
                    (low, high) = (low.min(f64::from(least)), high.max(f64::from(most)));
                }
            }
        }
        let (mut middle, mut half) = (low * 0.5 + high * 0.5, high * 0.5 - low * 0.5);
        if self.interpolation == Interpolation::Tricubic {
            half *= 1.953_125;
        }
        // 64 terms of three products each.
        let rounding = 1e-13 * (low.abs().max(high.abs()));
        if !middle.is_finite() {
            (middle, half) = (0.0, f64::INFINITY);
        }
        Interval::new((middle - half - rounding).next_down(), (middle + half + rounding).next_up())
    }

    fn lipschitz(&self) -> Option<f64> {
        (self.interpolation == Interpolation::Trilinear).then_some(self.steepest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Quantity, Samples, VoxelGrid};
    use shapeloom_core::AxisAngle;
    use shapeloom_core::glam::DMat3;

    struct Dice(u64);

    impl Dice {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }

        fn point(&mut self) -> DVec3 {
            DVec3::new(self.unit(), self.unit(), self.unit())
        }
    }

    const ZERO: Level = Level { iso: 0.0, inside: Inside::Below };

    fn placement() -> Affine {
        let turn = Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, 3.0), 0.7).unwrap());
        Affine::from_translation(DVec3::new(5.0, -3.0, 2.0)) * turn * Affine::from_scale(DVec3::new(0.5, -0.25, 1.0))
    }

    fn field(dimensions: [u32; 3], interpolation: Interpolation, sample: impl Fn(DVec3) -> f64) -> GridField {
        let lattice = Lattice::try_new(dimensions, placement()).unwrap();
        let at = |at: u64| sample(DVec3::from(lattice.coordinates(at).map(f64::from))) as f32;
        let samples = Samples::F32((0..lattice.samples()).map(at).collect());
        let grid = VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance).unwrap();
        GridField::try_new(&grid, ZERO, interpolation, &Exec::default()).unwrap()
    }

    fn random(dimensions: [u32; 3], interpolation: Interpolation) -> GridField {
        field(dimensions, interpolation, |at| (at.dot(DVec3::new(12.9, 78.2, 37.7))).sin() * 4.0 + at.x)
    }

    /// Products of linear functions are trilinear, of quadratic ones cubic along each direction.
    #[test]
    fn polynomials_come_back_between_samples() {
        let mut dice = Dice(1);
        let linear = |p: DVec3| (1.0 + p.x) * (2.0 - 0.5 * p.y) * (p.z - 3.0);
        let quadratic = |p: DVec3| (1.0 + p.x * p.x) * (2.0 - p.y) + p.z * p.z;
        let each =
            [field([6, 5, 7], Interpolation::Trilinear, linear), field([6, 5, 7], Interpolation::Tricubic, quadratic)];
        for _ in 0..200 {
            let at = DVec3::ONE + dice.point() * DVec3::new(3.0, 2.0, 4.0);
            let there = placement().point(at);
            assert!((each[0].value(there) - linear(at)).abs() < 1e-10);
            assert!((each[1].value(there) - quadratic(at)).abs() < 1e-10);
        }
    }

    #[test]
    fn gradients_are_those_of_differences_also_outside() {
        let mut dice = Dice(2);
        for interpolation in [Interpolation::Trilinear, Interpolation::Tricubic] {
            for dimensions in [[5, 6, 4], [1, 4, 3]] {
                let field = random(dimensions, interpolation);
                for _ in 0..300 {
                    let p = placement().point(dice.point() * 8.0 - 2.0);
                    let step = 1e-6;
                    let slope = DVec3::AXES
                        .map(|axis| (field.value(p + axis * step) - field.value(p - axis * step)) / (2.0 * step));
                    let found = field.gradient(p);
                    assert!((found - DVec3::from(slope)).length() < 1e-5, "{interpolation:?} {p}: {found} {slope:?}");
                }
            }
        }
    }

    #[test]
    fn ranges_hold_every_value_and_are_no_wider_than_they_must_be() {
        let mut dice = Dice(3);
        for interpolation in [Interpolation::Trilinear, Interpolation::Tricubic] {
            let field = random([19, 23, 17], interpolation);
            let whole = field.range(&Aabb::from_corners(DVec3::splat(-1e3), DVec3::splat(1e3)));
            let mut narrower = 0;
            for round in 0..300 {
                let center = placement().point(dice.point() * 22.0 - 2.0);
                let size = dice.point() * if round % 2 == 0 { 0.2 } else { 4.0 };
                let region = Aabb { min: center - size, max: center + size };
                let range = field.range(&region);
                narrower += usize::from(range.length() < whole.length());
                for _ in 0..60 {
                    let value = field.value(region.min + size * 2.0 * dice.point());
                    assert!(range.contains(value), "{interpolation:?} {region:?}: {value} {range:?}");
                }
            }
            assert!(narrower > 100, "{narrower}");
            assert_eq!(field.range(&Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY }), whole);
        }
    }

    #[test]
    fn a_trilinear_field_is_no_steeper_than_it_says() {
        let field = random([9, 8, 7], Interpolation::Trilinear);
        let bound = field.lipschitz().unwrap();
        let mut dice = Dice(4);
        for _ in 0..2000 {
            let [a, b] = [dice.point(), dice.point()].map(|at| placement().point(at * 12.0 - 2.0));
            assert!((field.value(a) - field.value(b)).abs() <= bound * a.distance(b) + 1e-9);
        }
    }

    /// Where all weights of one sign meet samples of that sign, the cubic interpolant is as large as it can be.
    #[test]
    fn the_bound_of_cubic_overshoot_is_met() {
        let side = |at: f64| if (1.0..=2.0).contains(&at) { 1.0 } else { -1.0 };
        let field = field([4; 3], Interpolation::Tricubic, |at| side(at.x) * side(at.y) * side(at.z));
        let middle = placement().point(DVec3::splat(1.5));
        let largest = field.value(middle);
        assert!((largest - 1.25f64.powi(3)).abs() < 1e-12, "{largest}");
        let range = field.range(&Aabb { min: middle - 1e-6, max: middle + 1e-6 });
        assert!(range.contains(largest) && range.hi < largest + 1e-9, "{range:?}");
    }

    #[test]
    fn one_sample_is_in_the_range_of_every_box_around_it() {
        let mut dice = Dice(5);
        for _ in 0..40 {
            let spike = (dice.point() * 17.0).floor();
            let field = field([17; 3], Interpolation::Trilinear, |at| if at == spike { 1.0 } else { 0.0 });
            for reach in [0.0, 1.0, 5.0, 30.0] {
                let place = placement().point(spike);
                let range = field.range(&Aabb { min: place - reach, max: place + reach });
                assert!(range.lo <= 0.0 && range.hi >= 1.0, "{spike} {reach}: {range:?}");
            }
        }
    }

    #[test]
    fn densities_are_negative_inside_and_slopes_of_skewed_lattices_are_bounded() {
        // Lattice coordinates rise along nearly the same direction: their sum has thrice the slope of each.
        let rows = DMat3::from_diagonal(DVec3::splat(0.01)) + DMat3::from_cols(DVec3::ONE, DVec3::ZERO, DVec3::ZERO);
        let placement = Affine { linear: rows.inverse(), translation: DVec3::ZERO };
        let lattice = Lattice::try_new([3; 3], placement).unwrap();
        let sum = |at: u64| lattice.coordinates(at).into_iter().sum::<u32>() as f32;
        let samples = Samples::F32((0..27).map(sum).collect());
        let grid = VoxelGrid::try_new(lattice, samples, Quantity::Density).unwrap();
        let level = Level { iso: 2.0, inside: Inside::Above };
        let field = GridField::try_new(&grid, level, Interpolation::Trilinear, &Exec::default()).unwrap();
        for (at, wanted) in [([0; 3], 2.0), ([2; 3], -4.0)] {
            assert!((field.value(lattice.position(at)) - wanted).abs() < 1e-9);
        }
        let steepest = field.gradient(lattice.position([1; 3])).length();
        assert!((steepest - 3.01).abs() < 0.01 && field.lipschitz().unwrap() >= steepest, "{steepest}");
    }

    #[test]
    fn strange_samples_and_points_are_told() {
        let lattice = Lattice::along_axes([2, 1, 1], DVec3::ZERO, DVec3::ONE).unwrap();
        let samples = Samples::F32(vec![0.0, f32::NAN]);
        let grid = VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance).unwrap();
        let refused = GridField::try_new(&grid, ZERO, Interpolation::Trilinear, &Exec::default()).unwrap_err();
        assert_eq!(refused.diagnostic().code(), "E-voxels-finite");
        let field = random([4, 4, 4], Interpolation::Tricubic);
        assert!(field.value(DVec3::splat(f64::NAN)).is_nan());
        assert!(field.value(DVec3::splat(f64::INFINITY)).is_finite() || field.value(DVec3::INFINITY).is_nan());
        assert!(field.value(DVec3::splat(1e300)).is_finite());
    }
}
