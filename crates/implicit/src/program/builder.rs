//! Building the steps of a program, each computed once.

use std::collections::HashMap;
use std::sync::Arc;

use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;

use super::Value;
use super::step::{Call, Linear, Step};
use crate::operator::{Binary, Unary};
use crate::power::power;

/// Where a field is asked: three values.
pub(crate) type Place = [Value; 3];

/// Collects steps. Steps that say the same are one step; sums, differences and multiples of the coordinates stay one linear step;
/// what depends on no coordinate is computed here.
#[derive(Default)]
pub(crate) struct Builder {
    steps: Vec<Step>,
    calls: Vec<Call>,
    known: HashMap<Key, Value>,
}

#[derive(PartialEq, Eq, Hash)]
enum Key {
    Constant(u64),
    Linear([u64; 4]),
    Unary(Unary, Value),
    Binary(Binary, Value, Value),
    Power(Value, i32),
    Call(usize, Place),
}

impl Builder {
    /// The coordinates of space.
    pub(crate) fn coordinates(&mut self) -> Place {
        DVec3::AXES.map(|axis| self.linear(axis, 0.0))
    }

    /// How many steps there are.
    pub(crate) fn len(&self) -> usize {
        self.steps.len()
    }

    pub(crate) fn into_parts(self) -> (Vec<Step>, Vec<Call>) {
        (self.steps, self.calls)
    }

    fn push(&mut self, key: Key, step: Step) -> Value {
        *self.known.entry(key).or_insert_with(|| {
            self.steps.push(step);
            Value(self.steps.len() as u32 - 1)
        })
    }

    fn step(&self, value: Value) -> &Step {
        &self.steps[value.index()]
    }

    fn as_constant(&self, value: Value) -> Option<f64> {
        match self.step(value) {
            Step::Constant(constant) => Some(*constant),
            _ => None,
        }
    }

    fn as_linear(&self, value: Value) -> Option<Linear> {
        match self.step(value) {
            Step::Constant(constant) => Some(Linear { slope: DVec3::ZERO, offset: *constant }),
            Step::Linear(linear) => Some(*linear),
            _ => None,
        }
    }

    pub(crate) fn constant(&mut self, value: f64) -> Value {
        self.push(Key::Constant(value.to_bits()), Step::Constant(value))
    }

    /// `slope · (x, y, z) + offset`.
    pub(crate) fn linear(&mut self, slope: DVec3, offset: f64) -> Value {
        if slope == DVec3::ZERO {
            return self.constant(offset);
        }
        let [x, y, z] = slope.to_array();
        self.push(Key::Linear([x, y, z, offset].map(f64::to_bits)), Step::Linear(Linear { slope, offset }))
    }

    /// A linear function of a place.
    pub(crate) fn linear_at(&mut self, place: Place, slope: DVec3, offset: f64) -> Value {
        let mut sum = self.constant(offset);
        for (value, factor) in place.into_iter().zip(slope.to_array()) {
            if factor != 0.0 {
                let factor = self.constant(factor);
                let part = self.multiply(value, factor);
                sum = self.add(sum, part);
            }
        }
        sum
    }

    pub(crate) fn unary(&mut self, operator: Unary, a: Value) -> Value {
        if let Some(constant) = self.as_constant(a) {
            return self.constant(operator.of(constant));
        }
        match (operator, self.step(a)) {
            (Unary::Negate, Step::Linear(linear)) => {
                let (slope, offset) = (-linear.slope, -linear.offset);
                return self.linear(slope, offset);
            }
            (Unary::Negate, Step::Unary(Unary::Negate, inner)) => return *inner,
            (Unary::Absolute | Unary::Square, Step::Unary(Unary::Negate | Unary::Absolute, inner)) => {
                let inner = *inner;
                return self.unary(operator, inner);
            }
            (Unary::Absolute, Step::Unary(Unary::Square | Unary::SquareRoot | Unary::Exponential, _)) => return a,
            _ => {}
        }
        self.push(Key::Unary(operator, a), Step::Unary(operator, a))
    }

    pub(crate) fn binary(&mut self, operator: Binary, a: Value, b: Value) -> Value {
        if let (Some(left), Some(right)) = (self.as_constant(a), self.as_constant(b)) {
            return self.constant(operator.of(left, right));
        }
        if let Some(simpler) = self.linear_result(operator, a, b) {
            return simpler;
        }
        match operator {
            Binary::Multiply if a == b => return self.unary(Unary::Square, a),
            Binary::Minimum | Binary::Maximum if a == b => return a,
            Binary::Add | Binary::Subtract if self.as_constant(b) == Some(0.0) => return a,
            Binary::Add if self.as_constant(a) == Some(0.0) => return b,
            Binary::Multiply | Binary::Divide if self.as_constant(b) == Some(1.0) => return a,
            Binary::Multiply if self.as_constant(a) == Some(1.0) => return b,
            Binary::Subtract if self.as_constant(a) == Some(0.0) => return self.unary(Unary::Negate, b),
            _ => {}
        }
        let (a, b) = if operator.is_symmetric() && b < a { (b, a) } else { (a, b) };
        self.push(Key::Binary(operator, a, b), Step::Binary(operator, a, b))
    }

