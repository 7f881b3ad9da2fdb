//! Height fields to few triangles: greedy insertion into a Delaunay triangulation.
//!
//! - `lattice_delaunay`: a constrained Delaunay triangulation of points with whole coordinates, exact; it knows no heights.
//! - `outline`: which cells are whole, and the outline of the holes as edges of the triangulation.
//! - `difference`: the largest difference between a triangle and the bilinear surface above it, in closed form.
//! - `twisted_cell`: cells that two triangles cannot follow closely enough.
//! - `converter`: the converter and its loop.

mod converter;
mod difference;
mod lattice_delaunay;
mod outline;
#[cfg(test)]
mod tests;
mod twisted_cell;

pub use converter::GreedyInsertion;
