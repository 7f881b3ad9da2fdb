//! Half-edges of triangles that do not change.

use std::sync::atomic::{AtomicU32, Ordering};

use shapeloom_core::{Exec, parallel};

use super::face_list::FaceList;
use super::incidence::{Answered, Visitor, visit_each};
use super::sides::{EdgeSides, by_edge};
use super::{
    Cost, EdgeId, FaceId, HalfEdgeId, Incidence, IndexedPolygons, IndexedTriangles, Query, StructureError, VertexId,
};

/// Where a half-edge has no twin, or a vertex no half-edge.
pub(crate) const NONE: u32 = u32::MAX;

/// Half-edges of triangles: what comes next, before and to the left is arithmetic, what lies across is stored.
///
/// Half-edge `3f + i` runs from corner `i` of triangle `f` to the next corner. Stored are the origin of each half-edge, its
/// twin, and for each vertex one half-edge that leaves it: 24 bytes a triangle and 4 a vertex, which is 26 bytes a triangle on a
/// large closed mesh. At the border there is no twin; a border vertex's half-edge is the one on the border, so that turning
/// counter-clockwise from it passes all.
///
/// It holds oriented 2-manifolds with boundary: at most two triangles an edge, in opposite directions, and one fan at each
/// vertex; isolated vertices are kept. The number of an edge is that of its smaller half-edge. All nine queries are local.
///
/// Half-edges as a structure: Weiler, "Edge-based data structures for solid modeling in curved-surface environments" (1985);
/// as arrays over triangles: Campagna, Kobbelt, Seidel, "Directed edges" (1998).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TriangleHalfEdges {
    triangles: Vec<[u32; 3]>,
    twins: Vec<u32>,
    firsts: Vec<u32>,
}

impl TriangleHalfEdges {
    /// The half-edges of triangles; the triangles are moved in, not copied.
    ///
    /// Twins are found by sorting sides by edge, in parallel: linear in practice, 20 bytes a corner while it runs.
    ///
    /// # Errors
    /// What it cannot hold: a triangle that names a vertex twice, an edge with more than two triangles or with two in the same
    /// direction, a vertex with several fans; the budget, or the reason to stop.
    pub fn try_build(triangles: IndexedTriangles, exec: &Exec) -> Result<Self, StructureError> {
        refuse_repeated_corners(&triangles, exec)?;
        let corners = triangles.all_corners();
        let _memory = exec.reserve_elements((corners.len() + triangles.vertex_total()) as u64, 4)?;
        let mut twins = Vec::with_capacity(corners.len());
        twins.resize_with(corners.len(), || AtomicU32::new(NONE));
        let faults = by_edge(&triangles, exec, |bucket| {
            let mut faults = EdgeFaults::default();
            bucket.for_each_edge(|edge| {
                if edge.len() == 2 {
                    let (a, b) = (edge.corner(0), edge.corner(1));
                    twins[a as usize].store(b, Ordering::Relaxed);
                    twins[b as usize].store(a, Ordering::Relaxed);
                }
                faults.note(&edge, &triangles);
            });
            Ok::<_, StructureError>(faults)
        })?;
        EdgeFaults::refuse(faults)?;
        let twins: Vec<u32> = twins.into_iter().map(AtomicU32::into_inner).collect();

        let mut firsts = vec![NONE; triangles.vertex_total()];
        for (part, twins) in corners.chunks(parallel::CHUNK * 16).zip(twins.chunks(parallel::CHUNK * 16)).enumerate() {
            exec.check()?;
            let start = (part * parallel::CHUNK * 16) as u32;
            for (i, (&origin, &twin)) in twins.0.iter().zip(twins.1).enumerate() {
                let first = &mut firsts[origin as usize];
                // The half-edge on the border if there is one, else the smallest.
                if twin == NONE || *first == NONE {
                    *first = start + i as u32;
                }
            }
        }
        let mesh = Self { triangles: triangles.into_triangles(), twins, firsts };
        mesh.refuse_several_fans(exec)?;
        Ok(mesh)
    }

