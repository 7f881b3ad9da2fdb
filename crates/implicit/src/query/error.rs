//! Why a question has no answer.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, Interval, OptionError, Stop, VectorWords, Words};

/// Why a question to a field has no answer.
#[derive(Clone, Debug, PartialEq)]
pub enum QueryError {
    /// A tolerance that is no length.
    Tolerance {
        /// The tolerance as given.
        found: f64,
    },
    /// A point that is not finite.
    Point {
        /// The point as given.
        found: DVec3,
    },
    /// A ray whose reach does not end.
    Reach {
        /// The reach as given.
        found: Interval,
    },
    /// A field without a Lipschitz constant, where steps need one.
    Lipschitz,
    /// An option out of range.
    Option(OptionError),
    /// Stopped by the caller.
    Stop(Stop),
}

impl fmt::Display for QueryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tolerance { found } => {
                write!(f, "tolerance: found {}, expected a finite length from 0 on", Words(*found))
            }
            Self::Point { found } => write!(f, "point: found {}, expected finite numbers", VectorWords(*found)),
            Self::Reach { found } => write!(
                f,
                "ray: found a reach from {} to {}, expected finite distances in this order",
                Words(found.lo),
                Words(found.hi)
            ),
            Self::Lipschitz => f.write_str("field: found no Lipschitz constant, expected one for sphere tracing"),
            Self::Option(error) => error.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
        }
    }
}

impl std::error::Error for QueryError {}

impl Diagnostic for QueryError {
    fn code(&self) -> &'static str {
        match self {
            Self::Tolerance { .. } => "E-query-tolerance",
            Self::Point { .. } => "E-query-point",
            Self::Reach { .. } => "E-query-reach",
            Self::Lipschitz => "E-query-lipschitz",
            Self::Option(error) => error.code(),
            Self::Stop(stop) => stop.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Lipschitz => Category::Unsupported,
            Self::Stop(stop) => stop.category(),
            _ => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::Reach { .. } => Some("cut the ray off at the shape's bounding box".into()),
            Self::Lipschitz => Some("intersect by intervals, which need none".into()),
            Self::Stop(stop) => stop.advice(),
            _ => None,
        }
    }
}

impl From<Stop> for QueryError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<OptionError> for QueryError {
    fn from(error: OptionError) -> Self {
        Self::Option(error)
    }
}

pub(super) fn usable_tolerance(found: f64) -> Result<f64, QueryError> {
    if found.is_finite() && found >= 0.0 { Ok(found) } else { Err(QueryError::Tolerance { found }) }
}

pub(super) fn usable_point(found: DVec3) -> Result<DVec3, QueryError> {
    if found.is_finite() { Ok(found) } else { Err(QueryError::Point { found }) }
}
