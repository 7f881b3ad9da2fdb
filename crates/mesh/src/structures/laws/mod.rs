//! What holds of every structure, tried on many meshes against truth by definition.

mod by_hand;
mod conversions;
mod homology;
mod meshes;
mod queries;
mod refusals;
mod sizes;
mod truth;
