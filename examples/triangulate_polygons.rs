//! Concave polygons cut into triangles without new vertices, and what the report says where polygons are not flat.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::TAU;

use shapeloom::core::Convert;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::render::{Mode, Picture, Scene, SceneMesh};
use shapeloom::shape::{Part, Shape};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let star = prism(9, 0.0)?;
    let converted = TriangulatePolygons::new().convert(&star)?;
    let (mesh, report) = (converted.value, converted.report);
    println!("{} polygons, {} triangles, error {}", star.face_count(), mesh.triangles().len(), report.deviation);
    println!("area {:.12} before, {:.12} after", star.area(), mesh.area());

    // Sides that are twisted are not flat: they have no surface of their own, and the report can only estimate.
    let twisted = TriangulatePolygons::new().convert(&prism(9, 0.2)?)?.report;
    println!("twisted: error {}; {}", twisted.deviation, twisted.basis);

    // An outline that crosses itself is cut as well as possible and named.
    let corners = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]].map(DVec3::from);
    let bow_tie = PolyMesh::from_faces(corners.to_vec(), &[[0, 1, 2, 3]])?;
    for finding in TriangulatePolygons::new().convert(&bow_tie)?.report.findings.iter() {
        println!("bow tie: {} {}", finding.code, finding.message);
    }

    let mut bytes = Vec::new();
    let shape = Shape::new(Part::new(mesh.clone()).named("star"));
    write(&shape, format_by_id("obj")?, &WriteContext::default(), &mut bytes)?;
    println!("{}", output.write("triangulate_polygons.obj", &bytes)?.display());

    // On the left only the sides of the polygons, on the right those of all triangles.
    let left = SceneMesh { edges: Some(polygon_sides(&star, &mesh)), ..moved(&mesh, -1.15) };
    let scene = Scene { surfaces: vec![left, moved(&mesh, 1.15)] };
    let look = Picture { mode: Mode::Flat, wires: true, ..Picture::new() };
    println!("{}", output.draw("triangulate_polygons", &scene, [0.0, 52.0], look)?.display());
    Ok(())
}

/// A star with that many rays as bottom and top, joined by quadrilaterals, the top turned by an angle.
fn prism(rays: u32, twist: f64) -> Result<PolyMesh, Box<dyn Error>> {
    let count = 2 * rays;
    let ring = |height: f64, turn: f64| {
        (0..count).map(move |i| {
            let (angle, radius) = (TAU * f64::from(i) / f64::from(count) + turn, if i % 2 == 0 { 1.0 } else { 0.45 });
            DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
        })
    };
    let mut faces: Vec<Vec<u32>> = vec![(0..count).rev().collect(), (count..2 * count).collect()];
    faces.extend((0..count).map(|i| vec![i, (i + 1) % count, count + (i + 1) % count, count + i]));
    Ok(PolyMesh::from_faces(ring(0.0, 0.0).chain(ring(0.4, twist)).collect(), &faces)?)
}

/// Which sides of the triangles are sides of polygons.
fn polygon_sides(polygons: &PolyMesh, mesh: &TriMesh) -> Vec<[bool; 3]> {
    let sides: Vec<[u32; 2]> =
        polygons.faces().flat_map(|face| (0..face.len()).map(|i| [face[i], face[(i + 1) % face.len()]])).collect();
    let flags = |[a, b, c]: &[u32; 3]| [[*a, *b], [*b, *c], [*c, *a]].map(|side| sides.contains(&side));
    mesh.triangles().iter().map(flags).collect()
}

fn moved(mesh: &TriMesh, x: f64) -> SceneMesh {
    let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
    SceneMesh::new(positions, mesh.triangles().to_vec())
}
