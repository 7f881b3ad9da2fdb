//! An ellipsoid cut in three ways, and the quadrics that are not closed, each with its proven error.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{ChoiceOption, Convert, Exec};
use shapeloom::mesh::primitives::{Ellipsoid, Quadric, QuadricShape, SphereCut};
use shapeloom::mesh::{PolyMesh, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();
    let mut scene = Scene::default();
    for (k, cut) in [SphereCut::Icosphere, SphereCut::Meridians, SphereCut::CubeSphere].into_iter().enumerate() {
        let ellipsoid = Ellipsoid { a: 1.0, b: 0.8, c: 0.7, cut, steps: [8, 6, 8][k] };
        let made = ellipsoid.mesh(&exec)?;
        let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.56;
        println!("{}: {} faces, error {}", cut.name(), made.value.face_count(), made.report.deviation);
        println!("  {:.2} % of the volume", 100.0 * made.value.volume() / volume);
        scene.surfaces.push(placed(&made.value, DVec3::new(2.3 * k as f64 - 2.3, 2.7, 0.7))?);
    }
    for (k, name) in QuadricShape::NAMES.iter().enumerate() {
        let shape = QuadricShape::from_name(name).ok_or("a name of the list")?;
        let paraboloid = k < 2;
        let (u_from, v_from) = if paraboloid { (-0.5, -0.5) } else { (0.0, if k == 4 { -0.7 } else { 0.0 }) };
        let (u_to, v_to) = if paraboloid { (0.5, 0.5) } else { (1.0, if k < 4 { 1.0 } else { 0.7 }) };
        let (a, b, c) = if paraboloid { (0.7, 0.7, 0.8) } else { (0.5, 0.5, if k == 5 { 0.45 } else { 0.7 }) };
        let steps = if paraboloid { 10 } else { 28 };
        let made = Quadric { shape, a, b, c, u_from, u_to, v_from, v_to, u_steps: steps, v_steps: 8 }.mesh(&exec)?;
        println!("{name}: {} triangles, error {}", made.value.face_count(), made.report.deviation);
        let low = made.value.bounds().min.z;
        let (x, y) = (1.9 * (k % 3) as f64 - 1.9, if k < 3 { 0.7 } else { -1.1 });
        scene.surfaces.push(placed(&made.value, DVec3::new(x, y, -low))?);
    }
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.6, ..Picture::new() };
    println!("{}", output.draw("quadrics", &scene, [0.0, 38.0], look)?.display());
    Ok(())
}

fn placed(mesh: &PolyMesh, to: DVec3) -> Result<SceneMesh, Box<dyn Error>> {
    let mesh = TriangulatePolygons::new().convert(mesh)?.value;
    Ok(SceneMesh::new(mesh.positions().iter().map(|&p| p + to).collect(), mesh.triangles().to_vec()))
}
