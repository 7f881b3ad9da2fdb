//! Why grids cannot be used.

use std::fmt;

use shapeloom_core::glam::{DVec2, Vec3Swizzles};
use shapeloom_core::{Category, Diagnostic};
use shapeloom_isosurface::Lattice;

/// Why a grid, an octree or bricks cannot be made or used.
#[derive(Clone, Debug, PartialEq)]
pub enum VoxelError {
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
    NotCubes,
    /// More samples in a direction than the structure can address.
    TooLarge {
        /// The structure.
        structure: &'static str,
        /// The samples in each direction.
        dimensions: [u32; 3],
        /// The most in a direction.
        most: u32,
    },
    /// Two grids that lie on different lattices.
    Lattices(
        /// The first and the second.
        Box<[Lattice; 2]>,
    ),
    /// A sample that is NaN or infinite where only numbers will do.
    NotFinite {
        /// Where it is in the lattice.
        sample: [u32; 3],
        /// What was found.
        found: f32,
    },
    /// A lattice that is one sample thick, so that it has no cells.
    Thin {
        /// The samples in each direction.
        dimensions: [u32; 3],
    },
    /// A number that single precision does not hold.
    Overflow {
        /// What the number is.
        what: &'static str,
        /// What was found.
        found: f64,
    },
    /// More steps than one run may take.
    Steps {
        /// The steps that it would take.
        found: f64,
        /// The most that are taken.
        most: u32,
    },
    /// Bits of an octree that end before the tree does.
    OctreeEnds {
        /// How many bits there are.
        bits: u64,
    },
    /// Eight equal leaves, which the code never has.
    OctreeEqual {
        /// The first bit after them.
        bit: u64,
    },
    /// Something behind the last node.
    OctreeTrails {
        /// The first bit behind it.
        bit: u64,
    },
}

impl fmt::Display for VoxelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Position { element } => write!(f, "position {element} is not finite, expected numbers"),
            Self::CellSize { found, cells, expected } => {
                write!(f, "found a cell size of {found:e} for {cells:.4e} cells, expected {expected}")
            }
            Self::NotCubes => f.write_str("found a lattice with other steps, expected cubes along the axes"),
            Self::TooLarge { structure, dimensions: [x, y, z], most } => {
                write!(f, "{structure}: found {x} x {y} x {z} samples, expected at most {most} in a direction")
            }
            Self::Lattices(both) => {
                let [first, second] = both.each_ref().map(Named);
                write!(f, "two grids: found {first}, and {second}, expected one lattice in one place")
            }
            Self::NotFinite { sample: [i, j, k], found } => {
                write!(f, "grid: sample ({i}, {j}, {k}): found {found}, expected a finite number")
            }
            Self::Overflow { what, found } => {
                write!(f, "grid: found {what} of {found:e}, expected one that single precision holds")
            }
            Self::Thin { dimensions: [x, y, z] } => {
                write!(f, "level set: found {x} x {y} x {z} samples, expected at least two in each direction")
            }
            Self::Steps { found, most } => {
                write!(f, "curvature flow: found a need of {found:e} steps, expected at most {most}")
            }
            Self::OctreeEnds { bits } => write!(f, "octree: found the end after bit {bits}, expected more nodes"),
            Self::OctreeEqual { bit } => {
                write!(f, "octree: bit {bit}: found eight equal leaves, expected one leaf in their place")
            }
            Self::OctreeTrails { bit } => write!(f, "octree: bit {bit}: found more, expected zeros up to a whole byte"),
        }
    }
}

/// A lattice in words.
struct Named<'a>(&'a Lattice);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.dimensions();
        let origin = self.0.placement().translation;
        let [a, b, c] = self.0.steps();
        let along_axes = a.yz() == DVec2::ZERO && b.xz() == DVec2::ZERO && c.xy() == DVec2::ZERO;
        write!(f, "{x} x {y} x {z} samples from {origin} ")?;
        match along_axes {
            true => write!(f, "in steps of {} x {} x {}", a.x, b.y, c.z),
            false => write!(f, "in steps of {a}, {b} and {c}"),
        }
    }
}

impl std::error::Error for VoxelError {}

impl Diagnostic for VoxelError {
    fn code(&self) -> &'static str {
        match self {
            Self::Position { .. } => "E-voxels-position",
            Self::CellSize { .. } => "E-voxels-cells",
            Self::NotCubes => "E-voxels-cubes",
            Self::TooLarge { .. } => "E-voxels-size",
            Self::Lattices { .. } => "E-voxels-lattices",
            Self::NotFinite { .. } => "E-voxels-finite",
            Self::Overflow { .. } => "E-voxels-overflow",
            Self::Steps { .. } => "E-voxels-steps",
            Self::Thin { .. } => "E-voxels-thin",
            Self::OctreeEnds { .. } => "E-octree-end",
            Self::OctreeEqual { .. } => "E-octree-equal",
            Self::OctreeTrails { .. } => "E-octree-trailing",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::TooLarge { .. } | Self::Steps { .. } | Self::CellSize { .. } => Category::OverLimit,
            Self::Lattices(_) | Self::Overflow { .. } | Self::NotCubes => Category::Usage,
            Self::Thin { .. } => Category::Unsupported,
            _ => Category::Malformed,
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::CellSize { .. } => {
                Some("choose another cell size, resolution, margin or radius, or scale or move the shape".into())
            }
            Self::Lattices(_) => Some("sample both on one lattice".into()),
            Self::Steps { .. } => Some("ask for less time, or a coarser grid".into()),
            _ => None,
        }
    }
}
