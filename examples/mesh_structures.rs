//! One mesh in every structure and back: what each takes, what each knows, what it refuses. The picture shows two winged
//! edges, one inside and one at the border.
#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::mesh::primitives::Torus;
use shapeloom::mesh::structures::{
    CornerTable, Cost, ExtendedEdgeList, FaceVertex, Incidence, IncidenceMatrices, IndexedPolygons, IndexedTriangles,
    Query, StructureKind, TriangleHalfEdges, WingedEdge, Wings,
};
use shapeloom::mesh::{PolyMesh, TriangulatePolygons};
use shapeloom::render::{Picture, Scene, SceneMesh};
use shapeloom_examples::{Output, rod};

const ORANGE: [f32; 3] = [0.9, 0.22, 0.02];
const GREEN: [f32; 3] = [0.12, 0.45, 0.1];
const GOLD: [f32; 3] = [0.8, 0.6, 0.05];

fn main() -> Result<(), Box<dyn Error>> {
    let output = Output::from_arguments()?;
    let torus = Torus { segments: 30, sides: 16, ..Torus::new() }.mesh(&Exec::default())?.value;
    let triangles = IndexedTriangles::from(&TriangulatePolygons::new().convert(&torus)?.value);
    let faces = IndexedPolygons::from(&triangles);
    for kind in StructureKind::ALL {
        let held = kind.build(&faces, &Exec::default())?;
        let words = held.memory_bytes() as f64 / 4.0 / faces.vertex_count() as f64;
        let with = |cost| Query::ALL.iter().filter(|&&query| held.cost(query) == cost).count();
        let (local, scan) = (with(Cost::Local), with(Cost::Scan));
        println!("{:<24}{words:>6.2} words a vertex, {local} queries local, {scan} by looking at all", kind.name());
    }

    // Each conversion is exact: numbers, order and start of corners are kept.
    let winged = WingedEdge::try_from(&FaceVertex::from(&triangles))?;
    let corners = CornerTable::from(&TriangleHalfEdges::try_from(&winged)?);
    let list = ExtendedEdgeList::try_from(&IncidenceMatrices::try_from(&corners)?)?;
    println!("the same after six conversions: {}", IndexedPolygons::from(&list) == faces);
    let pinched = IndexedPolygons::from_faces(5, &[[0, 1, 2], [2, 3, 4]])?;
    println!("two triangles at a corner: {}", WingedEdge::try_from(&pinched).expect_err("two fans"));

    // A torus of quads with a hole.
    let torus = Torus { segments: 16, sides: 10, minor_radius: 0.6, ..Torus::new() }.mesh(&Exec::default())?.value;
    let kept = |face: &&[u32]| !face.iter().any(|vertex| [41, 42].contains(vertex));
    let open: Vec<&[u32]> = torus.faces().filter(kept).collect();
    let open = PolyMesh::from_faces(torus.positions().to_vec(), &open)?;
    let mesh = WingedEdge::try_from(&IndexedPolygons::from(&open))?;
    let mut colors = vec![SceneMesh::GLAZE; open.face_count()];
    let mut scene = Scene::default();
    let at = |vertex: u32| open.positions()[vertex as usize];
    let edge_between = |a, b| mesh.edges().iter().find(|edge| edge.vertices == [a, b]).ok_or("no such edge");
    for edge in [edge_between(1, 2)?, edge_between(31, 32)?] {
        for (&face, color) in edge.faces.iter().zip([GREEN, GOLD]).filter(|(face, _)| **face != Wings::NO_FACE) {
            colors[face as usize] = color;
        }
        let wings = edge.wings.as_flattened().iter().map(|&wing| (&mesh.edges()[wing as usize], [0.02; 3]));
        for (edge, color) in wings.chain([(edge, ORANGE)]) {
            scene.surfaces.push(rod(at(edge.vertices[0]), at(edge.vertices[1]), 0.03, color));
        }
    }
    for (face, &color) in colors.iter().enumerate() {
        let corners: Vec<DVec3> = open.outline(face).collect();
        scene.surfaces.push(SceneMesh { color, ..SceneMesh::new(corners, vec![[0, 1, 2], [0, 2, 3]]) });
    }
    println!("{}", output.draw("mesh_structures", &scene, [150.0, 35.0], Picture::new())?.display());
    Ok(())
}
