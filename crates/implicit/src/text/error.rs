//! What is wrong with a text, and where.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

use crate::program::ParameterError;

/// A text that is not a shape: the place, what was found and what was expected.
#[derive(Clone, Debug, PartialEq)]
pub struct TextError {
    /// The line, from 1.
    pub line: u64,
    /// The column, from 1: a character counts as one, a tab too.
    pub column: u64,
    /// What is wrong there.
    pub problem: TextProblem,
}

/// What is wrong at a place of a text.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TextProblem {
    /// Bytes that are not UTF-8.
    Encoding {
        /// The first such byte.
        byte: u8,
    },
    /// A word or sign that cannot stand there.
    Syntax {
        /// The word or sign.
        found: String,
        /// What could.
        expected: String,
    },
    /// A number that double precision does not hold.
    Number {
        /// As written.
        found: String,
    },
    /// A name that nothing defines.
    UnknownName {
        /// The name.
        name: String,
        /// The known name that differs least, where one is near.
        nearest: Option<String>,
    },
    /// A name that is used before its definition.
    Early {
        /// The name.
        name: String,
        /// The line of its definition.
        defined: u64,
        /// Whether its definition needs the one in which it is used.
        cyclic: bool,
    },
    /// A second definition of a name, or one of a word of the language.
    Twice {
        /// The name.
        name: String,
        /// The line of the first; 0 for a word of the language.
        first: u64,
    },
    /// A function that does not exist.
    UnknownFunction {
        /// The name.
        name: String,
        /// The function whose name differs least, where one is near.
        nearest: Option<String>,
    },
    /// Arguments that do not fit a function or an operator.
    Argument {
        /// Of which.
        of: String,
        /// What there is.
        found: String,
        /// What there should be.
        expected: String,
    },
    /// A parameter outside its range.
    Parameter(ParameterError),
    /// A call for a field from elsewhere where nothing answers such calls.
    NoResolver {
        /// The call.
        call: String,
    },
    /// A call for a field from elsewhere that failed.
    Foreign {
        /// The call.
        call: String,
        /// Why.
        reason: String,
        /// The kind of failure.
        category: Category,
    },
    /// More nodes than a program could have steps.
    TooLarge {
        /// How many there may be.
        most: usize,
    },
}

impl fmt::Display for TextError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}", self.line, self.column, self.problem)
    }
}

impl fmt::Display for TextProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_near = |f: &mut fmt::Formatter<'_>, nearest: &Option<String>, otherwise: &str| match nearest {
            Some(nearest) => write!(f, ", expected {nearest}?"),
            None => write!(f, ", expected {otherwise}"),
        };
        match self {
            Self::Encoding { byte } => write!(f, "found the byte 0x{byte:02X}, expected UTF-8"),
            Self::Syntax { found, expected } => write!(f, "found {found}, expected {expected}"),
            Self::Number { found } => write!(f, "found {found}, expected a number below 1.8e308 in size"),
            Self::UnknownName { name, nearest } => {
                write!(f, "found the unknown name {name}")?;
                or_near(f, nearest, "a name that is defined before")
            }
            Self::Early { name, defined, cyclic: false } => {
                write!(f, "found {name}, which line {defined} defines, expected its definition before its use")
            }
            Self::Early { name, defined, cyclic: true } => {
                write!(f, "found {name}, whose definition in line {defined} needs this one, expected no circle")
            }
            Self::Twice { name, first: 0 } => write!(f, "found {name}, a word of the language, expected a new name"),
            Self::Twice { name, first } => write!(f, "found {name}, which line {first} defines, expected a new name"),
            Self::UnknownFunction { name, nearest } => {
                write!(f, "found the unknown function {name}")?;
                or_near(f, nearest, "a function of the language")
            }
            Self::Argument { of, found, expected } => write!(f, "{of}: found {found}, expected {expected}"),
            Self::Parameter(error) => error.fmt(f),
            Self::NoResolver { call } => {
                write!(f, "found {call}, expected a shape without names from outside: nothing here looks them up")
            }
            Self::Foreign { call, reason, .. } => write!(f, "{call}: {reason}"),
            Self::TooLarge { most } => write!(f, "found more than {most} operations, expected fewer"),
        }
    }
}

impl std::error::Error for TextError {}

impl Diagnostic for TextError {
    fn code(&self) -> &'static str {
        match self.problem {
            TextProblem::Encoding { .. } => "E-shape-text-encoding",
            TextProblem::Syntax { .. } => "E-shape-text-syntax",
            TextProblem::Number { .. } => "E-shape-text-number",
            TextProblem::UnknownName { .. } => "E-shape-text-name",
            TextProblem::Early { .. } => "E-shape-text-order",
            TextProblem::Twice { .. } => "E-shape-text-twice",
            TextProblem::UnknownFunction { .. } => "E-shape-text-function",
            TextProblem::Argument { .. } => "E-shape-text-argument",
            TextProblem::Parameter(_) => "E-shape-text-parameter",
            TextProblem::NoResolver { .. } => "E-shape-text-resolver",
            TextProblem::Foreign { .. } => "E-shape-text-foreign",
            TextProblem::TooLarge { .. } => "E-shape-text-size",
        }
    }

    fn category(&self) -> Category {
        match self.problem {
            TextProblem::NoResolver { .. } => Category::Unsupported,
            TextProblem::Foreign { category, .. } => category,
            TextProblem::TooLarge { .. } => Category::OverLimit,
            _ => Category::Malformed,
        }
    }
}

/// A problem at a byte of the text.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) at: usize,
    pub(super) problem: TextProblem,
}

impl Fault {
    pub(super) fn new(at: usize, problem: TextProblem) -> Self {
        Self { at, problem }
    }

    pub(super) fn syntax(at: usize, found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::new(at, TextProblem::Syntax { found: found.into(), expected: expected.into() })
    }

    /// The error, with the line and column of the byte.
    pub(super) fn within(self, text: &[u8]) -> TextError {
        let before = text.get(..self.at).unwrap_or(text);
        let line_start = before.iter().rposition(|&byte| byte == b'\n').map_or(0, |at| at + 1);
        let characters = before.iter().skip(line_start).filter(|&&byte| byte & 0xC0 != 0x80).count();
        TextError { line: line_of(text, self.at), column: characters as u64 + 1, problem: self.problem }
    }
}

/// The line in which a byte stands, from 1.
pub(super) fn line_of(text: &[u8], at: usize) -> u64 {
    text.iter().take(at).filter(|&&byte| byte == b'\n').count() as u64 + 1
}

/// At most so many characters of what was found, for messages.
pub(super) fn shortened(found: &str) -> String {
    const MOST: usize = 40;
    match found.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &found[..end]),
        None => found.to_owned(),
    }
}
