//! The nine queries from a few steps between neighbouring elements.

use super::once::once;

/// A structure that can go from vertices to edges and back.
pub(crate) trait WalkEdges {
    /// Every edge once.
    fn all_edges(&self) -> impl Iterator<Item = u32>;

    /// The vertices of an edge.
    fn ends(&self, edge: u32) -> [u32; 2];

    /// The edges at a vertex, each once.
    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32>;

    /// The other ends of the edges at a vertex.
    fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.edges_at(vertex).map(move |edge| {
            let [a, b] = self.ends(edge);
            if a == vertex { b } else { a }
        })
    }

    /// The edges at the ends of an edge. Two vertices have one edge at most, so that no other is at both ends.
    fn edges_near(&self, edge: u32) -> impl Iterator<Item = u32> {
        self.ends(edge).into_iter().flat_map(|vertex| self.edges_at(vertex)).filter(move |&other| other != edge)
    }
}

/// A structure that can go to faces and back besides.
pub(crate) trait WalkFaces: WalkEdges {
    /// The faces at a vertex, each once.
    fn faces_at(&self, vertex: u32) -> impl Iterator<Item = u32>;

    /// The faces with an edge as side, each once.
    fn faces_beside(&self, edge: u32) -> impl Iterator<Item = u32>;

    /// The corners of a face, in order.
    fn corners(&self, face: u32) -> impl Iterator<Item = u32>;

    /// The edges of a face in order, each once.
    fn sides(&self, face: u32) -> impl Iterator<Item = u32>;

    /// The faces beside the edges of a face.
    fn faces_near(&self, face: u32) -> impl Iterator<Item = u32> {
        once(self.sides(face).flat_map(|edge| self.faces_beside(edge)).filter(move |&other| other != face))
    }
}

/// The queries of [`Incidence`](super::Incidence) from the steps of [`WalkEdges`] (`edges`), or of both traits (`all`).
macro_rules! answer_by_walking {
    (edges) => {
        fn visit_edges(
            &self,
            visit: &mut crate::structures::Visitor<'_, crate::structures::EdgeId>,
        ) -> crate::structures::Answered {
            use crate::structures::walk::WalkEdges;
            crate::structures::incidence::visit_each(self.all_edges().map(crate::structures::EdgeId), visit);
            Ok(())
        }

        crate::structures::walk::answer_by_walking!(@ WalkEdges:
            vertex_vertices(VertexId) -> VertexId = neighbors,
            vertex_edges(VertexId) -> EdgeId = edges_at,
            edge_vertices(EdgeId) -> VertexId = ends,
            edge_edges(EdgeId) -> EdgeId = edges_near,
        );
    };
    (all) => {
        crate::structures::walk::answer_by_walking!(edges);
        crate::structures::walk::answer_by_walking!(@ WalkFaces:
            vertex_faces(VertexId) -> FaceId = faces_at,
            edge_faces(EdgeId) -> FaceId = faces_beside,
            face_vertices(FaceId) -> VertexId = corners,
            face_edges(FaceId) -> EdgeId = sides,
            face_faces(FaceId) -> FaceId = faces_near,
        );
    };
    (@ $steps:ident: $($query:ident($from:ident) -> $to:ident = $step:ident,)*) => {$(
        fn $query(
            &self,
            element: crate::structures::$from,
            visit: &mut crate::structures::Visitor<'_, crate::structures::$to>,
        ) -> crate::structures::Answered {
            use crate::structures::walk::$steps;
            let found = self.$step(element.0).into_iter();
            crate::structures::incidence::visit_each(found.map(crate::structures::$to), visit);
            Ok(())
        }
    )*};
}

pub(crate) use answer_by_walking;
