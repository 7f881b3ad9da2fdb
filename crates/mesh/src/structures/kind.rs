//! The list of structures.

use std::fmt;

use shapeloom_core::Exec;

use super::{
    AdjacencyMatrix, CornerTable, Cost, EdgeList, ExtendedEdgeList, FaceVertex, HalfEdgeMesh, Incidence,
    IncidenceMatrices, IndexedPolygons, IndexedTriangles, LocalUpdate, StructureError, TriangleHalfEdges, TriangleSoup,
    Update, WingedEdge,
};

/// A way to store connectivity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum StructureKind {
    /// [`TriangleSoup`].
    TriangleSoup,
    /// [`EdgeList`].
    EdgeList,
    /// [`ExtendedEdgeList`].
    ExtendedEdgeList,
    /// [`IndexedTriangles`].
    IndexedTriangles,
    /// [`IndexedPolygons`].
    IndexedPolygons,
    /// [`FaceVertex`].
    FaceVertex,
    /// [`WingedEdge`].
    WingedEdge,
    /// [`TriangleHalfEdges`].
    TriangleHalfEdges,
    /// [`HalfEdgeMesh`].
    HalfEdgeMesh,
    /// [`CornerTable`].
    CornerTable,
    /// [`AdjacencyMatrix`].
    AdjacencyMatrix,
    /// [`IncidenceMatrices`].
    IncidenceMatrices,
}

impl StructureKind {
    /// Every structure, the plainest first.
    pub const ALL: [Self; 12] = [
        Self::TriangleSoup,
        Self::EdgeList,
        Self::ExtendedEdgeList,
        Self::IndexedTriangles,
        Self::IndexedPolygons,
        Self::FaceVertex,
        Self::WingedEdge,
        Self::TriangleHalfEdges,
        Self::HalfEdgeMesh,
        Self::CornerTable,
        Self::AdjacencyMatrix,
        Self::IncidenceMatrices,
    ];

    /// What the structure is called, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::TriangleSoup => "triangle soup",
            Self::EdgeList => "edge list",
            Self::ExtendedEdgeList => "extended edge list",
            Self::IndexedTriangles => "indexed triangles",
            Self::IndexedPolygons => "indexed polygons",
            Self::FaceVertex => "face-vertex",
            Self::WingedEdge => "winged edge",
            Self::TriangleHalfEdges => "half-edges (triangles)",
            Self::CornerTable => "corner table",
            Self::AdjacencyMatrix => "adjacency matrix",
            Self::IncidenceMatrices => "incidence matrices",
            Self::HalfEdgeMesh => HalfEdgeMesh::NAME,
        }
    }

    /// What the connectivity takes in theory, in words of four bytes for each vertex of a large closed triangle mesh (two
    /// faces, three edges and six corners a vertex).
    pub fn words_per_vertex(self) -> f64 {
        match self {
            // None: there is nothing but coordinates, but these are there six times.
            Self::TriangleSoup => 0.0,
            // Two vertices of three edges.
            Self::EdgeList => 6.0,
            // Two vertices and two faces of three edges; a first edge of two faces, without which it would be 12.
            Self::ExtendedEdgeList => 14.0,
            // Three corners of two faces.
            Self::IndexedTriangles => 6.0,
            // Three corners and a start for each of two faces.
            Self::IndexedPolygons => 8.0,
            // Three corners of two faces, and as many at vertices: 12; starts of the lists at two faces and a vertex.
            Self::FaceVertex => 15.0,
            // Two vertices, two faces and four wings of three edges; an edge of the vertex and of two faces.
            Self::WingedEdge => 27.0,
            // The origin and the twin of six half-edges, and a half-edge of the vertex.
            Self::TriangleHalfEdges => 13.0,
            // The vertex and the opposite of six corners, and a corner of the vertex.
            Self::CornerTable => 13.0,
            // Two entries of three edges, and the start of a row.
            Self::AdjacencyMatrix => 7.0,
            // Vertices and edges: six entries, by columns with three starts, by rows with one. Edges and faces: six entries, by columns
            // with two starts, by rows with three.
            Self::IncidenceMatrices => 33.0,
            // Four words (origin, next, previous, face) for each of six half-edges, a half-edge of the vertex, and one for each of two faces.
            Self::HalfEdgeMesh => 27.0,
        }
    }

    /// What textbooks count for the same mesh, coordinates of three words included, where they do: they leave out where lists
    /// start, and the edge with which a face begins.
    pub fn textbook_words_per_vertex(self) -> Option<f64> {
        match self {
            // Nine coordinates of two triangles.
            Self::TriangleSoup => Some(18.0),
            Self::IndexedTriangles => Some(3.0 + 6.0),
            Self::FaceVertex => Some(9.0 + 6.0),
            // A vertex with an edge, eight words of three edges, and an edge of two faces.
            Self::WingedEdge => Some(3.0 + 1.0 + 24.0 + 2.0),
            _ => None,
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
        let _memory = exec.reserve(faces.memory_bytes() as u64)?;
        let half_edges = || TriangleHalfEdges::try_build(IndexedTriangles::try_from(faces)?, exec);
        Ok(match self {
            Self::TriangleSoup => Box::new(TriangleSoup::try_build(faces, exec)?),
            Self::EdgeList => Box::new(EdgeList::try_build(faces, exec)?),
            Self::ExtendedEdgeList => Box::new(ExtendedEdgeList::try_build(faces, exec)?),
            Self::IndexedTriangles => Box::new(IndexedTriangles::try_from(faces)?),
            Self::IndexedPolygons => Box::new(faces.clone()),
            Self::FaceVertex => Box::new(FaceVertex::try_build(faces, exec)?),
            Self::WingedEdge => Box::new(WingedEdge::try_build(faces, exec)?),
            Self::TriangleHalfEdges => Box::new(half_edges()?),
            Self::CornerTable => Box::new(CornerTable::from(half_edges()?)),
            Self::AdjacencyMatrix => Box::new(AdjacencyMatrix::try_build(faces, exec)?),
            Self::IncidenceMatrices => Box::new(IncidenceMatrices::try_build(faces, exec)?),
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
