//! The traits in which families of shapes meet.
//!
//! A family takes another's shape only through one of these: a tree of implicits holds any [`Field`], free-form
//! deformation takes any [`Warp`], pictures are made from anything with [`Rays`]. Each trait is one capability with few
//! required methods and a batch form, and each has laws that are tested on every implementor.

mod closest_point;
mod curve;
mod field;
mod rays;
mod surface;
mod warp;

pub use closest_point::{Closest, ClosestPoint};
pub use curve::{Curve, VectorSpace};
pub use field::{Field, Restricted};
pub use rays::{Hit, Rays};
pub use surface::{Surface, SurfaceJet};
pub use warp::Warp;
