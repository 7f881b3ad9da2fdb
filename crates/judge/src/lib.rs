//! Decides whether a result is sound.
//!
//! The judge shares nothing with what it judges but the lowest floors, and is itself held against brute force in exact
//! arithmetic. Every answer that says "no" comes with a witness: the elements that show it.

mod distance;
mod error;
mod scaled;

pub use distance::{
    DirectedHausdorff, Distances, Estimate, Hausdorff, MeanDistance, Measured, Sample, Simplices, Witness,
    distance_from_samples,
};
pub use error::JudgeError;
pub use scaled::Scaled;
