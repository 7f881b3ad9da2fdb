//! The operations that know what they mean: solids, sets, blends, bent space.

mod blend;
mod domain;
mod parameter;
mod primitive;
mod profile;
mod quadric;
mod set;
mod stretch;

pub use blend::{Blend, BlendForm};
pub use domain::Domain;
pub use parameter::ParameterError;
pub(crate) use parameter::{finite, finite_vector, not_negative, positive};
pub use primitive::Primitive;
pub use quadric::Quadric;
pub use set::SetOperation;
pub(crate) use stretch::stretches;
