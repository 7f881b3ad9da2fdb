//! Voxels: samples and cells on a lattice.

mod cell_faces;
mod error;
mod full_cells;
mod morton;
mod octree;
mod samples;
mod sparse_bricks;
mod voxel_grid;

pub use cell_faces::CellFaces;
pub use error::VoxelError;
pub use octree::{Octree, OctreeCounts};
pub use samples::Samples;
pub use shapeloom_isosurface as isosurface;
pub use sparse_bricks::SparseBricks;
pub use voxel_grid::{Quantity, SampleRange, VoxelGrid};
