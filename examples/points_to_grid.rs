//! Scattered points to numbers on a lattice: how many are in each cell, and a smooth density.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::PointCloud;
use shapeloom::render::{Picture, Scene};
use shapeloom::voxels::isosurface::sample_range;
use shapeloom::voxels::{PointWeight, PointsToGrid};
use shapeloom_examples::{Output, boxes};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // Points of a sequence without pattern, in a ring that is denser on one side.
    let spread = |k: u32, step: f64| (0.5 + f64::from(k) * step).fract();
    let point = |k: u32| {
        let (a, b) = (spread(k, 0.819_172_513), spread(k, 0.671_043_607));
        let around = TAU * a * a.sqrt();
        let (thick, angle) = (0.35 * b.sqrt(), TAU * spread(k, 0.549_700_478));
        let radius = 1.0 + thick * angle.cos();
        DVec3::new(radius * around.cos(), radius * around.sin(), thick * angle.sin())
    };
    let cloud = PointCloud::new((0..40_000).map(point).collect());

    let count = PointsToGrid { weight: PointWeight::Count, resolution: 32, ..PointsToGrid::new() };
    let density = PointsToGrid { resolution: 32, radius: 0.25, ..PointsToGrid::new() };
    let mut scene = Scene::default();
    for (words, method, at_least, x) in [("counted", &count, 12.0, 0.0), ("spread", &density, 16_000.0, 2.9)] {
        let made = method.convert(&cloud)?;
        let lattice = made.value.lattice();
        let volume = if method.weight == PointWeight::Count { 1.0 } else { lattice.placement().determinant() };
        let sum: f64 = (0..lattice.samples()).map(|at| f64::from(made.value.samples().get(at))).sum();
        println!(
            "{words}: {} samples of {}, {:.2} points",
            lattice.samples(),
            made.value.samples().name(),
            sum * volume
        );
        println!("  from {:?}", sample_range(&made.value, &Exec::default())?.finite);
        let is_dense = |cell: [u32; 3]| f64::from(made.value.sample(cell)) >= at_least;
        let mut cells = boxes(&made.value, is_dense, [0.075, 0.24, 0.48]);
        cells.positions.iter_mut().for_each(|position| position.x += x);
        scene.surfaces.push(cells);
    }
    println!("{}", output.draw("points_to_grid", &scene, [0.0, 45.0], Picture::new())?.display());
    Ok(())
}
