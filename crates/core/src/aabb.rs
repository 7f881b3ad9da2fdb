//! Axis-aligned bounding boxes.

use glam::DVec3;

use crate::{Affine, Interval};

/// An axis-aligned box `[min, max]` in space; empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest corner.
    pub min: DVec3,
    /// The largest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The empty box, neutral under [`Aabb::union`].
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The box between two opposite corners, in any order.
    pub fn from_corners(a: DVec3, b: DVec3) -> Self {
        Self { min: a.min(b), max: a.max(b) }
    }

    /// The smallest box around `points`. NaN coordinates are passed over.
    pub fn from_points(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::including)
    }

    /// The smallest box that holds `self` and `point`. NaN coordinates are passed over.
    #[must_use]
    pub fn including(self, point: DVec3) -> Self {
        let mut grown = self;
        for axis in 0..3 {
            grown.min[axis] = grown.min[axis].min(point[axis]);
            grown.max[axis] = grown.max[axis].max(point[axis]);
        }
        grown
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The common part, empty when the boxes are apart.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// The box moved outward by `margin` on every side.
    #[must_use]
    pub fn padded(self, margin: f64) -> Self {
        Self { min: self.min - DVec3::splat(margin), max: self.max + DVec3::splat(margin) }
    }

    /// Whether the box holds no point.
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Whether `point` lies in the closed box.
    pub fn contains(&self, point: DVec3) -> bool {
        point.cmpge(self.min).all() && point.cmple(self.max).all()
    }

    /// The centre. Zero for an empty box.
    pub fn center(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.min * 0.5 + self.max * 0.5 }
    }

    /// The edge lengths. Zero for an empty box.
    pub fn size(&self) -> DVec3 {
        if self.is_empty() { DVec3::ZERO } else { self.max - self.min }
    }

    /// The length of the diagonal, safe against overflow and underflow of squares. Zero for an empty box.
    pub fn diagonal(&self) -> f64 {
        let size = self.size();
        let largest = size.max_element();
        if (1e-150..1e150).contains(&largest) {
            return size.length();
        }
        if largest > 0.0 && largest.is_finite() { (size / largest).length() * largest } else { largest }
    }

    /// The extent along one axis (0, 1 or 2).
    pub fn interval(&self, axis: usize) -> Interval {
        Interval::new(self.min[axis], self.max[axis])
    }

    /// The eight corners; bit 0, 1 and 2 of the index pick the larger x, y and z.
    pub fn corners(&self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 1 { self.max[axis] } else { self.min[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The box around the image of this box under `map`.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::from_points(self.corners().map(|corner| map.point(corner)))
    }

    /// The squared distance from `point` to the closed box, zero inside.
    pub fn distance_squared(&self, point: DVec3) -> f64 {
        (point - point.clamp(self.min, self.max)).length_squared()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_box_is_neutral() {
        let unit = Aabb::from_corners(DVec3::ONE, DVec3::ZERO);
        assert_eq!(Aabb::EMPTY.union(unit), unit);
        assert!(Aabb::EMPTY.is_empty());
        assert_eq!(Aabb::EMPTY.diagonal(), 0.0);
        assert!(Aabb::EMPTY.transformed(&Affine::IDENTITY).is_empty());
    }

    #[test]
    fn nan_coordinates_are_passed_over() {
        let found = Aabb::from_points([DVec3::new(f64::NAN, 1.0, 2.0), DVec3::new(3.0, 4.0, f64::NAN)]);
        assert_eq!(found.min, DVec3::new(3.0, 1.0, 2.0));
        assert_eq!(found.max, DVec3::new(3.0, 4.0, 2.0));
    }

    #[test]
    fn diagonal_survives_huge_and_tiny_boxes() {
        let huge = Aabb::from_corners(DVec3::ZERO, DVec3::new(3e200, 4e200, 0.0));
        assert!((huge.diagonal() / 5e200 - 1.0).abs() < 1e-15);
        let tiny = Aabb::from_corners(DVec3::ZERO, DVec3::new(3e-200, 4e-200, 0.0));
        assert!((tiny.diagonal() / 5e-200 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn corners_are_all_different_and_inside() {
        let boxed = Aabb::from_corners(DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0));
        let corners = boxed.corners();
        assert_eq!(corners[5], DVec3::new(1.0, 0.0, 3.0));
        assert!(corners.iter().all(|&corner| boxed.contains(corner)));
        assert_eq!(boxed.distance_squared(DVec3::new(-1.0, 1.0, 5.0)), 5.0);
    }
}
