//! The faces of a mesh of a million triangles that meet each other.

use serde_json::{Map, json};
use shapeloom_core::{Convert, Exec};
use shapeloom_judge::self_intersections;
use shapeloom_mesh::{TriMesh, TriangulatePolygons};
use shapeloom_shape::Geometry;

use crate::{Outcome, Setting, files, measure};

pub(crate) fn run(setting: &Setting) -> Result<Outcome, String> {
    let path = setting.data.join("blob_1m.ply");
    let (shape, ..) = files::load(&path)?;
    let mesh: TriMesh = match shape.parts.first().map(|part| &*part.geometry) {
        Some(Geometry::TriMesh(mesh)) => mesh.clone(),
        Some(Geometry::PolyMesh(mesh)) => {
            TriangulatePolygons::new().convert(mesh).map_err(|error| error.to_string())?.value
        }
        _ => return Err(format!("{}: found no mesh", path.display())),
    };
    let (found, times) = measure::fastest(setting.runs, || {
        self_intersections(&mesh, 1000, &Exec::default()).map_err(|error| error.to_string())
    })?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("crossing".into(), json!(found.crossing.total));
    figures.insert("overlapping".into(), json!(found.overlapping.total));
    figures.insert("touching".into(), json!(found.touching.total));
    figures.insert("triangles_per_cpu_s".into(), json!(mesh.triangles().len() as f64 / times.cpu));
    Ok(Outcome { input: path.display().to_string(), times, figures })
}
