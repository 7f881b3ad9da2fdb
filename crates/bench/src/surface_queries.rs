//! The mesh and the points of the tasks that ask a surface.

use std::path::Path;
use std::sync::Arc;

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;
use shapeloom_mesh::TriMesh;

use crate::{Setting, files};

/// Points to ask about, and what they are called.
pub(crate) struct Queries {
    pub(crate) name: String,
    pub(crate) points: Vec<DVec3>,
}

/// blob_1m.ply, points near it (`qry_surface.f32`) and every tenth of those in its box (`qry_box.f32`). Where a file of
/// points is missing a few points in the mesh's box stand for it.
pub(crate) fn load(setting: &Setting) -> Result<(Arc<TriMesh>, [Queries; 2]), String> {
    let (mesh, _) = files::blob(setting)?;
    let mesh = Arc::new(mesh);
    let near = points(&setting.data, "qry_surface.f32", 1, &mesh.bounds())?;
    let around = points(&setting.data, "qry_box.f32", 10, &mesh.bounds())?;
    Ok((mesh, [near, around]))
}

fn points(folder: &Path, file: &str, step: usize, bounds: &Aabb) -> Result<Queries, String> {
    let path = folder.join(file);
    let name = path.display().to_string();
    if !path.exists() {
        let points = (0..1000).map(|i| {
            let fraction = DVec3::new(0.618, 0.755, 0.57) * f64::from(i);
            bounds.min + bounds.size() * (fraction - fraction.floor())
        });
        return Ok(Queries { name: format!("{name} (missing)"), points: points.collect() });
    }
    let bytes = std::fs::read(&path).map_err(|error| format!("{name}: {error}"))?;
    let number = |bytes: &[u8]| bytes.try_into().map_or(f64::NAN, |bytes| f64::from(f32::from_le_bytes(bytes)));
    let points = bytes.chunks_exact(12).step_by(step);
    let points = points.map(|p| DVec3::new(number(&p[..4]), number(&p[4..8]), number(&p[8..]))).collect();
    Ok(Queries { name, points })
}
