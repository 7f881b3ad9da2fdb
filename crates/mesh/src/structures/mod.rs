//! Ways to store which elements of a mesh meet: the same queries on every one, exact converters between them.
//!
//! Connectivity alone, apart from coordinates and attributes: vertices and faces keep their numbers in every structure,
//! so that columns beside them stay right. [`Incidence`] is what all of them answer; [`Query`] names the nine questions.

mod adjacency_matrix;
mod conversions;
mod corner_table;
mod edge_list;
mod edge_table;
mod error;
mod extended_edge_list;
mod face_list;
mod face_vertex;
mod half_edge_mesh;
mod ids;
mod incidence;
mod incidence_matrices;
mod indexed_polygons;
mod indexed_triangles;
mod kind;
#[cfg(test)]
mod laws;
mod lists;
mod once;
mod orientation;
mod scan;
mod sides;
mod triangle_half_edges;
mod triangle_soup;
mod update;
mod update_triangles;
mod walk;
mod winged_edge;

pub use adjacency_matrix::AdjacencyMatrix;
pub use corner_table::CornerTable;
pub use edge_list::EdgeList;
pub use error::StructureError;
pub use extended_edge_list::{ExtendedEdge, ExtendedEdgeList};
pub(crate) use face_list::FaceList;
pub use face_vertex::FaceVertex;
pub use half_edge_mesh::{
    AroundFace, AroundVertex, BreadthFirst, Compacted, Counts, HalfEdgeMesh, Hole, Illegal, Reached, Renumbering,
};
pub use ids::{CornerId, EdgeId, FaceId, HalfEdgeId, VertexId};
pub use incidence::{Answered, Cost, Incidence, Query, Unanswered, Visitor};
pub use incidence_matrices::{IncidenceMatrices, SignedMatrix};
pub use indexed_polygons::IndexedPolygons;
pub use indexed_triangles::IndexedTriangles;
pub use kind::StructureKind;
pub(crate) use orientation::Orientation;
pub use triangle_half_edges::{OneRing, TriangleHalfEdges};
pub use triangle_soup::TriangleSoup;
pub use update::{LocalUpdate, Update};
pub use winged_edge::{WingedEdge, Wings};
