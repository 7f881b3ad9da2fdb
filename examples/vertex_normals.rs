//! Normals from faces: facets, everything smooth, and creases; and why faces are weighted by their angle.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::{Cylinder, Platonic, Solid};
use shapeloom::mesh::{Domain, NORMAL, NormalWeight, PolyMesh, TriMesh, TriangulatePolygons, VertexNormals};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;

    // At a corner of a cube the normal is the diagonal. Each square is two triangles, so that some corners have four,
    // five or six triangles around them: only weights by angle do not see that.
    let cube = Platonic::new(Solid::Cube).mesh(&Exec::default())?.value;
    let cube = TriangulatePolygons::new().convert(&cube)?.value;
    for weight in [NormalWeight::Angle, NormalWeight::Area, NormalWeight::Uniform] {
        let made = VertexNormals { weight, ..VertexNormals::new() }.convert(&cube)?.value;
        let column = made.attribute(Domain::Vertex, NORMAL).ok_or("no normals")?;
        let turned = |vertex: usize| column.vector(vertex).angle_between(made.positions()[vertex]).to_degrees();
        let most = (0..made.positions().len()).map(turned).fold(0.0, f64::max);
        println!("weights by {weight:?}: the cube's corner normals are off by up to {most:.4} degrees");
    }

    // A cylinder without the normals that it comes with.
    let ready = Cylinder { segments: 32, height: 1.6, ..Cylinder::new() }.mesh(&Exec::default())?.value;
    let bare = PolyMesh::from_faces(ready.positions().to_vec(), &ready.faces().collect::<Vec<_>>())?;
    let bare = TriangulatePolygons::new().convert(&bare)?.value;
    let mut scene = Scene { surfaces: vec![SceneMesh::new(moved(&bare, -2.3), bare.triangles().to_vec())] };
    for (crease_angle, x) in [(180.0, 0.0), (40.0, 2.3)] {
        let converted = VertexNormals { crease_angle, ..VertexNormals::new() }.convert(&bare)?;
        let (mesh, report) = (converted.value, converted.report);
        let place = if mesh.attribute(Domain::Wedge, NORMAL).is_some() { "wedges" } else { "vertices" };
        println!("crease angle {crease_angle}: normals on {place}, error {}", report.deviation);
        let normals = Some(corner_normals(&mesh));
        scene.surfaces.push(SceneMesh { normals, ..SceneMesh::new(moved(&mesh, x), mesh.triangles().to_vec()) });
    }
    println!("{}", output.draw("vertex_normals", &scene, [0.0, 30.0], Picture::new())?.display());
    Ok(())
}

/// A normal for each corner of each triangle, wherever the mesh has them.
fn corner_normals(mesh: &TriMesh) -> Vec<DVec3> {
    let corners = mesh.triangles().as_flattened().iter().enumerate();
    let (wedge, vertex) = (mesh.attribute(Domain::Wedge, NORMAL), mesh.attribute(Domain::Vertex, NORMAL));
    let normal = |(corner, &at): (usize, &u32)| match (wedge, vertex) {
        (Some(column), _) => column.vector(corner),
        (None, Some(column)) => column.vector(at as usize),
        (None, None) => DVec3::ZERO,
    };
    corners.map(normal).collect()
}

fn moved(mesh: &TriMesh, x: f64) -> Vec<DVec3> {
    mesh.positions().iter().map(|&position| position + DVec3::X * x).collect()
}
