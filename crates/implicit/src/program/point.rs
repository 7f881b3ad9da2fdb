//! Values and gradients at points, in double precision.

use shapeloom_core::glam::DVec3;

use super::Program;
use super::step::Step;
use crate::operator::Dual;
use crate::power::power;

/// Evaluates programs at points in double precision. One for each thread; it keeps its memory from call to call and serves any program.
#[derive(Clone, Debug, Default)]
pub struct PointEvaluator {
    values: Vec<f64>,
    duals: Vec<Dual>,
}

impl PointEvaluator {
    /// An evaluator without memory yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The value at a point.
    pub fn value(&mut self, program: &Program, point: DVec3) -> f64 {
        let parts = &*program.0;
        self.values.clear();
        for step in &parts.steps {
            let at = |value: super::Value| self.values[value.index()];
            let value = match *step {
                Step::Constant(value) => value,
                Step::Linear(linear) => linear.at(point),
                Step::Unary(operator, a) => operator.of(at(a)),
                Step::Binary(operator, a, b) => operator.of(at(a), at(b)),
                Step::Power(a, exponent) => power(at(a), exponent),
                Step::Call(call, place) => parts.calls[call as usize].field.value(DVec3::from_array(place.map(at))),
            };
            self.values.push(value);
        }
        self.values[parts.result.index()]
    }

    /// The value and its derivatives along x, y and z, by forward automatic differentiation: exact up to rounding. Where a
    /// derivative does not exist it is one side's, or not a number.
    pub fn dual(&mut self, program: &Program, point: DVec3) -> Dual {
        let parts = &*program.0;
        self.duals.clear();
        for step in &parts.steps {
            let at = |value: super::Value| self.duals[value.index()];
            let dual = match *step {
                Step::Constant(value) => Dual::constant(value),
                Step::Linear(linear) => Dual { value: linear.at(point), gradient: linear.slope.to_array() },
                Step::Unary(operator, a) => operator.of_dual(at(a)),
                Step::Binary(operator, a, b) => operator.of_dual(at(a), at(b)),
                Step::Power(a, exponent) => {
                    let a = at(a);
                    let slope = f64::from(exponent) * power(a.value, exponent.saturating_sub(1));
                    Dual { value: power(a.value, exponent), gradient: a.gradient.map(|part| slope * part) }
                }
                Step::Call(call, place) => {
                    let place = place.map(at);
                    let field = &parts.calls[call as usize].field;
                    let point = DVec3::from_array(place.map(|dual| dual.value));
                    let along = field.gradient(point).to_array();
                    let mut gradient = [0.0; 3];
                    for (slope, dual) in along.into_iter().zip(place) {
                        for (sum, part) in gradient.iter_mut().zip(dual.gradient) {
                            *sum += slope * part;
                        }
                    }
                    Dual { value: field.value(point), gradient }
                }
            };
            self.duals.push(dual);
        }
        self.duals[parts.result.index()]
    }
}
