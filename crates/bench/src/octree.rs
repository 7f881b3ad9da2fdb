//! An octree over a million triangles beside the hierarchy, and a grid to an octree of octants and back.

use serde_json::{Map, Value, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec, Ray, Rays};
use shapeloom_isosurface::{Inside, Lattice, Level};
use shapeloom_spatial::TriangleOctree;
use shapeloom_voxels::{Octree, Quantity, Samples, VoxelGrid};

use crate::queries::{on_sphere, rays, scene, spread};
use crate::{Outcome, Setting, measure};

/// Boxes that are asked for.
const BOXES: u32 = 10_000;

/// The build of both, rays and boxes on both, and the grid.
pub(crate) fn run(setting: &Setting) -> Result<Vec<Outcome>, String> {
    let scene = scene(setting)?;
    let exec = Exec::default();
    let build = || {
        TriangleOctree::build(scene.mesh.positions(), scene.mesh.triangles(), &exec).map_err(|error| error.to_string())
    };
    let (tree, tree_times) = measure::fastest(setting.runs, build)?;
    let (bvh, bvh_times) = measure::fastest(setting.runs, || scene.hierarchy())?;
    let triangles = || Map::from_iter([("triangles".to_owned(), json!(tree.len()))]);
    let with = |more: &[(&str, Value)]| {
        let mut figures = triangles();
        figures.extend(more.iter().map(|(name, value)| ((*name).to_owned(), value.clone())));
        figures
    };
    let [octants, references] = tree.counts();
    let sizes = [("octants", json!(octants)), ("references", json!(references)), ("bytes", json!(tree.memory_bytes()))];
    let mut outcomes = vec![
        Outcome { input: scene.input("octree build"), times: tree_times, figures: with(&sizes) },
        Outcome { input: scene.input("hierarchy build"), times: bvh_times, figures: triangles() },
    ];

    let random = |index: u32| {
        let origin = on_sphere(index, 0) * 3.0;
        let target = DVec3::new(spread(index, 3), spread(index, 5), spread(index, 8)) * 2.4 - 1.2;
        (origin, target - origin)
    };
    let queries = rays(setting, "rays_random.f32", random)?.items;
    let shapes: [(&str, &dyn Rays); 2] = [("octree", &tree), ("hierarchy", &bvh)];
    for (name, shape) in shapes {
        outcomes.push(first_hits(&scene.input(&format!("{name} rays")), setting, shape, &queries, triangles())?);
    }

    let boxes: Vec<Aabb> = (0..BOXES)
        .map(|index| {
            let center = on_sphere(index, 0);
            Aabb { min: center, max: center }.padded(0.002 + 0.05 * spread(index, 3))
        })
        .collect();
    let mut found = Vec::new();
    type Query<'a> = &'a dyn Fn(&Aabb, &mut Vec<u32>);
    let ways: [(&str, Query<'_>); 2] = [
        ("octree boxes", &|region, found| tree.overlapping(region, found)),
        ("hierarchy boxes", &|region, found| bvh.overlapping(region, found)),
    ];
    for (name, overlapping) in ways {
        let (met, times) = measure::fastest(setting.runs, || {
            Ok(boxes.iter().fold(0, |met, region| {
                overlapping(region, &mut found);
                met + found.len()
            }))
        })?;
        let figures = with(&[("boxes", json!(boxes.len())), ("met", json!(met))]);
        outcomes.push(Outcome { input: scene.input(name), times, figures });
    }
    outcomes.push(grid(setting)?);
    Ok(outcomes)
}

fn first_hits(
    input: &str,
    setting: &Setting,
    shape: &dyn Rays,
    queries: &[Ray],
    mut figures: Map<String, Value>,
) -> Result<Outcome, String> {
    let mut hits = vec![None; queries.len()];
    let work = || shape.first_hits(queries, &mut hits, &Exec::default()).map_err(|stop| stop.to_string());
    let ((), times) = measure::fastest(setting.runs, work)?;
    figures.insert("rays".into(), json!(queries.len()));
    figures.insert("hits".into(), json!(hits.iter().flatten().count()));
    figures.insert("sum_t".into(), json!(hits.iter().flatten().map(|hit| hit.distance).sum::<f64>()));
    Ok(Outcome { input: input.to_owned(), times, figures })
}

/// A ball in a grid of as many samples a side as `--size` says, at most 256: to an octree and back.
fn grid(setting: &Setting) -> Result<Outcome, String> {
    let side = setting.size.min(256);
    let said = |error: &dyn std::fmt::Display| error.to_string();
    let spacing = DVec3::splat(2.0 / f64::from(side - 1));
    let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.0), spacing).map_err(|error| said(&error))?;
    let distance = |at: u64| (lattice.position(lattice.coordinates(at)).length() - 0.9) as f32;
    let samples = Samples::F32((0..lattice.samples()).map(distance).collect());
    let grid = VoxelGrid::try_new(lattice, samples, Quantity::SignedDistance).map_err(|error| said(&error))?;
    let level = Level { iso: 0.0, inside: Inside::Below };
    let (nodes, times) = measure::fastest(setting.runs, || {
        let tree = Octree::from_slabs(&grid, level, &Exec::default()).map_err(|error| said(&error))?;
        tree.to_grid(&Exec::default()).map_err(|error| said(&error))?;
        Ok(tree.counts().nodes())
    })?;
    let figures = Map::from_iter([
        ("triangles".to_owned(), json!(0)),
        ("samples".to_owned(), json!(lattice.samples())),
        ("nodes".to_owned(), json!(nodes)),
    ]);
    Ok(Outcome { input: format!("ball {side}^3: grid to octree to grid"), times, figures })
}
