//! The winged edge.

use shapeloom_core::Exec;

use crate::poly_mesh::check_count;

use super::conversions::without_limits;
use super::edge_list::{check_edges, inconsistent};
use super::edge_table::EdgeTable;
use super::face_list::FaceList;
use super::triangle_half_edges::NONE;
use super::walk::{WalkEdges, WalkFaces, answer_by_walking};
use super::{Cost, Incidence, IndexedPolygons, Query, StructureError};

/// An edge of a [`WingedEdge`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wings {
    /// Where it starts and where it ends.
    pub vertices: [u32; 2],
    /// The face to its left, which passes it forward, and the one to its right, which passes it backward;
    /// [`Wings::NO_FACE`] at the border.
    pub faces: [u32; 2],
    /// Around the left and the right face: the edge that comes before this one and the one that comes after. Around no face: those
    /// before and after it along the border.
    pub wings: [[u32; 2]; 2],
}

impl Wings {
    /// Where there is no face.
    pub const NO_FACE: u32 = NONE;
}

/// Edges that know their neighbours: two vertices, two faces and four wings, the edges that follow around either face; one
/// edge for each vertex and each face.
///
/// 32 bytes an edge, four a vertex and four a face; all nine queries are local, on polygons of any number of corners. The edge of
/// a face is its first side, so that corners keep their order and their start. Side 0 of an edge is the left one, where its
/// face passes it forward; at the border one side has no face, and its wings run along the border, so that turning about a vertex
/// needs no case for borders.
///
/// It holds oriented 2-manifolds with boundary: faces with different corners, at most two to an edge and these in opposite
/// directions, one fan at each vertex; isolated vertices are kept. The number of an edge is its place; built from faces they
/// rise by their smaller and then their larger vertex, from which they run to the other.
///
/// Baumgart, "A polyhedron representation for computer vision" (1975).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WingedEdge {
    edges: Vec<Wings>,
    vertex_edges: Vec<u32>,
    face_edges: Vec<u32>,
}

/// The place of the wing before and after an edge.
const BEFORE: usize = 0;
const AFTER: usize = 1;

impl Wings {
    /// The side on which the edge leaves one of its vertices.
    fn side_from(&self, vertex: u32) -> usize {
        usize::from(self.vertices[0] != vertex)
    }

    /// The side on which one of its faces lies.
    fn side_of(&self, face: u32) -> usize {
        usize::from(self.faces[0] != face)
    }
}

impl WingedEdge {
    /// A structure put together by hand: edges in any order and direction, an edge for each vertex (`u32::MAX` for isolated ones)
    /// and the first side of each face.
    ///
    /// # Errors
    /// Numbers out of range, parts that contradict one another, and what no winged edge can hold, with the element at fault.
    pub fn try_new(edges: Vec<Wings>, vertex_edges: Vec<u32>, face_edges: Vec<u32>) -> Result<Self, StructureError> {
        check_count("vertices", vertex_edges.len())?;
        check_count("wedges", edges.len().saturating_mul(2))?;
        check_count("faces", face_edges.len())?;
        check_edges(vertex_edges.len() as u32, edges.iter().map(|edge| edge.vertices))?;
        let mesh = Self { edges, vertex_edges, face_edges };
        mesh.check_wings()?;
        let faces = mesh.outlines()?;
        // Wings lead along closed ways now. What is left are faces and vertices that are none of this structure, and these show when
        // it is built anew.
        let anew = Self::try_build(&faces, &without_limits())?;
        for (vertex, (&own, &wanted)) in mesh.vertex_edges.iter().zip(&anew.vertex_edges).enumerate() {
            let fits = match mesh.edges.get(own as usize) {
                Some(edge) => edge.vertices.contains(&(vertex as u32)),
                None => own == wanted,
            };
            if !fits {
                return Err(inconsistent("vertex", vertex as u32, "its edge does not touch it"));
            }
        }
        Ok(mesh)
    }

