//! Faces that do not agree on an outside are turned over until they do; a surface with one side is shown by a ring.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::{OrientFaces, Outside, PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 36, sides: 18, ..Torus::new() }.mesh(&Exec::default())?.value;
    let mut faces: Vec<Vec<u32>> = torus.faces().map(<[u32]>::to_vec).collect();
    for corners in faces.iter_mut().step_by(3) {
        corners[1..].reverse();
    }
    let mixed = PolyMesh::from_faces(torus.positions().to_vec(), &faces)?;
    let outward = OrientFaces { outside: Outside::Volume, ..OrientFaces::new() };
    let oriented = outward.convert(&mixed)?;
    println!("a third of the faces turned: volume {:.4}", mixed.volume());
    println!("oriented: volume {:.4}, error {}", oriented.value.volume(), oriented.report.deviation);
    for figure in &oriented.report.figures {
        println!("  {} {}", figure.name, figure.value);
    }

    // A strip with a half twist: going along it once turns a face over.
    let around = |i: u32| std::f64::consts::TAU * f64::from(i) / 12.0;
    let point = |i: u32, side: f64| {
        let (turn, half) = (around(i), around(i) / 2.0);
        DVec3::new(turn.cos() * (1.0 + side * half.cos()), turn.sin() * (1.0 + side * half.cos()), side * half.sin())
    };
    let positions = (0..12).flat_map(|i| [point(i, -0.3), point(i, 0.3)]).collect();
    let at = |i: u32, side: u32| if i < 12 { 2 * i + side } else { 1 - side };
    let faces: Vec<[u32; 4]> = (0..12).map(|i| [at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)]).collect();
    let strip = PolyMesh::from_faces(positions, &faces)?;
    if let Err(error) = OrientFaces::new().convert(&strip) {
        println!("a Möbius strip: {error}");
    }

    let scene = Scene { surfaces: vec![shown(&mixed, -1.45)?, shown(&oriented.value, 1.45)?] };
    println!("{}", output.draw("orient_faces", &scene, [0.0, 40.0], Picture::new())?.display());
    Ok(())
}

/// The mesh to draw, moved aside; what is seen from inside is drawn in another colour.
fn shown(mesh: &PolyMesh, x: f64) -> Result<SceneMesh, Box<dyn Error>> {
    let mesh: TriMesh = TriangulatePolygons::new().convert(mesh)?.value;
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    Ok(SceneMesh::new(positions, mesh.triangles().to_vec()))
}
