//! Half-edges of a mesh of a million triangles, and a sweep over the one-rings.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Stop, parallel};
use shapeloom_mesh::structures::{Incidence, IndexedTriangles, TriangleHalfEdges, VertexId};

use crate::{Outcome, Setting, files, measure};

/// Builds them from the triangles.
pub(crate) fn build(setting: &Setting) -> Result<Outcome, String> {
    let (mesh, input) = files::blob(setting)?;
    // The builder takes the triangles by value: a copy of twelve bytes a triangle is part of the work.
    let work = || {
        TriangleHalfEdges::try_build(IndexedTriangles::from(&mesh), &Exec::default()).map_err(|error| error.to_string())
    };
    let (built, times) = measure::fastest(setting.runs, work)?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("bytes_per_triangle".into(), json!(built.memory_bytes() as f64 / mesh.triangles().len() as f64));
    figures.insert("triangles_per_cpu_s".into(), json!(mesh.triangles().len() as f64 / times.cpu));
    Ok(Outcome { input, times, figures })
}

/// Sums a coordinate over all neighbours of all vertices, and makes normals of all vertices from the triangles around
/// them.
pub(crate) fn sweep(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let (mesh, input) = files::blob(setting)?;
    let built = TriangleHalfEdges::try_build(IndexedTriangles::from(&mesh), &Exec::default())
        .map_err(|error| error.to_string())?;
    let positions = mesh.positions();
    let exec = Exec::default();
    let around = |vertex: usize| built.one_ring(VertexId(vertex as u32)).map(|near| positions[near.index()].x).sum();
    let work = || parallel::sum(&exec, positions.len(), around).map_err(|stop| stop.to_string());
    let (total, times) = measure::fastest(setting.runs, work)?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("sum".into(), json!(total));
    let sum = Outcome { input: format!("{input}: sum"), times, figures };

    // Twice the area of each triangle weighs its normal.
    let normal = |vertex: usize| {
        let center = positions[vertex];
        let mut ring = built.one_ring(VertexId(vertex as u32)).map(|near| positions[near.index()] - center);
        let Some(first) = ring.next() else { return DVec3::ZERO };
        let (mut last, mut sum) = (first, DVec3::ZERO);
        for edge in ring {
            sum += last.cross(edge);
            last = edge;
        }
        if !built.is_border(VertexId(vertex as u32)) {
            sum += last.cross(first);
        }
        sum.normalize_or_zero()
    };
    let work = || {
        let mut normals = vec![DVec3::ZERO; positions.len()];
        parallel::fill_chunks(&exec, &mut normals, parallel::CHUNK, |start, normals| {
            for (i, out) in normals.iter_mut().enumerate() {
                *out = normal(start + i);
            }
            Ok::<_, Stop>(())
        })
        .map_err(|stop| stop.to_string())?;
        Ok(normals)
    };
    let (normals, times) = measure::fastest(setting.runs, work)?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("outward".into(), json!(outward(&normals, positions)));
    Ok(vec![sum, Outcome { input: format!("{input}: normals"), times, figures }])
}

/// The share of normals that look away from the origin, which the blob is around.
fn outward(normals: &[DVec3], positions: &[DVec3]) -> f64 {
    let count = normals.iter().zip(positions).filter(|(normal, position)| normal.dot(**position) > 0.0).count();
    count as f64 / normals.len() as f64
}
