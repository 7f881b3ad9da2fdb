//! Arguments brought to their parameters.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;

use super::error::{Fault, TextProblem, shortened};
use super::names::nearest;
use super::value::Value;
use crate::program::ParameterError;
use crate::tree::Tree;

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Number,
    /// A shape, a formula or a number.
    Field,
    /// The same, but a number stays one.
    Value,
    Text,
}

impl Kind {
    fn described(self) -> &'static str {
        match self {
            Self::Number => "a number",
            Self::Field | Self::Value => "a shape or formula",
            Self::Text => "a text",
        }
    }
}

/// What holds for a parameter without an argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Missing {
    Refused,
    Number(f64),
    Absent,
}

/// A parameter of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parameter {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) missing: Missing,
}

/// An argument as written.
#[derive(Debug)]
pub(super) struct Argument<'a> {
    pub(super) name: Option<&'a str>,
    pub(super) value: Value,
    pub(super) at: usize,
}

/// The arguments of a call in the order of the parameters.
pub(super) struct Bound {
    pub(super) function: &'static str,
    slots: Vec<Option<Value>>,
    /// What a function of any number of parts was given.
    pub(super) parts: Vec<Tree>,
    /// The numbers behind the parameters of a function that takes groups of them, in whole groups.
    pub(super) rest: Vec<f64>,
}

impl Bound {
    /// The argument of a parameter, each once.
    pub(super) fn take(&mut self, index: usize) -> Option<Value> {
        self.slots.get_mut(index).and_then(Option::take)
    }

    pub(super) fn optional(&self, index: usize) -> Option<f64> {
        match self.slots.get(index) {
            Some(Some(Value::Number(number))) => Some(*number),
            _ => None,
        }
    }

    pub(super) fn number(&self, index: usize) -> f64 {
        self.optional(index).unwrap_or(f64::NAN)
    }

    pub(super) fn numbers<const N: usize>(&self, first: usize) -> [f64; N] {
        std::array::from_fn(|i| self.number(first + i))
    }

    pub(super) fn vector(&self, first: usize) -> DVec3 {
        DVec3::from_array(self.numbers(first))
    }

    pub(super) fn field(&self, index: usize) -> Tree {
        self.slots.get(index).cloned().flatten().and_then(Value::into_field).unwrap_or_else(|| Tree::constant(f64::NAN))
    }

    pub(super) fn text(&self, index: usize) -> Arc<str> {
        match self.slots.get(index) {
            Some(Some(Value::Text(text))) => Arc::clone(text),
            _ => Arc::from(""),
        }
    }

    /// A whole number, 0 where none was given.
    pub(super) fn whole(&self, index: usize, parameter: &'static str) -> Result<u32, ParameterError> {
        let found = self.optional(index).unwrap_or(0.0);
        let fits = found.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&found);
        if fits {
            return Ok(found as u32);
        }
        let expected = "a whole number, at least 0";
        Err(ParameterError { operation: self.function, parameter, found, expected, part: None })
    }
}

/// What a function takes.
#[derive(Clone, Copy)]
pub(super) struct Signature {
    pub(super) name: &'static str,
    pub(super) parameters: &'static [Parameter],
    /// Any number of fields instead of parameters.
    pub(super) many: bool,
    /// What each group of numbers behind the parameters is, where there may be any number of groups.
    pub(super) group: &'static [&'static str],
}

impl Signature {
    fn fault(&self, at: usize, found: impl Into<String>, expected: impl Into<String>) -> Fault {
        let argument =
            TextProblem::Argument { of: self.name.to_owned(), found: found.into(), expected: expected.into() };
        Fault::new(at, argument)
    }

