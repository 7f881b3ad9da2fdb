//! Polygons as triangles, where a question is about triangles.

use shapeloom_core::{Convert, Exec, OverBudget, Stop};
use shapeloom_mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom_spatial::BvhError;

use crate::JudgeError;

/// The triangles of polygons, in the order of the polygons.
pub(crate) fn triangulated(mesh: &PolyMesh, exec: &Exec) -> Result<TriMesh, JudgeError> {
    TriangulatePolygons::new().convert_with(mesh, exec).map(|converted| converted.value).map_err(|error| {
        let stop = error.narrow::<Stop>().copied().map(JudgeError::Stop);
        let memory = error.narrow::<OverBudget>().copied().map(JudgeError::OverBudget);
        stop.or(memory).unwrap_or(JudgeError::Bvh(BvhError::TooMany { found: mesh.triangle_count() }))
    })
}
