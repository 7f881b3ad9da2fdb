//! Conversions between any two structures are exact.

use super::meshes::{Dice, Mesh, mesh, random, random_patch, special};
use crate::structures::{
    AdjacencyMatrix, CornerTable, EdgeList, ExtendedEdgeList, FaceVertex, HalfEdgeMesh, IncidenceMatrices,
    IndexedPolygons, IndexedTriangles, TriangleHalfEdges, WingedEdge,
};

fn told(error: impl ToString) -> String {
    error.to_string()
}

/// A source that holds the mesh gives it back as it was, and every target is the same through the source as straight from the
/// mesh; where one is refused the other is, with the same words. Adds up how many pairs could be compared.
macro_rules! assert_exact {
    ($mesh:expr, $held:expr, $($from:ident => [$($to:ident),*];)*) => {$(
        let faces = &$mesh.faces;
        if let Ok(source) = $from::try_from(faces).map_err(told) {
            assert_eq!(&IndexedPolygons::from(&source), faces, "{}: {}", $mesh.name, stringify!($from));
            $(
                let straight = $to::try_from(faces).map_err(told);
                let through = $to::try_from(&source).map_err(told);
                assert_eq!(through, straight, "{}: {} to {}", $mesh.name, stringify!($from), stringify!($to));
                $held += usize::from(straight.is_ok());
            )*
        }
    )*};
}

fn assert_all_pairs(mesh: &Mesh) -> usize {
    let mut held = 0;
    assert_exact! { mesh, held,
        ExtendedEdgeList => [
            HalfEdgeMesh, EdgeList, IndexedTriangles, FaceVertex, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
        IndexedTriangles => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, FaceVertex, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
        FaceVertex => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, IndexedTriangles, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
        WingedEdge => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, IndexedTriangles, FaceVertex, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
        TriangleHalfEdges => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, IndexedTriangles, FaceVertex, WingedEdge, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
        CornerTable => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, IndexedTriangles, FaceVertex, WingedEdge, TriangleHalfEdges, AdjacencyMatrix,
            IncidenceMatrices
        ];
        IncidenceMatrices => [
            HalfEdgeMesh, EdgeList, ExtendedEdgeList, IndexedTriangles, FaceVertex, WingedEdge, TriangleHalfEdges, CornerTable,
            AdjacencyMatrix
        ];
            HalfEdgeMesh => [
            EdgeList, ExtendedEdgeList, IndexedTriangles, FaceVertex, WingedEdge, TriangleHalfEdges, CornerTable,
            AdjacencyMatrix, IncidenceMatrices
        ];
    }
    let list = EdgeList::from(&mesh.faces);
    let matrix = AdjacencyMatrix::try_from(&list).unwrap();
    assert_eq!(matrix, AdjacencyMatrix::try_from(&mesh.faces).unwrap(), "{}", mesh.name);
    assert_eq!(EdgeList::from(&matrix), list, "{}", mesh.name);
    // Those that are moved.
    assert_eq!(IndexedPolygons::from(FaceVertex::from(mesh.faces.clone())), mesh.faces);
    if let Ok(triangles) = IndexedTriangles::try_from(&mesh.faces) {
        assert_eq!(IndexedPolygons::from(triangles), mesh.faces);
    }
    held
}

#[test]
fn every_pair_is_exact_and_refuses_alike() {
    let most = special().iter().map(assert_all_pairs).max();
    assert_eq!(most, Some(7 * 9 + 9));
    let mut dice = Dice(17);
    for _ in 0..1500 {
        assert_all_pairs(&random(&mut dice));
    }
    for _ in 0..200 {
        assert_all_pairs(&random_patch(&mut dice));
    }
}

/// All conversions in a row, from one structure to the next.
#[test]
fn a_round_through_all_leaves_the_mesh_as_it_was() {
    let faces = super::meshes::in_triangles(&super::meshes::torus(6, 5)[..20]);
    let start = mesh("open torus with isolated vertices", 40, &faces).faces;
    let extended = ExtendedEdgeList::try_from(&start).unwrap();
    let triangles = IndexedTriangles::try_from(&extended).unwrap();
    let face_vertex = FaceVertex::from(&triangles);
    let winged = WingedEdge::try_from(&face_vertex).unwrap();
    let half_edges = TriangleHalfEdges::try_from(&winged).unwrap();
    let corners = CornerTable::from(&half_edges);
    let matrices = IncidenceMatrices::try_from(&corners).unwrap();
    assert_eq!(IndexedPolygons::from(&matrices), start);
    // By hand from what each of them shows, they pass their own checks.
    let again = ExtendedEdgeList::try_new(40, extended.edges().to_vec(), extended.firsts().to_vec());
    assert_eq!(again.unwrap(), extended);
    let face_edges = (0..faces.len() as u32).map(|face| winged.edge_of_face(face)).collect();
    let vertex_edges = (0..40).map(|vertex| winged.edge_of_vertex(vertex).unwrap_or(u32::MAX)).collect();
    assert_eq!(WingedEdge::try_new(winged.edges().to_vec(), vertex_edges, face_edges).unwrap(), winged);
}
