//! Half-edges of a torus: walks, and a search that spreads over faces until a fence of edges stops it.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::TriangulatePolygons;
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::structures::{
    EdgeId, FaceId, HalfEdgeMesh, IndexedPolygons, IndexedTriangles, StructureKind, Update, VertexId,
};
use shapeloom::render::{Picture, Scene, SceneMesh, sequential_color};
use shapeloom_examples::Output;

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 64, sides: 28, ..Torus::new() }.mesh(&Exec::default())?.value;
    let torus = TriangulatePolygons::new().convert(&torus)?.value;
    let faces = IndexedPolygons::from(&IndexedTriangles::from(&torus));
    let mesh = HalfEdgeMesh::try_from(&faces)?;
    println!("{:?}, Euler characteristic {}", mesh.counts(), mesh.counts().euler_characteristic());
    let around: Vec<VertexId> = mesh.around_vertex(VertexId(0)).map(|half| mesh.target(half)).collect();
    println!("around vertex 0, counter-clockwise: {around:?}");

    // Everywhere; and within a fence: it crosses no edge between faces on different sides of two planes.
    let middle = |face: FaceId| torus.corners(face.index()).iter().sum::<DVec3>() / 3.0;
    let side = |face: FaceId| {
        let at = middle(face);
        (at.x > -0.3, at.z > -0.15)
    };
    let fence = |edge: EdgeId| {
        let [left, right] = mesh.halves(edge).map(|half| mesh.face(half).map(side));
        left == right
    };
    let start = (0..torus.triangles().len() as u32).map(FaceId).max_by(|&a, &b| {
        let toward = |face| middle(face).dot(DVec3::new(0.6, -1.0, 0.8));
        toward(a).total_cmp(&toward(b))
    });
    let everywhere: Vec<_> = mesh.breadth_first(start).collect();
    let fenced: Vec<_> = mesh.breadth_first_within(start, fence).collect();
    let farthest = everywhere.last().map_or(0, |reached| reached.distance);
    println!("{} faces, the farthest {farthest} steps away; {} within the fence", everywhere.len(), fenced.len());

    let mut scene = Scene::default();
    for (reached, x) in [(&everywhere, -1.45), (&fenced, 1.45)] {
        let mut steps = vec![None; torus.triangles().len()];
        reached.iter().for_each(|found| steps[found.face.index()] = Some(f64::from(found.distance)));
        // Bands of three steps; faces that were not come to are grey.
        let color = |steps: Option<f64>| match steps {
            Some(steps) => sequential_color(0.95 - (steps / 3.0).floor() * 3.0 / f64::from(farthest) * 0.9),
            None => [0.32; 3],
        };
        let colors = steps.into_iter().flat_map(|steps| [color(steps); 3]).collect();
        let corners = (0..torus.triangles().len()).flat_map(|face| torus.corners(face)).map(|at| at + DVec3::X * x);
        let triangles =
            (0..torus.triangles().len() as u32).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
        scene.surfaces.push(SceneMesh { colors: Some(colors), ..SceneMesh::new(corners.collect(), triangles) });
    }
    for kind in StructureKind::ALL {
        println!("an edge flip on {kind}: {:?}", kind.update_cost(Update::FlipEdge));
    }
    println!("{}", output.draw("half_edges", &scene, [0.0, 40.0], Picture::new())?.display());
    Ok(())
}
