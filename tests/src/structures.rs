//! Mesh structures on real files, against what the judge finds of their topology.

use std::collections::BTreeSet;

use shapeloom::core::Exec;
use shapeloom::judge::Topology;
use shapeloom::mesh::structures::{
    Cost, ExtendedEdgeList, FaceVertex, Incidence, IncidenceMatrices, IndexedPolygons, IndexedTriangles, Query,
    StructureError, StructureKind, WingedEdge,
};
use shapeloom::mesh::{MeshError, PolyMesh};
use shapeloom::shape::Geometry;

use crate::collection::{facts, read_file};

/// Whether a structure should hold what the judge found.
fn fits(kind: StructureKind, topology: &Topology, triangles: bool) -> bool {
    use StructureKind as Kind;
    let edges = topology.repeating_faces.is_empty()
        && topology.non_manifold_edges.is_empty()
        && topology.inconsistent_edges.is_empty();
    match kind {
        Kind::TriangleSoup | Kind::IndexedTriangles => triangles,
        Kind::IncidenceMatrices => topology.repeating_faces.is_empty(),
        Kind::ExtendedEdgeList => edges,
        Kind::WingedEdge | StructureKind::HalfEdgeMesh => edges && topology.non_manifold_vertices.is_empty(),
        Kind::TriangleHalfEdges | Kind::CornerTable => triangles && edges && topology.non_manifold_vertices.is_empty(),
        _ => true,
    }
}

/// Whether what an error names is the first that the judge found, and the count is the judge's.
fn agrees(error: &StructureError, topology: &Topology) -> bool {
    match error {
        StructureError::Mesh(MeshError::NotTriangle { .. }) => true,
        StructureError::RepeatedCorner { face, count, .. } => {
            topology.repeating_faces.first() == Some(face) && topology.repeating_faces.len() == *count
        }
        StructureError::NonManifoldEdge { vertices, count, .. } => {
            topology.non_manifold_edges.iter().min() == Some(vertices) && topology.non_manifold_edges.len() == *count
        }
        StructureError::Orientation { vertices, count, .. } => {
            let edges = topology.inconsistent_edges.iter().map(|&[a, b]| [a.min(b), a.max(b)]);
            edges.min() == Some(*vertices) && topology.inconsistent_edges.len() == *count
        }
        StructureError::NonManifoldVertex { vertex, count, .. } => {
            topology.non_manifold_vertices.first() == Some(vertex) && topology.non_manifold_vertices.len() == *count
        }
        _ => false,
    }
}

/// An answer as a set that all structures agree on: edges by their vertices.
fn told(structure: &dyn Incidence, query: Query, element: u32) -> BTreeSet<[u32; 2]> {
    let found = structure.answer(query, element).expect("it answers");
    if !query.name().ends_with('E') {
        return found.into_iter().map(|number| [number; 2]).collect();
    }
    found.into_iter().map(|edge| ends(structure, edge)).collect()
}

fn ends(structure: &dyn Incidence, edge: u32) -> [u32; 2] {
    let ends = structure.answer(Query::EV, edge).expect("it answers");
    [ends[0].min(ends[1]), ends[0].max(ends[1])]
}

/// Compares a structure with the face list on a few elements.
fn assert_same_answers(name: &str, faces: &IndexedPolygons, structure: &dyn Incidence, edges: usize) {
    let Ok(own) = structure.edges() else { return };
    assert_eq!(own.len(), edges, "{name}");
    let few = |count: usize| [0, count / 2, count.saturating_sub(1)].into_iter().filter(move |&i| i < count);
    // The edges that stand where the face list has its first, middle and last.
    let listed = faces.edges().expect("faces have edges");
    let near: Vec<(u32, u32)> = few(listed.len())
        .map(|i| {
            let wanted = ends(faces, listed[i].0);
            let found = own.iter().find(|edge| ends(structure, edge.0) == wanted);
            (listed[i].0, found.unwrap_or_else(|| panic!("{name} has no edge {wanted:?}")).0)
        })
        .collect();
    for query in Query::ALL.into_iter().filter(|&query| structure.cost(query) != Cost::Unanswered) {
        let pairs: Vec<(u32, u32)> = match query.name().as_bytes()[0] {
            b'V' => few(faces.vertex_count()).map(|i| (i as u32, i as u32)).collect(),
            b'E' => near.clone(),
            _ => few(faces.face_count()).map(|i| (i as u32, i as u32)).collect(),
        };
        for (listed, own) in pairs {
            assert_eq!(told(structure, query, own), told(faces, query, listed), "{name}: {query} of {own}");
        }
    }
}

#[test]
fn files_are_held_or_refused_as_the_judge_says() {
    let files = facts(&["off/", "obj/", "ply/", "stl/", "synthetic/", "subdiv-golden/"]);
    let (mut held, mut refused) = (0, 0);
    for file in &files {
        for part in read_file(&file.path).expect("a sound file").shape.parts {
            let mesh = match &*part.geometry {
                Geometry::TriMesh(mesh) => PolyMesh::from(mesh.clone()),
                Geometry::PolyMesh(mesh) => mesh.clone(),
                _ => continue,
            };
            let topology = Topology::of(&mesh, &Exec::default()).expect("memory enough");
            let faces = IndexedPolygons::from(&mesh);
            let triangles = IndexedTriangles::try_from(&faces).is_ok();
            for kind in StructureKind::ALL {
                let name = format!("{}, {kind}", file.name());
                match kind.build(&faces, &Exec::default()) {
                    Ok(structure) => {
                        assert!(fits(kind, &topology, triangles), "{name}");
                        assert_same_answers(&name, &faces, &*structure, topology.edges);
                        held += 1;
                    }
                    Err(error) => {
                        assert!(!fits(kind, &topology, triangles) && agrees(&error, &topology), "{name}: {error}");
                        refused += 1;
                    }
                }
            }
            assert_eq!(IndexedPolygons::from(&FaceVertex::from(&faces)), faces, "{}", file.name());
            let back = [
                ExtendedEdgeList::try_from(&faces).map(|list| IndexedPolygons::from(&list)),
                WingedEdge::try_from(&faces).map(|mesh| IndexedPolygons::from(&mesh)),
                IncidenceMatrices::try_from(&faces).map(|matrices| IndexedPolygons::from(&matrices)),
            ];
            assert!(back.iter().flatten().all(|back| *back == faces), "{}", file.name());
        }
    }
    assert!(files.is_empty() || (held > 600 && refused > 50), "{held} held, {refused} refused");
}
