//! Polygons as triangles, where a question is about triangles.

use shapeloom_core::{Convert, Exec, OverBudget, Stop};
use shapeloom_mesh::{Column, Domain, PolyMesh, TriMesh, TriangulatePolygons, Values};
use shapeloom_spatial::BvhError;

use crate::JudgeError;

/// The triangles of polygons, in the order of the polygons, and the polygon of each.
pub(crate) fn triangulated(mesh: &PolyMesh, exec: &Exec) -> Result<(TriMesh, Vec<u32>), JudgeError> {
    let (starts, corners) = (mesh.face_starts(), mesh.wedge_vertices());
    let _memory = exec.reserve(mesh.memory_bytes() as u64)?;
    let faces = mesh.face_count() as u32;
    // What a mesh was made of makes one again; the labels tell the polygon of each triangle.
    let too_many = JudgeError::Bvh(BvhError::TooMany { found: mesh.triangle_count() });
    let plain = PolyMesh::try_new(mesh.positions().to_vec(), starts.to_vec(), corners.to_vec());
    let mut plain = plain.map_err(|_| too_many)?;
    plain.insert_attribute(Domain::Face, Column::labels("polygon", (0..faces).collect())).map_err(|_| too_many)?;
    let mut cut = TriangulatePolygons::new().convert_with(&plain, exec).map_err(|error| {
        let stop = error.narrow::<Stop>().copied().map(JudgeError::Stop);
        let memory = error.narrow::<OverBudget>().copied().map(JudgeError::OverBudget);
        stop.or(memory).unwrap_or(too_many)
    })?;
    match cut.value.remove_attribute(Domain::Face, "polygon").map(|column| column.values().clone()) {
        Some(Values::U32(owners)) => Ok((cut.value, owners)),
        _ => Err(too_many),
    }
}
