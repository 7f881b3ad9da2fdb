//! Which edges bound which faces and which vertices bound which edges, as sparse matrices with signs.

use shapeloom_core::Exec;

use crate::MeshError;

use super::edge_table::EdgeTable;
use super::face_list::FaceList;
use super::lists::Lists;
use super::once::once;
use super::triangle_half_edges::refuse_repeated_corners;
use super::walk::{WalkEdges, WalkFaces, answer_by_walking};
use super::{Cost, Incidence, IndexedPolygons, Query, StructureError};

/// A sparse matrix of ones and minus ones, stored by columns and again by rows without the zeros.
///
/// Four bytes an entry, a row and a column, twice for the entries. The order of the entries of a column may mean something; those
/// of a row rise.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct SignedMatrix {
    columns: Lists,
    rows: Lists,
}

/// The place of an entry and its sign in one number.
fn entry(place: u32, negative: bool) -> u32 {
    place << 1 | u32::from(negative)
}

fn place_and_sign(&entry: &u32) -> (u32, i8) {
    (entry >> 1, if entry & 1 == 0 { 1 } else { -1 })
}

impl SignedMatrix {
    /// The number of rows.
    pub fn row_count(&self) -> usize {
        self.rows.len()
    }

    /// The number of columns.
    pub fn column_count(&self) -> usize {
        self.columns.len()
    }

    /// The entries of a row: column and sign.
    ///
    /// # Panics
    /// When there is no such row.
    pub fn row(&self, row: u32) -> impl ExactSizeIterator<Item = (u32, i8)> + '_ {
        self.rows.of(row).iter().map(place_and_sign)
    }

    /// The entries of a column: row and sign.
    ///
    /// # Panics
    /// When there is no such column.
    pub fn column(&self, column: u32) -> impl ExactSizeIterator<Item = (u32, i8)> + '_ {
        self.columns.of(column).iter().map(place_and_sign)
    }
}

/// The boundary matrices of a mesh, as homology has them.
///
/// Column `e` of the matrix of vertices and edges is the boundary of edge `e`: its larger vertex minus its smaller one. Column
/// `f` of the matrix of edges and faces is the boundary of face `f`: the edges that it passes from the smaller to the larger
/// vertex, minus those that it passes the other way; its entries are in the order of the sides, so that the corners come back
/// as they were. The product of the two is zero: a boundary has no boundary.
///
/// It holds faces with different corners, any number of them at an edge or vertex, in any direction; isolated vertices are kept.
/// All nine queries are local. Edges rise by their smaller and then their larger vertex.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IncidenceMatrices {
    vertex_edge: SignedMatrix,
    edge_face: SignedMatrix,
}

impl IncidenceMatrices {
    /// The matrices of faces.
    ///
    /// Cost: linear in practice; sides are sorted in parallel.
    ///
    /// # Errors
    /// A face that names a vertex twice; more elements than 31 bits can tell apart, as one bit is the sign; the budget, or the
    /// reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        refuse_repeated_corners(faces, exec)?;
        let table = EdgeTable::new(faces, exec)?;
        for (kind, found) in [("vertices", faces.vertex_total()), ("edges", table.vertices.len())] {
            if found > i32::MAX as usize {
                return Err(MeshError::TooMany { kind, found: found as u64 }.into());
            }
        }
        let (edge_of, _of_memory) = table.edge_of_corners(exec)?;
        let edges = table.vertices.as_slice();
        let words = 6 * edges.len() + 2 * edge_of.len() + faces.face_total() + faces.vertex_total();
        let _memory = exec.reserve_elements(words as u64, 4)?;

        let starts = (0..=edges.len() as u32).map(|edge| 2 * edge).collect();
        let ends = edges.iter().flat_map(|&[low, high]| [entry(low, true), entry(high, false)]).collect();
        let rows =
            Lists::grouped(faces.vertex_total(), 2 * edges.len(), |end| edges.as_flattened()[end as usize], exec)?;
        // End `2e` is the smaller vertex of edge `e`.
        let rows = rows.map(|end| entry(end / 2, end % 2 == 0));
        let vertex_edge = SignedMatrix { columns: Lists::new(starts, ends), rows };

        let backward =
            |corner: u32| faces.all_corners()[corner as usize] != edges[edge_of[corner as usize] as usize][0];
        exec.check()?;
        let column = (0..).zip(&edge_of).map(|(corner, &edge)| entry(edge, backward(corner)));
        let columns = Lists::new(faces.starts().to_vec(), column.collect());
        exec.check()?;
        let rows = table.sides.clone().map(|corner| entry(faces.face_of(corner), backward(corner)));
        Ok(Self { vertex_edge, edge_face: SignedMatrix { columns, rows } })
    }

    /// The boundaries of the edges: a row for each vertex, a column for each edge.
    pub fn vertex_edge(&self) -> &SignedMatrix {
        &self.vertex_edge
    }

    /// The boundaries of the faces: a row for each edge, a column for each face.
    pub fn edge_face(&self) -> &SignedMatrix {
        &self.edge_face
    }
}

/// The faces are there, with the corners in their order.
impl From<&IncidenceMatrices> for IndexedPolygons {
    fn from(matrices: &IncidenceMatrices) -> Self {
        let faces = 0..matrices.face_count() as u32;
        let corners = faces.flat_map(|face| matrices.corners(face)).collect();
        let starts = matrices.edge_face.columns.starts().to_vec();
        Self::trusted(matrices.vertex_count() as u32, starts, corners)
    }
}

impl WalkEdges for IncidenceMatrices {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        0..self.vertex_edge.column_count() as u32
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        let ends = self.vertex_edge.columns.of(edge);
        [ends[0] >> 1, ends[1] >> 1]
    }

    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.vertex_edge.row(vertex).map(|(edge, _)| edge)
    }
}

impl WalkFaces for IncidenceMatrices {
    fn faces_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        once(self.edges_at(vertex).flat_map(|edge| self.faces_beside(edge)))
    }

    fn faces_beside(&self, edge: u32) -> impl Iterator<Item = u32> {
        self.edge_face.row(edge).map(|(face, _)| face)
    }

    fn corners(&self, face: u32) -> impl Iterator<Item = u32> {
        self.edge_face.column(face).map(|(edge, sign)| self.ends(edge)[usize::from(sign < 0)])
    }

    fn sides(&self, face: u32) -> impl Iterator<Item = u32> {
        self.edge_face.column(face).map(|(edge, _)| edge)
    }
}

impl Incidence for IncidenceMatrices {
    fn name(&self) -> &'static str {
        "incidence matrices"
    }

    fn vertex_count(&self) -> usize {
        self.vertex_edge.row_count()
    }

    fn face_count(&self) -> usize {
        self.edge_face.column_count()
    }

    fn cost(&self, _: Query) -> Cost {
        Cost::Local
    }

    fn memory_bytes(&self) -> usize {
        [&self.vertex_edge, &self.edge_face].map(|matrix| matrix.columns.bytes() + matrix.rows.bytes()).iter().sum()
    }

    answer_by_walking!(all);
}
