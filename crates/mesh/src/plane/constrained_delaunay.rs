//! Points and edges that must stay to triangles.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Loss, Options, choice, options,
};

use super::ANGLES;
use super::projection::{Projection, ProjectionPlane};
use super::sheet::{Kept, Refine, Sheet};
use super::triangulate_region::Crossings;
use crate::{GeometricGraph, TriMesh};

choice! {
    /// Which triangles of a constrained triangulation are kept.
    pub enum KeptTriangles {
        /// All within the convex hull of the vertices.
        Everything = "everything",
        /// Those that edges enclose: a way to them from outside crosses an odd number of edges, if it crosses as few as
        /// can be. For loops apart from each other this is the even-odd rule.
        Enclosed = "enclosed",
    }
}

options! {
    /// Triangulates vertices in a plane so that the given edges are edges of triangles: no vertex that sees a triangle lies
    /// within the circle around it (Chew 1989).
    ///
    /// The vertices and edges of a graph are projected along an axis, or onto the plane that fits best. Where edges cross
    /// they are split at a new vertex, at the middle height of both, and the report says how many there are, how far
    /// rounding moved them and how far apart the edges are there; edges through a vertex are split there, parts that
    /// overlap count once, edges without length are left out, and each is told. Triangles are kept within the convex hull
    /// or where edges enclose them. With an angle or area wanted, vertices are added (Ruppert 1995). Attributes of edges
    /// have no place in a mesh and are named as lost. Cost: n log n, and for each edge the triangles that it cuts.
    pub struct ConstrainedDelaunay("constrained-delaunay") {
        required {}
        optional {
            /// The plane of the triangulation.
            plane: ProjectionPlane = ProjectionPlane::Xy,
            /// Which triangles are kept.
            keep: KeptTriangles = KeptTriangles::Everything,
            /// What is done where edges cross.
            crossings: Crossings = Crossings::Split,
            /// The smallest angle wanted, in degrees, reached by adding vertices; 0 adds none. Up to about 30 is reached,
            /// except between edges that meet in less.
            angle: f64 [ANGLES] = 0.0,
            /// The largest area wanted of a triangle in the plane, in square model units; 0 for any.
            max_area: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many vertices may be added.
            max_added: u32 = 100_000,
            /// Whether added vertices may split the given edges. Otherwise angles beside them may stay smaller.
            split_edges: bool = true,
        }
    }
}

impl FromTolerance<GeometricGraph> for ConstrainedDelaunay {
    fn from_tolerance(_: &GeometricGraph, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<GeometricGraph> for ConstrainedDelaunay {
    type Output = TriMesh;

    fn convert_with(&self, source: &GeometricGraph, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        let kept = match self.keep {
            KeptTriangles::Everything => Kept::Hull,
            KeptTriangles::Enclosed => Kept::Enclosed,
        };
        let most = self.max_added;
        let mut converted = Sheet {
            name: Self::NAME,
            words: ["vertex", "edge"],
            positions: source.positions(),
            attributes: source.vertex_attributes(),
            edges: source.edges(),
            projection: Projection::new(self.plane, source.positions()),
            kept,
            refuse_crossings: self.crossings == Crossings::Refuse,
            refine: Refine { angle: self.angle, area: self.max_area, most, split_edges: self.split_edges },
            deviation: (Deviation::Unknown, "the surface between the edges is a choice: the edges lie on it"),
        }
        .triangulate(exec)?;
        let columns = source.edge_attributes().iter().map(|column| format!("edge attribute \"{}\"", column.name()));
        let lists = source.edge_attributes().lists().iter().map(|list| format!("edge list \"{}\"", list.name()));
        let lost = columns.chain(lists).map(|what| Loss::new(what, "triangle meshes have no values on edges"));
        converted.report.losses.extend(lost);
        Ok(converted)
    }
}
