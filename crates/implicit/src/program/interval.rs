//! Bounds of values over boxes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Interval};

use super::Program;
use super::step::{Call, Linear, Step};
use crate::operator::{Binary, Choice, Enclosure, Unary};

/// Evaluates programs over boxes. One for each thread; it keeps its memory from call to call and serves any program.
#[derive(Clone, Debug, Default)]
pub struct IntervalEvaluator {
    /// Ends and whether undefined, apart: a struct of both is copied by words, which waits for the byte just written.
    ends: Vec<[f64; 2]>,
    undefined: Vec<bool>,
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
        self.ends.clear();
        self.ends.reserve(parts.steps.len());
        self.undefined.clear();
        self.undefined.reserve(parts.steps.len());
        self.choices.clear();
        for (code, step) in parts.codes.iter().zip(&parts.steps) {
            let (a, b) = (self.at(code.a as usize), self.at(code.b as usize));
            let bounds = match (code.kind, a, b) {
                (Kind::Constant, ..) => match *step {
                    Step::Constant(value) => Enclosure::exactly(value),
                    _ => Enclosure::UNKNOWN,
                },
                (Kind::Square, Some(a), _) => Unary::Square.of_enclosure(a),
                (Kind::SquareRoot, Some(a), _) => Unary::SquareRoot.of_enclosure(a),
                (Kind::Negate, Some(a), _) => Unary::Negate.of_enclosure(a),
                (Kind::Absolute, Some(a), _) => Unary::Absolute.of_enclosure(a),
                (Kind::Add, Some(a), Some(b)) => Binary::Add.of_enclosures(a, b).0,
                (Kind::Subtract, Some(a), Some(b)) => Binary::Subtract.of_enclosures(a, b).0,
                (Kind::Multiply, Some(a), Some(b)) => Binary::Multiply.of_enclosures(a, b).0,
                (Kind::Minimum, Some(a), Some(b)) => {
                    let (bounds, choice) = Binary::Minimum.of_enclosures(a, b);
                    self.choices.push(choice);
                    bounds
                }
                (Kind::Maximum, Some(a), Some(b)) => {
                    let (bounds, choice) = Binary::Maximum.of_enclosures(a, b);
                    self.choices.push(choice);
                    bounds
                }
                _ => self.other(step, &parts.calls, region),
            };
            self.ends.push([bounds.lo, bounds.hi]);
            self.undefined.push(bounds.undefined);
        }
        (self.at(parts.result.index()).unwrap_or(Enclosure::UNKNOWN), Trace(&self.choices))
    }

    #[inline(always)]
    fn at(&self, step: usize) -> Option<Enclosure> {
        let (&[lo, hi], &undefined) = (self.ends.get(step)?, self.undefined.get(step)?);
        Some(Enclosure { lo, hi, undefined })
    }

    /// A step that is not among the common ones.
    #[inline(never)]
    fn other(&mut self, step: &Step, calls: &[Call], region: &Aabb) -> Enclosure {
        let at = |value: super::Value| self.at(value.index()).unwrap_or(Enclosure::UNKNOWN);
        match *step {
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
                    let Interval { lo, hi } = calls[call as usize].field.range(&region);
                    Enclosure::new(lo, hi)
                }
            }
        }
    }
}

/// What a step does, in short: the common ones are told apart by one jump, which costs less than the arithmetic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Code {
    kind: Kind,
    a: u32,
    b: u32,
}

#[derive(Clone, Copy, Debug)]
enum Kind {
    Constant,
    Square,
    SquareRoot,
    Negate,
    Absolute,
    Add,
    Subtract,
    Multiply,
    Minimum,
    Maximum,
    Other,
}

impl Code {
    pub(super) fn of(step: &Step) -> Self {
        let (kind, a, b) = match *step {
            Step::Unary(Unary::Square, a) => (Kind::Square, a, a),
            Step::Unary(Unary::SquareRoot, a) => (Kind::SquareRoot, a, a),
            Step::Unary(Unary::Negate, a) => (Kind::Negate, a, a),
            Step::Unary(Unary::Absolute, a) => (Kind::Absolute, a, a),
            Step::Binary(Binary::Add, a, b) => (Kind::Add, a, b),
            Step::Binary(Binary::Subtract, a, b) => (Kind::Subtract, a, b),
            Step::Binary(Binary::Multiply, a, b) => (Kind::Multiply, a, b),
            Step::Binary(Binary::Minimum, a, b) => (Kind::Minimum, a, b),
            Step::Binary(Binary::Maximum, a, b) => (Kind::Maximum, a, b),
            Step::Constant(_) => return Self { kind: Kind::Constant, a: 0, b: 0 },
            _ => return Self { kind: Kind::Other, a: 0, b: 0 },
        };
        Self { kind, a: a.0, b: b.0 }
    }
}

impl Linear {
    fn over(&self, region: &Aabb) -> Enclosure {
        if !region.min.is_finite() || !region.max.is_finite() {
            return self.over_any(region);
        }
        let (mut lo, mut hi) = (self.offset, self.offset);
        let mut empty = self.offset == 0.0;
        for axis in 0..3 {
            let slope = self.slope[axis];
            if slope == 0.0 {
                continue;
            }
            let (from, to) = (region.min[axis], region.max[axis]);
            // Nothing is rounded where a coordinate is taken as it is.
            let part = if slope == 1.0 {
                Enclosure { lo: from, hi: to, undefined: false }
            } else if slope > 0.0 {
                Enclosure::outward(slope * from, slope * to)
            } else {
                Enclosure::outward(slope * to, slope * from)
            };
            let sum = if empty { part } else { Enclosure::outward(lo + part.lo, hi + part.hi) };
            if sum.undefined || part.undefined {
                return Enclosure::UNKNOWN;
            }
            (lo, hi, empty) = (sum.lo, sum.hi, false);
        }
        Enclosure::new(lo, hi)
    }

    fn over_any(&self, region: &Aabb) -> Enclosure {
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