    /// Fails unless each wing leads on from where its edge ends, along the same face, and back again.
    fn check_wings(&self) -> Result<(), StructureError> {
        for (index, edge) in self.edges.iter().enumerate() {
            let wrong = |what| Err(inconsistent("edge", index as u32, what));
            match edge.faces {
                [NONE, NONE] => return wrong("it has no face"),
                [left, right] if left == right => return wrong("it has the same face on both sides"),
                faces if faces.iter().any(|&face| face != NONE && face as usize >= self.face_edges.len()) => {
                    return wrong("it has a face that is not there");
                }
                _ => {}
            }
            for side in 0..2 {
                let end = edge.vertices[1 - side];
                let Some(next) = self.edges.get(edge.wings[side][AFTER] as usize) else {
                    return wrong("it has a wing that is not there");
                };
                let next_side = next.side_from(end);
                if !next.vertices.contains(&end) {
                    return wrong("the wing after it does not start where it ends");
                }
                if next.faces[next_side] != edge.faces[side] {
                    return wrong("the wing after it lies beside another face");
                }
                if next.wings[next_side][BEFORE] as usize != index {
                    return wrong("the wing after it does not lead back to it");
                }
            }
        }
        Ok(())
    }

    /// The faces, where wings are known to lead along closed ways.
    fn outlines(&self) -> Result<IndexedPolygons, StructureError> {
        let (mut starts, mut corners) = (vec![0], Vec::with_capacity(2 * self.edges.len()));
        for (face, &edge) in self.face_edges.iter().enumerate() {
            if !self.edges.get(edge as usize).is_some_and(|edge| edge.faces.contains(&(face as u32))) {
                return Err(inconsistent("face", face as u32, "its edge does not touch it"));
            }
            corners.extend(self.corners(face as u32));
            starts.push(corners.len() as u32);
        }
        let mut sides = vec![0u32; self.face_edges.len()];
        for face in self.edges.iter().flat_map(|edge| edge.faces).filter(|&face| face != NONE) {
            sides[face as usize] += 1;
        }
        match starts.windows(2).zip(&sides).position(|(pair, &sides)| pair[1] - pair[0] != sides) {
            Some(face) => Err(inconsistent("face", face as u32, "its edges are no single closed chain")),
            None => Ok(IndexedPolygons::try_new(self.vertex_edges.len() as u32, starts, corners)?),
        }
    }

    /// The winged edges of faces.
    ///
    /// Cost: linear in practice; sides are sorted in parallel.
    ///
    /// # Errors
    /// What it cannot hold, with the elements at fault: a face that names a vertex twice, an edge with more than two faces or with
    /// two in the same direction, a vertex with several fans; the budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        let table = EdgeTable::oriented(faces, exec)?;
        let (edge_of, _of_memory) = table.edge_of_corners(exec)?;
        // The result, and while it is made the border edges at each vertex.
        let words = 8 * table.vertices.len() + faces.face_total() + 3 * faces.vertex_total();
        let _memory = exec.reserve_elements(words as u64, 4)?;
        let blank = |&vertices| Wings { vertices, faces: [NONE; 2], wings: [[NONE; 2]; 2] };
        let mut edges: Vec<Wings> = table.vertices.iter().map(blank).collect();
        let mut face_edges = Vec::with_capacity(faces.face_total());
        for face in 0..faces.face_total() as u32 {
            if face.is_multiple_of(1 << 12) {
                exec.check()?;
            }
            let corners = faces.face(face);
            let own = &edge_of[faces.corner_range(face)];
            face_edges.push(own[0]);
            let mut before = own[own.len() - 1];
            for (i, (&vertex, &edge)) in corners.iter().zip(own).enumerate() {
                let side = edges[edge as usize].side_from(vertex);
                let after = own[if i + 1 == own.len() { 0 } else { i + 1 }];
                edges[edge as usize].faces[side] = face;
                edges[edge as usize].wings[side] = [before, after];
                before = edge;
            }
        }

