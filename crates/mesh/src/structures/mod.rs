//! Ways to store which elements of a mesh meet: the same queries on every one, exact converters between them.
//!
//! Connectivity alone, apart from coordinates and attributes: vertices and faces keep their numbers in every structure,
//! so that columns beside them stay right. [`Incidence`] is what all of them answer; [`Query`] names the nine questions.

mod error;
mod face_list;
mod half_edge_mesh;
mod ids;
mod incidence;
mod indexed_polygons;
mod indexed_triangles;
mod kind;
mod scan;
mod sides;
mod update;
mod update_triangles;

pub use error::StructureError;
pub use half_edge_mesh::{
    AroundFace, AroundVertex, BreadthFirst, Compacted, Counts, HalfEdgeMesh, Hole, Illegal, Reached, Renumbering,
};
pub use ids::{CornerId, EdgeId, FaceId, HalfEdgeId, VertexId};
pub use incidence::{Answered, Cost, Incidence, Query, Unanswered, Visitor};
pub use indexed_polygons::IndexedPolygons;
pub use indexed_triangles::IndexedTriangles;
pub use kind::StructureKind;
pub use update::{LocalUpdate, Update};
