//! Voxels: samples and cells on a lattice.

mod samples;
mod voxel_grid;

pub use samples::Samples;
pub use shapeloom_isosurface as isosurface;
pub use voxel_grid::{Quantity, SampleRange, VoxelGrid};
