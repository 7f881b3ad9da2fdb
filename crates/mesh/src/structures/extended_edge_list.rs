//! Edges with their vertices and faces.

use shapeloom_core::Exec;

use crate::poly_mesh::check_count;

use super::edge_list::{check_edges, inconsistent};
use super::edge_table::EdgeTable;
use super::face_list::FaceList;
use super::lists::Lists;
use super::once::once;
use super::triangle_half_edges::NONE;
use super::walk::{WalkEdges, WalkFaces, answer_by_walking};
use super::{Cost, Incidence, IndexedPolygons, Query, StructureError};

/// An edge of an [`ExtendedEdgeList`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExtendedEdge {
    /// Where it starts and where it ends.
    pub vertices: [u32; 2],
    /// The face to its left, which passes it forward, and the one to its right, which passes it backward;
    /// [`ExtendedEdge::NO_FACE`] at the border.
    pub faces: [u32; 2],
}

impl ExtendedEdge {
    /// Where there is no face.
    pub const NO_FACE: u32 = NONE;
}

/// Edges, each with its two vertices and the faces to its left and right, and for each face the edge with which it starts.
///
/// 16 bytes an edge and four a face. Everything but the vertices and faces of an edge is found by looking at all edges; a face
/// comes back by chaining its edges from the first, so that corners keep their order and their start.
///
/// It holds faces with different corners, at most two to an edge and these in opposite directions; several fans may meet in a
/// vertex. Isolated vertices are kept. The number of an edge is its place; built from faces they rise by their
/// smaller and then their larger vertex, from which they run to the other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ExtendedEdgeList {
    vertex_count: u32,
    edges: Vec<ExtendedEdge>,
    firsts: Vec<u32>,
}

impl ExtendedEdgeList {
    /// Edges in any order and direction, and for each face the edge with which it starts.
    ///
    /// # Errors
    /// Vertices, faces or first edges out of range, edges that join a vertex to itself or the same vertices as another, that
    /// have no face or one face twice; faces whose edges are not one closed chain through different vertices; more elements
    /// than 32 bits can tell apart.
    pub fn try_new(vertex_count: u32, edges: Vec<ExtendedEdge>, firsts: Vec<u32>) -> Result<Self, StructureError> {
        check_count("vertices", vertex_count as usize)?;
        check_count("wedges", edges.len().saturating_mul(2))?;
        check_count("faces", firsts.len())?;
        check_edges(vertex_count, edges.iter().map(|edge| edge.vertices))?;
        for (index, edge) in edges.iter().enumerate() {
            let wrong = |what| Err(inconsistent("edge", index as u32, what));
            match edge.faces {
                [NONE, NONE] => return wrong("it has no face"),
                [left, right] if left == right => return wrong("it has the same face on both sides"),
                faces if faces.iter().any(|&face| face != NONE && face as usize >= firsts.len()) => {
                    return wrong("it has a face that is not there");
                }
                _ => {}
            }
        }
        let list = Self { vertex_count, edges, firsts };
        list.outlines()?;
        Ok(list)
    }

