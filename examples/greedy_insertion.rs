//! A terrain with a lake as few triangles within a proven tolerance: large where it is flat, small where it is not.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{Affine, Convert};
use shapeloom::mesh::{GreedyInsertion, HeightField, TriangulateHeightField};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let size = 97;
    let height = |k: u32| {
        let p = DVec2::new(f64::from(k % size), f64::from(k / size)) / f64::from(size - 1);
        let lake = p.distance(DVec2::new(0.7, 0.27)) < 0.14;
        let ridge = 0.22 * (-60.0 * (p.y - 0.62 - 0.12 * (7.0 * p.x).sin()).powi(2)).exp();
        let rough = 0.012 * (70.0 * p.x).sin() * (55.0 * p.y + 3.0 * p.x).cos() * (ridge / 0.22).powi(2);
        if lake { f64::NAN } else { ridge * (0.6 + 0.4 * (5.0 * p.x).cos()) + rough + 0.02 * p.x }
    };
    let heights: Vec<f64> = (0..size * size).map(height).collect();
    let field = HeightField::try_new(size, size, DVec2::splat(1.0 / 96.0), heights)?;
    let regular = TriangulateHeightField::new().convert(&field)?;
    println!("every cell: {} triangles, error {}", regular.value.triangles().len(), regular.report.deviation);

    let mut scene = Scene::default();
    for (tolerance, x) in [(0.01, 0.0), (0.001, 1.1)] {
        let placed = field.clone().placed(Affine::from_translation(DVec3::X * x));
        let made = GreedyInsertion::new(tolerance).convert(&placed)?;
        println!("within {tolerance}: {} triangles, error {}", made.value.triangles().len(), made.report.deviation);
        println!("  {}", made.report.basis);
        scene.surfaces.push(SceneMesh::new(made.value.positions().to_vec(), made.value.triangles().to_vec()));
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.6, ..Picture::new() };
    println!("{}", output.draw("greedy_insertion", &scene, [-18.0, 48.0], look)?.display());
    Ok(())
}
