//! The foundation that every shapeloom crate stands on.
//!
//! - **Space**: [`Aabb`], [`Interval`], [`Affine`], [`Frame`], rotations, [`Camera`], [`Ray`], [`predicates`].
//! - **Conversion**: [`Convert`], [`Converted`], [`Report`], [`Deviation`], [`Tolerance`], [`FromTolerance`].
//! - **Options**: the [`options!`] macro declares a struct whose fields can be listed, set and read by name.
//! - **Execution**: [`Exec`] carries progress, cancellation, a memory budget and the number of threads; [`parallel`]
//!   has the fixed-chunk helpers that give the same bits for any number of threads.
//! - **Trouble**: [`Diagnostic`], [`Category`], [`ConvertError`], [`Findings`], [`Place`], [`Limits`].
//! - **Capabilities**, the traits in which families of shapes meet: [`Field`], [`Curve`], [`Surface`], [`Rays`],
//!   [`ClosestPoint`], [`Warp`].
//!
//! Conventions: a right-handed frame, counter-clockwise front faces with normals outward, implicits negative inside,
//! angles in radians, positions in `f64`.

pub mod capability;
pub mod parallel;
pub mod predicates;

mod aabb;
mod affine;
mod camera;
mod convert;
mod diagnostic;
mod exec;
mod findings;
mod frame;
mod homogeneous;
mod interval;
mod limits;
mod number_words;
mod options;
mod place;
mod ray;
mod report;
mod rotation;
mod tolerance;

pub use aabb::Aabb;
pub use affine::{Affine, AffineClass, SingularMap};
pub use camera::{Camera, CameraError, Projection, Screen};
pub use capability::{
    Closest, ClosestPoint, Curve, Field, Hit, Rays, Restricted, Surface, SurfaceJet, VectorSpace, Warp,
};
pub use convert::{Convert, Converted, FromTolerance};
pub use diagnostic::{Category, ConvertError, Diagnostic};
pub use exec::{CancelFlag, Exec, OverBudget, Reservation, Stop, Threads};
pub use findings::{Finding, Findings, Severity};
pub use frame::{Frame, FrameError};
pub use glam;
pub use homogeneous::{Combination, Homogeneous, HomogeneousError};
pub use interval::Interval;
pub use limits::Limits;
pub use number_words::{VectorWords, Words};
#[doc(hidden)]
pub use options::declare::private as options_private;
pub use options::{Bounds, ChoiceOption, OptionError, OptionKind, OptionSpec, OptionType, OptionValue, Options};
pub use place::Place;
pub use ray::{Ray, RayError};
pub use report::{Deviation, Figure, Loss, Report};
pub use rotation::{AxisAngle, RotationError, YawPitchRoll};
pub use tolerance::{Tolerance, ToleranceError};
