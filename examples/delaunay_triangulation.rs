//! A terrain from scattered points: more of them where it is steep, as surveyors do; then with its thin triangles refined.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::{DelaunayTriangulation, PointCloud};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape, UpAxis};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // A volcano in a plain. Points of a sequence without pattern, kept where the slope asks for them.
    let height = |p: DVec2| {
        let r = p.distance(DVec2::new(0.55, 0.5));
        0.42 * (-(r / 0.2).powi(2)).exp() - 0.3 * (-(r / 0.075).powi(2)).exp()
            + 0.02 * (13.0 * p.x).sin() * (11.0 * p.y).cos()
    };
    let slope = |p: DVec2| {
        let step = |d: DVec2| (height(p + d * 1e-4) - height(p - d * 1e-4)) / 2e-4;
        step(DVec2::X).hypot(step(DVec2::Y))
    };
    let spread = |k: u32, step: f64| (0.5 + f64::from(k) * step).fract();
    let border = (0..16).flat_map(|k| {
        let t = f64::from(k) / 16.0;
        [(t, 0.0), (1.0, t), (1.0 - t, 1.0), (0.0, 1.0 - t)].map(DVec2::from)
    });
    let inner = (0..2600)
        .map(|k| (DVec2::new(spread(k, 0.754_877_666), spread(k, 0.569_840_291)), spread(k, 0.618_033_989)))
        .filter(|&(p, chance)| chance < 0.07 + 0.25 * slope(p))
        .map(|(p, _)| p);
    let cloud = PointCloud::new(border.chain(inner).map(|p| p.extend(height(p))).collect());

    let plain = DelaunayTriangulation::new();
    let refined = DelaunayTriangulation { angle: 28.0, ..DelaunayTriangulation::new() };
    let mut scene = Scene::default();
    for (words, converter, x) in [("as it is", plain, 0.0), ("no angle below 28 degrees", refined, 1.15)] {
        let converted = converter.convert(&cloud)?;
        let (mesh, report) = (converted.value, converted.report);
        println!("{words}: {} points to {} triangles", cloud.positions().len(), mesh.triangles().len());
        for name in ["smallest_angle", "vertices_added", "refinement_complete"] {
            report.find(name).iter().for_each(|value| println!("  {name} {value:.4}"));
        }
        report.findings.iter().for_each(|finding| println!("  {finding}"));
        let moved = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
        scene.surfaces.push(SceneMesh::new(moved, mesh.triangles().to_vec()));
        if x == 0.0 {
            let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(mesh).named("volcano")) };
            let mut bytes = Vec::new();
            write(&shape, format_by_id("ply")?, &WriteContext::default(), &mut bytes)?;
            println!("  {}", output.write("delaunay_triangulation.ply", &bytes)?.display());
        }
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.7, ..Picture::new() };
    println!("{}", output.draw("delaunay_triangulation", &scene, [-8.0, 38.0], look)?.display());
    Ok(())
}
