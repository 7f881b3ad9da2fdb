//! Where a mesh meets itself: every pair of faces that share more than corners and sides, told exactly.

mod equal_faces;
mod flat;
mod kind;
mod pair;
mod polygons;
mod search;
mod section;
mod tally;
mod thin;
mod triangle;

pub use kind::{FacePair, PairKind};
pub use polygons::self_intersections_of_polygons;
pub use search::self_intersections;
pub use tally::{PairList, SelfIntersections};
