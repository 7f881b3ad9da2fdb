//! Decides whether a result is sound.
//!
//! The judge shares nothing with what it judges but the lowest floors, and is itself held against brute force in exact
//! arithmetic. Every answer that says "no" comes with a witness: the elements that show it.

mod error;
mod scaled;
mod self_intersection;

pub use error::JudgeError;
pub use scaled::Scaled;
pub use self_intersection::{
    FacePair, PairKind, PairList, SelfIntersections, self_intersections, self_intersections_of_polygons,
};
