//! The corner table.

use super::incidence::{Answered, Visitor, visit_each};
use super::triangle_half_edges::NONE;
use super::{
    CornerId, Cost, EdgeId, FaceId, Incidence, IndexedPolygons, IndexedTriangles, Query, StructureError,
    TriangleHalfEdges, VertexId,
};

/// Triangles by their corners: the vertex of each corner and the corner opposite to it across an edge.
///
/// Corner `3t + i` is corner `i` of triangle `t`. Stored are its vertex, the opposite corner (in the triangle across the side
/// that does not touch the corner; none at the border), and for each vertex one of its corners: 24 bytes a triangle and 4 a
/// vertex. It holds what [`TriangleHalfEdges`] holds, with which it is exchanged exactly; all nine queries are local. The number
/// of an edge is that of the smaller of the two corners opposite to it.
///
/// Rossignac, Safonova, Szymczak, "3D compression made simple: Edgebreaker on a corner-table" (2001).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CornerTable {
    triangles: Vec<[u32; 3]>,
    opposites: Vec<u32>,
    firsts: Vec<u32>,
}

fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

fn previous(corner: u32) -> u32 {
    if corner.is_multiple_of(3) { corner + 2 } else { corner - 1 }
}

fn some(corner: u32) -> Option<CornerId> {
    (corner != NONE).then_some(CornerId(corner))
}

impl CornerTable {
    /// The vertex at a corner.
    pub fn vertex(&self, corner: CornerId) -> VertexId {
        VertexId(self.triangles.as_flattened()[corner.index()])
    }

    /// The triangle of a corner.
    pub fn triangle(&self, corner: CornerId) -> FaceId {
        FaceId(corner.0 / 3)
    }

    /// The corner after one, counter-clockwise around its triangle.
    pub fn next(&self, corner: CornerId) -> CornerId {
        CornerId(next(corner.0))
    }

    /// The corner before one.
    pub fn previous(&self, corner: CornerId) -> CornerId {
        CornerId(previous(corner.0))
    }

    /// The corner across the side opposite to a corner; none at the border.
    pub fn opposite(&self, corner: CornerId) -> Option<CornerId> {
        some(self.opposites[corner.index()])
    }

    /// Seen with the corner up: the tip of the triangle to the left, across the side from the corner to the next one.
    pub fn left(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(self.previous(corner))
    }

    /// Seen with the corner up: the tip of the triangle to the right, across the side from the previous corner to the corner.
    pub fn right(&self, corner: CornerId) -> Option<CornerId> {
        self.opposite(self.next(corner))
    }

    /// A corner at a vertex: at the border the clockwise last; none if the vertex is isolated.
    pub fn corner(&self, vertex: VertexId) -> Option<CornerId> {
        some(self.firsts[vertex.index()])
    }

    /// The corners at a vertex, counter-clockwise.
    pub fn corners_at(&self, vertex: VertexId) -> impl Iterator<Item = CornerId> + '_ {
        let start = self.corner(vertex);
        // The next triangle lies to the right of the corner; its tip there is the corner after the one at the vertex.
        std::iter::successors(start, move |&corner| {
            self.right(corner).map(|tip| self.next(tip)).filter(|&next| Some(next) != start)
        })
    }

    /// The corners opposite to the sides of a triangle: the first side, from corner 0 to corner 1, is opposite to corner 2.
    fn tips_of_sides(&self, face: FaceId) -> [CornerId; 3] {
        assert!(face.index() < self.triangles.len(), "there is no {face} among {}", self.triangles.len());
        [2, 0, 1].map(|i| CornerId(face.0 * 3 + i))
    }

    /// The edge opposite to a corner.
    fn edge_opposite(&self, corner: u32) -> EdgeId {
        EdgeId(corner.min(self.opposites[corner as usize]))
    }

    /// The edges at a vertex, counter-clockwise.
    fn edges_at(&self, vertex: VertexId) -> impl Iterator<Item = EdgeId> + '_ {
        let border = self.corner(vertex).is_some_and(|corner| self.left(corner).is_none());
        let last = border.then(|| self.corners_at(vertex).last()).flatten();
        let after = self.corners_at(vertex).map(|corner| self.edge_opposite(previous(corner.0)));
        after.chain(last.map(|corner| self.edge_opposite(next(corner.0))))
    }

    fn ends(&self, edge: EdgeId) -> [VertexId; 2] {
        [self.vertex(CornerId(next(edge.0))), self.vertex(CornerId(previous(edge.0)))]
    }
}

/// Exact: the side opposite to a corner is the half-edge that leaves the next corner.
impl From<TriangleHalfEdges> for CornerTable {
    fn from(mesh: TriangleHalfEdges) -> Self {
        let (triangles, twins, firsts) = mesh.into_parts();
        let across = |corner: u32| match twins[next(corner) as usize] {
            NONE => NONE,
            twin => previous(twin),
        };
        let opposites = (0..twins.len() as u32).map(across).collect();
        Self { triangles, opposites, firsts }
    }
}

/// Exact, corner for half-edge.
impl From<CornerTable> for TriangleHalfEdges {
    fn from(table: CornerTable) -> Self {
        let across = |half_edge: u32| match table.opposites[previous(half_edge) as usize] {
            NONE => NONE,
            corner => next(corner),
        };
        let twins = (0..table.opposites.len() as u32).map(across).collect();
        Self::from_parts(table.triangles, twins, table.firsts)
    }
}