    /// Fails if turning about each vertex does not pass all corners.
    fn refuse_several_fans(&self, exec: &Exec) -> Result<(), StructureError> {
        let passed = parallel::map_chunks(exec, self.firsts.len(), parallel::CHUNK, |vertices| {
            Ok::<_, StructureError>(
                vertices.map(|vertex| self.outgoing(VertexId(vertex as u32)).count()).sum::<usize>(),
            )
        })?;
        if passed.into_iter().sum::<usize>() == self.twins.len() {
            return Ok(());
        }
        // Rare: find out where.
        let mut fans = vec![0u32; self.firsts.len()];
        let mut seen = vec![false; self.twins.len()];
        for half_edge in (0..self.twins.len() as u32).map(HalfEdgeId) {
            if seen[half_edge.index()] {
                continue;
            }
            fans[self.origin(half_edge).index()] += 1;
            // Clockwise to the border or around, then counter-clockwise over the fan.
            let mut start = half_edge;
            while let Some(twin) = self.twin(start) {
                start = self.next(twin);
                if start == half_edge {
                    break;
                }
            }
            for passed in self.turn(Some(start)) {
                seen[passed.index()] = true;
            }
        }
        let count = fans.iter().filter(|&&fans| fans > 1).count();
        let vertex = fans.iter().position(|&fans| fans > 1).unwrap_or(0);
        Err(StructureError::NonManifoldVertex { vertex: vertex as u32, fans: fans[vertex] as usize, count })
    }

    /// The origins of the half-edges of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The number of half-edges.
    pub fn half_edge_count(&self) -> usize {
        self.twins.len()
    }

    /// The half-edge after one around its triangle.
    pub fn next(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if half_edge.0 % 3 == 2 { half_edge.0 - 2 } else { half_edge.0 + 1 })
    }

    /// The half-edge before one around its triangle.
    pub fn previous(&self, half_edge: HalfEdgeId) -> HalfEdgeId {
        HalfEdgeId(if half_edge.0.is_multiple_of(3) { half_edge.0 + 2 } else { half_edge.0 - 1 })
    }

    /// The triangle to the left of a half-edge, to which it belongs.
    pub fn face(&self, half_edge: HalfEdgeId) -> FaceId {
        FaceId(half_edge.0 / 3)
    }

    /// The half-edge on the other side, in the opposite direction; none at the border.
    pub fn twin(&self, half_edge: HalfEdgeId) -> Option<HalfEdgeId> {
        some(self.twins[half_edge.index()])
    }

    /// The vertex where a half-edge starts.
    pub fn origin(&self, half_edge: HalfEdgeId) -> VertexId {
        VertexId(self.triangles.as_flattened()[half_edge.index()])
    }

    /// The vertex where a half-edge ends.
    pub fn target(&self, half_edge: HalfEdgeId) -> VertexId {
        self.origin(self.next(half_edge))
    }

    /// The half-edge of a vertex: on the border if the vertex is; none if the vertex is isolated.
    pub fn half_edge(&self, vertex: VertexId) -> Option<HalfEdgeId> {
        some(self.firsts[vertex.index()])
    }

    /// Whether a vertex lies on the border; isolated vertices do not.
    pub fn is_border(&self, vertex: VertexId) -> bool {
        self.half_edge(vertex).is_some_and(|half_edge| self.twin(half_edge).is_none())
    }

    /// The half-edges that leave a vertex, counter-clockwise.
    pub fn outgoing(&self, vertex: VertexId) -> impl Iterator<Item = HalfEdgeId> + '_ {
        self.turn(self.half_edge(vertex))
    }

    fn turn(&self, start: Option<HalfEdgeId>) -> impl Iterator<Item = HalfEdgeId> + '_ {
        std::iter::successors(start, move |&half_edge| {
            self.twin(self.previous(half_edge)).filter(|&next| Some(next) != start)
        })
    }

    /// The vertices that edges join to a vertex, counter-clockwise.
    pub fn one_ring(&self, vertex: VertexId) -> OneRing<'_> {
        let first = self.firsts[vertex.index()];
        let border = first != NONE && self.twins[first as usize] == NONE;
        let before = if border { self.target(HalfEdgeId(first)).0 } else { NONE };
        OneRing { origins: self.triangles.as_flattened(), twins: &self.twins, first, at: first, before }
    }

    pub(crate) fn edge_of(&self, half_edge: HalfEdgeId) -> EdgeId {
        EdgeId(half_edge.0.min(self.twins[half_edge.index()]))
    }

    pub(crate) fn from_parts(triangles: Vec<[u32; 3]>, twins: Vec<u32>, firsts: Vec<u32>) -> Self {
        Self { triangles, twins, firsts }
    }

    pub(crate) fn into_parts(self) -> (Vec<[u32; 3]>, Vec<u32>, Vec<u32>) {
        (self.triangles, self.twins, self.firsts)
    }
}

