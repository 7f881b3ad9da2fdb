//! Orthonormal frames.

use std::fmt;

use glam::{DMat3, DVec3};

use crate::{Affine, Category, Diagnostic};

/// A right-handed orthonormal frame: an origin and three perpendicular unit axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    origin: DVec3,
    axes: DMat3,
}

impl Frame {
    /// The origin with the axes x, y, z.
    pub const WORLD: Self = Self { origin: DVec3::ZERO, axes: DMat3::IDENTITY };

    /// The frame whose first axis points along `first`, and whose second lies in the half-plane of `toward`.
    ///
    /// # Errors
    /// The two are parallel, zero or not finite.
    pub fn new(origin: DVec3, first: DVec3, toward: DVec3) -> Result<Self, FrameError> {
        let error = FrameError { first, toward };
        let x = first.try_normalize().ok_or(error)?;
        let z = x.cross(toward.try_normalize().ok_or(error)?);
        // Below this sine the cross product is rounding noise.
        if z.length() < 1e-12 || !origin.is_finite() {
            return Err(error);
        }
        let z = z.normalize();
        Ok(Self { origin, axes: DMat3::from_cols(x, z.cross(x), z) })
    }

    /// A frame whose third axis is the unit vector `normal` (Duff et al. 2017); the other two are any that fit.
    pub fn with_normal(origin: DVec3, normal: DVec3) -> Self {
        let sign = 1f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        let x = DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
        let y = DVec3::new(b, sign + normal.y * normal.y * a, -normal.y);
        Self { origin, axes: DMat3::from_cols(x, y, normal) }
    }

    /// The origin.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The three axes.
    pub fn axes(&self) -> [DVec3; 3] {
        [self.axes.x_axis, self.axes.y_axis, self.axes.z_axis]
    }

    /// The coordinates of a world point in this frame.
    pub fn coordinates(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.origin)
    }

    /// The world point with these coordinates in the frame.
    pub fn position(&self, coordinates: DVec3) -> DVec3 {
        self.axes * coordinates + self.origin
    }

    /// The map from frame coordinates to the world.
    pub fn to_world(&self) -> Affine {
        Affine { linear: self.axes, translation: self.origin }
    }

    /// The map from the world to frame coordinates.
    pub fn to_local(&self) -> Affine {
        let linear = self.axes.transpose();
        Affine { linear, translation: -(linear * self.origin) }
    }
}

/// Directions that span no frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameError {
    /// The wanted first axis.
    pub first: DVec3,
    /// The wanted side of the second axis.
    pub toward: DVec3,
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "frame: found the directions {} and {}, expected two that are not parallel", self.first, self.toward)
    }
}

impl std::error::Error for FrameError {}

impl Diagnostic for FrameError {
    fn code(&self) -> &'static str {
        "E-frame-parallel"
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_orthonormal_and_right_handed() {
        let made = Frame::new(DVec3::ONE, DVec3::new(3.0, 1.0, 0.0), DVec3::new(0.0, 0.2, 5.0)).unwrap();
        let around = [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, 0.0, -0.8)];
        for frame in around.map(|normal| Frame::with_normal(DVec3::ZERO, normal)).into_iter().chain([made]) {
            let [x, y, z] = frame.axes();
            assert!((x.cross(y) - z).length() < 1e-14 && (x.length() - 1.0).abs() < 1e-14);
            let p = DVec3::new(0.3, -4.0, 7.0);
            assert!((frame.position(frame.coordinates(p)) - p).length() < 1e-14);
            assert!((frame.to_world().point(frame.to_local().point(p)) - p).length() < 1e-14);
        }
    }

    #[test]
    fn parallel_directions_span_nothing() {
        assert!(Frame::new(DVec3::ZERO, DVec3::X, DVec3::X * -2.0).is_err());
        assert!(Frame::new(DVec3::ZERO, DVec3::ZERO, DVec3::X).is_err());
        assert!(Frame::new(DVec3::NAN, DVec3::X, DVec3::Y).is_err());
    }
}