/// Exact.
impl From<&TriangleHalfEdges> for CornerTable {
    fn from(mesh: &TriangleHalfEdges) -> Self {
        mesh.clone().into()
    }
}

/// Exact.
impl From<&CornerTable> for TriangleHalfEdges {
    fn from(table: &CornerTable) -> Self {
        table.clone().into()
    }
}

/// The triangles are there, as they were.
impl From<&CornerTable> for IndexedTriangles {
    fn from(table: &CornerTable) -> Self {
        Self::trusted(table.firsts.len() as u32, table.triangles.clone())
    }
}

/// The triangles are there, as they were.
impl From<&CornerTable> for IndexedPolygons {
    fn from(table: &CornerTable) -> Self {
        Self::from(&IndexedTriangles::from(table))
    }
}

/// Exact where triangles make an oriented manifold with boundary; the error names what does not fit.
impl TryFrom<&IndexedTriangles> for CornerTable {
    type Error = StructureError;

    fn try_from(triangles: &IndexedTriangles) -> Result<Self, StructureError> {
        Ok(TriangleHalfEdges::try_from(triangles)?.into())
    }
}

/// Exact where the faces are triangles that make an oriented manifold with boundary; the error names what does not fit.
impl TryFrom<&IndexedPolygons> for CornerTable {
    type Error = StructureError;

    fn try_from(polygons: &IndexedPolygons) -> Result<Self, StructureError> {
        Ok(TriangleHalfEdges::try_from(polygons)?.into())
    }
}

impl Incidence for CornerTable {
    fn name(&self) -> &'static str {
        "corner table"
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
            + size_of_val(self.opposites.as_slice())
            + size_of_val(self.firsts.as_slice())
    }

    fn visit_edges(&self, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        let all = (0..self.opposites.len() as u32).filter(|&corner| self.edge_opposite(corner).0 == corner);
        visit_each(all.map(EdgeId), visit);
        Ok(())
    }

    fn vertex_vertices(&self, vertex: VertexId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        let other = |edge: EdgeId| {
            let [a, b] = self.ends(edge);
            if a == vertex { b } else { a }
        };
        visit_each(self.edges_at(vertex).map(other), visit);
        Ok(())
    }

    fn vertex_edges(&self, vertex: VertexId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.edges_at(vertex), visit);
        Ok(())
    }

    fn vertex_faces(&self, vertex: VertexId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        visit_each(self.corners_at(vertex).map(|corner| self.triangle(corner)), visit);
        Ok(())
    }

    fn edge_vertices(&self, edge: EdgeId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.ends(edge), visit);
        Ok(())
    }

    fn edge_edges(&self, edge: EdgeId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        // Two vertices have one edge at most, so that no other is at both ends.
        let near = self.ends(edge).into_iter().flat_map(|vertex| self.edges_at(vertex));
        visit_each(near.filter(|&other| other != edge), visit);
        Ok(())
    }

    fn edge_faces(&self, edge: EdgeId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        let corner = CornerId(edge.0);
        let tips = [Some(corner), self.opposite(corner)];
        visit_each(tips.into_iter().flatten().map(|tip| self.triangle(tip)), visit);
        Ok(())
    }

    fn face_vertices(&self, face: FaceId, visit: &mut Visitor<'_, VertexId>) -> Answered {
        visit_each(self.triangles[face.index()].map(VertexId), visit);
        Ok(())
    }

    fn face_edges(&self, face: FaceId, visit: &mut Visitor<'_, EdgeId>) -> Answered {
        visit_each(self.tips_of_sides(face).map(|tip| self.edge_opposite(tip.0)), visit);
        Ok(())
    }

    fn face_faces(&self, face: FaceId, visit: &mut Visitor<'_, FaceId>) -> Answered {
        let near = self.tips_of_sides(face).map(|tip| self.opposite(tip).map(|beside| self.triangle(beside)));
        let first = |&i: &usize| near[i].is_some() && !near[..i].contains(&near[i]);
        visit_each((0..3).filter(first).filter_map(|i| near[i]), visit);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three times its number is 2, in 32 bits.
    #[test]
    #[should_panic(expected = "there is no")]
    fn a_triangle_that_is_not_there_is_taken_for_no_other() {
        let faces = IndexedTriangles::try_new(3, vec![[0, 1, 2]]).unwrap();
        let table = CornerTable::try_from(&faces).unwrap();
        let _ = table.answer(Query::FF, 1_431_655_766);
    }

    /// Two triangles, 0 1 2 and 2 1 3, beside each other across the edge 1-2.
    #[test]
    fn corners_turn_as_in_the_figure() {
        let faces = IndexedTriangles::try_new(4, vec![[0, 1, 2], [2, 1, 3]]).unwrap();
        let table = CornerTable::try_from(&faces).unwrap();
        let corner = CornerId;
        assert_eq!(table.opposite(corner(0)), Some(corner(5)));
        assert_eq!(table.opposite(corner(5)), Some(corner(0)));
        // With corner 1 up, the side from the previous corner to it is 0-1, at the border, and the one to the next is 1-2.
        assert_eq!((table.right(corner(1)), table.left(corner(1))), (None, Some(corner(5))));
        assert_eq!(table.corners_at(VertexId(1)).collect::<Vec<_>>(), [corner(4), corner(1)]);
        assert_eq!(table.answer(Query::VV, 1).unwrap(), [3, 2, 0]);
        assert_eq!(IndexedTriangles::from(&table), faces);
    }
}
