//! Three surfaces judged without their coordinates: with a border, with one side, pinched in a vertex. The picture shows
//! the witnesses.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::judge::Topology;
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::{Output, rod};

const ORANGE: [f32; 3] = [0.9, 0.22, 0.02];

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 32, sides: 16, ..Torus::new() }.mesh(&Exec::default())?.value;
    let torus = TriangulatePolygons::new().convert(&torus)?.value;
    // Two holes: every triangle that has one of two vertices is gone.
    let open = torus.triangles().iter().filter(|triangle| !triangle.contains(&37) && !triangle.contains(&180)).copied();
    let open = TriMesh::try_new(torus.positions().to_vec(), open.collect())?;
    let strip = grid(48, 5, |u, v| {
        let (turn, width) = (u * TAU, (v - 0.5) * 0.9);
        let along = 1.0 + width * (turn / 2.0).cos();
        DVec3::new(along * turn.cos(), along * turn.sin(), width * (turn / 2.0).sin())
    })?;
    let cones = PolyMesh::from_faces(
        std::iter::once(DVec3::ZERO).chain((0..48).map(|k| ring(k % 24, if k < 24 { 1.0 } else { -1.0 }))).collect(),
        &(0..48u32).map(|k| [0, 1 + k, if k % 24 == 23 { k - 22 } else { k + 2 }]).collect::<Vec<_>>(),
    )?;
    let cones = TriangulatePolygons::new().convert(&cones)?.value;

    let mut scene = Scene::default();
    for (name, mesh, x) in [("torus with holes", &open, -2.9), ("strip", &strip, 0.0), ("cones", &cones, 2.6)] {
        let report = Topology::of(mesh, &Exec::default())?;
        println!(
            "{name}: V - E + F = {}, boundary loops {}, orientable {}, vertices pinched {:?}",
            report.euler_characteristic(),
            report.boundary.len(),
            report.is_orientable(),
            report.non_manifold_vertices
        );
        let at = |vertex: u32| mesh.positions()[vertex as usize] + DVec3::X * x;
        let (ring, plain): (Vec<_>, Vec<_>) =
            (0..mesh.triangles().len() as u32).partition(|face| report.orientation_witness.contains(face));
        for (faces, color) in [(plain, SceneMesh::GLAZE), (ring, ORANGE)] {
            let triangles = faces.into_iter().map(|face| mesh.triangles()[face as usize]).collect();
            let positions = (0..mesh.positions().len() as u32).map(at).collect();
            scene.surfaces.push(SceneMesh { color, ..SceneMesh::new(positions, triangles) });
        }
        scene.surfaces.extend(report.boundary.edges().iter().map(|&[a, b]| rod(at(a), at(b), 0.035, ORANGE)));
        scene
            .surfaces
            .extend(report.non_manifold_vertices.iter().map(|&v| rod(at(v), at(v) + DVec3::Z * 1e-3, 0.14, ORANGE)));
    }
    println!("{}", output.draw("topology_report", &scene, [8.0, 38.0], Picture::new())?.display());
    Ok(())
}

fn ring(k: u32, z: f64) -> DVec3 {
    let turn = f64::from(k) / 24.0 * TAU;
    DVec3::new(turn.cos() * 0.9, turn.sin() * 0.9 * z, z)
}

/// Cells of which the last column is glued to the first with a turn.
fn grid(m: u32, n: u32, at: impl Fn(f64, f64) -> DVec3) -> Result<TriMesh, Box<dyn Error>> {
    let (rows, id) = (n + 1, |i: u32, j: u32| if i == m { n - j } else { i * (n + 1) + j });
    let positions = (0..m * rows).map(|k| at(f64::from(k / rows) / f64::from(m), f64::from(k % rows) / f64::from(n)));
    let cells = (0..m).flat_map(|i| (0..n).map(move |j| [id(i, j), id(i + 1, j), id(i + 1, j + 1), id(i, j + 1)]));
    Ok(TriMesh::try_new(positions.collect(), cells.flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())?)
}
