//! Edges of a sphere flipped at random, and edges split, collapsed and flipped until they are about equally long;
//! nothing folds over, and an attribute comes along.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::f64::consts::PI;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::Sphere;
use shapeloom::mesh::structures::{EdgeId, VertexId};
use shapeloom::mesh::{Column, Domain, EditableMesh, TriangulatePolygons, Values};
use shapeloom::render::{Picture, Scene, SceneMesh, sequential_color};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let sphere = Sphere { segments: 36, bands: 18, ..Sphere::new() }.mesh(&Exec::default())?.value;
    let mut sphere = TriangulatePolygons::new().convert(&sphere)?.value;
    let heights = sphere.positions().iter().map(|position| position.z).collect();
    sphere.insert_attribute(Domain::Vertex, Column::try_new("height", 1, Values::F64(heights))?)?;

    // Whatever the order, a flip that would turn a face over or double an edge is refused.
    let mut shaken = EditableMesh::try_from(&sphere)?;
    let (mut state, mut flips) = (1u32, 0);
    for _ in 0..3000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let edge = EdgeId((state >> 8) % shaken.connectivity().edge_slots() as u32);
        flips += usize::from(shaken.flip_edge(edge).is_ok());
    }
    println!("flips: {flips} done, {} refused", 3000 - flips);

    let mut even = EditableMesh::try_from(&sphere)?;
    (0..6).for_each(|_| even_out(&mut even, 0.22));
    let mut scene = Scene::default();
    for (mesh, x) in [(&EditableMesh::try_from(&sphere)?, -2.2), (&shaken, 0.0), (&even, 2.2)] {
        let (mesh, _) = mesh.to_triangles(&Exec::default())?;
        println!("{} triangles, volume {:.4}", mesh.triangles().len(), mesh.volume());
        let height = mesh.attribute(Domain::Vertex, "height").ok_or("no heights")?;
        let colors = (0..height.len()).map(|vertex| sequential_color(0.55 + 0.35 * height.number(vertex, 0)));
        let positions = mesh.positions().iter().map(|&position| position + DVec3::X * x).collect();
        let plain = SceneMesh::new(positions, mesh.triangles().to_vec());
        scene.surfaces.push(SceneMesh { colors: Some(colors.collect()), ..plain });
    }
    let look = Picture { wires: true, ..Picture::new() };
    println!("{}", output.draw("local_operators", &scene, [0.0, 28.0], look)?.display());
    Ok(())
}

/// Splits long edges, collapses short ones, flips those that are not Delaunay; then moves each vertex to the middle of
/// its neighbours.
fn even_out(mesh: &mut EditableMesh, length: f64) {
    for edge in (0..mesh.connectivity().edge_slots() as u32).map(EdgeId) {
        if mesh.connectivity().has_edge(edge) {
            let (connectivity, at) = (mesh.connectivity(), |vertex: VertexId| mesh.positions()[vertex.index()]);
            let [a, b] = connectivity.ends(edge).map(at);
            let (middle, longest) = ((a + b).normalize(), length * 4.0 / 3.0);
            let far = |vertex| near(mesh, vertex).any(|other| other.distance(middle) > longest);
            let third = |half| at(connectivity.target(connectivity.next(half)));
            let opposite = connectivity.halves(edge).map(third).map(|c| (a - c).angle_between(b - c));
            // What is refused stays as it is.
            if a.distance(b) > longest {
                mesh.split_edge(edge, middle).ok();
            } else if a.distance(b) < length * 0.8 && !connectivity.ends(edge).into_iter().any(far) {
                mesh.collapse_edge(edge, middle).ok();
            } else if opposite[0] + opposite[1] > PI {
                mesh.flip_edge(edge).ok();
            }
        }
    }
    for vertex in mesh.connectivity().live_vertices().collect::<Vec<_>>() {
        mesh.positions_mut()[vertex.index()] = near(mesh, vertex).sum::<DVec3>().normalize();
    }
}

fn near(mesh: &EditableMesh, vertex: VertexId) -> impl Iterator<Item = DVec3> {
    let around = mesh.connectivity().around_vertex(vertex);
    around.map(|half| mesh.positions()[mesh.connectivity().target(half).index()])
}
