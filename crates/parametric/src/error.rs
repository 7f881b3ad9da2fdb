//! What can be wrong with curves, patches and their tessellation.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

/// Why control points make no curve or patch.
#[derive(Clone, Debug, PartialEq)]
pub enum BezierError {
    /// No control points.
    Empty,
    /// Another number of control points than the degrees ask for.
    Count {
        /// The degree in u.
        degree_u: u32,
        /// The degree in v.
        degree_v: u32,
        /// How many control points there are.
        found: usize,
    },
    /// A control point that is infinite or NaN.
    NotFinite {
        /// Its index.
        index: usize,
    },
    /// A degree above what is supported.
    Degree {
        /// The degree.
        found: usize,
        /// The largest.
        max: usize,
    },
}

impl fmt::Display for BezierError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("found no control points, expected at least one"),
            Self::Count { degree_u, degree_v, found } => {
                let expected = (u64::from(*degree_u) + 1) * (u64::from(*degree_v) + 1);
                write!(f, "found {found} control points, expected {expected} for the degrees {degree_u} x {degree_v}")
            }
            Self::NotFinite { index } => {
                write!(f, "control point {index}: found a coordinate that is not finite, expected finite numbers")
            }
            Self::Degree { found, max } => write!(f, "found degree {found}, expected at most {max}"),
        }
    }
}

impl std::error::Error for BezierError {}

impl Diagnostic for BezierError {
    fn code(&self) -> &'static str {
        match self {
            Self::Empty => "E-bezier-empty",
            Self::Count { .. } => "E-bezier-count",
            Self::NotFinite { .. } => "E-bezier-finite",
            Self::Degree { .. } => "E-bezier-degree",
        }
    }

    fn category(&self) -> Category {
        Category::Malformed
    }
}

/// Why a chord tolerance cannot be met.
#[derive(Clone, Debug, PartialEq)]
pub enum TessellationError {
    /// The tolerance is below what `f64` resolves at the size of the control points.
    BelowRounding {
        /// The tolerance asked for.
        tolerance: f64,
        /// The rounding of an evaluation, which the certificate must cover.
        rounding: f64,
    },
    /// Control points so far apart that their differences overflow.
    TooLarge {
        /// What kind of element: a curve, a patch.
        kind: &'static str,
        /// Which one.
        index: usize,
    },
    /// More vertices or triangles than ids of 32 bits can tell apart.
    TooManyElements {
        /// How many, as far as they were counted.
        found: f64,
    },
    /// More segments along one curve or side than the option allows.
    TooManySegments {
        /// What kind of element: a curve, a patch.
        kind: &'static str,
        /// Which one.
        index: usize,
        /// How many segments it needs.
        found: f64,
        /// How many are allowed.
        allowed: u32,
    },
}

impl fmt::Display for TessellationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BelowRounding { tolerance, rounding } => write!(
                f,
                "chord tolerance: found {tolerance:e}, expected more than {rounding:.3e}, the rounding of a point at this size"
            ),
            Self::TooLarge { kind, index } => {
                write!(
                    f,
                    "{kind} {index}: found control points whose differences overflow, expected coordinates below 1e300"
                )
            }
            Self::TooManyElements { found } => {
                write!(f, "found a need of {found:.3e} vertices, expected at most {}", u32::MAX - 1)
            }
            Self::TooManySegments { kind, index, found, allowed } => {
                write!(
                    f,
                    "{kind} {index}: found a need of {found:.0} segments along a side, expected at most {allowed}"
                )
            }
        }
    }
}

impl std::error::Error for TessellationError {}

impl Diagnostic for TessellationError {
    fn code(&self) -> &'static str {
        match self {
            Self::BelowRounding { .. } => "E-tessellation-rounding",
            Self::TooLarge { .. } => "E-tessellation-overflow",
            Self::TooManyElements { .. } => "E-tessellation-size",
            Self::TooManySegments { .. } => "E-tessellation-segments",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::BelowRounding { .. } | Self::TooLarge { .. } => Category::Failed,
            Self::TooManyElements { .. } | Self::TooManySegments { .. } => Category::OverLimit,
        }
    }

    fn advice(&self) -> Option<String> {
        Some(match self {
            Self::TooLarge { .. } => "scale the shape down".into(),
            Self::TooManySegments { .. } => "ask for a larger tolerance, or raise the option max_segments".into(),
            _ => "ask for a larger tolerance".into(),
        })
    }
}
