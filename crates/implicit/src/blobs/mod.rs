//! Sums of many blobs: each adds to a density that falls with the distance to its centre, and the surface is where the sum reaches a
//! threshold.
//!
//! [`Blobs`] holds the blobs and the field: `threshold - sum`, so that it is negative inside as all fields here. Within, every blob is a
//! [`Term`](term::Term) that ends at a finite reach, and a [`Hierarchy`](hierarchy::Hierarchy) finds the few that reach a point or box.

mod batch;
mod error;
mod field;
mod form;
mod hierarchy;
mod slopes;
mod sum;
mod term;
#[cfg(test)]
mod tests;

pub use error::BlobsError;
pub use field::Blobs;
pub use form::{Blob, BlobForm};
