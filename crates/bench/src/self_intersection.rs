//! The faces of a mesh of a million triangles that meet each other.

use serde_json::{Map, json};
use shapeloom_core::Exec;
use shapeloom_judge::self_intersections;

use crate::{Outcome, Setting, files, measure};

pub(crate) fn run(setting: &Setting) -> Result<Outcome, String> {
    let (mesh, input) = files::blob(setting)?;
    let (found, times) = measure::fastest(setting.runs, || {
        self_intersections(&mesh, 1000, &Exec::default()).map_err(|error| error.to_string())
    })?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("crossing".into(), json!(found.crossing.total));
    figures.insert("overlapping".into(), json!(found.overlapping.total));
    figures.insert("touching".into(), json!(found.touching.total));
    figures.insert("triangles_per_cpu_s".into(), json!(mesh.triangles().len() as f64 / times.cpu));
    Ok(Outcome { input, times, figures })
}
