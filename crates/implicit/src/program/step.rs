//! The steps of a program.

use std::sync::Arc;

use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;

use super::Value;
use crate::operator::{Binary, Unary};

/// One step: its result is named by its number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// A number.
    Constant(f64),
    /// A linear function of the coordinates.
    Linear(Linear),
    /// An operator of one operand.
    Unary(Unary, Value),
    /// An operator of two operands.
    Binary(Binary, Value, Value),
    /// A whole power.
    Power(Value, i32),
    /// Another field at a place.
    Call(u32, [Value; 3]),
}

impl Step {
    /// The values that it needs.
    pub(crate) fn operands(&self) -> impl DoubleEndedIterator<Item = Value> {
        let operands = match *self {
            Self::Constant(_) | Self::Linear(_) => [None; 3],
            Self::Unary(_, a) | Self::Power(a, _) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Call(_, place) => place.map(Some),
        };
        operands.into_iter().flatten()
    }
}

/// `slope · (x, y, z) + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Linear {
    pub(crate) slope: DVec3,
    pub(crate) offset: f64,
}

impl Linear {
    /// The value at a point.
    pub(crate) fn at(&self, point: DVec3) -> f64 {
        // Coordinates that do not count must not spoil the value where they are infinite.
        let mut sum = self.offset;
        for (slope, coordinate) in self.slope.to_array().into_iter().zip(point.to_array()) {
            if slope != 0.0 {
                sum += slope * coordinate;
            }
        }
        sum
    }
}

/// Another field that a program asks.
#[derive(Clone)]
pub(crate) struct Call {
    pub(crate) field: Arc<dyn Field>,
    /// The place as linear functions of the coordinates, where it is that: batches then keep their precision far from the origin.
    pub(crate) map: Option<[Linear; 3]>,
}
