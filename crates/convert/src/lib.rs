//! From one representation to another: the registry of converters, the planner, and the conversion of whole shapes.
//!
//! - [`registry`]: every converter of the workspace, by name, with its options.
//! - [`plan`]: the way from one kind to another.
//! - [`convert_shape`]: runs a plan on every part of a shape, with the account of each step and its [`Timings`].

mod catalog;
mod error;
mod plan;
mod registry;
mod run;

pub use catalog::catalog;
pub use error::PlanError;
pub use plan::{Plan, Wish, plan};
pub use registry::{Converter, Effect, Request, converter, registry};
pub use run::{Conversion, Job, Step, Timings, convert_shape};
