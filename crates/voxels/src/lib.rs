//! Voxels: samples and cells on a lattice.

mod cubes;
#[cfg(test)]
mod fixtures;
mod losses;
mod mesh_distance;
mod points_to_grid;
mod sample_field;
mod samples;
mod voxel_grid;
mod voxelize;
mod voxelize_error;

pub use mesh_distance::{FarField, MeshToDistance};
pub use points_to_grid::{PointWeight, PointsToGrid};
pub use sample_field::sample_field;
pub use samples::Samples;
pub use shapeloom_isosurface as isosurface;
pub use voxel_grid::{Quantity, SampleRange, VoxelGrid};
pub use voxelize::{CellRule, VoxelizeMesh, VoxelizeMode};
pub use voxelize_error::VoxelizeError;
