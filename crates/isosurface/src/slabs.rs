//! Samples that come slab by slab.

use shapeloom_core::ConvertError;

use crate::{Inside, Lattice};

/// Samples on a lattice, given slab by slab.
///
/// Slabs are asked for in any order, some more than once, and from several threads. A sample that is NaN or infinite counts as outside.
pub trait Slabs: Sync {
    /// Where the samples are.
    fn lattice(&self) -> &Lattice;

    /// The samples of slab `k`, `i` fastest: those in memory where they are single precision, else `buffer`, filled.
    ///
    /// # Errors
    /// The slab cannot be had: a file that breaks off, for instance.
    fn slab<'a>(&'a self, k: u32, buffer: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError>;

    /// On which side of the iso value the inside is, if it is not said. Distances are negative inside; densities grow there.
    fn inside(&self) -> Inside {
        Inside::Below
    }

    /// The iso value if none is given; none where only the samples can tell.
    fn default_iso(&self) -> Option<f64> {
        Some(0.0)
    }
}
