//! Edges as pairs of vertices.

use shapeloom_core::Exec;

use crate::poly_mesh::check_count;
use crate::{GeometricGraph, MeshError};

use super::face_list::{FaceList, ordered};
use super::sides::by_edge;
use super::walk::{WalkEdges, answer_by_walking};
use super::{Cost, Incidence, IndexedPolygons, Query, StructureError};

/// Edges as pairs of vertices and nothing else: a wire frame.
///
/// Eight bytes an edge. It holds the edges of any faces, and any graph without loops and double edges; which edges bound a face
/// it does not know. The smaller vertex of each pair comes first and the pairs rise, so that equal graphs have equal lists;
/// the number of an edge is its place. Everything but the vertices of an edge is found by looking at all edges.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct EdgeList {
    vertex_count: u32,
    edges: Vec<[u32; 2]>,
}

impl EdgeList {
    /// Edges in any order and direction over `vertex_count` vertices.
    ///
    /// # Errors
    /// A vertex out of range, an edge from a vertex to itself or given twice (the later one is named), more elements than 32
    /// bits can tell apart.
    pub fn try_new(vertex_count: u32, edges: &[[u32; 2]]) -> Result<Self, StructureError> {
        check_count("vertices", vertex_count as usize)?;
        check_count("edges", edges.len())?;
        check_edges(vertex_count, edges.iter().copied())?;
        let mut edges: Vec<[u32; 2]> = edges.iter().map(|&edge| ordered(edge)).collect();
        edges.sort_unstable();
        Ok(Self { vertex_count, edges })
    }

    /// The edges of faces.
    ///
    /// Cost: linear in practice; sides are sorted in parallel.
    ///
    /// # Errors
    /// The budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        // At worst every side has an edge of its own; parts are put together, and for that moment all is there twice.
        let _memory = exec.reserve_elements(faces.all_corners().len() as u64, 2 * 8)?;
        let parts = by_edge(faces, exec, |bucket| {
            let mut edges = Vec::new();
            bucket.for_each_edge(|edge| edges.push(edge.vertices));
            Ok::<_, StructureError>(edges)
        })?;
        Ok(Self { vertex_count: faces.vertex_total() as u32, edges: parts.concat() })
    }

    /// The vertices of each edge, the smaller first; the pairs rise.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    pub(crate) fn trusted(vertex_count: u32, edges: Vec<[u32; 2]>) -> Self {
        Self { vertex_count, edges }
    }
}

/// Fails unless every edge joins two vertices below a number, and no two edges the same ones.
pub(crate) fn check_edges(vertex_count: u32, edges: impl Iterator<Item = [u32; 2]>) -> Result<(), StructureError> {
    let mut sorted = Vec::with_capacity(edges.size_hint().0);
    for (edge, ends) in edges.enumerate() {
        if let Some(&found) = ends.iter().find(|&&end| end >= vertex_count) {
            let (edge, found, vertices) = (edge as u64, u64::from(found), u64::from(vertex_count));
            return Err(MeshError::EdgeOutOfRange { edge, found, vertices }.into());
        }
        if ends[0] == ends[1] {
            return Err(inconsistent("edge", edge as u32, "it joins a vertex to itself"));
        }
        sorted.push((ordered(ends), edge as u32));
    }
    sorted.sort_unstable();
    let later = sorted.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| pair[1].1).min();
    later.map_or(Ok(()), |edge| Err(inconsistent("edge", edge, "it joins the same vertices as an earlier one")))
}

pub(crate) fn inconsistent(kind: &'static str, index: u32, what: &'static str) -> StructureError {
    StructureError::Inconsistent { kind, index, what }
}

/// Exact for graphs without loops and double edges, but for the numbers of the edges; the error names the first edge that is
/// one.
impl TryFrom<&GeometricGraph> for EdgeList {
    type Error = StructureError;

    fn try_from(graph: &GeometricGraph) -> Result<Self, StructureError> {
        Self::try_new(graph.positions().len() as u32, graph.edges())
    }
}

impl WalkEdges for EdgeList {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        0..self.edges.len() as u32
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        self.edges[edge as usize]
    }

    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        assert!(vertex < self.vertex_count, "there is no vertex {vertex} among {}", self.vertex_count);
        self.all_edges().filter(move |&edge| self.ends(edge).contains(&vertex))
    }
}

impl Incidence for EdgeList {
    fn name(&self) -> &'static str {
        "edge list"
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count as usize
    }

    fn face_count(&self) -> usize {
        0
    }

    fn cost(&self, query: Query) -> Cost {
        match query {
            Query::EV => Cost::Local,
            Query::VV | Query::VE | Query::EE => Cost::Scan,
            _ => Cost::Unanswered,
        }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.edges.as_slice())
    }

    answer_by_walking!(edges);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_graphs_have_equal_lists() {
        let list = EdgeList::try_new(5, &[[3, 1], [0, 1], [3, 0]]).unwrap();
        assert_eq!(list.edges(), [[0, 1], [0, 3], [1, 3]]);
        assert_eq!(list, EdgeList::try_new(5, &[[1, 0], [0, 3], [1, 3]]).unwrap());
        assert_eq!(list.answer(Query::VV, 3).unwrap(), [0, 1]);
        assert_eq!(list.answer(Query::EE, 1).unwrap(), [0, 2]);
        assert_eq!(list.answer(Query::VF, 0).unwrap_err(), list.unanswered(Query::VF));
    }

    #[test]
    fn loops_and_double_edges_are_named() {
        let refused = |edges: &[[u32; 2]]| EdgeList::try_new(4, edges).unwrap_err().to_string();
        assert_eq!(refused(&[[0, 1], [2, 2]]), "edge 1: it joins a vertex to itself");
        assert_eq!(refused(&[[0, 1], [1, 2], [1, 0]]), "edge 2: it joins the same vertices as an earlier one");
        assert_eq!(refused(&[[0, 4]]), "edge 0: found vertex index 4, expected one below 4");
    }
}
