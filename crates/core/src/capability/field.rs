//! Scalar fields.

use std::fmt;
use std::sync::Arc;

use glam::DVec3;

use crate::{Aabb, Interval};

/// A scalar field over space whose zero set is a surface: negative inside, positive outside.
///
/// The value is a distance only where an implementor says so. Laws, tested on every implementor: `values` agrees with
/// `value` within single precision, `gradient` with difference quotients, `range(b)` holds every value over `b`, and a
/// restriction has the same sign as the field, and where it is a field the same value, everywhere in its box.
pub trait Field: Send + Sync {
    /// The value at a point.
    fn value(&self, point: DVec3) -> f64;

    /// Values at many points, given in single precision relative to `origin` as three slices of the length of `out`.
    ///
    /// This is the hot path: implementors compute in `f32` around `origin`, so that far from the world's origin
    /// nothing is lost. The default goes through [`Field::value`].
    ///
    /// # Panics
    /// When the slices differ in length.
    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        for (i, value) in out.iter_mut().enumerate() {
            let offset = DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            *value = self.value(origin + offset) as f32;
        }
    }

    /// The gradient at a point; zero where it does not exist.
    fn gradient(&self, point: DVec3) -> DVec3;

    /// Bounds of the value over a box. The default knows nothing.
    fn range(&self, region: &Aabb) -> Interval {
        let _ = region;
        Interval::ALL
    }

    /// A Lipschitz constant of the whole field, if one is known: `|value(p) - value(q)| <= L · |p - q|`.
    fn lipschitz(&self) -> Option<f64> {
        None
    }

    /// The box in which the shape is to be looked at, where one was given. Nothing is known by default.
    fn extent(&self) -> Option<Aabb> {
        None
    }

    /// The field inside a box, perhaps simpler there. The default asks [`Field::range`].
    fn restrict(&self, region: &Aabb) -> Restricted {
        let range = self.range(region);
        if range.lo > 0.0 {
            Restricted::Positive
        } else if range.hi < 0.0 {
            Restricted::Negative
        } else {
            Restricted::Same
        }
    }
}

/// What is left of a field inside a box.
#[derive(Clone)]
pub enum Restricted {
    /// Positive everywhere in the box: outside.
    Positive,
    /// Negative everywhere in the box: inside.
    Negative,
    /// Nothing simpler is known.
    Same,
    /// A simpler field that agrees with the whole one in the box.
    Simpler(Arc<dyn Field>),
}

impl fmt::Debug for Restricted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Positive => "Positive",
            Self::Negative => "Negative",
            Self::Same => "Same",
            Self::Simpler(_) => "Simpler(..)",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Ball {
        center: DVec3,
        radius: f64,
    }

    impl Field for Ball {
        fn value(&self, point: DVec3) -> f64 {
            point.distance(self.center) - self.radius
        }

        fn gradient(&self, point: DVec3) -> DVec3 {
            (point - self.center).normalize_or_zero()
        }

        fn range(&self, region: &Aabb) -> Interval {
            let nearest = region.distance_squared(self.center).sqrt();
            let farthest = region.corners().map(|corner| corner.distance(self.center)).into_iter().fold(0.0, f64::max);
            Interval::new(nearest - self.radius, farthest - self.radius)
        }

        fn lipschitz(&self) -> Option<f64> {
            Some(1.0)
        }
    }

    #[test]
    fn batches_keep_precision_far_from_the_origin() {
        let center = DVec3::new(5e6, -3e6, 1e6);
        let ball = Ball { center, radius: 1.0 };
        let (x, y, z) = ([0.5f32, 2.0], [0.25f32, 0.0], [0.0f32, -1.0]);
        let mut out = [0.0f32; 2];
        ball.values(center, &x, &y, &z, &mut out);
        for i in 0..2 {
            let offset = DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            assert!((f64::from(out[i]) - ball.value(center + offset)).abs() < 1e-7);
        }
    }

    #[test]
    fn restriction_follows_the_range() {
        let field: Arc<dyn Field> = Arc::new(Ball { center: DVec3::ZERO, radius: 1.0 });
        let at = |lo: f64, hi: f64| Aabb::from_corners(DVec3::splat(lo), DVec3::splat(hi));
        assert!(matches!(field.restrict(&at(2.0, 3.0)), Restricted::Positive));
        assert!(matches!(field.restrict(&at(-0.1, 0.1)), Restricted::Negative));
        assert!(matches!(field.restrict(&at(0.0, 2.0)), Restricted::Same));
        assert_eq!(field.lipschitz(), Some(1.0));
        let step = 1e-6;
        let p = DVec3::new(0.3, 0.8, -0.2);
        let slope = (field.value(p + DVec3::X * step) - field.value(p - DVec3::X * step)) / (2.0 * step);
        assert!((slope - field.gradient(p).x).abs() < 1e-9);
    }
}