        // The edges whose side without a face leaves and reaches each vertex.
        let mut vertex_edges = vec![NONE; faces.vertex_total()];
        let mut border = vec![[NONE; 2]; faces.vertex_total()];
        let mut several = false;
        for (index, edge) in edges.iter().enumerate() {
            if index.is_multiple_of(1 << 16) {
                exec.check()?;
            }
            for (side, vertex) in edge.vertices.into_iter().enumerate() {
                let first = &mut vertex_edges[vertex as usize];
                *first = (*first).min(index as u32);
                if edge.faces[side] == NONE {
                    several |= border[vertex as usize][AFTER] != NONE;
                    border[vertex as usize][AFTER] = index as u32;
                    border[edge.vertices[1 - side] as usize][BEFORE] = index as u32;
                }
            }
        }
        let mut mesh = Self { edges, vertex_edges, face_edges };
        if !several {
            for edge in &mut mesh.edges {
                if let Some(side) = edge.faces.iter().position(|&face| face == NONE) {
                    let [start, end] = [edge.vertices[side], edge.vertices[1 - side]];
                    edge.wings[side] = [border[start as usize][BEFORE], border[end as usize][AFTER]];
                }
            }
            let turned = shapeloom_core::parallel::map_chunks(exec, mesh.vertex_edges.len(), 1 << 12, |vertices| {
                Ok::<_, StructureError>(vertices.map(|vertex| mesh.edges_at(vertex as u32).count()).sum::<usize>())
            })?;
            if turned.into_iter().sum::<usize>() == 2 * mesh.edges.len() {
                return Ok(mesh);
            }
        }
        Err(mesh.several_fans(faces, &edge_of, exec)?)
    }

    /// Which vertices have several fans, where some have.
    fn several_fans(
        &self,
        faces: &IndexedPolygons,
        edge_of: &[u32],
        exec: &Exec,
    ) -> Result<StructureError, StructureError> {
        let _memory = exec.reserve_elements((2 * self.edges.len() + self.vertex_edges.len()) as u64, 4)?;
        // Ends of edges, `2e + i` for vertex `i` of edge `e`, joined where they meet in a corner; every set is a fan.
        let mut parents: Vec<u32> = (0..2 * self.edges.len() as u32).collect();
        let mut fans = vec![0usize; self.vertex_edges.len()];
        self.edges.iter().flat_map(|edge| edge.vertices).for_each(|vertex| fans[vertex as usize] += 1);
        for face in 0..faces.face_total() as u32 {
            let own = &edge_of[faces.corner_range(face)];
            let mut before = own[own.len() - 1];
            for (&vertex, &edge) in faces.face(face).iter().zip(own) {
                let end = |edge: u32| 2 * edge + self.edges[edge as usize].side_from(vertex) as u32;
                let (a, b) = (root(&mut parents, end(before)), root(&mut parents, end(edge)));
                if a != b {
                    parents[a.max(b) as usize] = a.min(b);
                    fans[vertex as usize] -= 1;
                }
                before = edge;
            }
        }
        let count = fans.iter().filter(|&&fans| fans > 1).count();
        let vertex = fans.iter().position(|&fans| fans > 1).unwrap_or(0);
        Ok(StructureError::NonManifoldVertex { vertex: vertex as u32, fans: fans[vertex], count })
    }

    /// The edges.
    pub fn edges(&self) -> &[Wings] {
        &self.edges
    }

    /// An edge at a vertex, the smallest where the structure was built from faces; none if the vertex is isolated.
    pub fn edge_of_vertex(&self, vertex: u32) -> Option<u32> {
        Some(self.vertex_edges[vertex as usize]).filter(|&edge| edge != NONE)
    }

    /// The first side of a face.
    pub fn edge_of_face(&self, face: u32) -> u32 {
        self.face_edges[face as usize]
    }

    fn edge(&self, edge: u32) -> &Wings {
        &self.edges[edge as usize]
    }
}

/// The set of an element, with the way to it halved.
fn root(parents: &mut [u32], mut element: u32) -> u32 {
    while parents[element as usize] != element {
        parents[element as usize] = parents[parents[element as usize] as usize];
        element = parents[element as usize];
    }
    element
}

/// The edges that follow one another from a first one until it comes again.
fn around(first: Option<u32>, next: impl Fn(u32) -> u32) -> impl Iterator<Item = u32> {
    std::iter::successors(first, move |&edge| Some(next(edge)).filter(|&next| Some(next) != first))
}