pub(crate) fn some(half_edge: u32) -> Option<HalfEdgeId> {
    (half_edge != NONE).then_some(HalfEdgeId(half_edge))
}

/// The neighbours of a vertex, counter-clockwise: see [`TriangleHalfEdges::one_ring`].
#[derive(Clone, Debug)]
pub struct OneRing<'a> {
    origins: &'a [u32],
    twins: &'a [u32],
    first: u32,
    at: u32,
    before: u32,
}

impl Iterator for OneRing<'_> {
    type Item = VertexId;

    fn next(&mut self) -> Option<VertexId> {
        // A border vertex has a neighbour before its first triangle.
        if self.before != NONE {
            return Some(VertexId(std::mem::replace(&mut self.before, NONE)));
        }
        if self.at == NONE {
            return None;
        }
        let previous = if self.at.is_multiple_of(3) { self.at + 2 } else { self.at - 1 } as usize;
        let next = self.twins[previous];
        self.at = if next == self.first { NONE } else { next };
        Some(VertexId(self.origins[previous]))
    }
}

/// Fails at triangles or polygons that name a vertex twice.
pub(crate) fn refuse_repeated_corners(faces: &impl FaceList, exec: &Exec) -> Result<(), StructureError> {
    let found = parallel::map_chunks(exec, faces.face_total(), parallel::CHUNK, |chunk| {
        let mut sorted = Vec::new();
        let mut found: Option<(u32, u32, usize)> = None;
        for face in chunk.map(|face| face as u32) {
            let repeated = match *faces.face(face) {
                [a, b, c] => {
                    if a == b || a == c {
                        Some(a)
                    } else {
                        (b == c).then_some(b)
                    }
                }
                ref corners => {
                    sorted.clear();
                    sorted.extend_from_slice(corners);
                    sorted.sort_unstable();
                    sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
                }
            };
            if let Some(vertex) = repeated {
                found = Some(found.map_or((face, vertex, 1), |(face, vertex, count)| (face, vertex, count + 1)));
            }
        }
        Ok::<_, StructureError>(found)
    })?;
    let count = found.iter().flatten().map(|&(_, _, count)| count).sum();
    match found.into_iter().flatten().next() {
        Some((face, vertex, _)) => Err(StructureError::RepeatedCorner { face, vertex, count }),
        None => Ok(()),
    }
}

/// Edges that oriented manifolds do not have, found one bucket at a time.
#[derive(Default)]
pub(crate) struct EdgeFaults {
    crowded: Option<([u32; 2], Vec<u32>)>,
    crowded_count: usize,
    turned: Option<([u32; 2], [u32; 2])>,
    turned_count: usize,
}

impl EdgeFaults {
    /// Notes what is wrong with an edge, if anything.
    pub(crate) fn note(&mut self, edge: &EdgeSides<'_>, faces: &impl FaceList) {
        let forward = |i: usize| faces.all_corners()[edge.corner(i) as usize] == edge.vertices[0];
        if edge.len() > 2 {
            self.crowded_count += 1;
            self.crowded
                .get_or_insert_with(|| (edge.vertices, edge.corners().map(|corner| faces.face_of(corner)).collect()));
        } else if edge.len() == 2 && forward(0) == forward(1) {
            self.turned_count += 1;
            self.turned.get_or_insert_with(|| (edge.vertices, [0, 1].map(|i| faces.face_of(edge.corner(i)))));
        }
    }

