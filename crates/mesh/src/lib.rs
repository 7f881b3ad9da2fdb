//! Meshes and their simpler relatives: data structures, attributes, and the operations that need nothing else.
//!
//! - [`TriMesh`] and [`PolyMesh`]: indexed faces with attribute columns on vertices, faces and wedges (the corners of
//!   faces).
//! - [`Polyline`], [`GeometricGraph`], [`HeightField`], [`QuadGrid`], [`PointCloud`], [`PlanarRegion`].
//! - [`Column`], [`ListColumn`], [`Attributes`], [`Origins`] and [`carry`]: attributes of any name, moved through every
//!   operation by one function, or their loss reported.
//! - Operations, each a [`Convert`](shapeloom_core::Convert) value: [`Weld`], [`VertexNormals`], [`OrientFaces`],
//!   [`TriangulatePolygons`], [`TriangulateHeightField`], [`GreedyInsertion`], [`PlanarizeQuads`], [`Compact`]; in a plane, on
//!   exact signs, [`DelaunayTriangulation`] of scattered points, [`ConstrainedDelaunay`] of points and edges,
//!   [`TriangulateRegion`] of loops with holes.
//! - [`structures`]: ways to store connectivity behind one interface, and converters between them.
//! - [`EditableMesh`]: flips, splits and collapses of constant time, with positions and attributes.
//! - [`primitives`]: ready shapes with closed-form facts.

#[cfg(test)]
mod poll_count;
pub mod primitives;
mod stray_samples;
pub mod structures;

mod attributes;
mod carry;
mod collapsed;
mod column;
mod compact_mesh;
mod ear_clipping;
mod editable_mesh;
mod error;
mod geometric_graph;
mod greedy_insertion;
mod height_field;
mod list_column;
mod mesh_attributes;
mod normals;
mod orient_faces;
mod planarize_quads;
mod plane;
mod point_cloud;
mod poly_mesh;
mod polyline;
mod quad_grid;
mod quad_planarity;
mod sums;
mod tri_mesh;
mod triangulate_height_field;
mod triangulate_polygons;
mod vertex_normals;
mod weld;

pub use attributes::{Attributes, COLOR, GROUP, MATERIAL, NORMAL, PATCH, SMOOTHING, TEXCOORD};
pub use carry::{MeshOrigins, Origins, carry};
pub use collapsed::collapsed_leave_traces;
pub use column::{Blend, Column, TransformRule, Values};
pub use compact_mesh::{Compact, CompactMesh};
pub use editable_mesh::EditableMesh;
pub use error::{AttributeError, Domain, MeshError};
pub use geometric_graph::GeometricGraph;
pub use greedy_insertion::GreedyInsertion;
pub use height_field::HeightField;
pub use list_column::ListColumn;
pub use mesh_attributes::MeshAttributes;
pub use normals::{face_normals, newell_vector, triangle_normal};
pub use orient_faces::{OrientFaces, Outside};
pub use planarize_quads::PlanarizeQuads;
pub use plane::{
    ConstrainedDelaunay, Crossings, DelaunayTriangulation, KeptTriangles, PlanarRegion, PlaneError, ProjectionPlane,
    RegionMethod, TriangulateRegion,
};
pub use point_cloud::PointCloud;
pub use poly_mesh::PolyMesh;
pub use polyline::Polyline;
pub use quad_grid::QuadGrid;
pub use quad_planarity::{PLANARITY, QuadPlanarity, planarity_column};
pub use tri_mesh::TriMesh;
pub use triangulate_height_field::{Diagonal, TriangulateHeightField};
pub use triangulate_polygons::{QuadDiagonal, TriangulatePolygons};
pub use vertex_normals::{NormalWeight, VertexNormals};
pub use weld::Weld;
