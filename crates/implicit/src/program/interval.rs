//! Bounds of values over boxes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Interval};

use super::Program;
use super::step::{Linear, Step};
use crate::operator::{Binary, Choice, Enclosure};

/// Evaluates programs over boxes. One for each thread; it keeps its memory from call to call and serves any program.
#[derive(Clone, Debug, Default)]
pub struct IntervalEvaluator {
    bounds: Vec<Enclosure>,
    choices: Vec<Choice>,
}

/// Which operands the choosing steps of a program took all over a box, in the order of the steps.
#[derive(Clone, Copy, Debug)]
pub struct Trace<'a>(pub(crate) &'a [Choice]);

impl Trace<'_> {
    /// Whether any step took one operand everywhere, so that the program may be simplified.
    pub fn decides(&self) -> bool {
        self.0.iter().any(|choice| *choice != Choice::Both)
    }
}

/// Whether a step takes one of its operands.
pub(crate) fn chooses(step: &Step) -> bool {
    matches!(step, Step::Binary(Binary::Minimum | Binary::Maximum | Binary::And | Binary::Or, ..))
}

impl IntervalEvaluator {
    /// An evaluator without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// Bounds of the values over a box, rounded outward: no value that [`PointEvaluator`](super::PointEvaluator) computes there lies
    /// outside. Also which operands were taken.
    pub fn bounds(&mut self, program: &Program, region: &Aabb) -> (Enclosure, Trace<'_>) {
        let parts = &*program.0;
        self.bounds.clear();
        self.bounds.reserve(parts.steps.len());
        self.choices.clear();
        for step in &parts.steps {
            let at = |value: super::Value| self.bounds[value.index()];
            let bounds = match *step {
                Step::Constant(value) => Enclosure::exactly(value),
                Step::Linear(linear) => linear.over(region),
                Step::Unary(operator, a) => operator.of_enclosure(at(a)),
                Step::Binary(operator, a, b) => {
                    let (bounds, choice) = operator.of_enclosures(at(a), at(b));
                    if chooses(step) {
                        self.choices.push(choice);
                    }
                    bounds
                }
                Step::Power(a, exponent) => at(a).power(exponent),
                Step::Call(call, place) => {
                    let place = place.map(at);
                    let region = Aabb {
                        min: DVec3::from_array(place.map(|side| side.lo)),
                        max: DVec3::from_array(place.map(|side| side.hi)),
                    };
                    if place.iter().any(|side| side.undefined) || !region.min.is_finite() || !region.max.is_finite() {
                        Enclosure::UNKNOWN
                    } else {
                        let Interval { lo, hi } = parts.calls[call as usize].field.range(&region);
                        Enclosure::new(lo, hi)
                    }
                }
            };
            self.bounds.push(bounds);
        }
        (self.bounds[parts.result.index()], Trace(&self.choices))
    }
}

impl Linear {
    fn over(&self, region: &Aabb) -> Enclosure {
        let ends = region.min.to_array().into_iter().zip(region.max.to_array());
        let mut sum = Enclosure::exactly(self.offset);
        let mut empty = self.offset == 0.0;
        for (slope, (lo, hi)) in self.slope.to_array().into_iter().zip(ends) {
            if slope == 0.0 {
                continue;
            }
            let side = Enclosure::new(lo, hi);
            // Nothing is rounded where a coordinate is taken as it is.
            let part =
                if slope == 1.0 { side } else { Binary::Multiply.of_enclosures(Enclosure::exactly(slope), side).0 };
            sum = if empty { part } else { Binary::Add.of_enclosures(sum, part).0 };
            empty = false;
        }
        sum
    }
}
