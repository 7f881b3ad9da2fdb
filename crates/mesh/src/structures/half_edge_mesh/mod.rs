//! Half-edges that can be edited: connectivity of polygon meshes with borders, and local operators.

mod breadth_first;
mod build;
mod collapse;
mod compact;
mod faces;
mod flip;
mod fold_over;
mod holes;
mod illegal;
mod incidence;
mod remove_vertex;
mod split;
mod validate;
mod walk;

#[cfg(test)]
mod tests;

pub use breadth_first::{BreadthFirst, Reached};
pub use compact::{Compacted, Renumbering};
pub use illegal::Illegal;
pub use remove_vertex::Hole;
pub use walk::{AroundFace, AroundVertex};

use super::{EdgeId, FaceId, HalfEdgeId, VertexId};

/// No element: the face of a border half-edge, the half-edge of an isolated vertex.
const NONE: u32 = u32::MAX;
/// An element that was deleted.
const GONE: u32 = u32::MAX - 1;

/// Half-edges in pairs: each edge is two half-edges of opposite directions, `h` and `h ^ 1`; each knows where it
/// starts, the next and the previous one around its face, and its face. A vertex knows one half-edge that leaves it, a
/// face the one at its first corner. 16 bytes a half-edge, 4 a vertex, 4 a face.
///
/// It holds oriented 2-manifold meshes of polygons, with borders: no face has a vertex twice, no two edges have the
/// same vertices, no edge has more than two faces, the faces at a vertex form one fan. Half-edges on the border have no
/// face and are linked into loops; the half-edge of a border vertex is the one on the border. All of this holds after
/// every operator, and [`HalfEdgeMesh::validate`] lists what does not. Operators that would break it, or change the
/// topology, refuse with the reason, an [`Illegal`]; each has a `can_` function that tells beforehand.
///
/// Edge `e` has the half-edges `2e` and `2e + 1`. What is deleted leaves its number unused, so no number ever comes to
/// mean another element; [`HalfEdgeMesh::compact`] closes the gaps and tells the new numbers. Coordinates are not part
/// of it: functions that need them take a slice with one for each vertex number.
///
/// ```
/// use shapeloom_core::Exec;
/// use shapeloom_mesh::structures::{HalfEdgeMesh, IndexedPolygons, VertexId};
///
/// // Two triangles; their common edge from 0 to 2 becomes the one from 1 to 3.
/// let faces = IndexedPolygons::from_faces(4, &[[0, 1, 2], [0, 2, 3]])?;
/// let mut mesh = HalfEdgeMesh::try_build(&faces, &Exec::default())?;
/// let diagonal = mesh.find(VertexId(0), VertexId(2)).ok_or("no such edge")?;
/// mesh.flip_edge(mesh.edge(diagonal))?;
/// assert!(mesh.find(VertexId(1), VertexId(3)).is_some());
/// assert!(mesh.validate().is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct HalfEdgeMesh {
    /// Where each half-edge starts; `GONE` for deleted ones.
    origin: Vec<u32>,
    next: Vec<u32>,
    previous: Vec<u32>,
    /// The face of each half-edge; `NONE` on the border.
    face: Vec<u32>,
    /// A half-edge that leaves each vertex, the one on the border if there is one; `NONE` for isolated vertices, `GONE`
    /// for deleted ones.
    leaving: Vec<u32>,
    /// The half-edge at the first corner of each face; `GONE` for deleted ones.
    first: Vec<u32>,
    counts: Counts,
}

/// How many elements there are, deleted ones not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Vertices, isolated ones too.
    pub vertices: u32,
    /// Edges.
    pub edges: u32,
    /// Faces.
    pub faces: u32,
}

impl Counts {
    /// V − E + F.
    pub fn euler_characteristic(self) -> i64 {
        i64::from(self.vertices) - i64::from(self.edges) + i64::from(self.faces)
    }
}

/// Elements and their neighbours. All panic on numbers that the mesh does not have; `has_` functions never do.
impl HalfEdgeMesh {
    /// How many elements there are, deleted ones not counted.
    pub fn counts(&self) -> Counts {
        self.counts
    }

