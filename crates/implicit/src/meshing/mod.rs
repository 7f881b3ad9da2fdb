//! Implicit shapes to triangles, by samples on a lattice.

mod error;
mod find_bounds;
mod measured;
mod normals;
mod pruned_field;
mod refine;
mod region;
mod sampled_surface;
#[cfg(test)]
mod tests;

pub use error::MeshingError;
pub use find_bounds::{FoundBounds, find_bounds};
pub use pruned_field::PrunedField;
pub use region::Region;
pub use sampled_surface::{SampledSurface, SurfaceMethod};
