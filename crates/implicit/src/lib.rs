//! Implicit shapes: fields that are negative inside, zero on the surface and positive outside.
//!
//! A [`Tree`] says what a shape is: formulas, solids, sets, blends, bent space, fields from elsewhere. [`Tree::compile`] makes a
//! [`Program`] of it, which evaluators run: [`PointEvaluator`] in double precision with derivatives, [`BatchEvaluator`] for many points in
//! single precision, [`IntervalEvaluator`] for proven bounds over boxes. A program is a [`Field`](shapeloom_core::Field) too, and
//! [`SampledSurface`] makes triangles of any field.

mod blobs;
mod curve_distance;
mod implicit;
#[cfg(test)]
mod laws;
mod meshing;
mod molecule;
mod operator;
mod power;
mod program;
mod query;
mod shapes;
mod text;
mod tree;

pub use blobs::{Blob, BlobForm, Blobs, BlobsError};
pub use curve_distance::{CurveDistance, CurveError};
pub use implicit::{BoundsError, Implicit};
pub use meshing::{FoundBounds, MeshingError, PrunedField, Region, SampledSurface, SurfaceMethod, find_bounds};
pub use molecule::{Atom, AtomBlobs, Element, Molecule};
pub use operator::{Binary, Choice, Dual, Enclosure, Unary};
pub use program::{BatchEvaluator, CompileError, IntervalEvaluator, ParameterError, PointEvaluator, Program, Trace};
pub use query::{
    AdaptiveMarchingSquares, Certainty, Classification, CrossingKind, FieldRays, PlaneCurves, PlaneWindow, PointPlace,
    ProjectError, Projection, QueryError, RayCrossing, RayCrossings, RayIntervals, RegularClassification, SectionError,
    Side, SphereTracing, TraceEnd, Traced, classify, classify_exact, classify_regularised, project, section,
};
pub use shapes::{Blend, BlendForm, Domain, Primitive, Quadric, SetOperation};
pub use text::{
    ForeignCall, Parsed, ResolveError, Resolved, Resolver, TextError, TextProblem, VmError, VmProblem, VmWriteError,
    parse, parse_vm, print_vm, to_text,
};
pub use tree::{Axis, Foreign, Meaning, Nature, Operation, Tree, post_order};
