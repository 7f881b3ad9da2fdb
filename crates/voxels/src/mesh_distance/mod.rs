//! Signed distances of meshes on lattices.

mod band;
mod bins;
mod closing;
mod clusters;
mod convert;
mod fast_sweeping;
mod in_cells;
mod near_triangle;
mod open_signs;
mod rows;
mod thin;
mod turns;

#[cfg(test)]
mod tests;

pub(crate) use bins::Bins;
pub(crate) use convert::distances_in_cells;
pub use convert::{FarField, MeshToDistance};
pub(crate) use in_cells::InCells;
pub(crate) use rows::{Rows, whole_numbers};
pub(crate) use thin::lost_cells;
