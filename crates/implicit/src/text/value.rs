//! What an expression stands for while text is read.

use std::sync::Arc;

use shapeloom_core::Aabb;

use super::error::{Fault, TextProblem};
use crate::operator::{Binary, Unary};
use crate::power::power;
use crate::shapes::SetOperation;
use crate::tree::{Operation, Tree};

/// What an expression stands for.
///
/// Numbers are computed as they are read, so that they can be parameters; where a field is needed, a number is the
/// constant field.
#[derive(Clone, Debug)]
pub(super) enum Value {
    Number(f64),
    Field(Tree),
    /// `a | b | c` so far: one operation of many parts, unless something closes it.
    Chain(SetOperation, Vec<Tree>),
    Text(Arc<str>),
    /// Where to look: of no use but as a statement.
    Bounds(Aabb),
}

impl Value {
    pub(super) fn described(&self) -> &'static str {
        match self {
            Self::Number(_) => "a number",
            Self::Field(_) | Self::Chain(..) => "a shape or formula",
            Self::Text(_) => "a text",
            Self::Bounds(_) => "bounds",
        }
    }

    /// The value with no more parts to come.
    pub(super) fn closed(self) -> Self {
        match self {
            Self::Chain(set, parts) => Self::Field(Tree::new(Operation::Set(set, parts))),
            other => other,
        }
    }

    fn is_field(&self) -> bool {
        matches!(self, Self::Number(_) | Self::Field(_) | Self::Chain(..))
    }

    /// The value as a field, if it is one or a number.
    pub(super) fn into_field(self) -> Option<Tree> {
        match self.closed() {
            Self::Number(value) => Some(value.into()),
            Self::Field(tree) => Some(tree),
            Self::Chain(..) | Self::Text(_) | Self::Bounds(_) => None,
        }
    }
}

/// An operator between two values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Infix {
    Arithmetic(Binary),
    Power,
    Set(SetOperation),
}

/// How tightly prefixes bind: looser than powers, tighter than products.
pub(super) const PREFIX: u8 = 5;
/// How tightly powers bind.
pub(super) const POWER: u8 = 6;
/// Calls, names, numbers and what stands in parentheses.
pub(super) const PRIMARY: u8 = 7;

impl Infix {
    pub(super) fn from_sign(sign: char) -> Option<Self> {
        Some(match sign {
            '+' => Self::Arithmetic(Binary::Add),
            '-' => Self::Arithmetic(Binary::Subtract),
            '*' => Self::Arithmetic(Binary::Multiply),
            '/' => Self::Arithmetic(Binary::Divide),
            '^' => Self::Power,
            '|' => Self::Set(SetOperation::Union),
            '&' => Self::Set(SetOperation::Intersection),
            '\\' => Self::Set(SetOperation::Difference),
            _ => return None,
        })
    }

    /// The sign.
    fn sign(self) -> char {
        "+-*/^|&\\".chars().find(|&sign| Self::from_sign(sign) == Some(self)).unwrap_or('?')
    }

    /// How tightly it binds.
    pub(super) fn level(self) -> u8 {
        match self {
            Self::Set(SetOperation::Intersection) => 2,
            Self::Set(SetOperation::Union | SetOperation::Difference) => 1,
            Self::Arithmetic(Binary::Multiply | Binary::Divide) => 4,
            Self::Arithmetic(_) => 3,
            Self::Power => POWER,
        }
    }

    /// Whether `a ^ b ^ c` is `a ^ (b ^ c)`.
    pub(super) fn groups_rightward(self) -> bool {
        self == Self::Power
    }
}

fn no_operand(at: usize, of: char, found: &Value) -> Fault {
    let argument = TextProblem::Argument {
        of: format!("operator {of}"),
        found: found.described().to_owned(),
        expected: "a shape, a formula or a number".to_owned(),
    };
    Fault::new(at, argument)
}

/// `left operator right`; the operator stands at the byte `at`.
pub(super) fn infix(at: usize, operator: Infix, left: Value, right: Value) -> Result<Value, Fault> {
    for operand in [&left, &right] {
        if !operand.is_field() {
            return Err(no_operand(at, operator.sign(), operand));
        }
    }
    Ok(match (operator, left, right) {
        (Infix::Set(set), Value::Chain(so_far, mut parts), right) if so_far == set => {
            parts.extend(right.into_field());
            Value::Chain(set, parts)
        }
        (Infix::Set(set), left, right) => {
            Value::Chain(set, left.into_field().into_iter().chain(right.into_field()).collect())
        }
        (Infix::Arithmetic(operator), left, right) => binary(operator, left, right),
        (Infix::Power, Value::Number(base), Value::Number(exponent)) => Value::Number(match whole(exponent) {
            Some(exponent) => power(base, exponent),
            None => base.powf(exponent),
        }),
        (Infix::Power, base, exponent) => match (base.into_field(), &exponent) {
            (Some(base), Value::Number(number)) if whole(*number).is_some() => {
                Value::Field(base.power(whole(*number).unwrap_or_default()))
            }
            (Some(base), _) => binary(Binary::Power, Value::Field(base), exponent),
            (None, _) => exponent,
        },
    })
}

/// The whole number that it is.
fn whole(value: f64) -> Option<i32> {
    let fits = value.fract() == 0.0 && (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&value);
    fits.then_some(value as i32)
}

/// `-value` or `~value`; the sign stands at the byte `at`.
pub(super) fn prefix(at: usize, sign: char, value: Value) -> Result<Value, Fault> {
    if !value.is_field() {
        return Err(no_operand(at, sign, &value));
    }
    Ok(match (sign, value) {
        ('~', value) => value.into_field().map_or(Value::Number(f64::NAN), |field| Value::Field(field.complement())),
        (_, value) => unary(Unary::Negate, value),
    })
}

/// The operator's result: a number of a number, a node of a field. Other values are given back.
pub(super) fn unary(operator: Unary, value: Value) -> Value {
    match value.closed() {
        Value::Number(value) => Value::Number(operator.of(value)),
        Value::Field(field) => Value::Field(field.unary(operator)),
        other => other,
    }
}

/// The operator's result: a number of two numbers, else a node. Of other values the first.
pub(super) fn binary(operator: Binary, left: Value, right: Value) -> Value {
    match (left.closed(), right) {
        (Value::Number(left), Value::Number(right)) => Value::Number(operator.of(left, right)),
        (left, right) => match (left.clone().into_field(), right.into_field()) {
            (Some(left), Some(right)) => Value::Field(left.binary(operator, right)),
            _ => left,
        },
    }
}
