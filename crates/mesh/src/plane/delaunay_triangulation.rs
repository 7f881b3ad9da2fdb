//! Scattered points to triangles.

use shapeloom_core::{Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, options};

use super::ANGLES;
use super::projection::{Projection, ProjectionPlane};
use super::sheet::{Kept, Refine, Sheet};
use crate::{PointCloud, TriMesh};

options! {
    /// Triangulates scattered points in a plane, as of a terrain: no point lies within the circle around a triangle
    /// (Delaunay 1934).
    ///
    /// Points are projected along an axis, or onto the plane that fits them best. They become the vertices, with their
    /// own positions, heights and attributes; of several at one place of the plane the first is kept. The triangles fill
    /// the convex hull. Every decision is the sign of a determinant, without tolerance, and coordinates of 1e-300 or 1e150
    /// do as well as others. Points on one line give no triangles, and a finding. What the surface should be between the
    /// points is not known: the report bounds nothing. With an angle or area wanted, vertices are added, at heights and
    /// with attributes mixed in the triangle that they lie in. Cost: n log n, and in the worst case of adding vertices as
    /// many as are allowed.
    pub struct DelaunayTriangulation("delaunay-triangulation") {
        required {}
        optional {
            /// The plane of the triangulation.
            plane: ProjectionPlane = ProjectionPlane::Xy,
            /// The smallest angle wanted, in degrees, reached by adding vertices; 0 adds none. Up to about 30 is reached.
            angle: f64 [ANGLES] = 0.0,
            /// The largest area wanted of a triangle in the plane, in square model units; 0 for any.
            max_area: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// How many vertices may be added.
            max_added: u32 = 100_000,
        }
    }
}

impl FromTolerance<PointCloud> for DelaunayTriangulation {
    fn from_tolerance(_: &PointCloud, _: f64) -> Self {
        Self::new()
    }
}

impl Convert<PointCloud> for DelaunayTriangulation {
    type Output = TriMesh;

    fn convert_with(&self, source: &PointCloud, exec: &Exec) -> Result<Converted<TriMesh>, ConvertError> {
        self.validate()?;
        Sheet {
            name: Self::NAME,
            words: ["point", "edge"],
            positions: source.positions(),
            attributes: source.attributes(),
            edges: &[],
            projection: Projection::new(self.plane, source.positions()),
            kept: Kept::Hull,
            refuse_crossings: false,
            refine: Refine { angle: self.angle, area: self.max_area, most: self.max_added, split_edges: true },
            deviation: (Deviation::Unknown, "the surface between the points is a choice: the points lie on it"),
        }
        .triangulate(exec)
    }
}
