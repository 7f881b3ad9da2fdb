//! The topology report of a mesh of a million triangles.

use serde_json::{Map, json};
use shapeloom_core::Exec;
use shapeloom_judge::Topology;

use crate::{Outcome, Setting, files, measure};

pub(crate) fn run(setting: &Setting) -> Result<Outcome, String> {
    let (mesh, input) = files::blob(setting)?;
    let work = || Topology::of(&mesh, &Exec::default()).map_err(|error| error.to_string());
    let (found, times) = measure::fastest(setting.runs, work)?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("edges".into(), json!(found.edges));
    figures.insert("components".into(), json!(found.components.len()));
    figures.insert("boundary_edges".into(), json!(found.boundary.edges().len()));
    figures.insert("manifold".into(), json!(found.is_manifold()));
    figures.insert("triangles_per_cpu_s".into(), json!(mesh.triangles().len() as f64 / times.cpu));
    Ok(Outcome { input, times, figures })
}
