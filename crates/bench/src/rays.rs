//! A million rays on a million triangles: the first hit, and whether there is one.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Ray, Rays};
use shapeloom_spatial::TriangleBvh;

use crate::queries::{Queries, on_sphere, rays, scene, spread};
use crate::{Outcome, Setting, measure};

/// The build, then random rays from outside and a camera's rays.
pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let scene = scene(setting)?;
    let random = |index: u32| {
        let origin = on_sphere(index, 0) * 3.0;
        let target = DVec3::new(spread(index, 3), spread(index, 5), spread(index, 8)) * 2.4 - 1.2;
        (origin, target - origin)
    };
    let camera = |index: u32| {
        let target =
            DVec3::new(f64::from(index % 100), f64::from(index / 100), 0.0) * 0.024 - DVec3::new(1.2, 1.2, 0.0);
        let eye = DVec3::new(0.3, 0.2, 4.0);
        (eye, target - eye)
    };
    let sets =
        [("random", rays(setting, "rays_random.f32", random)?), ("camera", rays(setting, "rays_camera.f32", camera)?)];
    let (bvh, times) = measure::fastest(setting.runs, || scene.hierarchy())?;
    let mut figures = Map::new();
    figures.insert("triangles".into(), json!(bvh.len()));
    let mut outcomes = vec![Outcome { input: scene.input("build"), times, figures }];
    for (name, rays) in &sets {
        for outcome in on_rays(setting, &bvh, rays)? {
            let Outcome { input, times, figures } = outcome;
            outcomes.push(Outcome { input: scene.input(&format!("{name} {input}")), times, figures });
        }
    }
    Ok(outcomes)
}

fn on_rays(setting: &Setting, bvh: &TriangleBvh, rays: &Queries<Ray>) -> Result<[Outcome; 2], String> {
    let exec = Exec::default();
    let items = &rays.items;
    let mut hits = vec![None; items.len()];
    let ((), first) =
        measure::fastest(setting.runs, || bvh.first_hits(items, &mut hits, &exec).map_err(|stop| stop.to_string()))?;
    let mut met = vec![false; items.len()];
    let ((), any) =
        measure::fastest(setting.runs, || bvh.any_hits(items, &mut met, &exec).map_err(|stop| stop.to_string()))?;
    let figures = |hits: usize, times: measure::Times| {
        let mut figures = Map::new();
        figures.insert("triangles".into(), json!(bvh.len()));
        figures.insert("rays".into(), json!(items.len()));
        figures.insert("rays_from".into(), json!(rays.source));
        figures.insert("hits".into(), json!(hits));
        figures.insert("mrays_per_cpu_s".into(), json!(items.len() as f64 / 1e6 / times.cpu));
        figures
    };
    let mut of_first = figures(hits.iter().flatten().count(), first);
    of_first.insert("sum_t".into(), json!(hits.iter().flatten().map(|hit| hit.distance).sum::<f64>()));
    let of_any = figures(met.iter().filter(|&&met| met).count(), any);
    Ok([
        Outcome { input: "first".into(), times: first, figures: of_first },
        Outcome { input: "any".into(), times: any, figures: of_any },
    ])
}
