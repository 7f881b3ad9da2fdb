//! Closest points of a million triangles: from near the surface, and from anywhere in a box.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{ClosestPoint, Exec};

use crate::queries::{Queries, on_sphere, points, scene, spread};
use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let scene = scene(setting)?;
    let near = points(setting, "qry_surface.f32", |index| on_sphere(index, 0) * (0.99 + 0.02 * spread(index, 3)))?;
    let in_box = |index: u32| DVec3::new(spread(index, 0), spread(index, 1), spread(index, 3)) * 3.0 - 1.5;
    let Queries { items, source } = points(setting, "qry_box.f32", in_box)?;
    let far = Queries { items: items.into_iter().step_by(10).collect(), source };
    let bvh = scene.hierarchy()?;
    let mut outcomes = Vec::new();
    for (name, queries) in [("near", near), ("box", far)] {
        let mut found = vec![None; queries.items.len()];
        let ((), times) = measure::fastest(setting.runs, || {
            bvh.closest_points(&queries.items, &mut found, &Exec::default()).map_err(|stop| stop.to_string())
        })?;
        let mut figures = Map::new();
        figures.insert("triangles".into(), json!(bvh.len()));
        figures.insert("queries".into(), json!(queries.items.len()));
        figures.insert("queries_from".into(), json!(queries.source));
        let sum = found.iter().flatten().map(|closest| closest.distance_squared.sqrt()).sum::<f64>();
        figures.insert("sum_d".into(), json!(sum));
        figures.insert("us_per_query".into(), json!(times.cpu * 1e6 / queries.items.len() as f64));
        outcomes.push(Outcome { input: scene.input(name), times, figures });
    }
    Ok(outcomes)
}
