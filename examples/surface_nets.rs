//! Surface nets with one vertex a cell, and with one for each piece of the surface: alike on smooth shapes, not on thin or rough ones.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::isosurface::{Lattice, ManifoldSurfaceNets, SurfaceNets};
use shapeloom::judge::Topology;
use shapeloom::mesh::TriMesh;
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // A wave that gets thinner than a cell, in full and empty cells: a staircase whose steps meet at edges and corners.
    let stairs = grid([24, 24, 12], |i, j, k| {
        let height = 5.0 + 4.0 * (f64::from(i) * 0.45).sin() * (f64::from(j) * 0.3).cos();
        (f64::from(k) - height).abs() < 0.9
    })?;
    let ball = grid([24; 3], |i, j, k| DVec3::new(i.into(), j.into(), k.into()).distance(DVec3::splat(11.5)) < 9.3)?;

    for (name, grid) in [("ball", &ball), ("stairs", &stairs)] {
        for mesh in [SurfaceNets::new().convert(grid)?, ManifoldSurfaceNets::new().convert(grid)?] {
            let topology = Topology::of(&mesh.value, &Exec::default())?;
            println!(
                "{name} by {}: {} vertices, {} triangles, {} edges with more than two triangles, {} pinched vertices",
                mesh.report.steps.join(", "),
                mesh.value.positions().len(),
                mesh.value.triangles().len(),
                topology.non_manifold_edges.len(),
                topology.non_manifold_vertices.len()
            );
            for finding in &mesh.report.findings {
                println!("  {finding}");
            }
        }
    }

    let one = SurfaceNets::new().convert(&stairs)?.value;
    let parted = ManifoldSurfaceNets::new().convert(&stairs)?.value;
    let scene = Scene { surfaces: vec![marked(&one, -13.0)?, marked(&parted, 13.0)?] };
    println!("{}", output.draw("surface_nets", &scene, [-20.0, 40.0], Picture::new())?.display());
    Ok(())
}

/// Full and empty cells.
fn grid(dimensions: [u32; 3], full: impl Fn(u32, u32, u32) -> bool) -> Result<VoxelGrid, Box<dyn Error>> {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE)?;
    let at = |index: u64| lattice.coordinates(index);
    let samples = (0..lattice.samples()).map(at).map(|[i, j, k]| u8::from(full(i, j, k))).collect();
    Ok(VoxelGrid::try_new(lattice, Samples::U8(samples), Quantity::Occupancy)?)
}

/// The mesh beside the origin, red where an edge has more than two triangles.
fn marked(mesh: &TriMesh, x: f64) -> Result<SceneMesh, Box<dyn Error>> {
    let topology = Topology::of(mesh, &Exec::default())?;
    let mut colors = vec![SceneMesh::GLAZE; mesh.positions().len()];
    for &vertex in topology.non_manifold_edges.as_flattened() {
        colors[vertex as usize] = [0.8, 0.05, 0.03];
    }
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    Ok(SceneMesh { colors: Some(colors), ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
