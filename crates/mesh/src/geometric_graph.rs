//! Geometric graphs.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::poly_mesh::check_count;
use crate::sums::compensated;
use crate::{AttributeError, Attributes, Column, ListColumn, MeshError, Polyline};

/// Vertices and straight edges between them, with attribute columns on both.
///
/// Every index is in range; nothing else is promised: edges may be repeated, or join a vertex to itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GeometricGraph {
    positions: Vec<DVec3>,
    edges: Vec<[u32; 2]>,
    vertex_attributes: Attributes,
    edge_attributes: Attributes,
}

impl GeometricGraph {
    /// A graph without attributes.
    ///
    /// # Errors
    /// An index out of range, or more elements than 32 bits can tell apart.
    pub fn try_new(positions: Vec<DVec3>, edges: Vec<[u32; 2]>) -> Result<Self, MeshError> {
        check_count("vertices", positions.len())?;
        check_count("edges", edges.len())?;
        for (edge, ends) in edges.iter().enumerate() {
            if let Some(&found) = ends.iter().find(|&&end| end as usize >= positions.len()) {
                let (edge, found, vertices) = (edge as u64, u64::from(found), positions.len() as u64);
                return Err(MeshError::EdgeOutOfRange { edge, found, vertices });
            }
        }
        let (vertex_attributes, edge_attributes) = (Attributes::new(positions.len()), Attributes::new(edges.len()));
        Ok(Self { positions, edges, vertex_attributes, edge_attributes })
    }

    /// The positions of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions of the vertices, to be moved.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.positions
    }

    /// The two vertices of each edge.
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// The attribute columns of the vertices.
    pub fn vertex_attributes(&self) -> &Attributes {
        &self.vertex_attributes
    }

    /// The attribute columns of the edges.
    pub fn edge_attributes(&self) -> &Attributes {
        &self.edge_attributes
    }

    /// Adds a column to the vertices.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_vertex_attribute(&mut self, column: Column) -> Result<(), AttributeError> {
        self.vertex_attributes.insert(column)
    }

    /// Adds a column to the edges.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_edge_attribute(&mut self, column: Column) -> Result<(), AttributeError> {
        self.edge_attributes.insert(column)
    }

    /// Adds a column of lists to the vertices.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_vertex_list(&mut self, list: ListColumn) -> Result<(), AttributeError> {
        self.vertex_attributes.insert_list(list)
    }

    /// Adds a column of lists to the edges.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_edge_list(&mut self, list: ListColumn) -> Result<(), AttributeError> {
        self.edge_attributes.insert_list(list)
    }

    /// The positions of the ends of each edge.
    pub fn segments(&self) -> impl ExactSizeIterator<Item = [DVec3; 2]> + '_ {
        self.edges.iter().map(|ends| ends.map(|end| self.positions[end as usize]))
    }

    /// The number of edges at each vertex; an edge from a vertex to itself counts twice.
    pub fn degrees(&self) -> Vec<u32> {
        let mut degrees = vec![0u32; self.positions.len()];
        for &end in self.edges.as_flattened() {
            // Only loops at one vertex, and more of them than half of what 32 bits count, go beyond.
            degrees[end as usize] = degrees[end as usize].saturating_add(1);
        }
        degrees
    }

    /// The sum of the lengths of the edges.
    pub fn length(&self) -> f64 {
        compensated(self.segments().map(|[a, b]| a.distance(b)))
    }

    /// The smallest box around the vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.positions.iter().copied())
    }

    /// The image under an affine map; attributes move by their rules.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self {
            positions: self.positions.iter().map(|&position| map.point(position)).collect(),
            edges: self.edges.clone(),
            vertex_attributes: self.vertex_attributes.transformed(map),
            edge_attributes: self.edge_attributes.transformed(map),
        }
    }

    /// The memory that the graph takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice())
            + size_of_val(self.edges.as_slice())
            + self.vertex_attributes.memory_bytes()
            + self.edge_attributes.memory_bytes()
    }
}

