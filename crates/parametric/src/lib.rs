//! Parametric curves and surfaces.
//!
//! - [`BezierCurve`]: any degree, in the plane and in space.
//! - [`BezierPatch`], [`BezierSurface`]: tensor products of any degrees, alone and several together.
//! - [`TessellateCurve`], [`TessellatePatches`]: to polylines and triangles, with a proven chord error.

mod bezier_curve;
mod bezier_patch;
mod bezier_surface;
mod bounds;
mod curvature_net;
mod de_casteljau;
mod error;
mod tessellate_curve;
mod tessellate_patches;

pub use bezier_curve::BezierCurve;
pub use bezier_patch::{BezierPatch, SecondDerivativeBounds};
pub use bezier_surface::{BezierSurface, PatchSide};
pub use de_casteljau::MAX_DEGREE;
pub use error::{BezierError, TessellationError};
pub use tessellate_curve::TessellateCurve;
pub use tessellate_patches::TessellatePatches;
