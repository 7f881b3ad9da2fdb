//! The list of structures.

use std::fmt;

use shapeloom_core::Exec;

use super::{CornerTable, Incidence, IndexedPolygons, IndexedTriangles, StructureError, TriangleHalfEdges};

/// A way to store connectivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StructureKind {
    /// [`IndexedTriangles`].
    IndexedTriangles,
    /// [`IndexedPolygons`].
    IndexedPolygons,
    /// [`TriangleHalfEdges`].
    TriangleHalfEdges,
    /// [`CornerTable`].
    CornerTable,
}

impl StructureKind {
    /// Every structure, the plainest first.
    pub const ALL: [Self; 4] =
        [Self::IndexedTriangles, Self::IndexedPolygons, Self::TriangleHalfEdges, Self::CornerTable];

    /// What the structure is called, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::IndexedTriangles => "indexed triangles",
            Self::IndexedPolygons => "indexed polygons",
            Self::TriangleHalfEdges => "half-edges (triangles)",
            Self::CornerTable => "corner table",
        }
    }

    /// What the connectivity takes in theory, in words of four bytes for each vertex of a large closed triangle mesh (two
    /// faces and three edges a vertex).
    pub fn words_per_vertex(self) -> f64 {
        match self {
            Self::IndexedTriangles => 6.0,
            // Three corners and a start for each of two faces.
            Self::IndexedPolygons => 8.0,
            // The origin and the twin of six half-edges, and a half-edge of the vertex.
            Self::TriangleHalfEdges => 13.0,
            // The vertex and the opposite of six corners, and a corner of the vertex.
            Self::CornerTable => 13.0,
        }
    }

    /// The structure of a mesh.
    ///
    /// # Errors
    /// The structure cannot hold the mesh (the elements at fault are named), the memory budget, or the reason to stop.
    pub fn build(self, faces: &IndexedPolygons, exec: &Exec) -> Result<Box<dyn Incidence>, StructureError> {
        exec.check()?;
        Ok(match self {
            Self::IndexedTriangles => Box::new(IndexedTriangles::try_from(faces)?),
            Self::IndexedPolygons => Box::new(faces.clone()),
            Self::TriangleHalfEdges => {
                Box::new(TriangleHalfEdges::try_build(IndexedTriangles::try_from(faces)?, exec)?)
            }
            Self::CornerTable => {
                let triangles = IndexedTriangles::try_from(faces)?;
                Box::new(CornerTable::from(TriangleHalfEdges::try_build(triangles, exec)?))
            }
        })
    }
}

impl fmt::Display for StructureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_are_called_what_their_kind_is_called() {
        let faces = IndexedPolygons::from_faces(3, &[[0, 1, 2]]).unwrap();
        for kind in StructureKind::ALL {
            assert_eq!(kind.build(&faces, &Exec::default()).unwrap().name(), kind.name());
        }
    }
}
