//! Rays.

use std::fmt;

use glam::DVec3;

use crate::{Category, Diagnostic, Interval, VectorWords};

/// A half-line with a direction of unit length, and the stretch of it that counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    /// Distances along the ray at which hits count.
    pub reach: Interval,
}

impl Ray {
    /// The ray from `origin` along `direction`, which is scaled to unit length; hits count from distance 0 on.
    ///
    /// # Errors
    /// A direction of no length, or anything that is not finite.
    pub fn new(origin: DVec3, direction: DVec3) -> Result<Self, RayError> {
        match direction.try_normalize() {
            Some(direction) if origin.is_finite() => {
                Ok(Self { origin, direction, reach: Interval::new(0.0, f64::INFINITY) })
            }
            _ => Err(RayError { origin, direction }),
        }
    }

    /// The same ray with hits counted only at distances in `reach`.
    #[must_use]
    pub fn within(self, reach: Interval) -> Self {
        Self { reach, ..self }
    }

    /// Where the ray starts.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Its direction, of unit length.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The point at `distance`.
    pub fn at(&self, distance: f64) -> DVec3 {
        self.origin + self.direction * distance
    }
}

/// Numbers that make no ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayError {
    /// The origin as given.
    pub origin: DVec3,
    /// The direction as given.
    pub direction: DVec3,
}

impl fmt::Display for RayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "ray: found origin {} and direction {}, expected finite numbers and a direction with a length",
            VectorWords(self.origin),
            VectorWords(self.direction)
        )
    }
}

impl std::error::Error for RayError {}

impl Diagnostic for RayError {
    fn code(&self) -> &'static str {
        "E-ray-direction"
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}
