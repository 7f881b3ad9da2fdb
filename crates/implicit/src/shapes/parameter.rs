//! Parameters outside their ranges.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic};

/// A parameter of an operation outside its range.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterError {
    /// The operation, such as `sphere`.
    pub operation: &'static str,
    /// Its parameter, such as `radius`.
    pub parameter: &'static str,
    /// The value.
    pub found: f64,
    /// What would be right.
    pub expected: &'static str,
    /// The named part in which it stands, where there is one.
    pub part: Option<String>,
}

impl fmt::Display for ParameterError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(part) = &self.part {
            write!(f, "part {part}: ")?;
        }
        let Self { operation, parameter, found, expected, .. } = self;
        write!(f, "{operation}: found {parameter} {found}, expected {expected}")
    }
}

impl std::error::Error for ParameterError {}

impl Diagnostic for ParameterError {
    fn code(&self) -> &'static str {
        "E-implicit-parameter"
    }

    fn category(&self) -> Category {
        Category::Malformed
    }
}

pub(crate) fn expect(
    holds: bool,
    operation: &'static str,
    parameter: &'static str,
    found: f64,
    expected: &'static str,
) -> Result<(), ParameterError> {
    if holds { Ok(()) } else { Err(ParameterError { operation, parameter, found, expected, part: None }) }
}

pub(crate) fn finite(operation: &'static str, parameter: &'static str, found: f64) -> Result<(), ParameterError> {
    expect(found.is_finite(), operation, parameter, found, "a finite number")
}

pub(crate) fn positive(operation: &'static str, parameter: &'static str, found: f64) -> Result<(), ParameterError> {
    expect(found > 0.0 && found.is_finite(), operation, parameter, found, "a finite number above 0")
}

pub(crate) fn not_negative(operation: &'static str, parameter: &'static str, found: f64) -> Result<(), ParameterError> {
    expect(found >= 0.0 && found.is_finite(), operation, parameter, found, "a finite number, at least 0")
}

pub(crate) fn finite_vector(
    operation: &'static str,
    parameters: [&'static str; 3],
    found: DVec3,
) -> Result<(), ParameterError> {
    parameters.into_iter().zip(found.to_array()).try_for_each(|(parameter, found)| finite(operation, parameter, found))
}
