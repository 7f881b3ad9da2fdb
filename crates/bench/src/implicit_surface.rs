//! Implicits to triangles: with samples left out where bounds settle the sign, and without.

use serde_json::{Map, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Convert, Exec};
use shapeloom_implicit::{Program, Region, SampledSurface, Tree};

use crate::{Outcome, Setting, measure};

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let side = f64::from(setting.size.clamp(2, 256));
    // Files of fidget's, extruded where they are plane by the region they are looked at in.
    let region = Aabb::from_corners(DVec3::splat(-1.0), DVec3::ONE);
    let mut fields = vec![("a plate with 1000 parts".to_owned(), parts()?)];
    for name in ["prospero.vm", "colonnade.vm"] {
        if let Ok(text) = std::fs::read_to_string(setting.data.join(name)) {
            fields.push((name.to_owned(), super::field_eval::program(name, &text)?));
        }
    }
    let mut outcomes = Vec::new();
    for (name, field) in fields {
        for prune in [true, false] {
            let converter =
                SampledSurface { region: Region::Box(region), prune, refine: false, ..SampledSurface::new(2.0 / side) };
            let work = || converter.convert_with(&field, &Exec::default()).map_err(|error| error.to_string());
            let (made, times) = measure::fastest(setting.runs, work)?;
            let mut figures = Map::new();
            figures.insert("steps".into(), json!(field.len()));
            figures.insert("triangles".into(), json!(made.value.triangles().len()));
            figures.insert("samples".into(), json!(made.report.find("samples")));
            figures.insert("evaluations".into(), json!(made.report.find("evaluations")));
            let way = if prune { "pruned" } else { "all samples" };
            outcomes.push(Outcome { input: format!("{name}: {way}"), times, figures });
        }
    }
    Ok(outcomes)
}

/// A plate with 500 bosses, each with a hole.
fn parts() -> Result<Program, String> {
    let at = |n: u32| (f64::from(n % 25) * 0.075 - 0.9, f64::from(n / 25) * 0.09 - 0.85);
    let post = |radius: f64, height: f64, n: u32| Tree::cylinder(radius, height).translate(at(n).0, at(n).1, 0.1);
    let plate = Tree::cuboid(1.9, 1.9, 0.2);
    let bosses = Tree::union_of((0..500).map(|n| post(0.03, 0.3 + f64::from(n % 7) * 0.03, n)));
    let holes = Tree::union_of((0..500).map(|n| post(0.017, 1.0, n)));
    plate.union(bosses).difference(holes).compile().map_err(|error| error.to_string())
}
