//! Parametric surfaces.

use glam::{DVec2, DVec3};

use crate::Interval;

/// A point of a surface with its first and second partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceJet {
    /// The point.
    pub point: DVec3,
    /// ∂/∂u.
    pub du: DVec3,
    /// ∂/∂v.
    pub dv: DVec3,
    /// ∂²/∂u².
    pub duu: DVec3,
    /// ∂²/∂u∂v.
    pub duv: DVec3,
    /// ∂²/∂v².
    pub dvv: DVec3,
}

/// A surface `(u, v) ↦ point(u, v)` over a rectangle.
///
/// Laws, tested on every implementor: `jet` agrees with `point` and with difference quotients, a normal is of unit
/// length and perpendicular to both tangents, `points` agrees with `point` to the bit.
pub trait Surface: Send + Sync {
    /// The parameters in u and v over which the surface runs.
    fn domain(&self) -> [Interval; 2];

    /// The point at `(u, v)`.
    fn point(&self, u: f64, v: f64) -> DVec3;

    /// The point with its first and second derivatives.
    fn jet(&self, u: f64, v: f64) -> SurfaceJet;

    /// The unit normal `du × dv / |du × dv|`; none where the surface has no tangent plane or only a limit of one that
    /// the implementor does not know.
    fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        let jet = self.jet(u, v);
        jet.du.cross(jet.dv).try_normalize()
    }

    /// Points at many parameters.
    ///
    /// # Panics
    /// When the slices differ in length.
    fn points(&self, parameters: &[DVec2], out: &mut [DVec3]) {
        assert_eq!(parameters.len(), out.len(), "slices of one length");
        for (uv, point) in parameters.iter().zip(out) {
            *point = self.point(uv.x, uv.y);
        }
    }
}