    /// The result where it is linear in the coordinates. Numbers that are not finite stay as written.
    fn linear_result(&mut self, operator: Binary, a: Value, b: Value) -> Option<Value> {
        let (left, right) = (self.as_linear(a)?, self.as_linear(b)?);
        let (slope, offset) = match operator {
            Binary::Add => (left.slope + right.slope, left.offset + right.offset),
            Binary::Subtract => (left.slope - right.slope, left.offset - right.offset),
            Binary::Multiply if left.slope == DVec3::ZERO => (right.slope * left.offset, right.offset * left.offset),
            Binary::Multiply if right.slope == DVec3::ZERO => (left.slope * right.offset, left.offset * right.offset),
            Binary::Divide if right.slope == DVec3::ZERO => (left.slope / right.offset, left.offset / right.offset),
            _ => return None,
        };
        (slope.is_finite() && offset.is_finite()).then(|| self.linear(slope, offset))
    }

    pub(crate) fn power(&mut self, a: Value, exponent: i32) -> Value {
        if let Some(constant) = self.as_constant(a) {
            return self.constant(power(constant, exponent));
        }
        match exponent {
            0 => self.constant(1.0),
            1 => a,
            2 => self.unary(Unary::Square, a),
            -1 => self.unary(Unary::Reciprocal, a),
            _ => self.push(Key::Power(a, exponent), Step::Power(a, exponent)),
        }
    }

    /// Another field at a place.
    pub(crate) fn call(&mut self, field: &Arc<dyn Field>, place: Place) -> Value {
        let at = Arc::as_ptr(field).cast::<()>().addr();
        let forms = place.map(|value| self.as_linear(value));
        let map = match forms {
            [Some(x), Some(y), Some(z)] => Some([x, y, z]),
            _ => None,
        };
        let index = self.calls.len() as u32;
        let key = Key::Call(at, place);
        if let Some(&known) = self.known.get(&key) {
            return known;
        }
        self.calls.push(Call { field: Arc::clone(field), map });
        self.push(key, Step::Call(index, place))
    }

    pub(crate) fn add(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Add, a, b)
    }

    pub(crate) fn subtract(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Subtract, a, b)
    }

    pub(crate) fn multiply(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Multiply, a, b)
    }

    pub(crate) fn divide(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Divide, a, b)
    }

    pub(crate) fn minimum(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Minimum, a, b)
    }

    pub(crate) fn maximum(&mut self, a: Value, b: Value) -> Value {
        self.binary(Binary::Maximum, a, b)
    }

    pub(crate) fn negate(&mut self, a: Value) -> Value {
        self.unary(Unary::Negate, a)
    }

    pub(crate) fn absolute(&mut self, a: Value) -> Value {
        self.unary(Unary::Absolute, a)
    }

    pub(crate) fn square(&mut self, a: Value) -> Value {
        self.unary(Unary::Square, a)
    }

    pub(crate) fn square_root(&mut self, a: Value) -> Value {
        self.unary(Unary::SquareRoot, a)
    }

    /// `a + number`.
    pub(crate) fn plus(&mut self, a: Value, number: f64) -> Value {
        let number = self.constant(number);
        self.add(a, number)
    }

    /// `a * number`.
    pub(crate) fn times(&mut self, a: Value, number: f64) -> Value {
        let number = self.constant(number);
        self.multiply(a, number)
    }

    /// `a`, but at least 0.
    pub(crate) fn positive_part(&mut self, a: Value) -> Value {
        let zero = self.constant(0.0);
        self.maximum(zero, a)
    }

    /// `a`, but at most 0; where `a` is 0 it changes as `a` does.
    pub(crate) fn negative_part(&mut self, a: Value) -> Value {
        let zero = self.constant(0.0);
        self.minimum(zero, a)
    }

    /// `a` kept within two numbers.
    pub(crate) fn clamp(&mut self, a: Value, least: f64, most: f64) -> Value {
        let (least, most) = (self.constant(least), self.constant(most));
        let raised = self.maximum(a, least);
        self.minimum(raised, most)
    }

    /// The root of the sum of squares.
    pub(crate) fn length(&mut self, parts: &[Value]) -> Value {
        let mut sum = self.constant(0.0);
        for &part in parts {
            let square = self.square(part);
            sum = self.add(sum, square);
        }
        self.square_root(sum)
    }
}
