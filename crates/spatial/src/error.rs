//! Why triangles make no hierarchy.

use std::fmt;

use glam::DVec3;
use shapeloom_core::{Category, Diagnostic, OverBudget, Stop};

/// Why triangles make no bounding volume hierarchy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BvhError {
    /// A triangle names a position that does not exist.
    Index {
        /// The triangle.
        triangle: u32,
        /// Its corner: 0, 1 or 2.
        corner: u8,
        /// The index as given.
        found: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// A corner of a triangle has a coordinate that is not a finite number.
    NotFinite {
        /// The triangle.
        triangle: u32,
        /// The index of the position.
        position: u32,
        /// The position as given.
        found: DVec3,
    },
    /// More triangles than element numbers.
    TooMany {
        /// How many triangles there are.
        found: usize,
    },
    /// The memory budget does not allow it.
    OverBudget(OverBudget),
    /// The caller stopped it.
    Stop(Stop),
}

impl From<Stop> for BvhError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<OverBudget> for BvhError {
    fn from(error: OverBudget) -> Self {
        Self::OverBudget(error)
    }
}

impl fmt::Display for BvhError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index { triangle, corner, found, positions } => write!(
                f,
                "hierarchy: triangle {triangle}, corner {corner}: found index {found}, expected one below {positions}"
            ),
            Self::NotFinite { triangle, position, found } => write!(
                f,
                "hierarchy: triangle {triangle}: found position {position} at {found}, expected finite coordinates"
            ),
            Self::TooMany { found } => {
                write!(f, "hierarchy: found {found} triangles, expected at most {}", u32::MAX - 1)
            }
            Self::OverBudget(error) => error.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
        }
    }
}

impl std::error::Error for BvhError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::OverBudget(error) => Some(error),
            Self::Stop(stop) => Some(stop),
            _ => None,
        }
    }
}

impl Diagnostic for BvhError {
    fn code(&self) -> &'static str {
        match self {
            Self::Index { .. } => "E-bvh-index",
            Self::NotFinite { .. } => "E-bvh-finite",
            Self::TooMany { .. } => "E-bvh-count",
            Self::OverBudget(error) => error.code(),
            Self::Stop(stop) => stop.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Index { .. } | Self::NotFinite { .. } => Category::Malformed,
            Self::TooMany { .. } => Category::Unsupported,
            Self::OverBudget(error) => error.category(),
            Self::Stop(stop) => stop.category(),
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::OverBudget(error) => error.advice(),
            Self::Stop(stop) => stop.advice(),
            _ => None,
        }
    }
}
