//! Why there is no picture.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, OptionError, OverBudget, Stop};
use shapeloom_spatial::BvhError;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderError {
    /// The scene has no triangle.
    Empty,
    /// A width, height or other option is out of range.
    Option(OptionError),
    /// A list of a mesh has a length that does not fit its triangles.
    Length {
        /// The mesh's place in the scene.
        mesh: usize,
        /// Which list.
        list: &'static str,
        /// Its length.
        found: usize,
        /// The length that fits.
        expected: usize,
    },
    /// A triangle names a position that does not exist.
    Index {
        /// The mesh's place in the scene.
        mesh: usize,
        /// The triangle.
        triangle: usize,
        /// The index as given.
        found: u32,
        /// How many positions there are.
        positions: usize,
    },
    /// A corner of a triangle has a coordinate that is not a finite number, or the scene is too large for numbers.
    NotFinite {
        /// The mesh's place in the scene.
        mesh: usize,
        /// The index of the position.
        position: u32,
        /// The position as given.
        found: DVec3,
    },
    /// More triangles or positions than element numbers.
    TooMany {
        /// How many triangles or positions there are.
        found: usize,
    },
    /// An up direction without a length.
    Up {
        /// The direction as given.
        found: DVec3,
    },
    /// The picture could not be encoded.
    Encode {
        /// What the encoder says.
        message: String,
    },
    /// The memory budget does not allow it.
    OverBudget(OverBudget),
    /// The caller stopped it.
    Stop(Stop),
}

impl From<OptionError> for RenderError {
    fn from(error: OptionError) -> Self {
        Self::Option(error)
    }
}

impl From<OverBudget> for RenderError {
    fn from(error: OverBudget) -> Self {
        Self::OverBudget(error)
    }
}

impl From<Stop> for RenderError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<BvhError> for RenderError {
    fn from(error: BvhError) -> Self {
        match error {
            BvhError::Index { triangle, found, positions, .. } => {
                Self::Index { mesh: 0, triangle: triangle as usize, found, positions }
            }
            BvhError::NotFinite { position, found, .. } => Self::NotFinite { mesh: 0, position, found },
            BvhError::TooMany { found } => Self::TooMany { found },
            BvhError::OverBudget(error) => Self::OverBudget(error),
            BvhError::Stop(stop) => Self::Stop(stop),
        }
    }
}

impl fmt::Display for RenderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("picture: found no triangle, expected something to draw"),
            Self::Option(error) => error.fmt(f),
            Self::Length { mesh, list, found, expected } => {
                write!(f, "picture: mesh {mesh}: found {found} {list}, expected {expected}")
            }
            Self::Index { mesh, triangle, found, positions } => write!(
                f,
                "picture: mesh {mesh}, triangle {triangle}: found index {found}, expected one below {positions}"
            ),
            Self::NotFinite { mesh, position, found } => write!(
                f,
                "picture: mesh {mesh}: found position {position} at {found}, expected finite coordinates below 1e150"
            ),
            Self::TooMany { found } => {
                write!(f, "picture: found {found} elements, expected at most {}", u32::MAX - 1)
            }
            Self::Up { found } => write!(f, "picture: found the up direction {found}, expected one with a length"),
            Self::Encode { message } => write!(f, "picture: cannot be encoded: {message}"),
            Self::OverBudget(error) => error.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
        }
    }
}

impl std::error::Error for RenderError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Option(error) => Some(error),
            Self::OverBudget(error) => Some(error),
            Self::Stop(stop) => Some(stop),
            _ => None,
        }
    }
}

impl Diagnostic for RenderError {
    fn code(&self) -> &'static str {
        match self {
            Self::Empty => "E-render-empty",
            Self::Option(error) => error.code(),
            Self::Length { .. } => "E-render-length",
            Self::Index { .. } => "E-render-index",
            Self::NotFinite { .. } => "E-render-finite",
            Self::TooMany { .. } => "E-render-count",
            Self::Up { .. } => "E-render-up",
            Self::Encode { .. } => "E-render-encode",
            Self::OverBudget(error) => error.code(),
            Self::Stop(stop) => stop.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Empty => Category::Failed,
            Self::Option(error) => error.category(),
            Self::Length { .. } | Self::Index { .. } | Self::NotFinite { .. } => Category::Malformed,
            Self::TooMany { .. } => Category::Unsupported,
            Self::Up { .. } => Category::Usage,
            Self::Encode { .. } => Category::CannotWrite,
            Self::OverBudget(error) => error.category(),
            Self::Stop(stop) => stop.category(),
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::OverBudget(_) => Some("ask for a smaller picture, or raise the memory limit".into()),
            Self::Stop(stop) => stop.advice(),
            _ => None,
        }
    }
}
