//! Conversions between structures, by way of the list of faces.
//!
//! A structure that knows faces gives them as [`IndexedPolygons`], and is made from them; what fits both is the same after any
//! chain of conversions, because each keeps the numbers of vertices and faces, the order of corners and their start. Structures
//! without faces (edge list, adjacency matrix) are made from all others and exchanged with each other, but give no faces.

use shapeloom_core::Exec;

use super::{
    AdjacencyMatrix, CornerTable, EdgeList, ExtendedEdgeList, FaceVertex, HalfEdgeMesh, IncidenceMatrices,
    IndexedPolygons, IndexedTriangles, StructureError, TriangleHalfEdges, TriangleSoup, WingedEdge,
};

/// An `Exec` for conversions that cannot fail.
pub(crate) fn without_limits() -> Exec {
    Exec::default().with_memory(u64::MAX)
}

/// Every edge of the faces.
impl From<&IndexedPolygons> for EdgeList {
    fn from(faces: &IndexedPolygons) -> Self {
        Self::try_build(faces, &without_limits()).expect("nothing stops it")
    }
}

/// Exact.
impl From<&IndexedPolygons> for FaceVertex {
    fn from(faces: &IndexedPolygons) -> Self {
        faces.clone().into()
    }
}

/// `TryFrom` faces by `try_build`.
macro_rules! build_from_faces {
    ($($to:ident),*) => {$(
        /// Exact; the error names what does not fit.
        impl TryFrom<&IndexedPolygons> for $to {
            type Error = StructureError;

            fn try_from(faces: &IndexedPolygons) -> Result<Self, StructureError> {
                Self::try_build(faces, &Exec::default())
            }
        }
    )*};
}

build_from_faces!(ExtendedEdgeList, WingedEdge, AdjacencyMatrix, IncidenceMatrices);

/// Conversions by way of [`IndexedPolygons`]: `From` to what holds any faces, `TryFrom` to what does not.
macro_rules! convert_by_faces {
    ($($from:ident => total [$($total:ident),*], partial [$($partial:ident),*];)*) => {$(
        $(
            /// All that the target stores is kept.
            impl From<&$from> for $total {
                fn from(source: &$from) -> Self {
                    Self::from(&IndexedPolygons::from(source))
                }
            }
        )*
        $(
            /// All that the target stores is kept; the error names what does not fit.
            impl TryFrom<&$from> for $partial {
                type Error = StructureError;

                fn try_from(source: &$from) -> Result<Self, StructureError> {
                    Self::try_from(&IndexedPolygons::from(source))
                }
            }
        )*
    )*};
}

convert_by_faces! {
    TriangleSoup => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix, IncidenceMatrices];
    ExtendedEdgeList => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, IndexedTriangles, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix, IncidenceMatrices];
    IndexedTriangles => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, WingedEdge, AdjacencyMatrix, IncidenceMatrices];
    FaceVertex => total [EdgeList],
        partial [
            HalfEdgeMesh, ExtendedEdgeList, IndexedTriangles, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
    WingedEdge => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, IndexedTriangles, TriangleHalfEdges, CornerTable, AdjacencyMatrix, IncidenceMatrices];
    TriangleHalfEdges => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, WingedEdge, AdjacencyMatrix, IncidenceMatrices];
    CornerTable => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, WingedEdge, AdjacencyMatrix, IncidenceMatrices];
    IncidenceMatrices => total [EdgeList, FaceVertex],
        partial [HalfEdgeMesh, ExtendedEdgeList, IndexedTriangles, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix];
    HalfEdgeMesh => total [EdgeList, FaceVertex],
        partial [
            ExtendedEdgeList, IndexedTriangles, WingedEdge, TriangleHalfEdges, CornerTable, AdjacencyMatrix,
            IncidenceMatrices
        ];
}