    /// Numbers of vertices run below this; deleted ones are among them.
    pub fn vertex_slots(&self) -> usize {
        self.leaving.len()
    }

    /// Numbers of edges run below this; deleted ones are among them.
    pub fn edge_slots(&self) -> usize {
        self.origin.len() / 2
    }

    /// Numbers of faces run below this; deleted ones are among them.
    pub fn face_slots(&self) -> usize {
        self.first.len()
    }

    /// Whether there is such a vertex, not deleted.
    pub fn has_vertex(&self, vertex: VertexId) -> bool {
        self.leaving.get(vertex.index()).is_some_and(|&leaving| leaving != GONE)
    }

    /// Whether there is such an edge, not deleted.
    pub fn has_edge(&self, edge: EdgeId) -> bool {
        edge.index() < self.edge_slots() && self.origin[2 * edge.index()] != GONE
    }

    /// Whether there is such a half-edge, not deleted.
    pub fn has_half_edge(&self, half_edge: HalfEdgeId) -> bool {
        self.origin.get(half_edge.index()).is_some_and(|&origin| origin != GONE)
    }

    /// Whether there is such a face, not deleted.
    pub fn has_face(&self, face: FaceId) -> bool {
        self.first.get(face.index()).is_some_and(|&first| first != GONE)
    }

    /// The vertices, without deleted ones.
    pub fn live_vertices(&self) -> impl Iterator<Item = VertexId> + '_ {
        (0..self.leaving.len() as u32).map(VertexId).filter(|&vertex| self.has_vertex(vertex))
    }

    /// The edges, without deleted ones.
    pub fn live_edges(&self) -> impl Iterator<Item = EdgeId> + '_ {
        (0..self.edge_slots() as u32).map(EdgeId).filter(|&edge| self.has_edge(edge))
    }

    /// The faces, without deleted ones.
    pub fn live_faces(&self) -> impl Iterator<Item = FaceId> + '_ {
        (0..self.first.len() as u32).map(FaceId).filter(|&face| self.has_face(face))
    }

    /// The other half of the edge, which runs back.
    pub fn twin(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(half_edge.0 ^ 1)
    }

    /// The edge that a half-edge is a half of.
    pub fn edge(&self, half_edge: HalfEdgeId) -> EdgeId {
        EdgeId(half_edge.0 >> 1)
    }

    /// The half-edges of an edge.
    pub fn halves(&self, edge: EdgeId) -> [HalfEdgeId; 2] {
        // Twice a number that is not there may be one that is, as a wrapped number of 32 bits.
        assert!(edge.index() < self.edge_slots(), "there is no {edge} among {}", self.edge_slots());
        [HalfEdgeId(2 * edge.0), HalfEdgeId(2 * edge.0 + 1)]
    }

    /// The next half-edge around the face, or along the border.
    pub fn next(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(self.after(half_edge.0))
    }

    /// The previous half-edge around the face, or along the border.
    pub fn previous(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(self.before(half_edge.0))
    }

    /// The vertex that a half-edge leaves.
    pub fn origin(&self, half_edge: HalfEdgeId) -> VertexId {
        VertexId(self.start(half_edge.0))
    }

    /// The vertex that a half-edge leads to.
    pub fn target(&self, half_edge: HalfEdgeId) -> VertexId {
        VertexId(self.end(half_edge.0))
    }

    /// The vertices of an edge: where its first half starts and where it ends.
    pub fn ends(&self, edge: EdgeId) -> [VertexId; 2] {
        self.halves(edge).map(|half| self.origin(half))
    }

    /// The face to the left of a half-edge; none on the border.
    pub fn face(&self, half_edge: HalfEdgeId) -> Option<FaceId> {
        Some(self.left(half_edge.0)).filter(|&face| face < GONE).map(FaceId)
    }

    /// A half-edge that leaves a vertex, the one on the border if there is one; none if the vertex is isolated or
    /// deleted.
    pub fn leaving(&self, vertex: VertexId) -> Option<HalfEdgeId> {
        Some(self.leaving[vertex.index()]).filter(|&leaving| leaving < GONE).map(HalfEdgeId)
    }

    /// The half-edge at the first corner of a face; none if the face is deleted.
    pub fn first(&self, face: FaceId) -> Option<HalfEdgeId> {
        Some(self.first[face.index()]).filter(|&first| first < GONE).map(HalfEdgeId)
    }

    /// Whether a half-edge has no face.
    pub fn is_border(&self, half_edge: HalfEdgeId) -> bool {
        self.left(half_edge.0) == NONE
    }

    /// Whether an edge has one face only.
    pub fn is_border_edge(&self, edge: EdgeId) -> bool {
        self.halves(edge).into_iter().any(|half| self.is_border(half))
    }

    /// Whether a vertex lies on the border. Isolated vertices do not.
    pub fn is_border_vertex(&self, vertex: VertexId) -> bool {
        self.leaving(vertex).is_some_and(|leaving| self.is_border(leaving))
    }

    /// The memory that the connectivity takes, in bytes.
    fn bytes(&self) -> usize {
        size_of::<u32>() * (4 * self.origin.len() + self.leaving.len() + self.first.len())
    }
}

