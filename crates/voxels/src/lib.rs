//! Voxels: samples and cells on a lattice.

mod cubes;
#[cfg(test)]
mod fixtures;
mod losses;
mod mesh_distance;
mod points_to_grid;
mod sample_field;
mod cell_faces;
mod error;
mod full_cells;
mod grid_field;
mod level_set;
mod morton;
mod octree;
mod samples;
mod sparse_bricks;
mod voxel_grid;
mod voxelize;
mod voxelize_error;

pub use mesh_distance::{FarField, MeshToDistance};
pub use points_to_grid::{PointWeight, PointsToGrid};
pub use sample_field::sample_field;
pub use cell_faces::CellFaces;
pub use error::VoxelError;
pub use grid_field::{GridField, Interpolation};
pub use level_set::{
    Blend, CurvatureFlow, OffsetLevelSet, Redistance, blend, blend_bands, curvature_flow_band, redistance_band,
};
pub use octree::{Octree, OctreeCounts};
pub use samples::Samples;
pub use shapeloom_isosurface as isosurface;
pub use sparse_bricks::SparseBricks;
pub use voxel_grid::{Quantity, SampleRange, VoxelGrid};
pub use voxelize::{CellRule, VoxelizeMesh, VoxelizeMode};
pub use voxelize_error::VoxelizeError;
