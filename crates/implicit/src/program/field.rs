//! A program as a field.

use std::cell::Cell;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Field, Interval, Restricted};

use super::{BatchEvaluator, IntervalEvaluator, PointEvaluator, Program};
use crate::operator::Enclosure;

/// What one thread's runs need. A program that calls another takes a second one.
#[derive(Default)]
struct Memory {
    point: PointEvaluator,
    batch: BatchEvaluator,
    interval: IntervalEvaluator,
}

thread_local! {
    static MEMORY: Cell<Option<Box<Memory>>> = const { Cell::new(None) };
}

fn with_memory<T>(run: impl FnOnce(&mut Memory) -> T) -> T {
    let mut memory = MEMORY.take().unwrap_or_default();
    let result = run(&mut memory);
    MEMORY.set(Some(memory));
    result
}

/// Below this share of its steps a simplified program pays for being made.
const WORTHWHILE: f64 = 0.75;

impl Field for Program {
    fn value(&self, point: DVec3) -> f64 {
        with_memory(|memory| memory.point.value(self, point))
    }

    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        with_memory(|memory| memory.batch.values(self, origin, x, y, z, out));
    }

    /// By forward automatic differentiation.
    fn gradient(&self, point: DVec3) -> DVec3 {
        let gradient = DVec3::from_array(with_memory(|memory| memory.point.dual(self, point)).gradient);
        if gradient.is_finite() { gradient } else { DVec3::ZERO }
    }

    /// By interval arithmetic with outward rounding. The box may be infinite; the points in it are finite.
    fn range(&self, region: &Aabb) -> Interval {
        if !is_sound(region) {
            return Interval::ALL;
        }
        with_memory(|memory| widened(memory.interval.bounds(self, region).0))
    }

    fn lipschitz(&self) -> Option<f64> {
        self.nature().lipschitz
    }

    fn restrict(&self, region: &Aabb) -> Restricted {
        if !is_sound(region) {
            return Restricted::Same;
        }
        with_memory(|memory| {
            let (bounds, trace) = memory.interval.bounds(self, region);
            if bounds.is_positive() {
                return Restricted::Positive;
            }
            if bounds.is_negative() {
                return Restricted::Negative;
            }
            let simpler = if trace.decides() { Some(self.simplified(trace)) } else { None };
            let restricted = simpler.as_ref().unwrap_or(self).with_restricted_calls(region);
            match restricted.or(simpler) {
                Some(program)
                    if program.len() as f64 <= WORTHWHILE * self.len() as f64 || program.has_other_calls(self) =>
                {
                    Restricted::Simpler(Arc::new(program))
                }
                _ => Restricted::Same,
            }
        })
    }
}

/// Ends may be infinite: all finite numbers up to there.
fn is_sound(region: &Aabb) -> bool {
    !region.is_empty() && !region.min.is_nan() && !region.max.is_nan()
}

/// What is not a number counts as outside, so bounds must not say that all is inside.
fn widened(bounds: Enclosure) -> Interval {
    let hi = if bounds.undefined && bounds.hi < 0.0 { f64::INFINITY } else { bounds.hi };
    Interval::new(bounds.lo, hi)
}

impl Program {
    /// The program with the fields that it calls restricted too; none when that changes nothing.
    fn with_restricted_calls(&self, region: &Aabb) -> Option<Self> {
        let mut calls = self.0.calls.clone();
        let mut changed = false;
        for call in &mut calls {
            let Some(map) = &call.map else { continue };
            if !region.min.is_finite() || !region.max.is_finite() {
                continue;
            }
            let corners = region.corners().map(|corner| DVec3::from_array(map.map(|linear| linear.at(corner))));
            let there = Aabb::from_points(corners);
            // Rounding may have moved a corner inward.
            let there = there.padded(there.min.abs().max(there.max.abs()).max_element() * 1e-12);
            if let Restricted::Simpler(field) = call.field.restrict(&there) {
                call.field = field;
                changed = true;
            }
        }
        changed.then(|| self.with_calls(calls))
    }

    fn has_other_calls(&self, whole: &Self) -> bool {
        let whole = &whole.0.calls;
        self.0.calls.iter().any(|call| whole.iter().all(|other| !Arc::ptr_eq(&call.field, &other.field)))
    }
}
