//! Parametric curves.

use std::fmt::Debug;
use std::ops::{Add, Mul, Sub};

use glam::{DVec2, DVec3};

use crate::Interval;

/// Points and vectors that curves are made of: the plane ([`DVec2`]) and space ([`DVec3`]).
pub trait VectorSpace:
    Copy + Debug + PartialEq + Send + Sync + 'static + Add<Output = Self> + Sub<Output = Self> + Mul<f64, Output = Self>
{
    /// The origin, and the zero vector.
    const ZERO: Self;

    /// The inner product.
    fn dot(self, other: Self) -> f64;

    /// Whether every coordinate is finite.
    fn is_finite(self) -> bool;

    /// The coordinates, padded with zeros to three.
    fn to_space(self) -> DVec3;

    /// The length, safe against overflow and underflow of squares.
    fn length(self) -> f64 {
        let vector = self.to_space();
        let largest = vector.abs().max_element();
        if largest == 0.0 || !largest.is_finite() || (1e-140..1e140).contains(&largest) {
            return vector.length();
        }
        (vector / largest).length() * largest
    }
}

impl VectorSpace for DVec2 {
    const ZERO: Self = DVec2::ZERO;

    fn dot(self, other: Self) -> f64 {
        DVec2::dot(self, other)
    }

    fn is_finite(self) -> bool {
        DVec2::is_finite(self)
    }

    fn to_space(self) -> DVec3 {
        self.extend(0.0)
    }
}

impl VectorSpace for DVec3 {
    const ZERO: Self = DVec3::ZERO;

    fn dot(self, other: Self) -> f64 {
        DVec3::dot(self, other)
    }

    fn is_finite(self) -> bool {
        DVec3::is_finite(self)
    }

    fn to_space(self) -> DVec3 {
        self
    }
}

/// A curve `t ↦ point(t)` over a closed interval, in the plane or in space.
///
/// Parameters outside the domain give the curve's continuation where it has one. Laws, tested on every implementor:
/// `derivatives` agrees with `point` and with difference quotients, `points` with `point` to the bit.
pub trait Curve<P: VectorSpace>: Send + Sync {
    /// The parameters over which the curve runs.
    fn domain(&self) -> Interval;

    /// The point at `t`.
    fn point(&self, t: f64) -> P;

    /// The point and derivatives at `t`: `out[0]` is the point, `out[k]` the `k`-th derivative by `t`. As many as `out`
    /// has room for.
    fn derivatives(&self, t: f64, out: &mut [P]);

    /// Points at many parameters.
    ///
    /// # Panics
    /// When the slices differ in length.
    fn points(&self, parameters: &[f64], out: &mut [P]) {
        assert_eq!(parameters.len(), out.len(), "slices of one length");
        for (&t, point) in parameters.iter().zip(out) {
            *point = self.point(t);
        }
    }
}
