//! The faces of every vertex beside the vertices of every face.

use shapeloom_core::{Exec, Stop};

use super::conversions::without_limits;
use super::face_list::FaceList;
use super::lists::Lists;
use super::once::once;
use super::walk::{WalkEdges, WalkFaces, answer_by_walking};
use super::{Cost, Incidence, IndexedPolygons, Query, StructureError};

/// The vertices of each face and the faces at each vertex: faces of any number of corners, in any constellation.
///
/// At a vertex its corners are stored: one number tells the face and the place in it. Eight bytes a corner, four a face and
/// four a vertex. Everything that [`IndexedPolygons`] hold fits, non-manifold or not, and all nine queries are local. Edges are
/// not stored: the number of an edge is that of the corner at which its first side starts, found at the end with fewer corners.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaceVertex {
    faces: IndexedPolygons,
    corners_at: Lists,
}

impl FaceVertex {
    /// The structure of faces, which are copied.
    ///
    /// # Errors
    /// The budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        let corners = faces.all_corners().len() as u64;
        let _memory = exec.reserve_elements(2 * corners + (faces.face_total() + faces.vertex_total()) as u64, 4)?;
        Ok(Self::new(faces.clone(), exec)?)
    }

    fn new(faces: IndexedPolygons, exec: &Exec) -> Result<Self, Stop> {
        let corners = faces.all_corners();
        let vertex = |corner: u32| corners[corner as usize];
        let corners_at = Lists::grouped(faces.vertex_total(), corners.len(), vertex, exec)?;
        Ok(Self { faces, corners_at })
    }

    /// The vertices of each face.
    pub fn faces(&self) -> &IndexedPolygons {
        &self.faces
    }

    /// The corners at a vertex, rising; corners are numbered through all faces.
    ///
    /// # Panics
    /// When there is no such vertex.
    pub fn corners_at(&self, vertex: u32) -> &[u32] {
        self.corners_at.of(vertex)
    }

    /// The corner before one around its face.
    fn before(&self, corner: u32) -> u32 {
        let range = self.faces.corner_range(self.faces.face_of(corner));
        if corner as usize == range.start { range.end as u32 - 1 } else { corner - 1 }
    }

    /// The sides at a vertex, by their other end and then by the corner at which they start.
    fn sides_at(&self, vertex: u32) -> Vec<(u32, u32)> {
        let mut sides = Vec::with_capacity(2 * self.corners_at(vertex).len());
        for &corner in self.corners_at(vertex) {
            let before = self.before(corner);
            sides.push((self.faces.side(corner)[1], corner));
            sides.push((self.faces.all_corners()[before as usize], before));
        }
        sides.retain(|&(end, _)| end != vertex);
        sides.sort_unstable();
        sides
    }

    /// The sides on the edge between two vertices, by the corners at which they start; those of one face in a row.
    fn sides_between(&self, [a, b]: [u32; 2]) -> impl Iterator<Item = u32> {
        let a_has_fewer = self.corners_at(a).len() <= self.corners_at(b).len();
        let (fewer, other) = if a_has_fewer { (a, b) } else { (b, a) };
        self.corners_at(fewer).iter().flat_map(move |&corner| {
            let before = self.before(corner);
            let leads = self.faces.side(corner)[1] == other;
            let comes = self.faces.all_corners()[before as usize] == other;
            comes.then_some(before).into_iter().chain(leads.then_some(corner))
        })
    }

    fn edge_between(&self, ends: [u32; 2]) -> Option<u32> {
        self.sides_between(ends).min()
    }
}

/// The numbers without those equal to the one before.
fn without_repeats(numbers: impl Iterator<Item = u32>) -> impl Iterator<Item = u32> {
    let mut last = None;
    numbers.filter(move |&number| last.replace(number) != Some(number))
}

/// Exact; the faces are moved in, not copied.
impl From<IndexedPolygons> for FaceVertex {
    fn from(faces: IndexedPolygons) -> Self {
        Self::new(faces, &without_limits()).expect("nothing stops it")
    }
}

/// The faces are there, as they were, and moved out.
impl From<FaceVertex> for IndexedPolygons {
    fn from(mesh: FaceVertex) -> Self {
        mesh.faces
    }
}

/// The faces are there, as they were.
impl From<&FaceVertex> for IndexedPolygons {
    fn from(mesh: &FaceVertex) -> Self {
        mesh.faces.clone()
    }
}

impl WalkEdges for FaceVertex {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        let all = 0..self.faces.all_corners().len() as u32;
        all.filter(|&corner| {
            let [a, b] = self.faces.side(corner);
            a != b && self.edge_between([a, b]) == Some(corner)
        })
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        self.faces.side(edge)
    }

    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        let mut sides = self.sides_at(vertex);
        sides.dedup_by_key(|side| side.0);
        sides.into_iter().map(|(_, corner)| corner)
    }

    fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> {
        without_repeats(self.sides_at(vertex).into_iter().map(|(end, _)| end))
    }
}

impl WalkFaces for FaceVertex {
    fn faces_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        without_repeats(self.corners_at(vertex).iter().map(|&corner| self.faces.face_of(corner)))
    }

    fn faces_beside(&self, edge: u32) -> impl Iterator<Item = u32> {
        without_repeats(self.sides_between(self.ends(edge)).map(|corner| self.faces.face_of(corner)))
    }

    fn corners(&self, face: u32) -> impl Iterator<Item = u32> {
        self.faces.face(face).iter().copied()
    }

    fn sides(&self, face: u32) -> impl Iterator<Item = u32> {
        let sides = self.faces.corner_range(face).map(|corner| self.faces.side(corner as u32));
        once(sides.filter(|[a, b]| a != b).filter_map(|ends| self.edge_between(ends)))
    }
}

impl Incidence for FaceVertex {
    fn name(&self) -> &'static str {
        "face-vertex"
    }

    fn vertex_count(&self) -> usize {
        self.corners_at.len()
    }

    fn face_count(&self) -> usize {
        self.faces.face_total()
    }

    fn cost(&self, _: Query) -> Cost {
        Cost::Local
    }

    fn memory_bytes(&self) -> usize {
        self.faces.memory_bytes() + self.corners_at.bytes()
    }

    answer_by_walking!(all);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_faces_at_an_edge_are_found() {
        let faces = IndexedPolygons::from_faces(6, &[vec![0, 1, 2], vec![0, 1, 3, 4], vec![1, 0, 5]]).unwrap();
        let mesh = FaceVertex::from(faces.clone());
        assert_eq!(mesh.corners_at(1), [1, 4, 7]);
        assert_eq!(mesh.answer(Query::EF, 0).unwrap(), [0, 1, 2]);
        assert_eq!(mesh.answer(Query::FE, 2).unwrap(), [0, 8, 9]);
        assert_eq!(mesh.answer(Query::VV, 0).unwrap(), [1, 2, 4, 5]);
        assert_eq!(IndexedPolygons::from(mesh), faces);
    }
}
