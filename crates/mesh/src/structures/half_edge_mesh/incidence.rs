//! The nine queries, all local.

use super::HalfEdgeMesh;
use crate::structures::incidence::visit_each;
use crate::structures::once::once;
use crate::structures::{Answered, Cost, EdgeId, FaceId, Incidence, Query, VertexId, Visitor};

impl HalfEdgeMesh {
    /// The name of the structure.
    pub(crate) const NAME: &'static str = "half-edges (editable)";
}

/// Counts are those of numbers, deleted elements among them; these have no neighbours. Around a vertex answers go
/// counter-clockwise, around a face from its first corner on.
impl Incidence for HalfEdgeMesh {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn vertex_count(&self) -> usize {
        self.vertex_slots()
    }

    fn face_count(&self) -> usize {
        self.face_slots()
    }

    fn cost(&self, _query: Query) -> Cost {
        Cost::Local
    }

    fn memory_bytes(&self) -> usize {
        self.bytes()
    }

    fn visit_edges(&self, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.live_edges(), visit);
        Ok(())
    }

    fn vertex_vertices(&self, vertex: VertexId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.around_vertex(vertex).map(|h| self.target(h)), visit);
        Ok(())
    }

    fn vertex_edges(&self, vertex: VertexId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.around_vertex(vertex).map(|h| self.edge(h)), visit);
        Ok(())
    }

    fn vertex_faces(&self, vertex: VertexId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        visit_each(self.around_vertex(vertex).filter_map(|h| self.face(h)), visit);
        Ok(())
    }

    fn edge_vertices(&self, edge: EdgeId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        if self.has_edge(edge) {
            visit_each(self.ends(edge), visit);
        }
        Ok(())
    }

    fn edge_edges(&self, edge: EdgeId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        if self.has_edge(edge) {
            let all = self.ends(edge).into_iter().flat_map(|end| self.around_vertex(end));
            visit_each(all.map(|h| self.edge(h)).filter(|&other| other != edge), visit);
        }
        Ok(())
    }

    fn edge_faces(&self, edge: EdgeId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        if self.has_edge(edge) {
            visit_each(self.halves(edge).into_iter().filter_map(|h| self.face(h)), visit);
        }
        Ok(())
    }

    fn face_vertices(&self, face: FaceId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.corners(face), visit);
        Ok(())
    }

    fn face_edges(&self, face: FaceId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.around_face(face).map(|h| self.edge(h)), visit);
        Ok(())
    }

    fn face_faces(&self, face: FaceId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        // Two polygons may share several edges.
        let beside = self.around_face(face).filter_map(|h| self.face(self.twin(h)));
        visit_each(once(beside.map(|other| other.0)).map(FaceId), visit);
        Ok(())
    }
}