    /// Fails if anything was noted in any bucket: crowded edges before those whose faces disagree.
    pub(crate) fn refuse(faults: Vec<Self>) -> Result<(), StructureError> {
        let count = faults.iter().map(|faults| faults.crowded_count).sum();
        let turned_count = faults.iter().map(|faults| faults.turned_count).sum();
        let (mut crowded, mut turned) = (None, None);
        for faults in faults {
            crowded = crowded.or(faults.crowded);
            turned = turned.or(faults.turned);
        }
        match (crowded, turned) {
            (Some((vertices, faces)), _) => Err(StructureError::NonManifoldEdge { vertices, faces, count }),
            (None, Some((vertices, faces))) => {
                Err(StructureError::Orientation { vertices, faces, count: turned_count })
            }
            (None, None) => Ok(()),
        }
    }
}

/// The triangles are there, as they were.
impl From<TriangleHalfEdges> for IndexedTriangles {
    fn from(mesh: TriangleHalfEdges) -> Self {
        Self::trusted(mesh.firsts.len() as u32, mesh.triangles)
    }
}

/// The triangles are there, as they were.
impl From<&TriangleHalfEdges> for IndexedTriangles {
    fn from(mesh: &TriangleHalfEdges) -> Self {
        Self::trusted(mesh.firsts.len() as u32, mesh.triangles.clone())
    }
}

/// The triangles are there, as they were.
impl From<&TriangleHalfEdges> for IndexedPolygons {
    fn from(mesh: &TriangleHalfEdges) -> Self {
        Self::from(&IndexedTriangles::from(mesh))
    }
}

/// Exact where triangles make an oriented manifold with boundary; the error names what does not fit.
impl TryFrom<&IndexedTriangles> for TriangleHalfEdges {
    type Error = StructureError;

    fn try_from(triangles: &IndexedTriangles) -> Result<Self, StructureError> {
        Self::try_build(triangles.clone(), &Exec::default())
    }
}

/// Exact where the faces are triangles that make an oriented manifold with boundary; the error names what does not fit.
impl TryFrom<&IndexedPolygons> for TriangleHalfEdges {
    type Error = StructureError;

    fn try_from(polygons: &IndexedPolygons) -> Result<Self, StructureError> {
        Self::try_build(IndexedTriangles::try_from(polygons)?, &Exec::default())
    }
}

impl Incidence for TriangleHalfEdges {
    fn name(&self) -> &'static str {
        "half-edges (triangles)"
    }

    fn vertex_count(&self) -> usize {
        self.firsts.len()
    }

    fn face_count(&self) -> usize {
        self.triangles.len()
    }

    fn cost(&self, _: Query) -> Cost {
        Cost::Local
    }

    fn memory_bytes(&self) -> usize {
        size_of_val(self.triangles.as_slice())
            + size_of_val(self.twins.as_slice())
            + size_of_val(self.firsts.as_slice())
    }

    fn visit_edges(&self, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        let all = (0..self.twins.len() as u32).map(HalfEdgeId);
        visit_each(all.filter(|&side| self.edge_of(side).0 == side.0).map(|side| EdgeId(side.0)), visit);
        Ok(())
    }

    fn vertex_vertices(&self, vertex: VertexId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.one_ring(vertex), visit);
        Ok(())
    }

    fn vertex_edges(&self, vertex: VertexId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.edges_at(vertex), visit);
        Ok(())
    }

    fn vertex_faces(&self, vertex: VertexId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        visit_each(self.outgoing(vertex).map(|half_edge| self.face(half_edge)), visit);
        Ok(())
    }

    fn edge_vertices(&self, edge: EdgeId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        let half_edge = HalfEdgeId(edge.0);
        visit_each([self.origin(half_edge), self.target(half_edge)], visit);
        Ok(())
    }

    fn edge_edges(&self, edge: EdgeId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        let ends = [self.origin(HalfEdgeId(edge.0)), self.target(HalfEdgeId(edge.0))];
        // Two vertices have one edge at most, so that no other is at both ends.
        let near = ends.into_iter().flat_map(|vertex| self.edges_at(vertex));
        visit_each(near.filter(|&other| other != edge), visit);
        Ok(())
    }

    fn edge_faces(&self, edge: EdgeId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        let half_edge = HalfEdgeId(edge.0);
        let sides = [Some(half_edge), self.twin(half_edge)];
        visit_each(sides.into_iter().flatten().map(|side| self.face(side)), visit);
        Ok(())
    }

    fn face_vertices(&self, face: FaceId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.triangles[face.index()].map(VertexId), visit);
        Ok(())
    }

    fn face_edges(&self, face: FaceId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.sides_of(face).map(|side| self.edge_of(side)), visit);
        Ok(())
    }

    fn face_faces(&self, face: FaceId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        let near = self.sides_of(face).map(|side| self.twin(side).map_or(NONE, |twin| self.face(twin).0));
        let first = |i: usize| near[i] != NONE && !near[..i].contains(&near[i]);
        visit_each((0..3).filter(|&i| first(i)).map(|i| FaceId(near[i])), visit);
        Ok(())
    }
}

