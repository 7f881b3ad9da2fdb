//! Implicit shapes in the notation of fidget's `.vm` files, evaluated at many points and over many boxes, beside fidget's interpreter
//! (fidget-core 0.5, without its JIT compiler) in the same run.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use fidget_core::Context;
use fidget_core::shape::EzShape;
use fidget_core::types::Interval;
use fidget_core::vm::VmShape;
use serde_json::{Map, Value, json};
use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;
use shapeloom_implicit::{BatchEvaluator, Binary, IntervalEvaluator, Program, Tree, Unary};

use crate::{Outcome, Setting, measure};

/// A shape, compiled by both.
struct Model {
    name: String,
    ours: Program,
    theirs: VmShape,
    /// Half the side of the cube in which it lies.
    reach: f64,
}

/// The `.vm` files of the folder; without one, a small formula.
fn models(setting: &Setting) -> Result<Vec<Model>, String> {
    let files = std::fs::read_dir(&setting.data).map_err(|error| format!("{}: {error}", setting.data.display()))?;
    let mut paths: Vec<PathBuf> = files.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "vm"));
    paths.sort();
    if paths.is_empty() {
        let ring = "x var-x\ny var-y\nz var-z\na square x\nb square y\nc add a b\nd sqrt c\ne sub d z\nf max e x\n";
        return Ok(vec![model("a small formula", ring)?]);
    }
    let load = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        model(&path.file_name().unwrap_or_default().to_string_lossy(), &text)
    };
    paths.iter().map(load).collect()
}

pub(crate) fn program(name: &str, text: &str) -> Result<Program, String> {
    let tree = tree(text).map_err(|line| format!("{name}: line {line}: found something else than an operation"))?;
    tree.compile().map_err(|error| format!("{name}: {error}"))
}

fn model(name: &str, text: &str) -> Result<Model, String> {
    let ours = program(name, text)?;
    let (context, root) = Context::from_text(text.as_bytes()).map_err(|error| format!("{name}: {error}"))?;
    let theirs = VmShape::new(&context, root).map_err(|error| format!("{name}: {error}"))?;
    let stem = Path::new(name).file_stem().unwrap_or_default();
    let reach = if stem == "bear" || stem == "tanglecube" || stem == "colonnade" { 4.0 } else { 1.0 };
    Ok(Model { name: name.to_owned(), ours, theirs, reach })
}

/// The tree that the last line names; else the number of the line that cannot be read.
fn tree(text: &str) -> Result<Tree, usize> {
    let mut known: HashMap<&str, Tree> = HashMap::new();
    let mut last = Err(0);
    for (number, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().collect();
        let [name, operation, operands @ ..] = words.as_slice() else { continue };
        if name.starts_with('#') {
            continue;
        }
        let of = |k: usize| operands.get(k).and_then(|operand| known.get(operand)).cloned();
        let tree = match *operation {
            "var-x" => Some(Tree::x()),
            "var-y" => Some(Tree::y()),
            "var-z" => Some(Tree::z()),
            "const" => operands.first().and_then(|number| number.parse::<f64>().ok()).map(Tree::constant),
            other => match (Unary::from_name(other), Binary::from_name(other)) {
                (Some(operator), _) => of(0).map(|a| a.unary(operator)),
                (_, Some(operator)) => of(0).zip(of(1)).map(|(a, b)| a.binary(operator, b)),
                _ => None,
            },
        };
        let tree = tree.ok_or(number + 1)?;
        known.insert(name, tree.clone());
        last = Ok(tree);
    }
    last
}

fn figures(model: &Model, of: &str, count: usize, ours: measure::Times, theirs: measure::Times) -> Map<String, Value> {
    let mut figures = Map::new();
    figures.insert(of.into(), json!(count));
    figures.insert("steps".into(), json!(model.ours.len()));
    figures.insert("registers".into(), json!(model.ours.register_count()));
    figures.insert("ns_each".into(), json!(ours.cpu / count as f64 * 1e9));
    figures.insert("fidget_cpu_s".into(), json!(theirs.cpu));
    figures.insert("fidget_over_ours".into(), json!(theirs.cpu / ours.cpu));
    figures
}