/// The faces are there, with the corners in their order.
impl From<&WingedEdge> for IndexedPolygons {
    fn from(mesh: &WingedEdge) -> Self {
        mesh.outlines().expect("wings lead around faces")
    }
}

impl WalkEdges for WingedEdge {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        0..self.edges.len() as u32
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        self.edge(edge).vertices
    }

    /// Counter-clockwise: the face to the left of the leaving edge comes in along the next one.
    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        around(self.edge_of_vertex(vertex), move |edge| {
            let edge = self.edge(edge);
            edge.wings[edge.side_from(vertex)][BEFORE]
        })
    }
}

impl WalkFaces for WingedEdge {
    fn faces_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let left = move |edge| {
            let edge = self.edge(edge);
            edge.faces[edge.side_from(vertex)]
        };
        self.edges_at(vertex).map(left).filter(|&face| face != NONE)
    }

    fn faces_beside(&self, edge: u32) -> impl Iterator<Item = u32> {
        self.edge(edge).faces.into_iter().filter(|&face| face != NONE)
    }

    fn corners(&self, face: u32) -> impl Iterator<Item = u32> {
        self.sides(face).map(move |edge| {
            let edge = self.edge(edge);
            edge.vertices[edge.side_of(face)]
        })
    }

    fn sides(&self, face: u32) -> impl Iterator<Item = u32> {
        around(Some(self.edge_of_face(face)), move |edge| {
            let edge = self.edge(edge);
            edge.wings[edge.side_of(face)][AFTER]
        })
    }
}

