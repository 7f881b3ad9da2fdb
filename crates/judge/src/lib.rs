//! Decides whether a result is sound.
//!
//! The judge shares nothing with what it judges but the lowest floors, and is itself held against brute force in exact
//! arithmetic. Every answer that says "no" comes with a witness: the elements that show it.

mod check;
mod columns;
mod cycle;
mod distance;
mod equal_positions;
mod error;
mod faces;
mod measures;
mod mesh_ref;
mod polygon;
mod scaled;
mod segments;
mod self_intersection;
mod solid;
mod topology;
mod triangulated;
mod union_find;

pub use check::{NotPolyhedron, Profile, RULES, Rule, Shell, Verdict};
pub use distance::{
    DirectedHausdorff, Distances, Estimate, Hausdorff, MeanDistance, MeanDistances, Measured, Sample, Sampled, Samples,
    SimplexCells, Simplices, Witness, distance_from_samples, distances_from_samples,
};
pub use error::JudgeError;
pub use faces::Faces;
pub use measures::Measures;
pub use mesh_ref::MeshRef;
pub use polygon::{NotConvex, PolygonReport};
pub use scaled::Scaled;
pub use self_intersection::{
    FacePair, PairKind, PairList, SelfIntersections, self_intersections, self_intersections_of_polygons,
};
pub use solid::{Location, Solid};
pub use topology::{BoundaryLoops, Component, Topology};
