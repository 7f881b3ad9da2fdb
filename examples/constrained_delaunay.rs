//! Scattered heights with a road that must stay in one piece, a crossing path, and a lake shore that bounds what is kept.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::mesh::{ConstrainedDelaunay, GeometricGraph, KeptTriangles};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let height = |p: DVec2| 0.1 * (3.0 * p.x).sin() * (2.5 * p.y).cos();
    let mut points: Vec<DVec3> = Vec::new();
    let mut edges: Vec<[u32; 2]> = Vec::new();
    // A line of points, joined one to the next.
    let mut line = |count: u32, closed: bool, at: &dyn Fn(f64) -> DVec2| {
        let first = points.len() as u32;
        points.extend((0..count).map(|k| at(f64::from(k) / f64::from(count))).map(|p| p.extend(height(p))));
        edges.extend((1..count).map(|k| [first + k - 1, first + k]));
        edges.extend(closed.then_some([first + count - 1, first]));
    };
    let turn = |t: f64| DVec2::from_angle(std::f64::consts::TAU * t);
    line(48, true, &|t| turn(t) * (1.0 + 0.12 * (t * 31.4).sin()));
    line(20, true, &|t| turn(t) * DVec2::new(0.28, 0.18) + DVec2::new(0.35, 0.3));
    line(24, false, &|t| DVec2::new(1.6 * t - 0.82, 0.3 * (7.0 * t).sin() - 0.25));
    line(12, false, &|t| DVec2::new(-0.35 + 0.2 * t, 1.4 * t - 0.75));
    let spread = |k: u32, step: f64| (0.5 + f64::from(k) * step).fract() * 2.3 - 1.15;
    let anywhere = (0..240).map(|k| DVec2::new(spread(k, 0.754_877_666), spread(k, 0.569_840_291)));
    points.extend(anywhere.map(|p| p.extend(height(p))));
    let graph = GeometricGraph::try_new(points, edges)?;

    let everything = ConstrainedDelaunay::new();
    let enclosed = ConstrainedDelaunay { keep: KeptTriangles::Enclosed, angle: 25.0, ..ConstrainedDelaunay::new() };
    let mut scene = Scene::default();
    for (words, converter, x) in [("all, as it is", everything, 0.0), ("inside the shores, refined", enclosed, 2.5)] {
        let converted = converter.convert(&graph)?;
        let (mesh, report) = (converted.value, converted.report);
        println!("{words}: {} vertices, {} triangles", mesh.positions().len(), mesh.triangles().len());
        for name in ["crossings", "crossing_rounding", "crossing_height_gap", "smallest_angle", "vertices_added"] {
            report.find(name).iter().for_each(|value| println!("  {name} {value:.3e}"));
        }
        report.findings.iter().for_each(|finding| println!("  {finding}"));
        let moved = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
        scene.surfaces.push(SceneMesh::new(moved, mesh.triangles().to_vec()));
    }
    // The given edges as ribbons above the triangles.
    for x in [0.0, 2.5] {
        let ribbons = graph.segments().flat_map(|[a, b]| {
            let across = DVec3::Z.cross(b - a).normalize_or_zero() * 0.012;
            [a - across, b - across, b + across, a + across].map(|corner| corner + DVec3::new(x, 0.0, 0.012))
        });
        let corners =
            (0..graph.edges().len() as u32).flat_map(|k| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|c| 4 * k + c)));
        let color = [0.62, 0.12, 0.03];
        scene.surfaces.push(SceneMesh { color, ..SceneMesh::new(ribbons.collect(), corners.collect()) });
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.6, ground: false, ..Picture::new() };
    println!("{}", output.draw("constrained_delaunay", &scene, [-4.0, 65.0], look)?.display());
    Ok(())
}
