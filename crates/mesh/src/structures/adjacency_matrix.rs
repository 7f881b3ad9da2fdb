//! Which vertices an edge joins, as a sparse matrix.

use shapeloom_core::Exec;

use crate::poly_mesh::check_count;

use super::edge_list::inconsistent;
use super::lists::Lists;
use super::walk::{WalkEdges, answer_by_walking};
use super::{Cost, EdgeList, Incidence, IndexedPolygons, Query, StructureError};

/// The adjacency matrix of the graph of vertices and edges: symmetric, with a one where an edge joins the vertices of row and
/// column, stored by rows without the zeros.
///
/// Four bytes a vertex and eight an edge. It holds what an [`EdgeList`] holds, with which it is exchanged exactly: no
/// faces. The four queries without faces are local. The number of an edge is the place of its entry above the diagonal among all
/// entries; the other end is found in its row by halving.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct AdjacencyMatrix {
    rows: Lists,
}

impl AdjacencyMatrix {
    /// The matrix with ones in row `i` at the columns `columns[starts[i]..starts[i + 1]]`.
    ///
    /// # Errors
    /// Starts that do not rise from 0 to the number of columns; a row whose columns do not rise, go out of range or have the row
    /// itself; an entry without the one across the diagonal; more entries than 32 bits can tell apart.
    pub fn try_new(starts: Vec<u32>, columns: Vec<u32>) -> Result<Self, StructureError> {
        check_count("entries", columns.len())?;
        check_count("vertices", starts.len())?;
        let falling = starts.windows(2).position(|pair| pair[0] > pair[1]);
        let row = match (starts.first(), starts.last()) {
            (Some(0), Some(&end)) if end as usize == columns.len() => falling,
            _ => Some(starts.len().saturating_sub(2)),
        };
        if let Some(row) = row {
            return Err(inconsistent("row", row as u32, "its entries start out of order"));
        }
        let matrix = Self { rows: Lists::new(starts, columns) };
        for row in 0..matrix.rows.len() as u32 {
            let columns = matrix.rows.of(row);
            if columns.iter().any(|&column| column as usize >= matrix.rows.len()) {
                return Err(inconsistent("row", row, "it has a column that is not there"));
            }
            if columns.windows(2).any(|pair| pair[0] >= pair[1]) {
                return Err(inconsistent("row", row, "its columns do not rise"));
            }
            if columns.contains(&row) {
                return Err(inconsistent("row", row, "it has an entry on the diagonal"));
            }
        }
        for row in 0..matrix.rows.len() as u32 {
            if matrix.rows.of(row).iter().any(|&column| matrix.rows.of(column).binary_search(&row).is_err()) {
                return Err(inconsistent("row", row, "it has an entry that is missing across the diagonal"));
            }
        }
        Ok(matrix)
    }

    /// The matrix of the edges of faces.
    ///
    /// # Errors
    /// More entries than 32 bits can tell apart, the budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        Self::of_edges(&EdgeList::try_build(faces, exec)?, exec)
    }

    fn of_edges(list: &EdgeList, exec: &Exec) -> Result<Self, StructureError> {
        let edges = list.edges();
        check_count("entries", edges.len().saturating_mul(2))?;
        let _memory = exec.reserve_elements((list.vertex_count() + 2 * edges.len()) as u64, 4)?;
        // Ends below the diagonal come first in each row: an edge's larger vertex has it among the first.
        let end = |i: u32| edges[i as usize % edges.len()][usize::from((i as usize) < edges.len())];
        let other = |i: u32| edges[i as usize % edges.len()][usize::from((i as usize) >= edges.len())];
        Ok(Self { rows: Lists::grouped(list.vertex_count(), 2 * edges.len(), end, exec)?.map(other) })
    }

    /// The columns with a one in a row: the neighbours of a vertex, rising.
    ///
    /// # Panics
    /// When there is no such row.
    pub fn row(&self, vertex: u32) -> &[u32] {
        self.rows.of(vertex)
    }
}

