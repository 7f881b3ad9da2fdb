//! Bounds of a field over small sets, from its range and its Lipschitz constant together.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Field, Interval};

/// Room for the rounding of a few multiplications and additions.
const SLACK: f64 = 1.0 + 8.0 * f64::EPSILON;

/// A field with its Lipschitz constant, where that is a usable number.
pub(super) struct Bounds<'a, F: ?Sized> {
    pub(super) field: &'a F,
    pub(super) lipschitz: Option<f64>,
}

impl<'a, F: Field + ?Sized> Bounds<'a, F> {
    pub(super) fn new(field: &'a F) -> Self {
        Self { field, lipschitz: field.lipschitz().filter(|bound| bound.is_finite() && *bound >= 0.0) }
    }

    /// Bounds of the value at one point, rounding included where the field's range has it; `None` where the field knows none.
    pub(super) fn proven_at(&self, point: DVec3) -> Option<Interval> {
        let bounds = self.field.range(&Aabb { min: point, max: point });
        (!bounds.is_empty() && (bounds.lo > f64::NEG_INFINITY || bounds.hi < f64::INFINITY)).then_some(bounds)
    }

    /// The side of a point, and whether that is proven. None for the value 0 and what is not a number.
    pub(super) fn side_at(&self, point: DVec3) -> Option<(Side, bool)> {
        let value = self.field.value(point);
        if value == 0.0 || value.is_nan() {
            return None;
        }
        let side = Side::of(value);
        Some((side, self.proven_at(point).and_then(Side::of_bounds) == Some(side)))
    }

    /// Bounds over a box that lies within `radius` of `center`, by the range of `part` (the field or a restriction of it).
    pub(super) fn over(&self, part: &dyn Field, region: &Aabb, center: DVec3, radius: f64) -> Interval {
        let range = part.range(region);
        let range = if range.is_empty() { Interval::ALL } else { range };
        if Side::of_bounds(range).is_some() {
            return range;
        }
        range.meet(self.by_slope(center, radius))
    }

    /// Bounds over a ball by the Lipschitz constant.
    pub(super) fn by_slope(&self, center: DVec3, radius: f64) -> Interval {
        let Some(lipschitz) = self.lipschitz else { return Interval::ALL };
        let value = self.field.value(center);
        if value.is_nan() {
            return Interval::ALL;
        }
        let middle = self.proven_at(center).unwrap_or(Interval::new(value, value));
        let change = lipschitz * radius * SLACK;
        let bounds = Interval::new((middle.lo - change).next_down(), (middle.hi + change).next_up());
        if bounds.is_empty() { Interval::ALL } else { bounds }
    }
}

/// The distance from a point of a box to its farthest corner, rounded up.
pub(super) fn reach(region: &Aabb, center: DVec3) -> f64 {
    let farthest = (region.max - center).abs().max((center - region.min).abs());
    let largest = farthest.max_element();
    if largest > 0.0 && largest.is_finite() { (farthest / largest).length() * largest * SLACK } else { largest }
}

use super::Side;

trait Meet {
    fn meet(self, other: Self) -> Self;
}

impl Meet for Interval {
    /// What lies in both; the first where rounding leaves nothing.
    fn meet(self, other: Self) -> Self {
        let both = Self::new(self.lo.max(other.lo), self.hi.min(other.hi));
        if both.is_empty() { self } else { both }
    }
}
