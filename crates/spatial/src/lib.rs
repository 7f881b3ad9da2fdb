//! Spatial structures over slices of points and triangles.
//!
//! They know no mesh type: a structure is built from positions and index triples, keeps the copies it needs, and answers
//! through the capabilities of the foundation, [`Rays`](shapeloom_core::Rays) and
//! [`ClosestPoint`](shapeloom_core::ClosestPoint). [`WindingTree`] tells inside from outside; [`SignedDistance`] is a
//! [`Field`](shapeloom_core::Field).
//!
//! ```
//! use shapeloom_core::glam::DVec3;
//! use shapeloom_core::{ClosestPoint, Exec, Ray, Rays};
//! use shapeloom_spatial::TriangleBvh;
//!
//! let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
//! let bvh = TriangleBvh::build(&positions, &[[0, 1, 2]], &Exec::default())?;
//! let ray = Ray::new(DVec3::new(0.25, 0.25, 2.0), DVec3::NEG_Z).expect("a direction with a length");
//! assert_eq!(bvh.first_hit(&ray).map(|hit| hit.distance), Some(2.0));
//! assert_eq!(bvh.closest(DVec3::new(0.25, 0.25, -3.0)).map(|found| found.distance_squared), Some(9.0));
//! # Ok::<(), shapeloom_spatial::BvhError>(())
//! ```

mod batch_order;
mod box_pairs;
mod box_queries;
mod closed;
mod closest_point;
mod equal_triangles;
mod error;
#[cfg(test)]
mod fixtures;
mod hierarchy;
#[cfg(test)]
mod leak_tests;
mod rays;
mod scaled_input;
mod signed_distance;
mod space_order;
mod stack;
mod triangle_block;
mod triangle_box;
mod triangle_bvh;
mod triangle_octree;
mod triangle_point;
mod triangle_ray;
mod wide_node;
mod winding;

pub use box_pairs::BoxPairs;
pub use closed::is_closed;
pub use error::BvhError;
pub use signed_distance::{InsideRule, SignedClosest, SignedDistance};
pub use triangle_bvh::TriangleBvh;
pub use triangle_octree::TriangleOctree;
pub use winding::{WindingNumber, WindingTree, generalized_winding_number};
