//! The first crossing of a ray, by steps that the Lipschitz constant allows.

use shapeloom_core::{Bounds as OptionBounds, Exec, Field, Interval, Options, Ray, options};

use super::bounds::Bounds;
use super::root::side_change;
use super::{Certainty, QueryError, RayCrossing, Side};

options! {
    /// The first place where a ray crosses the surface of a field whose Lipschitz constant L is known (Hart, 1996).
    ///
    /// No surface is nearer than the value over L, so the ray goes on by that much. With over-relaxation steps are longer by a
    /// factor and taken back where the balls of two steps do not meet (Keinert et al., 2014). Where the surface may be nearer than the
    /// tolerance, the ray goes on by the tolerance and looks whether the side has changed.
    pub struct SphereTracing("sphere-tracing") {
        required {
            /// The distance from the surface below which steps have this length.
            tolerance: f64 [OptionBounds::POSITIVE],
        }
        optional {
            /// The factor of steps; 1 is Hart's method.
            over_relaxation: f64 [OptionBounds::closed(1.0, 1.9)] = 1.0,
            /// How many steps are taken.
            max_steps: u32 [OptionBounds::closed(1.0, 1e9)] = 100_000,
        }
    }
}

/// How a ray that was traced ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TraceEnd {
    /// It crosses the surface; before that it does not, except perhaps twice within a step where it grazes.
    Hit(RayCrossing),
    /// It does not cross the surface within its reach, except perhaps twice within a step where it grazes.
    Miss,
    /// The steps were used up.
    OutOfSteps,
    /// The field is not a number there.
    Undefined,
}

/// What became of a ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// The end.
    pub end: TraceEnd,
    /// Up to this distance the ray crosses no surface, except perhaps where it grazes.
    pub free: f64,
    /// Where the ray may be within the tolerance of the surface without crossing it, in order.
    pub grazes: Vec<Interval>,
    /// How many values were asked for.
    pub steps: u32,
}

impl SphereTracing {
    /// Follows a ray to the first place where the side changes.
    ///
    /// # Errors
    /// Options out of range, a reach that is not finite, a field without a Lipschitz constant, or stopped.
    pub fn trace<F: Field + ?Sized>(&self, field: &F, ray: &Ray, exec: &Exec) -> Result<Traced, QueryError> {
        self.validate()?;
        let Interval { lo, hi } = ray.reach;
        if !(lo.is_finite() && hi.is_finite() && lo <= hi) {
            return Err(QueryError::Reach { found: ray.reach });
        }
        let bounds = Bounds::new(field);
        let lipschitz = bounds.lipschitz.ok_or(QueryError::Lipschitz)?;
        let mut grazes: Vec<Interval> = Vec::new();
        let (mut at, mut value, mut steps) = (lo, field.value(ray.at(lo)), 1_u32);
        let mut factor = self.over_relaxation;
        let end = loop {
            if steps.is_multiple_of(256) {
                exec.check()?;
            }
            if value.is_nan() {
                break TraceEnd::Undefined;
            }
            if at >= hi {
                break TraceEnd::Miss;
            }
            if steps >= self.max_steps {
                break TraceEnd::OutOfSteps;
            }
            // A field that does not change is either side for ever.
            let radius = if lipschitz > 0.0 { value.abs() / lipschitz } else { f64::INFINITY };
            let near = radius <= self.tolerance;
            let step = if near { self.tolerance } else { radius * factor };
            // Far out the step may be lost in rounding.
            let next = (at + step).max(at.next_up()).min(hi);
            let there = field.value(ray.at(next));
            steps += 1;
            let overshot = !near && factor > 1.0 && radius + there.abs() / lipschitz < (next - at) * (1.0 - 1e-12);
            if overshot || (there.is_nan() && factor > 1.0) {
                factor = 1.0;
                continue;
            }
            factor = self.over_relaxation;
            if near {
                match grazes.last_mut() {
                    Some(last) if last.hi >= at => last.hi = next,
                    _ => grazes.push(Interval::new(at, next)),
                }
            }
            if Side::of(there) != Side::of(value) && !there.is_nan() {
                if let Some(last) = grazes.pop_if(|last| last.hi >= next)
                    && last.lo < at
                {
                    grazes.push(Interval::new(last.lo, at));
                }
                break TraceEnd::Hit(crossing(&bounds, ray, (at, value), (next, there)));
            }
            (at, value) = (next, there);
        };
        Ok(Traced { end, free: at, grazes, steps })
    }
}

fn crossing<F: Field + ?Sized>(bounds: &Bounds<'_, F>, ray: &Ray, from: (f64, f64), to: (f64, f64)) -> RayCrossing {
    let distance = side_change(|place| bounds.field.value(ray.at(place)), from, to);
    let point = ray.at(distance);
    let proven = [from.0, to.0].into_iter().all(|end| bounds.side_at(ray.at(end)).is_some_and(|side| side.1));
    RayCrossing {
        distance,
        interval: Interval::new(from.0, to.0),
        point,
        normal: bounds.field.gradient(point).normalize_or_zero(),
        before: Some(Side::of(from.1)),
        after: Some(Side::of(to.1)),
        certainty: Certainty::proven_if(proven),
    }
}
