//! Generalised winding numbers, building included.

use serde_json::{Map, json};
use shapeloom_core::Exec;
use shapeloom_spatial::WindingTree;

use crate::surface_queries::{self, Queries};
use crate::{Outcome, Setting, measure};

/// How many queries are compared with the exact sum.
const SAMPLES: usize = 200;

pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let (mesh, queries) = surface_queries::load(setting)?;
    let exec = Exec::default();
    let build = || WindingTree::build(mesh.positions(), mesh.triangles(), &exec).map_err(|error| error.to_string());
    let mut outcomes = Vec::new();
    for Queries { name, points } in queries {
        let (_, build_times) = measure::fastest(setting.runs, build)?;
        let ((tree, numbers), times) = measure::fastest(setting.runs, || {
            let tree = build()?;
            let mut numbers = vec![0.0; points.len()];
            tree.winding_numbers(&points, &mut numbers, &exec).map_err(|error| error.to_string())?;
            Ok((tree, numbers))
        })?;
        let step = (points.len() / SAMPLES).max(1);
        let sample = points.iter().zip(&numbers).step_by(step);
        let errors: Vec<f64> =
            sample.map(|(&point, number)| (number - tree.winding_number_exact(point).value).abs()).collect();
        let mut figures = Map::new();
        figures.insert("triangles".into(), json!(tree.len()));
        figures.insert("queries".into(), json!(points.len()));
        figures.insert("build_cpu_s".into(), json!(build_times.cpu));
        figures.insert("inside".into(), json!(numbers.iter().filter(|&&number| number > 0.5).count()));
        figures.insert("mean_error".into(), json!(errors.iter().sum::<f64>() / errors.len().max(1) as f64));
        figures.insert("max_error".into(), json!(errors.iter().copied().fold(0.0, f64::max)));
        for tolerance in [0.45, 0.01] {
            let mut widest = 0.0f64;
            let sample: Vec<_> = points.iter().step_by((points.len() / 20_000).max(1)).collect();
            let (_, times) = measure::fastest(1, || {
                for &&point in &sample {
                    widest = widest.max(tree.winding_number_within(point, tolerance).bound);
                }
                Ok(())
            })?;
            figures.insert(format!("within_{tolerance}_us"), json!(times.cpu / sample.len() as f64 * 1e6));
            figures.insert(format!("within_{tolerance}_bound"), json!(widest));
        }
        outcomes.push(Outcome { input: name, times, figures });
    }
    Ok(outcomes)
}
