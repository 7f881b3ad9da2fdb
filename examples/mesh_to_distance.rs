//! A torus with a hole in it to signed distances on a lattice: a slice, and what the report proves of the closed one.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::{TriMesh, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene};
use shapeloom::voxels::{FarField, MeshToDistance, VoxelGrid};
use shapeloom_examples::{Output, Slice};

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 96, sides: 48, ..Torus::new() }.mesh(&Exec::default())?.value;
    let whole = TriangulatePolygons::new().convert(&torus)?.value;
    // Without the triangles of a piece the winding number closes the gap smoothly.
    let is_kept = |triangle: &[u32; 3]| {
        let center: DVec3 = triangle.iter().map(|&vertex| whole.positions()[vertex as usize] / 3.0).sum();
        center.x < 0.5 || center.y.abs() > 0.35
    };
    let kept = whole.triangles().iter().filter(|triangle| is_kept(triangle)).copied().collect();
    let open = TriMesh::try_new(whole.positions().to_vec(), kept)?;

    let mut scene = Scene::default();
    let mut place = 0.0;
    for (name, mesh, far) in [("closed, swept", &whole, FarField::Sweep), ("open, clamped", &open, FarField::Clamp)] {
        let method = MeshToDistance { resolution: 96, margin: 16, far, ..MeshToDistance::new() };
        let made = method.convert(mesh)?;
        println!("{name}: {} samples, deviation {}", made.value.lattice().samples(), made.report.deviation);
        println!("  {}", made.report.basis);
        made.report.findings.iter().for_each(|finding| println!("  {finding}"));
        let mut squares = middle(&made.value);
        squares.iter_mut().for_each(|mesh| mesh.positions.iter_mut().for_each(|position| position.x += place));
        scene.surfaces.extend(squares);
        place += made.value.bounds().size().x + 0.1;
    }
    // Each sample a square: inside blue, outside warm, with a line at every tenth.
    let look = Picture { mode: Mode::Flat, ..Picture::new() };
    println!("{}", output.draw("mesh_to_distance", &scene, [0.0, 89.0], look)?.display());
    Ok(())
}

/// The middle slab, as squares.
fn middle(grid: &VoxelGrid) -> Vec<shapeloom::render::SceneMesh> {
    let [columns, rows, slabs] = grid.lattice().dimensions();
    let half = grid.lattice().spacing().truncate() * 0.5;
    let from = grid.lattice().position([0, 0, slabs / 2]);
    let to = grid.lattice().position([columns - 1, rows - 1, slabs / 2]);
    let slice =
        Slice { from: from.truncate() - half, to: to.truncate() + half, height: from.z, columns: columns as usize };
    let sample = |at: u32| f64::from(grid.sample([at % columns, (at / columns).min(rows - 1), slabs / 2]));
    let values: Vec<f64> = (0..slice.points().len() as u32).map(sample).collect();
    let shade = |value: f64| {
        let line = (value * 10.0 - (value * 10.0).round()).abs() < 0.12;
        0.5 + (if line { 0.65 } else { 1.0 }) * (0.12f64.copysign(-value) - value * 0.45).clamp(-0.5, 0.5)
    };
    slice.colored(&values, shade, 48)
}