/// Values at the points of a lattice, row by row.
pub(crate) fn points(setting: &Setting) -> Result<Vec<Outcome>, String> {
    const SIDE: usize = 128;
    let mut outcomes = Vec::new();
    for model in models(setting)? {
        let at = |i: usize| ((i as f64 + 0.5) / SIDE as f64 * 2.0 - 1.0) * model.reach;
        let slabs = if model.ours.len() > 1000 { 1 } else { 8 };
        let indices: Vec<[usize; 3]> =
            (0..SIDE * SIDE * slabs).map(|n| [n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE * 16]).collect();
        let along = |axis: usize| indices.iter().map(|index| at(index[axis]) as f32).collect::<Vec<f32>>();
        let (x, y, z) = (along(0), along(1), along(2));
        // The same points, but no coordinate the same along a batch.
        let mixed = |values: &[f32]| (0..values.len()).map(|n| values[n * 7919 % values.len()]).collect::<Vec<f32>>();
        let scattered = [mixed(&x), mixed(&y), mixed(&z)];
        for (way, [x, y, z]) in [("rows", [x, y, z]), ("scattered", scattered)] {
            let mut found = vec![0.0_f32; x.len()];
            let mut evaluator = BatchEvaluator::new();
            let ((), ours) = measure::fastest(setting.runs, || {
                evaluator.values(&model.ours, DVec3::ZERO, &x, &y, &z, &mut found);
                Ok(())
            })?;
            let mut theirs: Option<measure::Times> = None;
            let mut expected = Vec::new();
            // The batch that suits it best.
            for batch in [256, 1024, 4096] {
                let tape = model.theirs.ez_float_slice_tape();
                let mut evaluator = VmShape::new_float_slice_eval();
                let (values, times) = measure::fastest(setting.runs, || {
                    let mut values = Vec::with_capacity(x.len());
                    for ((x, y), z) in x.chunks(batch).zip(y.chunks(batch)).zip(z.chunks(batch)) {
                        let out = evaluator.eval(&tape, x, y, z).map_err(|error| error.to_string())?;
                        values.extend_from_slice(out);
                    }
                    Ok(values)
                })?;
                theirs = Some(theirs.filter(|best| best.cpu < times.cpu).unwrap_or(times));
                expected = values;
            }
            let Some(theirs) = theirs else { continue };
            let close = |a: f32, b: f32| {
                (a - b).abs() <= 1e-4 * (1.0 + a.abs().max(b.abs())) || a == b || (a.is_nan() && b.is_nan())
            };
            let differ = found.iter().zip(&expected).filter(|&(&a, &b)| !close(a, b)).count();
            let mut figures = figures(&model, "points", x.len(), ours, theirs);
            figures.insert("differ".into(), json!(differ));
            outcomes.push(Outcome { input: format!("{}: {way}", model.name), times: ours, figures });
        }
    }
    Ok(outcomes)
}

/// Bounds over the boxes of a regular division, and what is left of the program there.
pub(crate) fn boxes(setting: &Setting) -> Result<Vec<Outcome>, String> {
    const SIDE: usize = 16;
    let mut outcomes = Vec::new();
    for model in models(setting)? {
        let at = |i: usize| (i as f64 / SIDE as f64 * 2.0 - 1.0) * model.reach;
        let layers = if model.ours.len() > 1000 { 1 } else { SIDE };
        let count = SIDE * SIDE * layers;
        let ends = |n: usize| [n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE].map(|i| [at(i), at(i + 1)]);
        let regions: Vec<Aabb> = (0..count)
            .map(|n| {
                let [x, y, z] = ends(n);
                Aabb::from_corners(DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1]))
            })
            .collect();
        let tape = model.theirs.ez_interval_tape();
        for simplifying in [false, true] {
            let (decided, ours) = measure::fastest(setting.runs, || {
                let mut evaluator = IntervalEvaluator::new();
                let mut inner = IntervalEvaluator::new();
                let mut decided = 0;
                for region in &regions {
                    let (bounds, trace) = evaluator.bounds(&model.ours, region);
                    let known = bounds.is_negative() || bounds.is_positive();
                    decided += usize::from(known);
                    if simplifying && !known && trace.decides() {
                        let simpler = model.ours.simplified(trace);
                        decided += usize::from(inner.bounds(&simpler, region).0.is_positive());
                    }
                }
                Ok(decided)
            })?;
            let (decided_there, theirs) = measure::fastest(setting.runs, || {
                let mut evaluator = VmShape::new_interval_eval();
                let mut inner = VmShape::new_interval_eval();
                let mut decided = 0;
                for n in 0..count {
                    let [x, y, z] = ends(n).map(|[lo, hi]| Interval::new(lo as f32, hi as f32));
                    let (bounds, trace) = evaluator.eval(&tape, x, y, z).map_err(|error| error.to_string())?;
                    let known = bounds.upper() < 0.0 || bounds.lower() > 0.0;
                    decided += usize::from(known);
                    if let (true, false, Some(trace)) = (simplifying, known, trace) {
                        let simpler = model.theirs.ez_simplify(trace).map_err(|error| error.to_string())?;
                        let tape = simpler.ez_interval_tape();
                        let (bounds, _) = inner.eval(&tape, x, y, z).map_err(|error| error.to_string())?;
                        decided += usize::from(bounds.lower() > 0.0);
                    }
                }
                Ok(decided)
            })?;
            let mut figures = figures(&model, "boxes", count, ours, theirs);
            figures.insert("decided".into(), json!(decided));
            figures.insert("decided_by_fidget".into(), json!(decided_there));
            let way = if simplifying { "bounds, simplified, bounds" } else { "bounds" };
            outcomes.push(Outcome { input: format!("{}: {way}", model.name), times: ours, figures });
        }
    }
    Ok(outcomes)
}
