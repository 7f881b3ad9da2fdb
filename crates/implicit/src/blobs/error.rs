//! Why numbers make no blobs.

use std::fmt;

use shapeloom_core::{Category, Diagnostic, OverBudget, Stop};

/// Why numbers make no blobs.
#[derive(Clone, Debug, PartialEq)]
pub enum BlobsError {
    /// No blob at all.
    Empty,
    /// More blobs than there may be.
    TooMany {
        /// How many.
        found: usize,
    },
    /// A threshold that is not finite and above 0: the sum is 0 far away, and all of space would be inside.
    Threshold {
        /// The threshold.
        found: f64,
    },
    /// A threshold that no place reaches, even where all peaks fall together.
    Unreachable {
        /// The threshold.
        threshold: f64,
        /// The sum of the peaks that are above 0.
        peaks: f64,
    },
    /// Peaks whose sizes add up to more than single precision holds safely.
    Strength {
        /// The sum of their sizes.
        found: f64,
    },
    /// A centre that is not finite.
    Center {
        /// Which blob.
        index: usize,
        /// The coordinate.
        found: f64,
    },
    /// A parameter of a blob outside its range.
    Parameter {
        /// Which blob.
        index: usize,
        /// Which parameter.
        parameter: &'static str,
        /// The value.
        found: f64,
        /// What would be right.
        expected: &'static str,
    },
    /// A share of the threshold to leave out that is not between 0 and 1/10.
    Cutoff {
        /// The share.
        found: f64,
    },
    /// The caller stopped it.
    Stop(Stop),
    /// The memory budget does not have what the blobs need.
    OverBudget(OverBudget),
}

impl fmt::Display for BlobsError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("blobs: found none, expected at least one"),
            Self::TooMany { found } => write!(f, "blobs: found {found}, expected fewer than 2^31"),
            Self::Threshold { found } => write!(f, "blobs: found threshold {found}, expected a finite number above 0"),
            Self::Unreachable { threshold, peaks } => {
                write!(f, "blobs: found threshold {threshold}, expected one below {peaks}, the sum of all peaks")
            }
            Self::Strength { found } => {
                write!(f, "blobs: found peaks whose sizes add up to {found:e}, expected at most 1e37")
            }
            Self::Center { index, found } => {
                write!(f, "blob {index}: found coordinate {found}, expected a finite number")
            }
            Self::Parameter { index, parameter, found, expected } => {
                write!(f, "blob {index}: found {parameter} {found}, expected {expected}")
            }
            Self::Cutoff { found } => write!(f, "blobs: found cutoff {found}, expected a number above 0, at most 0.1"),
            Self::Stop(stop) => stop.fmt(f),
            Self::OverBudget(over) => over.fmt(f),
        }
    }
}

impl std::error::Error for BlobsError {}

impl Diagnostic for BlobsError {
    fn code(&self) -> &'static str {
        match self {
            Self::Empty => "E-blobs-empty",
            Self::TooMany { .. } => "E-blobs-count",
            Self::Threshold { .. } => "E-blobs-threshold",
            Self::Unreachable { .. } => "E-blobs-unreachable",
            Self::Strength { .. } => "E-blobs-strength",
            Self::Center { .. } => "E-blobs-center",
            Self::Parameter { .. } => "E-blobs-parameter",
            Self::Cutoff { .. } => "E-blobs-cutoff",
            Self::Stop(stop) => stop.code(),
            Self::OverBudget(over) => over.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Stop(stop) => stop.category(),
            Self::OverBudget(over) => over.category(),
            Self::TooMany { .. } => Category::OverLimit,
            _ => Category::Malformed,
        }
    }
}

impl From<Stop> for BlobsError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<OverBudget> for BlobsError {
    fn from(over: OverBudget) -> Self {
        Self::OverBudget(over)
    }
}
