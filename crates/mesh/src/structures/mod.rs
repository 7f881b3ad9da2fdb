//! Ways to store which elements of a mesh meet: the same queries on every one, exact converters between them.
//!
//! Connectivity alone, apart from coordinates and attributes: vertices and faces keep their numbers in every structure,
//! so that columns beside them stay right. [`Incidence`] is what all of them answer; [`Query`] names the nine questions.

mod corner_table;
mod error;
mod face_list;
mod ids;
mod incidence;
mod indexed_polygons;
mod indexed_triangles;
mod kind;
mod orientation;
mod scan;
mod sides;
mod triangle_half_edges;

pub use corner_table::CornerTable;
pub use error::StructureError;
pub(crate) use face_list::FaceList;
pub use ids::{CornerId, EdgeId, FaceId, HalfEdgeId, VertexId};
pub use incidence::{Answered, Cost, Incidence, Query, Unanswered, Visitor};
pub use indexed_polygons::IndexedPolygons;
pub use indexed_triangles::IndexedTriangles;
pub use kind::StructureKind;
pub(crate) use orientation::Orientation;
pub use triangle_half_edges::{OneRing, TriangleHalfEdges};
