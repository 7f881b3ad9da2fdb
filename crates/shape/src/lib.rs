//! The dynamic shape: what files hold and pictures show, whatever its representation.
//!
//! A [`Shape`] is a list of [`Part`]s. A part places a [`Geometry`] in space and may name it and give it a material; parts
//! that share a geometry are instances. [`Kind`] tells representations apart where code must choose one by name, and
//! [`Family`] groups them as the crates do.

mod geometry;
mod kind;
mod material;
mod shape;
mod table;
mod units;

pub use geometry::{Geometry, Representation, WrongKind};
pub use kind::{Family, Kind};
pub use material::Material;
pub use shape::{Part, Shape};
pub use table::Table;
pub use units::{UnitError, Units, UpAxis};