/// The same in plain numbers, and how links are changed.
impl HalfEdgeMesh {
    fn start(&self, h: u32) -> u32 {
        self.origin[h as usize]
    }

    fn end(&self, h: u32) -> u32 {
        self.origin[h as usize ^ 1]
    }

    fn after(&self, h: u32) -> u32 {
        self.next[h as usize]
    }

    fn before(&self, h: u32) -> u32 {
        self.previous[h as usize]
    }

    fn left(&self, h: u32) -> u32 {
        self.face[h as usize]
    }

    /// Lets one half-edge follow another.
    fn link(&mut self, h: u32, next: u32) {
        self.next[h as usize] = next;
        self.previous[next as usize] = h;
    }

    /// Lets the half-edge of a vertex be another, where it is this one.
    fn relieve(&mut self, vertex: u32, of: u32, by: u32) {
        let leaving = &mut self.leaving[vertex as usize];
        if *leaving == of {
            *leaving = by;
        }
    }

    /// Lets a face start at another half-edge, where it starts at this one.
    fn restart(&mut self, face: u32, of: u32, by: u32) {
        if face != NONE && self.first[face as usize] == of {
            self.first[face as usize] = by;
        }
    }

    /// A new edge with nothing set but where its halves start; the first half's number.
    fn add_edge(&mut self, from: u32, to: u32) -> u32 {
        let h = self.origin.len() as u32;
        self.origin.extend([from, to]);
        self.next.extend([NONE; 2]);
        self.previous.extend([NONE; 2]);
        self.face.extend([NONE; 2]);
        self.counts.edges += 1;
        h
    }

    fn add_vertex(&mut self, leaving: u32) -> u32 {
        self.leaving.push(leaving);
        self.counts.vertices += 1;
        self.leaving.len() as u32 - 1
    }

    fn add_face(&mut self, first: u32) -> u32 {
        self.first.push(first);
        self.counts.faces += 1;
        self.first.len() as u32 - 1
    }

    fn delete_edge(&mut self, h: u32) {
        for half in [h as usize, h as usize ^ 1] {
            self.origin[half] = GONE;
            self.next[half] = GONE;
            self.previous[half] = GONE;
            self.face[half] = GONE;
        }
        self.counts.edges -= 1;
    }

    fn delete_vertex(&mut self, vertex: u32) {
        self.leaving[vertex as usize] = GONE;
        self.counts.vertices -= 1;
    }

    fn delete_face(&mut self, face: u32) {
        self.first[face as usize] = GONE;
        self.counts.faces -= 1;
    }

    /// Refuses more elements than numbers of 32 bits can tell apart.
    fn room(&self, vertices: usize, edges: usize, faces: usize) -> Result<(), Illegal> {
        let last = GONE as usize;
        let full = self.leaving.len() + vertices > last
            || self.origin.len() + 2 * edges > last
            || self.first.len() + faces > last;
        if full { Err(Illegal::Full) } else { Ok(()) }
    }
}
