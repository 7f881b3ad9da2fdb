//! Why something cannot be judged.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Bounds, Category, Diagnostic, OverBudget, Stop, VectorWords, Words};
use shapeloom_spatial::BvhError;

/// Why something cannot be judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JudgeError {
    /// A position that is not finite.
    NotFinite {
        /// The vertex.
        vertex: u32,
        /// Its position as given.
        found: DVec3,
    },
    /// A coordinate so small beside the shape's size that exact arithmetic would underflow.
    Underflow {
        /// The vertex.
        vertex: u32,
        /// Its position as given.
        found: DVec3,
        /// The largest coordinate of the shape in magnitude.
        largest: f64,
    },
    /// A point that is asked about is not finite, or so small beside the shape that exact arithmetic would underflow.
    Query {
        /// The point as given.
        found: DVec3,
    },
    /// A shape without triangles has no distance from anything.
    NothingToCompare {
        /// 0 for the first shape, 1 for the second.
        shape: usize,
    },
    /// A sample of a shape that stands for nothing.
    Sample {
        /// Its number.
        sample: u64,
        /// What is wrong with it: its position, weight, radius, or the distance of its closest point.
        name: &'static str,
        /// The number as given.
        found: f64,
    },
    /// An option out of range.
    OutOfBounds {
        /// The option.
        name: &'static str,
        /// Its value.
        found: f64,
        /// What it accepts.
        bounds: Bounds,
    },
    /// No hierarchy could be built over the triangles.
    Bvh(BvhError),
    /// The memory budget does not allow it.
    OverBudget(OverBudget),
    /// The caller stopped it.
    Stop(Stop),
}

impl From<BvhError> for JudgeError {
    fn from(error: BvhError) -> Self {
        Self::Bvh(error)
    }
}

impl From<OverBudget> for JudgeError {
    fn from(error: OverBudget) -> Self {
        Self::OverBudget(error)
    }
}

impl From<Stop> for JudgeError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl fmt::Display for JudgeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { vertex, found } => {
                write!(f, "judge: vertex {vertex}: found position {}, expected finite coordinates", VectorWords(*found))
            }
            Self::Underflow { vertex, found, largest } => write!(
                f,
                "judge: vertex {vertex}: found position {}, expected no coordinate so small beside the largest, {largest:e}, \
                 that its products vanish",
                VectorWords(*found)
            ),
            Self::Query { found } => write!(
                f,
                "judge: found a query at {}, expected finite coordinates, none so small that their products vanish",
                VectorWords(*found)
            ),
            Self::NothingToCompare { shape } => {
                let which = if *shape == 0 { "first" } else { "second" };
                write!(f, "distance: the {which} shape: found nothing, expected a triangle, segment or point")
            }
            Self::Sample { sample, name: name @ "position", found } => {
                write!(f, "distance: sample {sample}: {name}: found {}, expected finite coordinates", Words(*found))
            }
            Self::Sample { sample, name, found } => write!(
                f,
                "distance: sample {sample}: {name}: found {}, expected a finite number that is not negative",
                Words(*found)
            ),
            Self::OutOfBounds { name, found, bounds } => {
                write!(f, "judge: option {name}: found {}, expected {bounds}", Words(*found))
            }
            Self::Bvh(error) => error.fmt(f),
            Self::OverBudget(error) => error.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
        }
    }
}

impl std::error::Error for JudgeError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Bvh(error) => Some(error),
            Self::OverBudget(error) => Some(error),
            Self::Stop(stop) => Some(stop),
            _ => None,
        }
    }
}

impl Diagnostic for JudgeError {
    fn code(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } => "E-judge-finite",
            Self::Underflow { .. } => "E-judge-underflow",
            Self::Query { .. } => "E-judge-query",
            Self::NothingToCompare { .. } => "E-distance-empty",
            Self::Sample { .. } => "E-distance-sample",
            Self::OutOfBounds { .. } => "E-option-range",
            Self::Bvh(error) => error.code(),
            Self::OverBudget(error) => error.code(),
            Self::Stop(stop) => stop.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::NotFinite { .. } => Category::Malformed,
            Self::Underflow { .. } => Category::Unsupported,
            Self::Query { .. } => Category::Usage,
            Self::NothingToCompare { .. } => Category::Unsupported,
            Self::Sample { .. } => Category::Malformed,
            Self::OutOfBounds { .. } => Category::Usage,
            Self::Bvh(error) => error.category(),
            Self::OverBudget(error) => error.category(),
            Self::Stop(stop) => stop.category(),
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::NotFinite { .. } => Some("leave such vertices out with --drop-non-finite".into()),
            Self::Underflow { .. } => Some("set coordinates that small to 0".into()),
            Self::Query { .. } => None,
            Self::NothingToCompare { .. } | Self::Sample { .. } | Self::OutOfBounds { .. } => None,
            Self::Bvh(error) => error.advice(),
            Self::OverBudget(error) => error.advice(),
            Self::Stop(stop) => stop.advice(),
        }
    }
}
