//! A triangle soup welded: the triangles get neighbours, and with them one smooth normal a vertex.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::{Domain, NORMAL, TriMesh, TriangulatePolygons, VertexNormals, Weld};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape, UpAxis};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 36, sides: 18, ..Torus::new() }.mesh(&Exec::default())?.value;
    let torus = TriangulatePolygons::new().convert(&torus)?.value;

    // As many programs store it: each triangle with corners of its own.
    let corners: Vec<DVec3> = (0..torus.triangles().len()).flat_map(|triangle| torus.corners(triangle)).collect();
    let soup = TriMesh::try_new(corners, triples(torus.triangles().len()))?;
    let welded = Weld::new().convert(&soup)?;
    say("equal positions", &soup, &welded.value, &welded.report);
    let welded = welded.value;

    // As other programs store it: corners that differ in the last digits. No vertex moves farther than the distance.
    let noise = |k: usize| DVec3::new((k as f64 * 1.7).sin(), (k as f64 * 2.3).sin(), (k as f64 * 3.1).sin()) * 1e-6;
    let shaken = soup.positions().iter().enumerate().map(|(k, &position)| position + noise(k)).collect();
    let shaken = TriMesh::try_new(shaken, triples(soup.triangles().len()))?;
    let nothing = Weld::new().convert(&shaken)?;
    say("shaken, distance 0", &shaken, &nothing.value, &nothing.report);
    let near = Weld { distance: 1e-5, ..Weld::new() }.convert(&shaken)?;
    say("shaken, distance 1e-5", &shaken, &near.value, &near.report);

    let mut bytes = Vec::new();
    let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(welded.clone()).named("torus")) };
    write(&shape, format_by_id("glb")?, &WriteContext::default(), &mut bytes)?;
    println!("{}", output.write("weld.glb", &bytes)?.display());

    // Both with a normal for each vertex: in the soup that is the normal of its only triangle.
    let scene = Scene { surfaces: vec![smooth(&soup, -1.45)?, smooth(&welded, 1.45)?] };
    println!("{}", output.draw("weld", &scene, [0.0, 40.0], Picture::new())?.display());
    Ok(())
}

fn triples(count: usize) -> Vec<[u32; 3]> {
    (0..count as u32).map(|triangle| [3 * triangle, 3 * triangle + 1, 3 * triangle + 2]).collect()
}

fn say(what: &str, before: &TriMesh, after: &TriMesh, report: &shapeloom::core::Report) {
    let counts = [before, after].map(|mesh| (mesh.positions().len(), mesh.memory_bytes()));
    let [(vertices, bytes), (left, bytes_left)] = counts;
    println!("{what}: {vertices} vertices to {left}, {bytes} bytes to {bytes_left}, error {}", report.deviation);
}

fn smooth(mesh: &TriMesh, x: f64) -> Result<SceneMesh, Box<dyn Error>> {
    let mesh = VertexNormals::new().convert(mesh)?.value;
    let column = mesh.attribute(Domain::Vertex, NORMAL).ok_or("no normals")?;
    let normals = mesh.triangles().as_flattened().iter().map(|&vertex| column.vector(vertex as usize)).collect();
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    Ok(SceneMesh { normals: Some(normals), ..SceneMesh::new(positions, mesh.triangles().to_vec()) })
}
