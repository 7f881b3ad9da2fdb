//! Triangulation in a plane: scattered points, edges that must stay, regions with holes.
//!
//! Points of space are projected ([`ProjectionPlane`]), triangulated by exact signs on spade, which stays private to this
//! folder, and lifted back: the vertices of a result have the positions and attributes of their source, bit by bit.

use shapeloom_core::Bounds;

/// The smallest angles that may be asked for, in degrees. Beyond about 30 refinement seldom ends but by its limit on
/// vertices, and no triangle has all of its angles above 60.
const ANGLES: Bounds = Bounds::closed(0.0, 40.0);

mod constrained_delaunay;
mod constraints;
mod delaunay_triangulation;
mod error;
mod hull_border;
mod inside;
mod location;
mod mixtures;
mod order;
mod planar_region;
mod projection;
mod refine;
mod scale;
mod sheet;
mod simple_loops;
mod triangle_shape;
mod triangulate_region;
mod triangulation;
mod with_earcut;

pub use constrained_delaunay::{ConstrainedDelaunay, KeptTriangles};
pub use delaunay_triangulation::DelaunayTriangulation;
pub use error::PlaneError;
pub use planar_region::PlanarRegion;
pub use projection::ProjectionPlane;
pub use triangulate_region::{Crossings, RegionMethod, TriangulateRegion};

#[cfg(test)]
mod tests;
