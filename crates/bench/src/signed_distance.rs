//! Signed distances, building included.

use serde_json::{Map, json};
use shapeloom_core::{ClosestPoint, Exec};
use shapeloom_spatial::SignedDistance;

use crate::surface_queries::{self, Queries};
use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let (mesh, queries) = surface_queries::load(setting)?;
    let exec = Exec::default();
    let build = || SignedDistance::build(mesh.positions(), mesh.triangles(), &exec).map_err(|error| error.to_string());
    let (distance, build_times) = measure::fastest(setting.runs, build)?;
    let mut outcomes = Vec::new();
    for Queries { name, points } in queries {
        let mut found = vec![0.0; points.len()];
        // Peers build before the clock starts.
        let ((), times) = measure::fastest(setting.runs, || {
            distance.distances(&points, &mut found, &exec).map_err(|error| error.to_string())
        })?;
        let mut closest = vec![None; points.len()];
        let ((), closest_times) = measure::fastest(setting.runs, || {
            distance.bvh().closest_points(&points, &mut closest, &exec).map_err(|error| error.to_string())
        })?;
        let mut figures = Map::new();
        figures.insert("triangles".into(), json!(mesh.triangles().len()));
        figures.insert("queries".into(), json!(points.len()));
        figures.insert("closed".into(), json!(distance.is_closed()));
        figures.insert("build_cpu_s".into(), json!(build_times.cpu));
        figures.insert("closest_cpu_s".into(), json!(closest_times.cpu));
        figures.insert("inside".into(), json!(found.iter().filter(|&&distance| distance < 0.0).count()));
        figures.insert("sum_of_distances".into(), json!(found.iter().map(|distance| distance.abs()).sum::<f64>()));
        outcomes.push(Outcome { input: name, times, figures });
    }
    Ok(outcomes)
}
