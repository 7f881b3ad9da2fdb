//! The list of structures.

use std::fmt;

use shapeloom_core::Exec;

use super::{Cost, HalfEdgeMesh, Incidence, IndexedPolygons, IndexedTriangles, LocalUpdate, StructureError, Update};

/// A way to store connectivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StructureKind {
    /// [`IndexedTriangles`].
    IndexedTriangles,
    /// [`IndexedPolygons`].
    IndexedPolygons,
    /// [`HalfEdgeMesh`].
    HalfEdgeMesh,
}

impl StructureKind {
    /// Every structure, the plainest first.
    pub const ALL: [Self; 3] = [Self::IndexedTriangles, Self::IndexedPolygons, Self::HalfEdgeMesh];

    /// What the structure is called, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::IndexedTriangles => "indexed triangles",
            Self::IndexedPolygons => "indexed polygons",
            Self::HalfEdgeMesh => HalfEdgeMesh::NAME,
        }
    }

    /// What the connectivity takes in theory, in words of four bytes for each vertex of a large closed triangle mesh (two
    /// faces and three edges a vertex).
    pub fn words_per_vertex(self) -> f64 {
        match self {
            Self::IndexedTriangles => 6.0,
            // Three corners and a start for each of two faces.
            Self::IndexedPolygons => 8.0,
            // Four words (origin, next, previous, face) for each of six half-edges, one, and one for each of two faces.
            Self::HalfEdgeMesh => 27.0,
        }
    }

    /// What a local change costs in this structure; unanswered where it cannot be changed in place.
    pub fn update_cost(self, _update: Update) -> Cost {
        match self {
            Self::IndexedTriangles => Cost::Scan,
            Self::HalfEdgeMesh => Cost::Local,
            _ => Cost::Unanswered,
        }
    }

    /// The structure of a mesh, to be changed in place; none where [`StructureKind::update_cost`] is unanswered.
    ///
    /// # Errors
    /// As [`StructureKind::build`].
    pub fn build_for_updates(
        self,
        faces: &IndexedPolygons,
        exec: &Exec,
    ) -> Result<Option<Box<dyn LocalUpdate>>, StructureError> {
        exec.check()?;
        Ok(match self {
            Self::IndexedTriangles => Some(Box::new(IndexedTriangles::try_from(faces)?)),
            Self::HalfEdgeMesh => Some(Box::new(HalfEdgeMesh::try_build(faces, exec)?)),
            _ => None,
        })
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
            Self::HalfEdgeMesh => Box::new(HalfEdgeMesh::try_build(faces, exec)?),
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
