//! Signed distances of meshes on lattices.

mod band;
mod bins;
mod convert;
mod fast_sweeping;
mod in_cells;
mod near_triangle;
mod open_signs;
mod rows;
mod steepness;
mod thin;

#[cfg(test)]
mod tests;

pub(crate) use bins::Bins;
pub use convert::{FarField, MeshToDistance};
pub(crate) use convert::{corner_bounds, distances_in_cells};
pub(crate) use in_cells::InCells;
pub(crate) use rows::{Rows, whole_numbers};
pub(crate) use thin::lost_cells;