impl TriangleHalfEdges {
    /// The half-edges of a triangle.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn sides_of(&self, face: FaceId) -> [HalfEdgeId; 3] {
        assert!(face.index() < self.triangles.len(), "there is no {face} among {}", self.triangles.len());
        [0, 1, 2].map(|i| HalfEdgeId(face.0 * 3 + i))
    }

    /// The edges at a vertex, counter-clockwise.
    fn edges_at(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        let last = self.is_border(vertex).then(|| self.outgoing(vertex).last()).flatten();
        let leaving = self.outgoing(vertex).map(|half_edge| self.edge_of(half_edge));
        leaving.chain(last.map(|half_edge| self.edge_of(self.previous(half_edge))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn built(vertices: u32, triangles: &[[u32; 3]]) -> Result<TriangleHalfEdges, StructureError> {
        TriangleHalfEdges::try_from(&IndexedTriangles::try_new(vertices, triangles.to_vec()).unwrap())
    }

    #[test]
    fn rings_turn_counter_clockwise_and_stop_at_the_border() {
        // A fan of three triangles about vertex 0, and an isolated vertex 5.
        let fan = built(6, &[[0, 2, 3], [1, 2, 0], [4, 0, 3]]).unwrap();
        let ring = |vertex| fan.one_ring(VertexId(vertex)).map(|vertex| vertex.0).collect::<Vec<_>>();
        assert_eq!(ring(0), [1, 2, 3, 4]);
        assert_eq!(ring(2), [3, 0, 1]);
        assert_eq!(ring(5), []);
        assert_eq!((fan.is_border(VertexId(0)), fan.is_border(VertexId(5))), (true, false));
        let closed = built(4, &[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
        let ring: Vec<u32> = closed.one_ring(VertexId(0)).map(|vertex| vertex.0).collect();
        assert_eq!(ring, [1, 3, 2]);
        assert!((0..4).all(|vertex| !closed.is_border(VertexId(vertex))));
    }

    #[test]
    fn what_it_cannot_hold_is_named() {
        let error = built(4, &[[0, 1, 2], [1, 3, 3], [2, 2, 0]]).unwrap_err();
        assert_eq!(error, StructureError::RepeatedCorner { face: 1, vertex: 3, count: 2 });
        let error = built(5, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldEdge { vertices: [0, 1], faces: vec![0, 1, 2], count: 1 });
        assert_eq!(error.to_string(), "edge 0-1: found 3 faces (0, 1, 2), expected at most two");
        let error = built(4, &[[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(error, StructureError::Orientation { vertices: [0, 1], faces: [0, 1], count: 1 });
        let error = built(9, &[[0, 1, 2], [2, 3, 4], [5, 6, 2], [7, 8, 0]]).unwrap_err();
        assert_eq!(error, StructureError::NonManifoldVertex { vertex: 0, fans: 2, count: 2 });
    }

    #[test]
    fn twenty_six_bytes_a_triangle() {
        // A torus of 100 x 60 vertices.
        let (columns, rows) = (100u32, 60u32);
        let at = |i: u32, j: u32| (j % rows) * columns + i % columns;
        let mut triangles = Vec::new();
        for j in 0..rows {
            for i in 0..columns {
                triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
        }
        let torus = built(columns * rows, &triangles).unwrap();
        assert_eq!(torus.memory_bytes(), 26 * triangles.len());
        assert!((0..columns * rows).all(|vertex| torus.one_ring(VertexId(vertex)).count() == 6));
    }
}