    /// The arguments in the order of the parameters; the call stands at the byte `at`.
    pub(super) fn bind(&self, at: usize, arguments: Vec<Argument<'_>>) -> Result<Bound, Fault> {
        let mut bound = Bound { function: self.name, slots: Vec::new(), parts: Vec::new(), rest: Vec::new() };
        if self.many {
            for argument in arguments {
                if let Some(name) = argument.name {
                    return Err(self.fault(argument.at, format!("the parameter {}", shortened(name)), "parts alone"));
                }
                bound.parts.push(self.field(argument.at, argument.value)?);
            }
            if bound.parts.is_empty() {
                return Err(self.fault(at, "no parts", "at least one"));
            }
            return Ok(bound);
        }
        bound.slots.resize(self.parameters.len(), None);
        let count = arguments.len();
        for (place, argument) in arguments.into_iter().enumerate() {
            let index = match argument.name {
                None if place < self.parameters.len() => place,
                None if !self.group.is_empty() => match argument.value.closed() {
                    Value::Number(number) => {
                        bound.rest.push(number);
                        continue;
                    }
                    value => {
                        let name = self.group.get(bound.rest.len() % self.group.len()).copied().unwrap_or_default();
                        return Err(self.fault(argument.at, value.described(), format!("a number as {name}")));
                    }
                },
                None => {
                    return Err(self.fault(argument.at, format!("{count} arguments"), self.described()));
                }
                Some(name) => self.index_of(argument.at, name)?,
            };
            let (Some(parameter), Some(slot)) = (self.parameters.get(index), bound.slots.get_mut(index)) else {
                continue;
            };
            if slot.is_some() {
                return Err(self.fault(argument.at, format!("{} twice", parameter.name), "it once"));
            }
            *slot = Some(self.fit(parameter, argument)?);
        }
        for (parameter, slot) in self.parameters.iter().zip(&mut bound.slots) {
            match (&slot, parameter.missing) {
                (None, Missing::Refused) => {
                    return Err(self.fault(at, format!("no {}", parameter.name), self.described()));
                }
                (None, Missing::Number(number)) => *slot = Some(Value::Number(number)),
                _ => {}
            }
        }
        if bound.rest.len().checked_rem(self.group.len()).unwrap_or(0) != 0 {
            let found = format!("{} numbers behind {} parameters", bound.rest.len(), self.parameters.len());
            return Err(self.fault(at, found, self.described()));
        }
        Ok(bound)
    }

    fn index_of(&self, at: usize, name: &str) -> Result<usize, Fault> {
        self.parameters.iter().position(|parameter| parameter.name == name).ok_or_else(|| {
            let expected = match nearest(name, self.parameters.iter().map(|parameter| parameter.name)) {
                Some(nearest) => format!("{nearest}?"),
                None => self.described(),
            };
            self.fault(at, format!("the unknown parameter {}", shortened(name)), expected)
        })
    }

    fn fit(&self, parameter: &Parameter, argument: Argument<'_>) -> Result<Value, Fault> {
        match (parameter.kind, argument.value.closed()) {
            (Kind::Number, value @ Value::Number(_))
            | (Kind::Text, value @ Value::Text(_))
            | (Kind::Field | Kind::Value, value @ (Value::Field(_) | Value::Number(_))) => Ok(value),
            (kind, value) => {
                let expected = format!("{} as {}", kind.described(), parameter.name);
                Err(self.fault(argument.at, value.described(), expected))
            }
        }
    }

    fn field(&self, at: usize, value: Value) -> Result<Tree, Fault> {
        let found = value.described();
        value.into_field().ok_or_else(|| self.fault(at, found, Kind::Field.described()))
    }

    /// How it is called, such as `sphere(radius, x = 0, y = 0, z = 0)`.
    pub(super) fn described(&self) -> String {
        if self.many {
            return format!("{}(a, b, ...)", self.name);
        }
        let parameters: Vec<String> = self
            .parameters
            .iter()
            .map(|parameter| match parameter.missing {
                Missing::Refused => parameter.name.to_owned(),
                Missing::Number(number) => format!("{} = {number}", parameter.name),
                Missing::Absent => format!("{} = none", parameter.name),
            })
            .collect();
        let group = if self.group.is_empty() { String::new() } else { format!(", {}, ...", self.group.join(", ")) };
        format!("{}({}{group})", self.name, parameters.join(", "))
    }
}