    /// The edges of faces with what lies beside them.
    ///
    /// Cost: linear in practice; sides are sorted in parallel.
    ///
    /// # Errors
    /// What it cannot hold, with the elements at fault: a face that names a vertex twice, an edge with more than two faces or with
    /// two in the same direction; the budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        let table = EdgeTable::oriented(faces, exec)?;
        let (edge_of, _of_memory) = table.edge_of_corners(exec)?;
        let words = 4 * table.vertices.len() + faces.face_total();
        let _memory = exec.reserve_elements(words as u64, 4)?;
        let blank = |&vertices| ExtendedEdge { vertices, faces: [NONE; 2] };
        let mut edges: Vec<ExtendedEdge> = table.vertices.iter().map(blank).collect();
        let mut firsts = Vec::with_capacity(faces.face_total());
        for face in 0..faces.face_total() as u32 {
            if face.is_multiple_of(1 << 12) {
                exec.check()?;
            }
            let range = faces.corner_range(face);
            firsts.push(edge_of[range.start]);
            for (&vertex, &edge) in faces.face(face).iter().zip(&edge_of[range]) {
                let edge = &mut edges[edge as usize];
                edge.faces[usize::from(edge.vertices[0] != vertex)] = face;
            }
        }
        Ok(Self { vertex_count: faces.vertex_total() as u32, edges, firsts })
    }

    /// The edges.
    pub fn edges(&self) -> &[ExtendedEdge] {
        &self.edges
    }

    /// The edge with which each face starts: from its first corner to its second.
    pub fn firsts(&self) -> &[u32] {
        &self.firsts
    }

    /// The face on a side: sides `2e` and `2e + 1` are the left and the right one of edge `e`.
    fn face_of(&self, side: u32) -> u32 {
        self.edges[side as usize / 2].faces[side as usize % 2]
    }

    /// Where a side starts and ends, as its face passes it.
    fn ends_of(&self, side: u32) -> [u32; 2] {
        let [a, b] = self.edges[side as usize / 2].vertices;
        if side.is_multiple_of(2) { [a, b] } else { [b, a] }
    }

    /// The sides of a face in order, from its first; none unless they are one closed chain through different vertices.
    fn chained(&self, face: u32, sides: &[u32]) -> Option<Vec<u32>> {
        let mut by_start: Vec<(u32, u32)> = sides.iter().map(|&side| (self.ends_of(side)[0], side)).collect();
        by_start.sort_unstable();
        let first = *sides.iter().find(|&&side| side / 2 == self.firsts[face as usize])?;
        let (mut side, mut chain) = (first, Vec::with_capacity(sides.len()));
        loop {
            chain.push(side);
            let end = self.ends_of(side)[1];
            side = by_start[by_start.binary_search_by_key(&end, |&(start, _)| start).ok()?].1;
            if side == first || chain.len() == sides.len() {
                break;
            }
        }
        // Of two sides that start at one vertex only one would ever be found, so that the chain would miss the other.
        (side == first && chain.len() == sides.len()).then_some(chain)
    }

    /// The sides of a face in order, found among all.
    fn sides_of(&self, face: u32) -> Vec<u32> {
        assert!((face as usize) < self.firsts.len(), "there is no face {face} among {}", self.firsts.len());
        let own: Vec<u32> = (0..2 * self.edges.len() as u32).filter(|&side| self.face_of(side) == face).collect();
        self.chained(face, &own).expect("edges of a face are a chain")
    }

    /// All faces at once.
    fn outlines(&self) -> Result<IndexedPolygons, StructureError> {
        let exec = super::conversions::without_limits();
        let of_faces = Lists::grouped(self.firsts.len(), 2 * self.edges.len(), |side| self.face_of(side), &exec)?;
        let mut corners = Vec::with_capacity(of_faces.items().len());
        for face in 0..self.firsts.len() as u32 {
            let chain = self.chained(face, of_faces.of(face));
            let what = "its edges are no closed chain through different vertices, from its first edge";
            let chain = chain.ok_or_else(|| inconsistent("face", face, what))?;
            corners.extend(chain.into_iter().map(|side| self.ends_of(side)[0]));
        }
        Ok(IndexedPolygons::trusted(self.vertex_count, of_faces.starts().to_vec(), corners))
    }
}

/// The faces are there, chained anew, with the corners in their order.
impl From<&ExtendedEdgeList> for IndexedPolygons {
    fn from(list: &ExtendedEdgeList) -> Self {
        list.outlines().expect("edges of a face are a chain")
    }
}

impl WalkEdges for ExtendedEdgeList {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        0..self.edges.len() as u32
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        self.edges[edge as usize].vertices
    }

    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        assert!(vertex < self.vertex_count, "there is no vertex {vertex} among {}", self.vertex_count);
        self.all_edges().filter(move |&edge| self.ends(edge).contains(&vertex))
    }
}

