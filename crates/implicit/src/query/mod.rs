//! Questions to fields: where a point lies, what a ray meets, where the surface is nearest along the gradient, curves in planes.
//!
//! They ask any [`Field`](shapeloom_core::Field) and say of each answer whether it is [proven or estimated](Certainty). What is proven
//! follows from the field's range over boxes and from its Lipschitz constant; it is as true as these are.

mod bounds;
mod certainty;
mod classify;
mod error;
mod field_rays;
mod project;
mod ray_crossings;
mod regularised;
mod root;
mod section;
mod sphere_tracing;
mod survey;

pub use certainty::{Certainty, Side};
pub use classify::{Classification, PointPlace, classify, classify_exact};
pub use error::QueryError;
pub use field_rays::FieldRays;
pub use project::{ProjectError, Projection, project};
pub use ray_crossings::{CrossingKind, RayCrossing, RayCrossings, RayIntervals};
pub use regularised::{RegularClassification, classify_regularised};
pub use section::{AdaptiveMarchingSquares, PlaneCurves, PlaneWindow, SectionError, section};
pub use sphere_tracing::{SphereTracing, TraceEnd, Traced};
