//! Why an option cannot be used.

use std::fmt;

use super::{Bounds, OptionKind};
use crate::{Category, Diagnostic, Words};

/// Why an option cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionError {
    /// No option has that name.
    Unknown {
        /// The algorithm.
        algorithm: &'static str,
        /// The name as given.
        name: String,
        /// The names that exist.
        known: Vec<&'static str>,
    },
    /// The text is no value of the option's kind.
    Unreadable {
        /// The algorithm.
        algorithm: &'static str,
        /// The option.
        name: &'static str,
        /// The text as given.
        found: String,
        /// What kind of value is wanted.
        kind: OptionKind,
    },
    /// The number is out of bounds.
    OutOfBounds {
        /// The algorithm.
        algorithm: &'static str,
        /// The option.
        name: &'static str,
        /// The value as given.
        found: f64,
        /// What is accepted.
        bounds: Bounds,
    },
}

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { algorithm, name, known } if known.is_empty() => {
                write!(f, "{algorithm}: found option \"{name}\", expected none: it has no options")
            }
            Self::Unknown { algorithm, name, known } => {
                write!(f, "{algorithm}: found option \"{name}\", expected one of {}", known.join(", "))
            }
            Self::Unreadable { algorithm, name, found, kind } => {
                write!(f, "{algorithm}: option {name}: found \"{found}\", expected {kind}")
            }
            Self::OutOfBounds { algorithm, name, found, bounds } => {
                write!(f, "{algorithm}: option {name}: found {}, expected a number {bounds}", Words(*found))
            }
        }
    }
}

impl std::error::Error for OptionError {}

impl Diagnostic for OptionError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "E-option-unknown",
            Self::Unreadable { .. } => "E-option-text",
            Self::OutOfBounds { .. } => "E-option-range",
        }
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}
