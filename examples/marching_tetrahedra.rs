//! The same samples by cubes and by tetrahedra: more triangles, and the direction of the tetrahedra shows.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::isosurface::{Lattice, MarchingCubes, MarchingTetrahedra};
use shapeloom::mesh::TriMesh;
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape, UpAxis};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let grid = |x: f64| -> Result<VoxelGrid, Box<dyn Error>> {
        let lattice = Lattice::along_axes([15, 15, 15], DVec3::new(x - 1.4, -1.4, -1.4), DVec3::splat(0.2))?;
        let center = DVec3::X * x;
        let value = |p: DVec3| {
            let q = p - center;
            q.length() - 1.05 - 0.2 * (4.0 * q.x).sin() * (4.0 * q.y).sin() * (4.0 * q.z).sin()
        };
        let samples =
            (0..lattice.samples()).map(|at| value(lattice.position(lattice.coordinates(at))) as f32).collect();
        Ok(VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance)?)
    };
    let cubes = MarchingCubes::new().convert(&grid(-1.45)?)?.value;
    say("cubes", &cubes);
    let converted = MarchingTetrahedra::new().convert(&grid(1.45)?)?;
    say("tetrahedra", &converted.value);
    let times = converted.report.find("times_marching_cubes").unwrap_or_default();
    println!("{times:.2} times as many triangles; error {}", converted.report.deviation);

    let surface = |mesh: &TriMesh| SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec());
    let scene = Scene { surfaces: vec![surface(&cubes), surface(&converted.value)] };
    let mut bytes = Vec::new();
    let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(converted.value).named("bumps")) };
    write(&shape, format_by_id("ply")?, &WriteContext::default(), &mut bytes)?;
    println!("{}", output.write("marching_tetrahedra.ply", &bytes)?.display());
    let look = Picture { mode: Mode::Flat, wires: true, wire_width: 0.7, ..Picture::new() };
    println!("{}", output.draw("marching_tetrahedra", &scene, [20.0, 25.0], look)?.display());
    Ok(())
}

fn say(what: &str, mesh: &TriMesh) {
    let counts = (mesh.positions().len(), mesh.triangles().len());
    println!("{what}: {} vertices, {} triangles, volume {:.4}", counts.0, counts.1, mesh.volume());
}
