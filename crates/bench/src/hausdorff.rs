//! The Hausdorff distance between two meshes: of nearly the same surface, and of one mesh with its vertices shaken.

use std::path::Path;

use serde_json::{Map, json};
use shapeloom_core::Exec;
use shapeloom_core::glam::DVec3;
use shapeloom_judge::{Distances, Simplices};
use shapeloom_mesh::TriMesh;

use crate::{Outcome, Setting, files, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let (first, second) = (setting.data.join("loop_250k.ply"), setting.data.join("remesh_200k.ply"));
    let mut outcomes = Vec::new();
    // The same surface, from a subdivided ball and by marching cubes.
    if first.exists() && second.exists() {
        let name = format!("{} to {}", first.display(), name_of(&second));
        outcomes.push(between(name, &files::load_triangles(&first)?, &files::load_triangles(&second)?, setting)?);
    }
    let blob = setting.data.join("blob_1m.ply");
    let mesh = files::load_triangles(&blob)?;
    outcomes.push(between(format!("{} to itself", blob.display()), &mesh, &mesh, setting)?);
    let shaken = shaken(&mesh, mesh.bounds().diagonal() * 1e-4)?;
    outcomes.push(between(format!("{} to itself shaken", blob.display()), &mesh, &shaken, setting)?);
    Ok(outcomes)
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Each vertex moved by up to `distance` along each axis.
fn shaken(mesh: &TriMesh, distance: f64) -> Result<TriMesh, String> {
    let mut state = 1u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let positions = mesh.positions().iter().map(|&position| position + DVec3::new(draw(), draw(), draw()) * distance);
    TriMesh::try_new(positions.collect(), mesh.triangles().to_vec()).map_err(|error| error.to_string())
}

fn between(input: String, a: &TriMesh, b: &TriMesh, setting: &Setting) -> Result<Outcome, String> {
    let shapes = [a, b].map(Simplices::from);
    let (found, times) = measure::fastest(setting.runs, || {
        Distances::new().hausdorff(&shapes[0], &shapes[1], &Exec::default()).map_err(|error| error.to_string())
    })?;
    let diagonal = a.bounds().diagonal();
    let ways = [&found.a_to_b, &found.b_to_a];
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(a.triangles().len() + b.triangles().len()));
    figures.insert("lower_of_diagonal".into(), json!(found.lower() / diagonal));
    figures.insert("upper_of_diagonal".into(), json!(found.upper() / diagonal));
    figures.insert("converged".into(), json!(found.converged()));
    figures.insert("queries".into(), json!(ways.map(|way| way.queries)));
    figures.insert("splits".into(), json!(ways.map(|way| way.splits)));
    figures.insert("rounds".into(), json!(ways.map(|way| way.rounds)));
    Ok(Outcome { input, times, figures })
}
