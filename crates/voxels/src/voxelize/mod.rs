//! Which cells a mesh fills.

mod box_overlap;
mod cells;
mod convert;

#[cfg(test)]
mod tests;

pub use convert::{CellRule, VoxelizeMesh, VoxelizeMode};
