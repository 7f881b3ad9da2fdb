//! A height field as triangles: holes stay holes, and the shorter diagonal follows a ridge that the first one cuts up.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{Affine, Convert};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::{Diagonal, HeightField, TriangulateHeightField};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape, UpAxis};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // A ridge across the grid, and a pond of which nothing is known.
    let (columns, rows) = (17, 17);
    let height = |k: u32| {
        let (x, y) = (f64::from(k % columns) / 16.0, f64::from(k / columns) / 16.0);
        let pond = DVec2::new(x, y).distance(DVec2::new(0.75, 0.8)) < 0.13;
        if pond { f64::NAN } else { 0.45 * (-50.0 * (x + y - 0.85).powi(2)).exp() + 0.05 * (9.0 * x).sin() }
    };
    let heights: Vec<f64> = (0..columns * rows).map(height).collect();
    let field = HeightField::try_new(columns, rows, DVec2::splat(1.0 / 16.0), heights)?;

    let mut scene = Scene::default();
    for (diagonal, x) in [(Diagonal::First, 0.0), (Diagonal::Shorter, 1.12)] {
        let placed = field.clone().placed(Affine::from_translation(DVec3::X * x));
        let converted = TriangulateHeightField { diagonal }.convert(&placed)?;
        let (mesh, report) = (converted.value, converted.report);
        let counts = (mesh.positions().len(), mesh.triangles().len());
        println!("{diagonal:?}: {} vertices, {} triangles, error {}", counts.0, counts.1, report.deviation);
        println!("  against {}", report.basis);
        scene.surfaces.push(SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec()));
        if diagonal == Diagonal::Shorter {
            let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(mesh)) };
            let mut bytes = Vec::new();
            let report = write(&shape, format_by_id("ply")?, &WriteContext::default(), &mut bytes)?;
            println!("{}", output.write("triangulate_height_field.ply", &bytes)?.display());
            report.losses.iter().for_each(|loss| println!("  lost: {loss}"));
        }
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.8, ..Picture::new() };
    println!("{}", output.draw("triangulate_height_field", &scene, [-14.0, 42.0], look)?.display());
    Ok(())
}
