//! A Bézier curve as a polyline: the tolerance decides how many points, and the report has the proven error.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Curve};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::Polyline;
use shapeloom::parametric::{BezierCurve, TessellateCurve};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let control = [[0.0, 0.0, 0.0], [1.0, 0.0, 3.0], [2.0, 1.5, -3.0], [3.0, 1.0, 3.0], [4.0, 0.0, 0.0]];
    let curve = BezierCurve::try_new(control.map(DVec3::from).to_vec())?;

    println!("tolerance  segments  proven at most  measured");
    let mut scene = Scene::default();
    for (row, tolerance) in [0.2, 0.02, 0.002].into_iter().enumerate() {
        let converted = TessellateCurve::new(tolerance).convert(&curve)?;
        let line = converted.value;
        let bound = converted.report.deviation.value().unwrap_or(f64::NAN);
        // Not part of the conversion: how far the curve really is from its chords.
        let measured = (0..=4000).map(|k| distance(&line, curve.point(f64::from(k) / 4000.0))).fold(0.0, f64::max);
        println!("{tolerance:9}  {:8}  {bound:14.6}  {measured:8.6}", line.segments().count());
        scene.surfaces.extend(beads(&line, DVec3::NEG_Z * (row as f64 * 1.6)));

        if row == 2 {
            let mut bytes = Vec::new();
            let shape = Shape::new(Part::new(line).named("curve"));
            let report = write(&shape, format_by_id("glb")?, &WriteContext::default(), &mut bytes)?;
            println!("{}: error {}", output.write("tessellate_curve.glb", &bytes)?.display(), report.deviation);
        }
    }
    let look = Picture { ground: false, ..Picture::new() };
    println!("{}", output.draw("tessellate_curve", &scene, [0.0, 8.0], look)?.display());
    Ok(())
}

/// The distance of a point from the nearest segment.
fn distance(line: &Polyline, point: DVec3) -> f64 {
    let to = |[a, b]: [DVec3; 2]| {
        let t = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        point.distance(a.lerp(b, t))
    };
    line.segments().map(to).fold(f64::INFINITY, f64::min)
}

/// Lines have no surface to draw: a rod for each segment, and an octahedron for each point.
fn beads(line: &Polyline, offset: DVec3) -> Vec<SceneMesh> {
    let mut rods = SceneMesh::new(Vec::new(), Vec::new());
    let mut dots = SceneMesh { color: [0.55, 0.12, 0.04], ..rods.clone() };
    for [a, b] in line.segments() {
        let (across, first) = ((b - a).any_orthonormal_pair(), rods.positions.len() as u32);
        for (side, end) in (0..12).map(|i| (f64::from(i / 2) * std::f64::consts::TAU / 6.0, [a, b][i as usize % 2])) {
            rods.positions.push(end + offset + (across.0 * side.cos() + across.1 * side.sin()) * 0.015);
        }
        for i in 0..6 {
            let [p, q] = [2 * i, (2 * i + 2) % 12].map(|k| first + k);
            rods.triangles.extend([[p, q, q + 1], [p, q + 1, p + 1]]);
        }
    }
    for point in line.points() {
        let first = dots.positions.len() as u32;
        dots.positions
            .extend(DVec3::AXES.into_iter().flat_map(|axis| [axis, -axis]).map(|d| *point + offset + d * 0.05));
        let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
        dots.triangles.extend(faces.map(|face: [u32; 3]| face.map(|corner| first + corner)));
    }
    vec![rods, dots]
}
