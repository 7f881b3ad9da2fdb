//! The signed distance as a field.

use glam::DVec3;
use shapeloom_core::{Aabb, Closest, Field, Interval};

use super::{RECENT, SignedDistance, length};

/// The value is the signed distance in model units, exact up to rounding.
impl Field for SignedDistance {
    fn value(&self, point: DVec3) -> f64 {
        self.distance(point)
    }

    /// As [`Field::values`] of any field, with each answer helping the next: neighbours in the slices should be
    /// neighbours in space.
    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let mut before = Vec::with_capacity(2 * RECENT);
        for (i, value) in out.iter_mut().enumerate() {
            let point = origin + DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            let found = self.beside(point, &before).map(|found| found.distance);
            if before.len() == 2 * RECENT {
                before.drain(..RECENT);
            }
            before.push((point, found.unwrap_or(f64::NAN)));
            *value = found.unwrap_or_else(|| self.nowhere(point)) as f32;
        }
    }

    /// The unit vector from the closest point, turned around inside; on a face the normal that looks outside. Zero
    /// where there is none: on edges and corners, on sheets that have the same on both sides, without triangles.
    fn gradient(&self, point: DVec3) -> DVec3 {
        let Some(found) = self.signed_closest(point) else {
            return DVec3::ZERO;
        };
        let way = point - found.closest.point;
        let distance = length(way);
        // So near the surface rounding has taken the direction.
        if distance <= self.slack(point) {
            return self.gradient_on_face(&found.closest);
        }
        way / if found.distance < 0.0 { -distance } else { distance }
    }

    /// From the distance at the centre, which changes at most by the way to a corner. Where the mesh is not closed, the
    /// sign may change away from the surface, so both signs count.
    fn range(&self, region: &Aabb) -> Interval {
        let center = region.center();
        let reach = length((region.max - center).max(center - region.min));
        if region.is_empty() || !center.is_finite() || !reach.is_finite() {
            return Interval::ALL;
        }
        let value = self.distance(center);
        if value == f64::INFINITY {
            return Interval::new(value, value);
        }
        let slack = self.slack(region.min.abs().max(region.max.abs()));
        let reach = reach * (1.0 + 1e-12) + slack;
        if self.closed {
            return Interval::new(value - reach, value + reach);
        }
        let most = value.abs() + reach;
        Interval::new(-most, most)
    }

    /// 1 where the mesh is closed; else the sign may jump, and there is none.
    fn lipschitz(&self) -> Option<f64> {
        self.closed.then_some(1.0)
    }
}

impl SignedDistance {
    fn gradient_on_face(&self, closest: &Closest) -> DVec3 {
        let weights = [closest.parameters.x, closest.parameters.y, 1.0 - closest.parameters.x - closest.parameters.y];
        let normal = self.normals.get(closest.element as usize).copied().unwrap_or_default();
        if weights.into_iter().any(|weight| weight <= 1e-9) || normal == DVec3::ZERO {
            return DVec3::ZERO;
        }
        let step = normal * (self.slack(closest.point) * 16.0);
        match [closest.point - step, closest.point + step].map(|place| self.is_inside(place)) {
            [true, false] => normal,
            [false, true] => -normal,
            _ => DVec3::ZERO,
        }
    }
}
