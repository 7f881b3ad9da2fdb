//! A million scattered points in the plane to triangles.

use std::collections::HashMap;

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::predicates::in_circle;
use shapeloom_core::{Convert, Exec};
use shapeloom_mesh::{DelaunayTriangulation, PointCloud, TriMesh};

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Outcome, String> {
    let path = setting.data.join("pts2d.f64");
    let (input, points) = match path.exists() {
        true => {
            let name = path.display().to_string();
            let bytes = std::fs::read(&path).map_err(|error| format!("{name}: {error}"))?;
            let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(|&bytes| f64::from_le_bytes(bytes)).collect();
            (name, numbers.as_chunks().0.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect())
        }
        false => ("points of a formula".to_owned(), spread(2000)),
    };
    let cloud = PointCloud::new(points);
    let work = || {
        let found = DelaunayTriangulation::new().convert_with(&cloud, &Exec::default());
        found.map_err(|error| error.to_string())
    };
    let (converted, times) = measure::fastest(setting.runs, work)?;
    let mesh = &converted.value;
    let edges = edges(mesh);
    let mut figures = Map::new();
    figures.insert("points".into(), json!(cloud.positions().len()));
    figures.insert("vertices".into(), json!(mesh.positions().len()));
    figures.insert("triangles".into(), json!(mesh.triangles().len()));
    figures.insert("boundary_edges".into(), json!(edges.values().filter(|[_, other]| *other == NONE).count()));
    figures.insert("euler".into(), json!(mesh.positions().len() + mesh.triangles().len() - edges.len()));
    figures.insert(
        "edges_not_delaunay".into(),
        json!(edges.iter().filter(|(edge, apexes)| !is_delaunay(mesh, **edge, **apexes)).count()),
    );
    figures.insert("area".into(), json!(mesh.area()));
    figures.insert("points_per_cpu_s".into(), json!(cloud.positions().len() as f64 / times.cpu));
    Ok(Outcome { input, times, figures })
}

/// Points without regularity, by the fractional parts of multiples of two irrational numbers.
fn spread(count: u32) -> Vec<DVec3> {
    let part = |k: u32, step: f64| (f64::from(k) * step).fract();
    (0..count).map(|k| DVec3::new(part(k, 2f64.sqrt()), part(k, 3f64.sqrt()), 0.0)).collect()
}

const NONE: u32 = u32::MAX;

/// Every edge with the third corners of the triangles at it.
fn edges(mesh: &TriMesh) -> HashMap<[u32; 2], [u32; 2]> {
    let mut edges: HashMap<[u32; 2], [u32; 2]> = HashMap::with_capacity(mesh.triangles().len() * 3 / 2);
    for &[a, b, c] in mesh.triangles() {
        for (from, to, apex) in [(a, b, c), (b, c, a), (c, a, b)] {
            let apexes = edges.entry([from.min(to), from.max(to)]).or_insert([apex, NONE]);
            if apexes[0] != apex {
                apexes[1] = apex;
            }
        }
    }
    edges
}

/// Whether the circle of the triangle on one side of an edge leaves the corner on the other side out: if that is so of
/// all edges, it is so of all points.
fn is_delaunay(mesh: &TriMesh, [a, b]: [u32; 2], [c, d]: [u32; 2]) -> bool {
    if d == NONE {
        return true;
    }
    let [a, b, c, d] = [a, b, c, d].map(|vertex| mesh.positions()[vertex as usize].truncate());
    let (a, b) = if (b - a).perp_dot(c - a) > 0.0 { (a, b) } else { (b, a) };
    in_circle(a, b, c, d).is_le()
}
