//! Voxels: samples and cells on a lattice.

mod cell_faces;
mod cubes;
mod error;
#[cfg(test)]
mod fixtures;
mod full_cells;
mod grid_field;
mod level_set;
mod losses;
mod mesh_distance;
mod morton;
mod octree;
mod points_to_grid;
mod sample_field;
mod samples;
mod sparse_bricks;
mod voxel_grid;
mod voxelize;
mod waves;

pub use cell_faces::CellFaces;
pub use error::VoxelError;
pub use grid_field::{GridField, Interpolation};
pub use level_set::{
    Blend, CurvatureFlow, OffsetLevelSet, Redistance, blend, blend_bands, curvature_flow_band, redistance_band,
};
pub use mesh_distance::{FarField, MeshToDistance};
pub use octree::{Octree, OctreeCounts};
pub use points_to_grid::{PointWeight, PointsToGrid};
pub use sample_field::sample_field;
pub use samples::Samples;
pub use shapeloom_isosurface as isosurface;
pub use sparse_bricks::SparseBricks;
pub use voxel_grid::{Quantity, VoxelGrid};
pub use voxelize::{CellRule, VoxelizeMesh, VoxelizeMode};
