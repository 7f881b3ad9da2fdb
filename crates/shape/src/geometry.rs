//! The representations that a part can hold.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, Category, Diagnostic};
use shapeloom_implicit::Implicit;
use shapeloom_mesh::{GeometricGraph, HeightField, PointCloud, PolyMesh, Polyline, TriMesh};
use shapeloom_parametric::{BezierCurve, BezierSurface};
use shapeloom_voxels::VoxelGrid;

use crate::Kind;

/// A shape in one representation. More come as families arrive.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// Points with attributes.
    PointCloud(PointCloud),
    /// A Bézier curve in space.
    BezierCurve(BezierCurve<DVec3>),
    /// Tensor-product Bézier patches.
    BezierSurface(BezierSurface),
    /// Points joined by segments.
    Polyline(Polyline),
    /// Vertices and edges alone.
    GeometricGraph(GeometricGraph),
    /// Heights over a grid.
    HeightField(HeightField),
    /// The zero set of a field.
    Implicit(Implicit),
    /// Samples on a lattice.
    VoxelGrid(VoxelGrid),
    /// Indexed polygons.
    PolyMesh(PolyMesh),
    /// Indexed triangles.
    TriMesh(TriMesh),
}

impl Geometry {
    /// Which representation it is.
    pub fn kind(&self) -> Kind {
        match self {
            Self::PointCloud(_) => Kind::PointCloud,
            Self::BezierCurve(_) => Kind::BezierCurve,
            Self::BezierSurface(_) => Kind::BezierSurface,
            Self::Polyline(_) => Kind::Polyline,
            Self::GeometricGraph(_) => Kind::GeometricGraph,
            Self::HeightField(_) => Kind::HeightField,
            Self::Implicit(_) => Kind::Implicit,
            Self::VoxelGrid(_) => Kind::VoxelGrid,
            Self::PolyMesh(_) => Kind::PolyMesh,
            Self::TriMesh(_) => Kind::TriMesh,
        }
    }

    /// The box of the geometry; of curves and surfaces within a billionth of its size.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::PointCloud(cloud) => cloud.bounds(),
            Self::BezierCurve(curve) => curve.bounds(),
            Self::BezierSurface(surface) => surface.bounds(),
            Self::Polyline(line) => line.bounds(),
            Self::GeometricGraph(graph) => graph.bounds(),
            Self::HeightField(field) => field.bounds(),
            Self::Implicit(implicit) => implicit.bounds(),
            Self::VoxelGrid(grid) => grid.bounds(),
            Self::PolyMesh(mesh) => mesh.bounds(),
            Self::TriMesh(mesh) => mesh.bounds(),
        }
    }

    /// The image under an affine map.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        match self {
            Self::PointCloud(cloud) => Self::PointCloud(cloud.transformed(map)),
            Self::BezierCurve(curve) => Self::BezierCurve(curve.transformed(map)),
            Self::BezierSurface(surface) => Self::BezierSurface(surface.transformed(map)),
            Self::Polyline(line) => Self::Polyline(line.transformed(map)),
            Self::GeometricGraph(graph) => Self::GeometricGraph(graph.transformed(map)),
            Self::HeightField(field) => Self::HeightField(field.transformed(map)),
            Self::Implicit(implicit) => Self::Implicit(implicit.transformed(map)),
            Self::VoxelGrid(grid) => Self::VoxelGrid(grid.transformed(map)),
            Self::PolyMesh(mesh) => Self::PolyMesh(mesh.transformed(map)),
            Self::TriMesh(mesh) => Self::TriMesh(mesh.transformed(map)),
        }
    }

    /// The memory that the geometry takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::PointCloud(cloud) => cloud.memory_bytes(),
            Self::BezierCurve(curve) => size_of_val(curve.control_points()),
            Self::BezierSurface(surface) => surface.memory_bytes(),
            Self::Polyline(line) => line.memory_bytes(),
            Self::GeometricGraph(graph) => graph.memory_bytes(),
            Self::HeightField(field) => field.memory_bytes(),
            Self::Implicit(implicit) => implicit.memory_bytes(),
            Self::VoxelGrid(grid) => grid.memory_bytes(),
            Self::PolyMesh(mesh) => mesh.memory_bytes(),
            Self::TriMesh(mesh) => mesh.memory_bytes(),
        }
    }
}

/// A geometry of another kind than the one asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrongKind {
    /// What was asked for.
    pub expected: Kind,
    /// What it is.
    pub found: Kind,
}

impl fmt::Display for WrongKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "found a {}, expected a {}", self.found, self.expected)
    }
}

impl std::error::Error for WrongKind {}

impl Diagnostic for WrongKind {
    fn code(&self) -> &'static str {
        "E-shape-kind"
    }

    fn category(&self) -> Category {
        Category::Unsupported
    }
}

/// A type that is one kind of [`Geometry`].
pub trait Representation: Into<Geometry> {
    /// Which one.
    const KIND: Kind;

    /// The value, if the geometry is of this kind.
    ///
    /// # Errors
    /// The geometry is of another kind.
    fn from_geometry(geometry: &Geometry) -> Result<&Self, WrongKind>;
}

macro_rules! holds {
    ($($variant:ident($type:ty)),* $(,)?) => {$(
        impl From<$type> for Geometry {
            fn from(value: $type) -> Self {
                Self::$variant(value)
            }
        }

        impl Representation for $type {
            const KIND: Kind = Kind::$variant;

            fn from_geometry(geometry: &Geometry) -> Result<&Self, WrongKind> {
                match geometry {
                    Geometry::$variant(value) => Ok(value),
                    other => Err(WrongKind { expected: Self::KIND, found: other.kind() }),
                }
            }
        }
    )*};
}

holds!(
    PointCloud(PointCloud),
    BezierCurve(BezierCurve<DVec3>),
    BezierSurface(BezierSurface),
    Polyline(Polyline),
    GeometricGraph(GeometricGraph),
    HeightField(HeightField),
    Implicit(Implicit),
    VoxelGrid(VoxelGrid),
    PolyMesh(PolyMesh),
    TriMesh(TriMesh),
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_come_out_as_they_went_in() {
        let geometry = Geometry::from(TriMesh::default());
        assert_eq!(TriMesh::from_geometry(&geometry), Ok(&TriMesh::default()));
        let error = PolyMesh::from_geometry(&geometry).unwrap_err();
        assert_eq!(error.to_string(), "found a tri-mesh, expected a poly-mesh");
    }
}
