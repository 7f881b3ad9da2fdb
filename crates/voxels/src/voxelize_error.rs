//! Why a shape does not become voxels.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

/// Why a shape does not become voxels.
#[derive(Clone, Debug, PartialEq)]
pub enum VoxelizeError {
    /// A position that is not finite.
    Position {
        /// Which vertex or point.
        element: u64,
    },
    /// A cell size with which distances leave single precision, or samples have no places of their own.
    CellSize {
        /// The cell size.
        found: f64,
        /// How many cells the longest side of the shape's box has with it.
        cells: f64,
        /// What is expected of cells.
        expected: &'static str,
    },
    /// A lattice that is not one of cubes along the axes.
    Lattice,
}

impl fmt::Display for VoxelizeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position { element } => write!(f, "position {element} is not finite, expected numbers"),
            Self::CellSize { found, cells, expected } => {
                write!(f, "found a cell size of {found:e} for {cells:.4e} cells, expected {expected}")
            }
            Self::Lattice => f.write_str("found a lattice with other steps, expected cubes along the axes"),
        }
    }
}

impl std::error::Error for VoxelizeError {}

impl Diagnostic for VoxelizeError {
    fn code(&self) -> &'static str {
        match self {
            Self::Position { .. } => "E-voxel-position",
            Self::CellSize { .. } => "E-voxel-cell-size",
            Self::Lattice => "E-voxel-lattice",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Position { .. } => Category::Malformed,
            Self::CellSize { .. } => Category::OverLimit,
            Self::Lattice => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        matches!(self, Self::CellSize { .. })
            .then(|| "choose another cell size, resolution, margin or radius, or scale or move the shape".into())
    }
}
