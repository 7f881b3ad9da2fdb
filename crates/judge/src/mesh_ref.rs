//! Either kind of mesh.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, OverBudget};
use shapeloom_mesh::{PolyMesh, TriMesh};

use crate::Faces;

/// A mesh to be judged: of triangles or of polygons.
#[derive(Clone, Copy, Debug)]
pub enum MeshRef<'a> {
    /// Of triangles.
    Triangles(&'a TriMesh),
    /// Of polygons.
    Polygons(&'a PolyMesh),
}

impl<'a> From<&'a TriMesh> for MeshRef<'a> {
    fn from(mesh: &'a TriMesh) -> Self {
        Self::Triangles(mesh)
    }
}

impl<'a> From<&'a PolyMesh> for MeshRef<'a> {
    fn from(mesh: &'a PolyMesh) -> Self {
        Self::Polygons(mesh)
    }
}

impl<'a> MeshRef<'a> {
    /// The positions of the vertices.
    pub fn positions(self) -> &'a [DVec3] {
        match self {
            Self::Triangles(mesh) => mesh.positions(),
            Self::Polygons(mesh) => mesh.positions(),
        }
    }

    /// The faces apart from the coordinates.
    ///
    /// # Errors
    /// The memory budget has no room for four bytes a corner of a polygon.
    pub fn faces(self, exec: &Exec) -> Result<Faces<'a>, OverBudget> {
        match self {
            Self::Triangles(mesh) => Ok(Faces::of_triangles(mesh)),
            Self::Polygons(mesh) => Faces::of_polygons(mesh, exec),
        }
    }
}
