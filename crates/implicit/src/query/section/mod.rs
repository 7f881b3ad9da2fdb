//! Curves where a plane meets the surface of a field.

mod cells;
mod chains;
mod convert;
mod error;
mod plane;
#[cfg(test)]
mod tests;

pub use convert::{AdaptiveMarchingSquares, PlaneCurves, section};
pub use error::SectionError;
pub use plane::PlaneWindow;