/// The points are the vertices and the segments the edges, in order: exact, attributes and all.
///
/// # Panics
/// When the polyline has more points than 32 bits can tell apart.
impl From<Polyline> for GeometricGraph {
    fn from(line: Polyline) -> Self {
        let count = u32::try_from(line.points().len()).expect("a polyline of fewer points than 32 bits can tell apart");
        let closing = (line.is_closed() && count > 1).then(|| [count - 1, 0]);
        let edges: Vec<[u32; 2]> = (1..count).map(|end| [end - 1, end]).chain(closing).collect();
        let edge_attributes = Attributes::new(edges.len());
        let vertex_attributes = line.attributes().clone();
        Self { positions: line.points().to_vec(), edges, vertex_attributes, edge_attributes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{NORMAL, Values};

    /// A letter Y with a loop at its end.
    fn fork() -> GeometricGraph {
        let positions = vec![DVec3::ZERO, DVec3::Y, DVec3::new(3.0, 5.0, 0.0), DVec3::new(0.0, 1.0, 2.0)];
        GeometricGraph::try_new(positions, vec![[0, 1], [1, 2], [3, 1], [3, 3]]).unwrap()
    }

    #[test]
    fn degrees_and_length_are_counted_from_the_edges() {
        assert_eq!(fork().degrees(), [1, 3, 1, 3]);
        assert_eq!(fork().degrees().iter().sum::<u32>(), 2 * 4);
        assert_eq!(fork().length(), 1.0 + 5.0 + 2.0);
        assert_eq!(GeometricGraph::default().length(), 0.0);
        assert_eq!(fork().bounds(), Aabb::from_corners(DVec3::ZERO, DVec3::new(3.0, 5.0, 2.0)));
    }

    #[test]
    fn vertices_that_do_not_exist_are_refused() {
        let error = GeometricGraph::try_new(vec![DVec3::ZERO; 2], vec![[0, 1], [1, 2]]).unwrap_err();
        assert_eq!(error, MeshError::EdgeOutOfRange { edge: 1, found: 2, vertices: 2 });
        assert!(GeometricGraph::try_new(vec![], vec![[0, 0]]).is_err());
    }

    #[test]
    fn attributes_of_both_kinds_move_along() {
        let mut graph = fork();
        graph.insert_vertex_attribute(Column::normals(NORMAL, &[DVec3::X; 4])).unwrap();
        graph.insert_edge_attribute(Column::labels("street", vec![4, 5, 6, 7])).unwrap();
        let list = ListColumn::try_new("houses", vec![0, 1, 1, 2, 2], Values::U8(vec![9, 8])).unwrap();
        graph.insert_edge_list(list.clone()).unwrap();
        assert!(graph.insert_edge_attribute(Column::labels("houses", vec![0; 4])).is_err());
        graph.insert_vertex_list(list.renamed("doors")).unwrap();
        assert!(graph.insert_vertex_attribute(Column::labels("x", vec![1])).is_err());
        let quarter = Affine {
            linear: shapeloom_core::glam::DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z),
            ..Affine::IDENTITY
        };
        let turned = graph.transformed(&quarter);
        assert_eq!(turned.positions()[2], DVec3::new(-5.0, 3.0, 0.0));
        assert_eq!(turned.vertex_attributes().get(NORMAL).unwrap().vector(1), DVec3::Y);
        assert_eq!((turned.edges(), turned.edge_attributes()), (graph.edges(), graph.edge_attributes()));
        assert!(graph.memory_bytes() > fork().memory_bytes());
    }

    #[test]
    fn polylines_become_graphs_with_their_attributes() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0)];
        for closed in [false, true] {
            let mut line = Polyline::new(points.clone(), closed);
            line.insert_attribute(Column::labels("id", vec![3, 4, 5])).unwrap();
            let graph = GeometricGraph::from(line.clone());
            assert_eq!(graph.segments().collect::<Vec<_>>(), line.segments().collect::<Vec<_>>());
            assert_eq!((graph.vertex_attributes(), graph.length()), (line.attributes(), line.length()));
            assert_eq!(graph.edge_attributes().len(), graph.edges().len());
        }
        let lone = GeometricGraph::from(Polyline::new(vec![DVec3::X], true));
        assert_eq!((lone.positions().len(), lone.edges().len()), (1, 0));
        assert_eq!(GeometricGraph::from(Polyline::default()), GeometricGraph::default());
    }
}
