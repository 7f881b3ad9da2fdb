//! The faces between full and empty cells: closed where cells touch along edges, or merged to few rectangles.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::judge::Topology;
use shapeloom::mesh::{PolyMesh, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::voxels::CellFaces;
use shapeloom_examples::{Output, sampled};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // A gyroid in a ball: thin walls that touch along edges here and there.
    let gyroid = |p: DVec3| {
        let q = p * 5.0;
        let wave = q.x.sin() * q.y.cos() + q.y.sin() * q.z.cos() + q.z.sin() * q.x.cos();
        (wave.abs() - 0.45).max(p.length() - 0.95)
    };
    let grid = sampled(29, 1.0, gyroid)?;
    let mut scene = Scene::default();
    let kinds = [("apart", false, true), ("together", false, false), ("merged", true, true)];
    for (place, (name, merge, separate)) in kinds.into_iter().enumerate() {
        let converted = CellFaces { merge, separate, ..CellFaces::new() }.convert(&grid)?;
        let mesh = &converted.value;
        let topology = Topology::of(mesh, &Exec::default())?;
        println!(
            "{name:>8}: {} faces, {} vertices, {} edges of four faces, manifold: {}, closed: {}, error {}",
            mesh.face_count(),
            mesh.positions().len(),
            topology.non_manifold_edges.len(),
            topology.is_manifold(),
            topology.is_closed(),
            converted.report.deviation,
        );
        if name != "together" {
            scene.surfaces.push(outlined(mesh, DVec3::X * 1.05 * (place as f64 - 1.0))?);
        }
    }
    let look = Picture { mode: Mode::Wire, ..Picture::new() };
    println!("{}", output.draw("cell_faces", &scene, [20.0, 25.0], look)?.display());
    Ok(())
}

/// The triangles of rectangles, with the sides of the rectangles as wire.
fn outlined(mesh: &PolyMesh, shift: DVec3) -> Result<SceneMesh, Box<dyn Error>> {
    let triangles = TriangulatePolygons::new().convert(mesh)?.value;
    let positions: Vec<DVec3> = triangles.positions().iter().map(|&position| position + shift).collect();
    // A diagonal runs along two axes.
    let straight = |a: u32, b: u32| {
        let along = (positions[a as usize] - positions[b as usize]).abs();
        along.to_array().into_iter().filter(|&part| part > 1e-9).count() < 2
    };
    let edges =
        triangles.triangles().iter().map(|&[a, b, c]| [straight(a, b), straight(b, c), straight(c, a)]).collect();
    Ok(SceneMesh { edges: Some(edges), ..SceneMesh::new(positions, triangles.triangles().to_vec()) })
}