impl Incidence for WingedEdge {
    fn name(&self) -> &'static str {
        "winged edge"
    }

    fn vertex_count(&self) -> usize {
        self.vertex_edges.len()
    }

    fn face_count(&self) -> usize {
        self.face_edges.len()
    }

    fn cost(&self, _: Query) -> Cost {
        Cost::Local
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.edges.as_slice())
            + size_of_val(self.vertex_edges.as_slice())
            + size_of_val(self.face_edges.as_slice())
    }

    answer_by_walking!(all);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(vertices: u32, faces: &[Vec<u32>]) -> Result<WingedEdge, StructureError> {
        WingedEdge::try_build(&IndexedPolygons::from_faces(vertices, faces).unwrap(), &Exec::default())
    }

    /// The triangle 0 1 2 and the square 2 1 3 4: edges 0-1, 0-2, 1-2, 1-3, 2-4, 3-4.
    fn two_faces() -> WingedEdge {
        built(6, &[vec![1, 2, 0], vec![3, 4, 2, 1]]).unwrap()
    }

    #[test]
    fn wings_are_where_baumgart_draws_them() {
        let mesh = two_faces();
        // Edge 1-2: the triangle to its left, between 0-1 and 0-2; the square to its right, between 2-4 and 1-3.
        assert_eq!(mesh.edges()[2], Wings { vertices: [1, 2], faces: [0, 1], wings: [[0, 1], [4, 3]] });
        // Edge 0-1: the border to its right, where 1-3 comes before it and 0-2 after.
        assert_eq!(mesh.edges()[0], Wings { vertices: [0, 1], faces: [0, NONE], wings: [[1, 2], [3, 1]] });
        assert_eq!(mesh.answer(Query::VE, 1).unwrap(), [0, 3, 2]);
        assert_eq!(mesh.answer(Query::VF, 1).unwrap(), [1, 0]);
        assert_eq!((mesh.edge_of_vertex(4), mesh.edge_of_vertex(5), mesh.edge_of_face(1)), (Some(4), None, 5));
    }

    #[test]
    fn what_it_cannot_hold_is_named() {
        let error = built(4, &[vec![0, 1, 2], vec![0, 1, 2, 1]]).unwrap_err();
        assert_eq!(error, StructureError::RepeatedCorner { face: 1, vertex: 1, count: 1 });
        let error = built(5, &[vec![0, 1, 2], vec![1, 0, 3], vec![0, 1, 4]]).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldEdge { vertices: [0, 1], faces: vec![0, 1, 2], count: 1 });
        let error = built(4, &[vec![0, 1, 2], vec![0, 1, 3]]).unwrap_err();
        assert_eq!(error, StructureError::Orientation { vertices: [0, 1], faces: [0, 1], count: 1 });
        let error = built(9, &[vec![0, 1, 2], vec![2, 3, 4], vec![5, 6, 2], vec![7, 8, 0]]).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldVertex { vertex: 0, fans: 2, count: 2 });
        // Two closed fans: two tetrahedra that share vertex 3.
        let tetrahedron = |[a, b, c, d]: [u32; 4]| [vec![a, c, b], vec![a, b, d], vec![b, c, d], vec![c, a, d]];
        let error = built(7, &[tetrahedron([0, 1, 2, 3]), tetrahedron([4, 5, 6, 3])].concat()).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldVertex { vertex: 3, fans: 2, count: 1 });
    }

    #[test]
    fn contradictions_are_named() {
        let WingedEdge { edges, vertex_edges, face_edges } = two_faces();
        let refused = |change: &dyn Fn(&mut WingedEdge)| {
            let mut mesh = two_faces();
            change(&mut mesh);
            WingedEdge::try_new(mesh.edges, mesh.vertex_edges, mesh.face_edges).unwrap_err().to_string()
        };
        assert_eq!(WingedEdge::try_new(edges, vertex_edges, face_edges).unwrap(), two_faces());
        assert_eq!(refused(&|mesh| mesh.edges[0].faces[0] = NONE), "edge 0: it has no face");
        assert_eq!(refused(&|mesh| mesh.edges[2].faces[1] = 0), "edge 2: it has the same face on both sides");
        assert_eq!(refused(&|mesh| mesh.edges[2].faces[1] = 2), "edge 2: it has a face that is not there");
        assert_eq!(refused(&|mesh| mesh.edges[3].wings[0][1] = 9), "edge 3: it has a wing that is not there");
        let elsewhere = "edge 3: the wing after it does not start where it ends";
        assert_eq!(refused(&|mesh| mesh.edges[3].wings[0][1] = 0), elsewhere);
        assert_eq!(
            refused(&|mesh| mesh.edges[0].wings[0][1] = 3),
            "edge 0: the wing after it lies beside another face"
        );
        let back = "edge 1: the wing after it does not lead back to it";
        assert_eq!(refused(&|mesh| mesh.edges[0].wings[0][0] = 2), back);
        assert_eq!(refused(&|mesh| mesh.face_edges[1] = 0), "face 1: its edge does not touch it");
        assert_eq!(refused(&|mesh| mesh.face_edges.push(0)), "face 2: its edge does not touch it");
        assert_eq!(refused(&|mesh| mesh.vertex_edges[5] = 0), "vertex 5: its edge does not touch it");
        assert_eq!(refused(&|mesh| mesh.vertex_edges[1] = NONE), "vertex 1: its edge does not touch it");
        assert_eq!(refused(&|mesh| mesh.vertex_edges[1] = 1), "vertex 1: its edge does not touch it");
    }

    /// Two separate triangles that claim to be one face.
    #[test]
    fn a_face_of_two_chains_is_refused() {
        let mut mesh = built(6, &[vec![0, 1, 2], vec![3, 4, 5]]).unwrap();
        mesh.edges.iter_mut().flat_map(|edge| &mut edge.faces).filter(|face| **face == 1).for_each(|face| *face = 0);
        let error = WingedEdge::try_new(mesh.edges, mesh.vertex_edges, vec![0]).unwrap_err();
        assert_eq!(error.to_string(), "face 0: its edges are no single closed chain");
    }

    /// Two separate triangles of which a vertex is called the same.
    #[test]
    fn fans_that_are_put_together_by_hand_are_refused() {
        let mut mesh = built(6, &[vec![0, 1, 2], vec![3, 4, 5]]).unwrap();
        mesh.edges.iter_mut().flat_map(|edge| &mut edge.vertices).filter(|end| **end == 5).for_each(|end| *end = 2);
        mesh.vertex_edges[5] = NONE;
        let error = WingedEdge::try_new(mesh.edges, mesh.vertex_edges, mesh.face_edges).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldVertex { vertex: 2, fans: 2, count: 1 });
    }
}
