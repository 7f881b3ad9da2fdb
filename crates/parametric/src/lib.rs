//! Parametric curves and surfaces.
//!
//! - [`BezierCurve`]: any degree, in the plane and in space.
//! - [`BezierPatch`], [`BezierSurface`]: tensor products of any degrees, alone and several together.

mod bezier_curve;
mod bezier_patch;
mod bezier_surface;
mod de_casteljau;
mod error;

pub use bezier_curve::BezierCurve;
pub use bezier_patch::{BezierPatch, SecondDerivativeBounds};
pub use bezier_surface::{BezierSurface, PatchSide};
pub use de_casteljau::MAX_DEGREE;
pub use error::{BezierError, TessellationError};
