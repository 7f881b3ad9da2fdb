//! A triangle as the tests of pairs need it.

use std::cmp::Ordering;

use shapeloom_core::Aabb;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};

/// A triangle by its corners. Corners have equal numbers where their positions are equal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub corners: [u32; 3],
    /// Along which axis the triangle keeps an area when seen; none if it has no area.
    pub seen_along: Option<Axis>,
    /// Whether it lies in a plane across that axis, as the flat parts of machines do: then coordinates tell sides. Such
    /// determinants are zero often, and zeros are what exact arithmetic takes longest for.
    pub level: Option<Ordering>,
}

/// An axis to look along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    fn along(self, point: DVec3) -> f64 {
        match self {
            Self::X => point.x,
            Self::Y => point.y,
            Self::Z => point.z,
        }
    }

    /// The point as it is seen along the axis, counter-clockwise from its positive side.
    pub fn flatten(self, point: DVec3) -> DVec2 {
        match self {
            Self::X => DVec2::new(point.y, point.z),
            Self::Y => DVec2::new(point.z, point.x),
            Self::Z => DVec2::new(point.x, point.y),
        }
    }
}

/// Positions on the scale of exact arithmetic, and the predicates on corners by number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Points<'a>(pub &'a [DVec3]);

impl Points<'_> {
    pub fn at(self, corner: u32) -> DVec3 {
        self.0[corner as usize]
    }

    pub fn triangle(self, corners: [u32; 3]) -> Triangle {
        let [a, b, c] = corners;
        let seen_along = Axis::ALL.into_iter().find(|&axis| self.turn(axis, a, b, c) != Ordering::Equal);
        let turn = seen_along.map(|axis| (axis, self.turn(axis, a, b, c)));
        let height = |axis: Axis, corner: u32| axis.along(self.at(corner));
        let level = turn.filter(|&(axis, _)| [b, c].iter().all(|&other| height(axis, other) == height(axis, a)));
        Triangle { corners, seen_along, level: level.map(|(_, turn)| turn) }
    }

    pub fn bounds(self, corners: [u32; 3]) -> Aabb {
        let [a, b, c] = corners.map(|corner| self.at(corner));
        Aabb { min: a.min(b).min(c), max: a.max(b).max(c) }
    }

    /// Which way three corners turn, seen along an axis.
    pub fn turn(self, axis: Axis, a: u32, b: u32, c: u32) -> Ordering {
        let [a, b, c] = [a, b, c].map(|corner| axis.flatten(self.at(corner)));
        orient2d(a, b, c)
    }

    /// On which side of a triangle's plane a corner lies.
    pub fn side_of(self, triangle: &Triangle, corner: u32) -> Ordering {
        let (Some(axis), Some(upward)) = (triangle.seen_along, triangle.level) else {
            return self.side(triangle.corners, corner);
        };
        match axis.along(self.at(corner)).partial_cmp(&axis.along(self.at(triangle.corners[0]))) {
            Some(Ordering::Greater) => upward,
            Some(Ordering::Less) => upward.reverse(),
            _ => Ordering::Equal,
        }
    }

    /// On which side of the plane through three corners a fourth lies.
    pub fn side(self, [a, b, c]: [u32; 3], d: u32) -> Ordering {
        orient3d(self.at(a), self.at(b), self.at(c), self.at(d))
    }

    /// An order in which the points of a line follow one another.
    pub fn along(self, a: u32, b: u32) -> Ordering {
        let (a, b) = (self.at(a), self.at(b));
        let by = |axis: usize| a[axis].partial_cmp(&b[axis]).unwrap_or(Ordering::Equal);
        by(0).then_with(|| by(1)).then_with(|| by(2))
    }
}
