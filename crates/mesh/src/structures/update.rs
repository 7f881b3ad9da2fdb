//! Local changes, the same of every structure that can be changed in place.

use std::fmt;

use super::{HalfEdgeId, HalfEdgeMesh, Illegal, Incidence, VertexId};

/// A local change of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Update {
    /// An edge between two triangles joins their other two vertices instead.
    FlipEdge,
    /// A vertex is put on an edge and joined to the opposite corners.
    SplitEdge,
    /// One vertex of an edge is moved into the other.
    CollapseEdge,
}

impl Update {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::FlipEdge, Self::SplitEdge, Self::CollapseEdge];

    /// What it is called, in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::FlipEdge => "edge flip",
            Self::SplitEdge => "edge split",
            Self::CollapseEdge => "edge collapse",
        }
    }
}

impl fmt::Display for Update {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A structure of a triangle mesh that can be changed in place. Edges are named by their vertices, whose numbers are
/// the same in all structures; what [`StructureKind::update_cost`](super::StructureKind::update_cost) says is paid
/// beside the search for the edge, which is no dearer.
///
/// All implementors refuse the same changes of a manifold mesh, and come to the same faces; the faces' numbers may
/// differ.
pub trait LocalUpdate: Incidence {
    /// Lets the edge between two vertices join the opposite corners of its two triangles instead.
    ///
    /// # Errors
    /// No such edge, or why the change is illegal; then nothing is changed. So for all.
    fn flip(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal>;

    /// Puts a vertex on the edge and joins it to the opposite corners.
    ///
    /// # Errors
    /// No such edge, or numbers run out.
    fn split(&mut self, edge: [VertexId; 2]) -> Result<VertexId, Illegal>;

    /// Moves the first vertex of the edge into the second. The first is then isolated or gone.
    ///
    /// # Errors
    /// No such edge, or why the change is illegal.
    fn collapse(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal>;
}

impl HalfEdgeMesh {
    fn joined(&self, [from, to]: [VertexId; 2]) -> Result<HalfEdgeId, Illegal> {
        let known = self.has_vertex(from) && self.has_vertex(to);
        known.then(|| self.find(from, to)).flatten().ok_or(Illegal::NoEdge { vertices: [from, to] })
    }
}

impl LocalUpdate for HalfEdgeMesh {
    fn flip(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal> {
        let half = self.joined(edge)?;
        self.flip_edge(self.edge(half))
    }

    fn split(&mut self, edge: [VertexId; 2]) -> Result<VertexId, Illegal> {
        let half = self.joined(edge)?;
        self.split_edge(self.edge(half))
    }

    fn collapse(&mut self, edge: [VertexId; 2]) -> Result<(), Illegal> {
        let half = self.joined(edge)?;
        self.collapse_half_edge(half).map(drop)
    }
}
