//! How far polyhedra are inside their sphere, and a sphere from a torus: bounded from both sides, and in colours.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{ClosestPoint, Convert, Exec};
use shapeloom::judge::{Distances, Simplices};
use shapeloom::mesh::primitives::{Sphere, Torus};
use shapeloom::mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::render::{Picture, Scene, SceneMesh, sequential_color};
use shapeloom::spatial::TriangleBvh;
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let exec = Exec::default();

    // A polyhedron of facets lies inside its sphere: how far, is known.
    let fine = sphere(512, 256)?;
    for segments in [16, 32, 64] {
        let coarse = sphere(segments, segments / 2)?;
        let found = Distances::new().measure(&Simplices::from(&coarse), &Simplices::from(&fine), &exec)?;
        let (hausdorff, mean) = (&found.hausdorff, &found.a_to_b.mean);
        println!("a sphere of {segments} segments: from {:.3e} to {:.3e} away", hausdorff.lower(), hausdorff.upper());
        println!("  on average {:.3e}, proven to be from {:.3e} to {:.3e}", mean.value, mean.lower, mean.upper);
        println!("  {} closest points, {} pieces cut", hausdorff.a_to_b.queries, hausdorff.a_to_b.splits);
    }

    // Two shapes that have little to do with each other: both directions differ.
    let (ball, ring) = (sphere(96, 48)?, triangles(&Torus::new().mesh(&exec)?.value)?);
    let found = Distances::new().measure(&Simplices::from(&ball), &Simplices::from(&ring), &exec)?;
    for (name, way) in [("sphere to torus", &found.hausdorff.a_to_b), ("torus to sphere", &found.hausdorff.b_to_a)] {
        println!("{name}: from {:.4} to {:.4}, farthest at {:.3}", way.lower, way.upper, way.witness.point);
    }
    println!("chamfer distance {:.4}", found.chamfer());

    let most = found.hausdorff.upper();
    let scene = Scene { surfaces: vec![colored(&ball, &ring, most, -1.5)?, colored(&ring, &ball, most, 1.5)?] };
    println!("{}", output.draw("mesh_distances", &scene, [0.0, 30.0], Picture::new())?.display());
    Ok(())
}

fn sphere(segments: u32, bands: u32) -> Result<TriMesh, Box<dyn Error>> {
    triangles(&Sphere { segments, bands, ..Sphere::new() }.mesh(&Exec::default())?.value)
}

fn triangles(mesh: &PolyMesh) -> Result<TriMesh, Box<dyn Error>> {
    Ok(TriangulatePolygons::new().convert(mesh)?.value)
}

/// A mesh in the colours of its distances to another, dark where they are 0, moved aside.
fn colored(mesh: &TriMesh, to: &TriMesh, most: f64, aside: f64) -> Result<SceneMesh, Box<dyn Error>> {
    let bvh = TriangleBvh::build(to.positions(), to.triangles(), &Exec::default())?;
    let away = |position: DVec3| bvh.closest(position).map_or(0.0, |closest| closest.distance_squared.sqrt());
    let colors = mesh.positions().iter().map(|&position| sequential_color(away(position) / most)).collect();
    let moved = mesh.positions().iter().map(|&position| position + DVec3::X * aside).collect();
    Ok(SceneMesh { colors: Some(colors), ..SceneMesh::new(moved, mesh.triangles().to_vec()) })
}
