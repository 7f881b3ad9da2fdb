//! Implicit shapes: fields that are negative inside, zero on the surface and positive outside.
//!
//! A [`Tree`] says what a shape is: formulas, solids, sets, blends, bent space, fields from elsewhere. [`Tree::compile`] makes a
//! [`Program`] of it, which evaluators run: [`PointEvaluator`] in double precision with derivatives, [`BatchEvaluator`] for many points in
//! single precision, [`IntervalEvaluator`] for proven bounds over boxes. A program is a [`Field`](shapeloom_core::Field) too, and
//! [`SampledSurface`] makes triangles of any field.

#[cfg(test)]
mod laws;
mod meshing;
mod operator;
mod power;
mod program;
mod shapes;
mod tree;

pub use meshing::{FoundBounds, MeshingError, PrunedField, Region, SampledSurface, SurfaceMethod, find_bounds};
pub use operator::{Binary, Choice, Dual, Enclosure, Unary};
pub use program::{BatchEvaluator, CompileError, IntervalEvaluator, ParameterError, PointEvaluator, Program, Trace};
pub use shapes::{Blend, BlendForm, Domain, Primitive, Quadric, SetOperation};
pub use tree::{Axis, Foreign, Meaning, Nature, Operation, Tree, post_order};
