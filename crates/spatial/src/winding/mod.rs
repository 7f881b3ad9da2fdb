//! Generalised winding numbers of triangles.

mod arctangent;
mod batch;
mod bounded;
mod build;
mod cluster;
mod far;
mod near;
mod pack;
mod reference;
mod side;
mod sum;
mod tree;
mod walk;

#[cfg(test)]
mod bound_tests;
#[cfg(test)]
mod size_tests;
#[cfg(test)]
mod tests;

pub use reference::{WindingNumber, generalized_winding_number};
pub use tree::WindingTree;

pub(crate) use batch::along_curve;
