//! A field in a box, as something that rays meet.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Aabb, Exec, Field, Hit, Interval, Options, Ray, Rays};

use super::{QueryError, RayCrossing, RayIntervals, Side};

/// A field within a box, as something that rays meet: hits are where the side changes, found by [`RayIntervals`].
///
/// Places where a ray only touches the surface are no hits, and neither is the border of the box. The element of a hit is 0 and its
/// parameters are 0. A ray that uses up its pieces ends there.
#[derive(Clone, Debug)]
pub struct FieldRays<F> {
    field: F,
    bounds: Aabb,
    intervals: RayIntervals,
}

impl<F: Field> FieldRays<F> {
    /// The field within the box; crossings closer together than the tolerance may be missed in pairs.
    ///
    /// # Errors
    /// A box that is empty or not finite, a tolerance that is not above 0.
    pub fn new(field: F, bounds: Aabb, tolerance: f64) -> Result<Self, QueryError> {
        let intervals = RayIntervals::new(tolerance);
        intervals.validate()?;
        for corner in [bounds.min, bounds.max] {
            if !corner.is_finite() || bounds.is_empty() {
                return Err(QueryError::Point { found: corner });
            }
        }
        Ok(Self { field, bounds, intervals })
    }

    /// The field.
    pub fn field(&self) -> &F {
        &self.field
    }

    /// The box.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The ray with its reach cut off at the box; none if it misses it.
    fn cut(&self, ray: &Ray) -> Option<Ray> {
        let Interval { lo: mut near, hi: mut far } = ray.reach;
        for axis in 0..3 {
            let (origin, direction) = (ray.origin()[axis], ray.direction()[axis]);
            let (lo, hi) = (self.bounds.min[axis], self.bounds.max[axis]);
            if direction == 0.0 {
                if origin < lo || origin > hi {
                    return None;
                }
                continue;
            }
            let (a, b) = ((lo - origin) / direction, (hi - origin) / direction);
            near = near.max(a.min(b));
            far = far.min(a.max(b));
        }
        (near <= far && near.is_finite() && far.is_finite()).then(|| ray.within(Interval::new(near, far)))
    }
}

fn hit(crossing: &RayCrossing) -> Hit {
    let back = crossing.before == Some(Side::Inside);
    Hit { distance: crossing.distance, element: 0, parameters: DVec2::ZERO, back }
}

impl<F: Field> Rays for FieldRays<F> {
    fn first_hit(&self, ray: &Ray) -> Option<Hit> {
        let found = self.intervals.first_change(&self.field, &self.cut(ray)?, &Exec::default());
        found.ok().flatten().as_ref().map(hit)
    }

    fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>) {
        hits.clear();
        let Some(ray) = self.cut(ray) else { return };
        if let Ok(found) = self.intervals.intersect(&self.field, &ray, &Exec::default()) {
            hits.extend(found.changes().map(hit));
        }
    }
}

impl<F: Field> FieldRays<F> {
    /// The unit normal at a hit, outward; zero where the field has no gradient.
    pub fn normal(&self, ray: &Ray, hit: &Hit) -> DVec3 {
        self.field.gradient(ray.at(hit.distance)).normalize_or_zero()
    }
}
