//! Surfaces of samples by manifold surface nets: a gyroid that the border of its lattice cuts off, and noise, both closed.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::isosurface::{Border, Lattice, ManifoldSurfaceNets};
use shapeloom::judge::Topology;
use shapeloom::mesh::{Domain, NORMAL, TriMesh};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let gyroid = grid(49, |p| {
        let p = p * 4.0;
        p.x.sin() * p.y.cos() + p.y.sin() * p.z.cos() + p.z.sin() * p.x.cos() - 0.2
    })?;
    // Noise of three samples to a bump: cells with several pieces of the surface are common.
    let noise = grid(29, |p| {
        0.35 - (p * 97.0).to_array().map(|x| (x * x * 0.37 + p.element_sum() * 31.0).sin()).iter().sum::<f64>().abs()
            * 0.3
            - (1.0 - p.length()) * 0.5
    })?;

    let nets = ManifoldSurfaceNets { normals: true, ..ManifoldSurfaceNets::new() };
    let closed = nets.convert(&gyroid)?;
    say("gyroid, closed at the border", &closed.value)?;
    println!("  error: {}, {}", closed.report.deviation, closed.report.basis);
    let open = ManifoldSurfaceNets { border: Border::Open, ..nets.clone() }.convert(&gyroid)?;
    say("gyroid, open at the border", &open.value)?;
    let rough = nets.convert(&noise)?.value;
    say("noise", &rough)?;

    let scene = Scene { surfaces: vec![moved(&closed.value, -1.15, true)?, moved(&rough, 1.15, false)?] };
    println!("{}", output.draw("manifold_surface_nets", &scene, [-25.0, 25.0], Picture::new())?.display());
    Ok(())
}

/// Samples of a formula on the cube from -1 to 1.
fn grid(side: u32, value: impl Fn(DVec3) -> f64) -> Result<VoxelGrid, Box<dyn Error>> {
    let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.0), DVec3::splat(2.0 / f64::from(side - 1)))?;
    let samples = (0..lattice.samples()).map(|at| value(lattice.position(lattice.coordinates(at))) as f32).collect();
    Ok(VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance)?)
}

fn say(what: &str, mesh: &TriMesh) -> Result<(), Box<dyn Error>> {
    let topology = Topology::of(mesh, &Exec::default())?;
    println!(
        "{what}: {} triangles in {} pieces, closed {}, manifold {}, Euler number {}",
        mesh.triangles().len(),
        topology.components.len(),
        topology.is_closed(),
        topology.is_manifold(),
        topology.euler_characteristic()
    );
    Ok(())
}

/// The mesh beside the origin; smooth by its normals, or with facets.
fn moved(mesh: &TriMesh, x: f64, smooth: bool) -> Result<SceneMesh, Box<dyn Error>> {
    let column = mesh.attribute(Domain::Vertex, NORMAL).ok_or("no normals")?;
    let normals = mesh.triangles().as_flattened().iter().map(|&vertex| column.vector(vertex as usize)).collect();
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    Ok(SceneMesh { normals: smooth.then_some(normals), ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
