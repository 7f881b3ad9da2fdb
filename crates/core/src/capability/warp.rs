//! Maps of space to itself.

use glam::{DMat3, DVec3};

/// A map of space to itself, such as an affine map or a free-form deformation.
///
/// Laws, tested on every implementor: `jacobian` agrees with difference quotients of `position`, and `positions` with
/// `position` to the bit.
pub trait Warp: Send + Sync {
    /// The image of a point.
    fn position(&self, point: DVec3) -> DVec3;

    /// The derivative at a point; its columns are the images of the unit vectors.
    fn jacobian(&self, point: DVec3) -> DMat3;

    /// Moves many points in place.
    fn positions(&self, points: &mut [DVec3]) {
        for point in points {
            *point = self.position(*point);
        }
    }
}