/// Exact, edge for edge; fails for more entries than 32 bits can tell apart.
impl TryFrom<&EdgeList> for AdjacencyMatrix {
    type Error = StructureError;

    fn try_from(list: &EdgeList) -> Result<Self, StructureError> {
        Self::of_edges(list, &Exec::default())
    }
}

/// Exact, edge for edge.
impl From<&AdjacencyMatrix> for EdgeList {
    fn from(matrix: &AdjacencyMatrix) -> Self {
        Self::trusted(matrix.rows.len() as u32, matrix.all_edges().map(|edge| matrix.ends(edge)).collect())
    }
}

impl WalkEdges for AdjacencyMatrix {
    fn all_edges(&self) -> impl Iterator<Item = u32> {
        let row = move |row: u32| self.rows.range(row).filter(move |&entry| self.rows.items()[entry] > row);
        (0..self.rows.len() as u32).flat_map(row).map(|entry| entry as u32)
    }

    fn ends(&self, edge: u32) -> [u32; 2] {
        let column = self.rows.items()[edge as usize];
        [self.rows.list_of(edge), column]
    }

    fn edges_at(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.rows.range(vertex).filter_map(move |entry| {
            let column = self.rows.items()[entry];
            if column > vertex {
                return Some(entry as u32);
            }
            let place = self.rows.of(column).binary_search(&vertex).ok()?;
            Some((self.rows.range(column).start + place) as u32)
        })
    }

    fn neighbors(&self, vertex: u32) -> impl Iterator<Item = u32> {
        self.rows.of(vertex).iter().copied()
    }
}

impl Incidence for AdjacencyMatrix {
    fn name(&self) -> &'static str {
        "adjacency matrix"
    }

    fn vertex_count(&self) -> usize {
        self.rows.len()
    }

    fn face_count(&self) -> usize {
        0
    }

    fn cost(&self, query: Query) -> Cost {
        if matches!(query, Query::VV | Query::VE | Query::EV | Query::EE) { Cost::Local } else { Cost::Unanswered }
    }

    fn memory_bytes(&self) -> usize {
        self.rows.bytes()
    }

    answer_by_walking!(edges);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_neighbours() {
        // A square 0 1 2 3 with the diagonal 0-2, and an isolated vertex.
        let list = EdgeList::try_new(5, &[[0, 1], [1, 2], [2, 3], [0, 3], [0, 2]]).unwrap();
        let matrix = AdjacencyMatrix::try_from(&list).unwrap();
        let rows: Vec<&[u32]> = (0..5).map(|row| matrix.row(row)).collect();
        assert_eq!(rows, [&[1, 2, 3][..], &[0, 2], &[0, 1, 3], &[0, 2], &[]]);
        let by_hand = AdjacencyMatrix::try_new(vec![0, 3, 5, 8, 10, 10], vec![1, 2, 3, 0, 2, 0, 1, 3, 0, 2]).unwrap();
        assert_eq!((EdgeList::from(&by_hand), by_hand), (list, matrix));
    }

    #[test]
    fn what_is_no_adjacency_is_named() {
        let refused =
            |starts: &[u32], columns: &[u32]| AdjacencyMatrix::try_new(starts.to_vec(), columns.to_vec()).unwrap_err();
        assert_eq!(refused(&[], &[]), inconsistent("row", 0, "its entries start out of order"));
        assert_eq!(refused(&[0, 2, 1, 2], &[1, 0]), inconsistent("row", 1, "its entries start out of order"));
        assert_eq!(refused(&[0, 1, 2], &[1, 2]), inconsistent("row", 1, "it has a column that is not there"));
        assert_eq!(refused(&[0, 2, 2, 2], &[2, 1]), inconsistent("row", 0, "its columns do not rise"));
        assert_eq!(refused(&[0, 1, 2], &[1, 1]), inconsistent("row", 1, "it has an entry on the diagonal"));
        let missing = inconsistent("row", 0, "it has an entry that is missing across the diagonal");
        assert_eq!(refused(&[0, 2, 3, 3], &[1, 2, 0]), missing);
    }
}
