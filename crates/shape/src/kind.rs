//! Kinds of representation.

use std::fmt;

/// A family of representations, each with a crate of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Family {
    /// Points without connections.
    Points,
    /// Curves and surfaces over parameters.
    Parametric,
    /// Zero sets of fields.
    Implicits,
    /// Samples on a lattice.
    Voxels,
    /// Vertices, edges and faces.
    Meshes,
    /// Pictures that stand for shapes.
    Images,
}

/// A representation. More come as families arrive.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Kind {
    /// Points with attributes.
    PointCloud,
    /// A Bézier curve in space.
    BezierCurve,
    /// Tensor-product Bézier patches.
    BezierSurface,
    /// Points joined by segments.
    Polyline,
    /// Vertices and edges alone.
    GeometricGraph,
    /// Heights over a grid.
    HeightField,
    /// The zero set of a field.
    Implicit,
    /// Samples on a lattice.
    VoxelGrid,
    /// Indexed polygons.
    PolyMesh,
    /// Indexed triangles.
    TriMesh,
}

impl Kind {
    /// Every kind, in the order of the families.
    pub const ALL: [Self; 10] = [
        Self::PointCloud,
        Self::BezierCurve,
        Self::BezierSurface,
        Self::Polyline,
        Self::GeometricGraph,
        Self::HeightField,
        Self::Implicit,
        Self::VoxelGrid,
        Self::PolyMesh,
        Self::TriMesh,
    ];

    /// The name, in lower case with hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Self::PointCloud => "point-cloud",
            Self::BezierCurve => "bezier-curve",
            Self::BezierSurface => "bezier-surface",
            Self::Polyline => "polyline",
            Self::GeometricGraph => "geometric-graph",
            Self::HeightField => "height-field",
            Self::Implicit => "implicit",
            Self::VoxelGrid => "voxel-grid",
            Self::PolyMesh => "poly-mesh",
            Self::TriMesh => "tri-mesh",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// The family it belongs to.
    pub fn family(self) -> Family {
        match self {
            Self::PointCloud => Family::Points,
            Self::BezierCurve | Self::BezierSurface => Family::Parametric,
            Self::Implicit => Family::Implicits,
            Self::VoxelGrid => Family::Voxels,
            Self::Polyline | Self::GeometricGraph | Self::HeightField | Self::PolyMesh | Self::TriMesh => {
                Family::Meshes
            }
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        assert!(Kind::ALL.into_iter().all(|kind| Kind::from_name(kind.name()) == Some(kind)));
        assert_eq!(Kind::from_name("teapot"), None);
    }
}
