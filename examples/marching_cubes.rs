//! A pretzel of three rings from its distances on a lattice; and what becomes of one cell that its corners leave open.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::isosurface::{Lattice, MarchingCubes, Topology};
use shapeloom::mesh::{Domain, NORMAL, TriMesh};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape, UpAxis};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    // Three rings, cut off flat where the lattice ends.
    let ring = |p: DVec3, center: DVec3| {
        let q = p - center;
        (q.truncate().length() - 0.55).hypot(q.z) - 0.2
    };
    let centers = [0.0, 2.1, 4.2].map(|angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0) * 0.6);
    let pretzel = |p: DVec3| centers.iter().map(|&center| ring(p, center)).fold(f64::INFINITY, f64::min);
    let lattice = Lattice::along_axes([46, 52, 14], DVec3::new(-1.4, -1.3, -0.3), DVec3::splat(0.05))?;
    let samples = (0..lattice.samples()).map(|at| pretzel(lattice.position(lattice.coordinates(at))) as f32).collect();
    let grid = VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance)?;
    let converted = MarchingCubes { normals: true, ..MarchingCubes::new() }.convert(&grid)?;
    let (mesh, report) = (converted.value, converted.report);
    println!("{} vertices, {} triangles", mesh.positions().len(), mesh.triangles().len());
    println!("error {}: {}", report.deviation, report.basis);
    let mut bytes = Vec::new();
    let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(mesh.clone()).named("pretzel")) };
    write(&shape, format_by_id("glb")?, &WriteContext::default(), &mut bytes)?;
    println!("{}", output.write("marching_cubes.glb", &bytes)?.display());

    // Two opposite corners inside: apart by the fixed rule, joined by a tunnel as the trilinear interpolant has them.
    let mut scene = Scene { surfaces: vec![smooth(&mesh)?] };
    let corners = [-1.0, 0.3, 0.3, 0.35, 0.3, 0.35, 0.35, -1.0];
    for (topology, x) in [(Topology::Table, 1.7), (Topology::Exact, 3.2)] {
        let lattice = Lattice::along_axes([2, 2, 2], DVec3::new(x, -0.5, -0.5), DVec3::ONE)?;
        let cell = VoxelGrid::try_new(lattice, Samples::F32(corners.to_vec()), Quantity::SignedDistance)?;
        let mesh = MarchingCubes { topology, ..MarchingCubes::new() }.convert(&cell)?.value;
        println!("{topology:?}: {} triangles, volume {:.3}", mesh.triangles().len(), mesh.volume());
        scene.surfaces.push(SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec()));
    }
    let look = Picture { mode: Mode::Shaded, wires: true, wire_width: 0.6, ..Picture::new() };
    println!("{}", output.draw("marching_cubes", &scene, [-20.0, 35.0], look)?.display());
    Ok(())
}

fn smooth(mesh: &TriMesh) -> Result<SceneMesh, Box<dyn Error>> {
    let column = mesh.attribute(Domain::Vertex, NORMAL).ok_or("normals were asked for")?;
    let normals = mesh.triangles().as_flattened().iter().map(|&vertex| column.vector(vertex as usize)).collect();
    let surface = SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec());
    Ok(SceneMesh { normals: Some(normals), ..surface })
}
