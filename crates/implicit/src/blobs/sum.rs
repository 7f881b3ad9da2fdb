//! A threshold less the sum of terms, as a field.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Field, Interval, Restricted};

use super::batch;
use super::hierarchy::Hierarchy;
use super::slopes::largest_slope;
use super::term::{Fall, ROOM, Term};

/// Above this share of its terms a restriction costs more than it saves.
const WORTHWHILE: f64 = 0.75;

/// `threshold - sum of terms`. Terms are always added up in the order in which they lie, so that a part of them gives the same bits
/// wherever the rest is nothing.
#[derive(Clone, Debug)]
pub(super) struct Sum {
    threshold: f64,
    fall: Fall,
    terms: Vec<Term>,
    hierarchy: Hierarchy,
    lipschitz: f64,
    /// Whether single precision holds all numbers of the terms.
    single: bool,
}

impl Sum {
    /// The sum of terms in the order of [`sort_by_place`](super::hierarchy::sort_by_place).
    pub(super) fn new(threshold: f64, fall: Fall, terms: Vec<Term>) -> Self {
        let mut sum = Self::part(threshold, fall, terms, 0.0);
        sum.lipschitz = largest_slope(&sum);
        sum
    }

    fn part(threshold: f64, fall: Fall, terms: Vec<Term>, lipschitz: f64) -> Self {
        let hierarchy = Hierarchy::new(&terms);
        let single = (1e-30..1e37).contains(&threshold) && terms.iter().all(batch::holds);
        Self { threshold, fall, terms, hierarchy, lipschitz, single }
    }

    pub(super) fn terms(&self) -> &[Term] {
        &self.terms
    }

    pub(super) fn fall(&self) -> Fall {
        self.fall
    }

    /// A box around all that terms reach.
    pub(super) fn bounds(&self) -> Aabb {
        self.hierarchy.bounds()
    }

    pub(super) fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The terms that may reach into a box, in order.
    fn meeting(&self, region: &Aabb) -> Vec<Term> {
        let mut found = Vec::new();
        self.hierarchy.meeting(region, |leaf| {
            found.extend(self.terms[leaf].iter().filter(|term| term.q_over(region).0 < 1.0 + ROOM));
            true
        });
        found
    }
}

impl Field for Sum {
    fn value(&self, point: DVec3) -> f64 {
        if point.is_nan() {
            return f64::NAN;
        }
        let mut sum = 0.0;
        self.hierarchy.around(point, |leaf| {
            for term in &self.terms[leaf] {
                let q = term.q(point);
                if q < 1.0 {
                    sum += term.value(self.fall, q);
                }
            }
        });
        self.threshold - sum
    }

    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        if self.single && origin.is_finite() {
            batch::values(self, self.threshold as f32, origin, [x, y, z], out);
            return;
        }
        for (i, value) in out.iter_mut().enumerate() {
            let offset = DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            *value = self.value(origin + offset) as f32;
        }
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        self.hierarchy.around(point, |leaf| {
            for term in &self.terms[leaf] {
                let q = term.q(point);
                if q < 1.0 {
                    sum -= term.gradient(self.fall, point, q);
                }
            }
        });
        sum
    }

    fn range(&self, region: &Aabb) -> Interval {
        if region.is_empty() || !region.min.is_finite() || !region.max.is_finite() {
            return Interval::ALL;
        }
        let (mut least, mut most) = (0.0, 0.0);
        self.hierarchy.meeting(region, |leaf| {
            for term in &self.terms[leaf] {
                let q = term.q_over(region);
                if q.0 < 1.0 {
                    // Added in the order of `value`, rounding keeps bounds bounds.
                    let part = term.over(self.fall, q);
                    least += part.lo;
                    most += part.hi;
                }
            }
            true
        });
        Interval::new(self.threshold - most, self.threshold - least)
    }

    fn lipschitz(&self) -> Option<f64> {
        Some(self.lipschitz)
    }

    fn restrict(&self, region: &Aabb) -> Restricted {
        let range = self.range(region);
        if range.lo > 0.0 {
            return Restricted::Positive;
        }
        if range.hi < 0.0 {
            return Restricted::Negative;
        }
        if range == Interval::ALL {
            return Restricted::Same;
        }
        let terms = self.meeting(region);
        if terms.len() as f64 > WORTHWHILE * self.terms.len() as f64 {
            return Restricted::Same;
        }
        Restricted::Simpler(Arc::new(Self::part(self.threshold, self.fall, terms, self.lipschitz)))
    }
}
