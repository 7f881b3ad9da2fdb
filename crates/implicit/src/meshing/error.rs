//! Why a field cannot be sampled.

use std::fmt;

use shapeloom_core::{Aabb, Category, Diagnostic};

/// Why a field cannot be sampled.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshingError {
    /// The shape reaches the end of the space that was searched, or nothing is known of its values there.
    Unbounded {
        /// What was searched.
        searched: Aabb,
        /// The axis along which the shape does not end: 0, 1, 2.
        axis: usize,
        /// Whether it does not end towards larger coordinates.
        upward: bool,
    },
    /// A region that is no box with finite sides above 0.
    Region {
        /// What was given.
        found: Aabb,
    },
}

impl fmt::Display for MeshingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unbounded { searched, axis, upward } => {
                let end = if *upward { searched.max[*axis] } else { searched.min[*axis] };
                let axis = ["x", "y", "z"].get(*axis).unwrap_or(&"?");
                write!(
                    f,
                    "implicit: found no proof that the shape ends before {axis} = {end:e}, expected a bounded shape"
                )
            }
            Self::Region { found } => write!(
                f,
                "implicit: found the region from {} to {}, expected finite corners, each coordinate of the first below that of the second",
                found.min, found.max
            ),
        }
    }
}

impl std::error::Error for MeshingError {}

impl Diagnostic for MeshingError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unbounded { .. } => "E-implicit-unbounded",
            Self::Region { .. } => "E-implicit-region",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Unbounded { .. } => Category::Unsupported,
            Self::Region { .. } => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        matches!(self, Self::Unbounded { .. })
            .then(|| "say where to look, as region=x0,y0,z0,x1,y1,z1: the shape is cut off there".into())
    }
}
