//! Coordinates times a power of two.

use shapeloom_core::glam::{DVec2, DVec3};

/// A power of two by which coordinates are multiplied before the triangulation sees them.
///
/// Multiplying by a power of two changes no bit but the exponent, so every sign of a determinant stays what it is, and
/// shapes of 1e-300 and of 1e150 come to lie where no product of four coordinates underflows or overflows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Scale {
    exponent: i32,
}

/// The largest coordinate comes to lie between this power of two and the next. The triangulation takes up to 2^201.
const TOP: i32 = 190;

/// Smaller coordinates are taken as 0: 2^-142 is the smallest that the triangulation takes.
const SMALLEST: f64 = f64::from_bits((1023 - 142) << 52);

impl Scale {
    /// The scale for coordinates up to `largest` in magnitude.
    pub(crate) fn of(largest: f64) -> Self {
        Self { exponent: if largest > 0.0 { TOP - exponent_of(largest) } else { 0 } }
    }

    /// The scale on which coordinates up to `largest` come to lie below 2 in magnitude.
    pub(crate) fn to_one(largest: f64) -> Self {
        Self { exponent: if largest > 0.0 { -exponent_of(largest) } else { 0 } }
    }

    /// The scale for these points.
    pub(crate) fn of_points(points: &[DVec2]) -> Self {
        Self::of(points.iter().map(|point| point.abs().max_element()).fold(0.0, f64::max))
    }

    /// A point on this scale, and whether a coordinate was too small beside the largest and became 0.
    pub(crate) fn apply(self, point: DVec2) -> (DVec2, bool) {
        let moved = times_power(point, self.exponent);
        let kept = flushed(moved);
        (kept, kept != moved || (moved == DVec2::ZERO && point != DVec2::ZERO))
    }

    /// A point of space on this scale; coordinates that vanish beside the largest become small or 0.
    pub(crate) fn apply_to_space(self, point: DVec3) -> DVec3 {
        times_power(point.truncate(), self.exponent).extend(times_power(DVec2::new(point.z, 0.0), self.exponent).x)
    }

    /// The way back, rounded only where a coordinate gets below 2^-1022.
    pub(crate) fn undo(self, point: DVec2) -> DVec2 {
        times_power(point, -self.exponent)
    }

    /// A length in the units of the source on this scale.
    pub(crate) fn length_there(self, length: f64) -> f64 {
        times_power(DVec2::new(length, 0.0), self.exponent).x
    }

    /// A length on this scale in the units of the source.
    pub(crate) fn length(self, length: f64) -> f64 {
        self.undo(DVec2::new(length, 0.0)).x
    }
}

/// A point on the scale of a triangulation with coordinates that are too small for it made 0.
pub(crate) fn flushed(point: DVec2) -> DVec2 {
    DVec2::select(point.abs().cmplt(DVec2::splat(SMALLEST)), DVec2::ZERO, point)
}

/// The exponent of the largest power of two that is no larger than a positive number.
pub(crate) fn exponent_of(value: f64) -> i32 {
    let biased = (value.to_bits() >> 52 & 0x7ff) as i32;
    if biased == 0 {
        // Below 2^-1022 the leading bit of the mantissa counts.
        return -1011 - value.to_bits().leading_zeros() as i32;
    }
    biased - 1023
}

/// A point times a power of two, in steps that are numbers themselves.
fn times_power(point: DVec2, mut exponent: i32) -> DVec2 {
    let mut point = point;
    while exponent != 0 {
        let step = exponent.clamp(-1000, 1000);
        point *= f64::from_bits(((1023 + step) as u64) << 52);
        exponent -= step;
    }
    point
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_change_nothing_but_the_exponent() {
        for size in [1e-300, 3e-17, 1.0, 5e6, 1e150, f64::MAX, f64::MIN_POSITIVE] {
            let points = [DVec2::new(size, -size / 3.0), DVec2::new(0.0, size / 7.0)];
            let scale = Scale::of_points(&points);
            for point in points {
                let (moved, lost) = scale.apply(point);
                assert!(!lost && moved.abs().max_element() < 2f64.powi(TOP + 1), "{size}");
                assert_eq!(scale.undo(moved), point, "{size}");
                assert_eq!(moved.x * point.y, moved.y * point.x, "{size}");
            }
        }
        let all = [-1074, -1023, -1022, -1, 0, 1, 1023];
        all.iter().for_each(|&exponent| assert_eq!(exponent_of(2f64.powi(exponent)), exponent));
        assert_eq!(exponent_of(3.9), 1);
    }

    #[test]
    fn coordinates_that_vanish_beside_others_are_told() {
        let scale = Scale::of(1.0);
        assert_eq!(scale.apply(DVec2::new(1e-120, 1.0)).0.x, 0.0);
        assert!(scale.apply(DVec2::new(1e-120, 1.0)).1);
        assert!(!scale.apply(DVec2::new(1e-90, 1.0)).1);
        assert!(!scale.apply(DVec2::new(-0.0, 1.0)).1);
        assert_eq!(Scale::of(0.0).apply(DVec2::ZERO), (DVec2::ZERO, false));
    }
}
