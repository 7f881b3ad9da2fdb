//! What is wrong with a list of steps.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

use crate::program::CompileError;

/// A list of steps that is no field.
#[derive(Clone, Debug, PartialEq)]
pub struct VmError {
    /// The line, from 1.
    pub line: u64,
    /// What is wrong there.
    pub problem: VmProblem,
}

/// What is wrong in a line.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum VmProblem {
    /// Bytes that are not UTF-8.
    Encoding,
    /// No step in the whole text.
    Empty,
    /// An opcode that does not exist.
    Opcode {
        /// The opcode.
        found: String,
        /// The one that differs least, where one is near.
        nearest: Option<String>,
    },
    /// More or fewer operands than the opcode takes.
    Operands {
        /// The opcode.
        opcode: String,
        /// How many there are.
        found: usize,
        /// How many there should be.
        expected: usize,
    },
    /// An operand that no line above defines.
    Name {
        /// The operand.
        found: String,
        /// The known name that differs least, where one is near.
        nearest: Option<String>,
    },
    /// A second step of the same name.
    Twice {
        /// The name.
        name: String,
    },
    /// A constant that is no number in double precision.
    Number {
        /// As written.
        found: String,
    },
    /// More steps than a program may have.
    TooLarge {
        /// How many there may be.
        most: usize,
    },
}

impl fmt::Display for VmError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}: ", self.line)?;
        match &self.problem {
            VmProblem::Encoding => write!(f, "found bytes that are no characters, expected UTF-8"),
            VmProblem::Empty => write!(f, "found the end, expected at least one step"),
            VmProblem::Opcode { found, nearest: Some(nearest) } => {
                write!(f, "found the unknown opcode {found}, expected {nearest}?")
            }
            VmProblem::Opcode { found, nearest: None } => {
                write!(f, "found {found:?}, expected an opcode such as const, var-x or add")
            }
            VmProblem::Operands { opcode, found, expected } => {
                write!(f, "{opcode}: found {found} operands, expected {expected}")
            }
            VmProblem::Name { found, nearest: Some(nearest) } => {
                write!(f, "found the unknown step {found}, expected {nearest}?")
            }
            VmProblem::Name { found, nearest: None } => {
                write!(f, "found the unknown step {found}, expected one of a line above")
            }
            VmProblem::Twice { name } => write!(f, "found a second step {name}, expected a new name"),
            VmProblem::Number { found } => write!(f, "found {found}, expected a number below 1.8e308 in size"),
            VmProblem::TooLarge { most } => write!(f, "found more than {most} steps, expected fewer"),
        }
    }
}

impl std::error::Error for VmError {}

impl Diagnostic for VmError {
    fn code(&self) -> &'static str {
        match self.problem {
            VmProblem::Encoding => "E-vm-encoding",
            VmProblem::Empty => "E-vm-empty",
            VmProblem::Opcode { .. } => "E-vm-opcode",
            VmProblem::Operands { .. } => "E-vm-operands",
            VmProblem::Name { .. } => "E-vm-name",
            VmProblem::Twice { .. } => "E-vm-twice",
            VmProblem::Number { .. } => "E-vm-number",
            VmProblem::TooLarge { .. } => "E-vm-size",
        }
    }

    fn category(&self) -> Category {
        match self.problem {
            VmProblem::TooLarge { .. } => Category::OverLimit,
            _ => Category::Malformed,
        }
    }
}

/// Why a tree cannot be written as arithmetic steps.
#[derive(Clone, Debug, PartialEq)]
pub enum VmWriteError {
    /// A field from elsewhere, which has no steps.
    Foreign {
        /// The words that name it.
        source: String,
    },
    /// The tree makes no program.
    Compile(CompileError),
}

impl fmt::Display for VmWriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Foreign { source } => write!(f, "found the field {source} from elsewhere, expected formulas alone"),
            Self::Compile(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for VmWriteError {}

impl Diagnostic for VmWriteError {
    fn code(&self) -> &'static str {
        match self {
            Self::Foreign { .. } => "E-vm-foreign",
            Self::Compile(error) => error.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Foreign { .. } => Category::Unsupported,
            Self::Compile(error) => error.category(),
        }
    }
}