impl WalkFaces for ExtendedEdgeList {
    fn faces_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        once(self.edges_at(vertex).flat_map(|edge| self.faces_beside(edge)))
    }

    fn faces_beside(&self, edge: u32) -> impl Iterator<Item = u32> {
        self.edges[edge as usize].faces.into_iter().filter(|&face| face != NONE)
    }

    fn corners(&self, face: u32) -> impl Iterator<Item = u32> {
        self.sides_of(face).into_iter().map(|side| self.ends_of(side)[0])
    }

    fn sides(&self, face: u32) -> impl Iterator<Item = u32> {
        self.sides_of(face).into_iter().map(|side| side / 2)
    }
}

impl Incidence for ExtendedEdgeList {
    fn name(&self) -> &'static str {
        "extended edge list"
    }

    fn vertex_count(&self) -> usize {
        self.vertex_count as usize
    }

    fn face_count(&self) -> usize {
        self.firsts.len()
    }

    fn cost(&self, query: Query) -> Cost {
        if matches!(query, Query::EV | Query::EF) { Cost::Local } else { Cost::Scan }
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.edges.as_slice()) + size_of_val(self.firsts.as_slice())
    }

    answer_by_walking!(all);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(vertices: [u32; 2], left: Option<u32>, right: Option<u32>) -> ExtendedEdge {
        let face = |face: Option<u32>| face.unwrap_or(ExtendedEdge::NO_FACE);
        ExtendedEdge { vertices, faces: [face(left), face(right)] }
    }

    /// The triangle 0 1 2 and the square 2 1 3 4.
    fn by_hand() -> Vec<ExtendedEdge> {
        vec![
            edge([0, 1], Some(0), None),
            edge([1, 2], Some(0), Some(1)),
            edge([0, 2], None, Some(0)),
            edge([1, 3], Some(1), None),
            edge([2, 4], None, Some(1)),
            edge([3, 4], Some(1), None),
        ]
    }

    #[test]
    fn a_list_by_hand_is_the_list_of_its_faces() {
        let list = ExtendedEdgeList::try_new(6, by_hand(), vec![1, 5]).unwrap();
        let faces = IndexedPolygons::from_faces(6, &[vec![1, 2, 0], vec![3, 4, 2, 1]]).unwrap();
        assert_eq!(IndexedPolygons::from(&list), faces);
        let mut sorted = by_hand();
        sorted.sort_unstable_by_key(|edge| edge.vertices);
        let built = ExtendedEdgeList::try_build(&faces, &Exec::default()).unwrap();
        assert_eq!(built.edges(), sorted);
        assert_eq!(built.answer(Query::FE, 1).unwrap(), [5, 4, 2, 3]);
        assert_eq!(built.answer(Query::VF, 1).unwrap(), [0, 1]);
    }

    #[test]
    fn contradictions_are_named() {
        let refused = |change: &dyn Fn(&mut Vec<ExtendedEdge>, &mut Vec<u32>)| {
            let (mut edges, mut firsts) = (by_hand(), vec![0, 1]);
            change(&mut edges, &mut firsts);
            ExtendedEdgeList::try_new(5, edges, firsts).unwrap_err().to_string()
        };
        let chain = "its edges are no closed chain through different vertices, from its first edge";
        assert_eq!(refused(&|_, firsts| firsts[1] = 0), format!("face 1: {chain}"));
        assert_eq!(refused(&|_, firsts| firsts[0] = 77), format!("face 0: {chain}"));
        assert_eq!(refused(&|_, firsts| firsts.push(1)), format!("face 2: {chain}"));
        assert_eq!(refused(&|edges, _| edges.truncate(5)), format!("face 1: {chain}"));
        assert_eq!(refused(&|edges, _| edges[3].vertices = [3, 1]), format!("face 1: {chain}"));
        assert_eq!(refused(&|edges, _| edges[2].faces = [NONE; 2]), "edge 2: it has no face");
        assert_eq!(refused(&|edges, _| edges[2].faces = [1, 1]), "edge 2: it has the same face on both sides");
        assert_eq!(refused(&|edges, _| edges[2].faces = [NONE, 2]), "edge 2: it has a face that is not there");
        assert!(refused(&|edges, _| edges[2].vertices = [2, 5]).contains("expected one below 5"));
        assert!(refused(&|edges, _| edges[2].vertices = [1, 0]).contains("the same vertices as an earlier one"));
    }
}
