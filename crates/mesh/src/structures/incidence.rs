//! The nine incidence queries, the same of every structure.

use std::fmt;
use std::ops::ControlFlow;

use shapeloom_core::{Category, Diagnostic};

use super::{EdgeId, FaceId, VertexId};

/// Which elements at which: the first letter is what is asked about, the second what is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Query {
    /// Vertices that an edge joins to a vertex.
    VV,
    /// Edges at a vertex.
    VE,
    /// Faces at a vertex.
    VF,
    /// The two vertices of an edge.
    EV,
    /// Edges that share a vertex with an edge.
    EE,
    /// Faces that have an edge as side.
    EF,
    /// The corners of a face.
    FV,
    /// The sides of a face.
    FE,
    /// Faces that share an edge with a face.
    FF,
}

impl Query {
    /// All nine.
    pub const ALL: [Self; 9] =
        [Self::VV, Self::VE, Self::VF, Self::EV, Self::EE, Self::EF, Self::FV, Self::FE, Self::FF];

    /// The two letters.
    pub fn name(self) -> &'static str {
        match self {
            Self::VV => "VV",
            Self::VE => "VE",
            Self::VF => "VF",
            Self::EV => "EV",
            Self::EE => "EE",
            Self::EF => "EF",
            Self::FV => "FV",
            Self::FE => "FE",
            Self::FF => "FF",
        }
    }
}

impl fmt::Display for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a structure pays for a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Cost {
    /// In proportion to the answer and the elements next to it, however large the mesh.
    Local,
    /// In proportion to the whole mesh.
    Scan,
    /// The structure does not know.
    Unanswered,
}

/// A question that a structure cannot answer, because it does not hold such elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Unanswered {
    /// The structure.
    pub structure: &'static str,
    /// The question.
    pub query: Query,
}

impl fmt::Display for Unanswered {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: found the query {}, which it cannot answer; ask a structure that can",
            self.structure, self.query
        )
    }
}

impl std::error::Error for Unanswered {}

impl Diagnostic for Unanswered {
    fn code(&self) -> &'static str {
        "E-structure-query"
    }

    fn category(&self) -> Category {
        Category::Unsupported
    }
}

/// Whether a query could be answered.
pub type Answered = Result<(), Unanswered>;

/// What is called with each element of an answer; `Break` ends the query.
pub type Visitor<'a, T> = dyn FnMut(T) -> ControlFlow<()> + 'a;

/// Hands elements to a visitor until it has enough.
pub(crate) fn visit_each<T>(elements: impl IntoIterator<Item = T>, visit: &mut Visitor<'_, T>) {
    for element in elements {
        if visit(element).is_break() {
            return;
        }
    }
}

/// A structure that knows which elements of a mesh meet.
///
/// Every answer has each element once and in an order that depends on the structure alone; `EV` gives two vertices, `FV`
/// the corners of a face in their order, as often as the face has them. An edge joins two different vertices, however many faces have it
/// as a side. Two edges are neighbours (`EE`) if they share a vertex, two faces (`FF`) if they share an edge; nothing is
/// its own neighbour. At the border nothing is missing: a border vertex has one edge more than faces.
///
/// # Panics
/// Queries panic on numbers that the structure does not have.
pub trait Incidence {
    /// What the structure is called.
    fn name(&self) -> &'static str;

    /// The number of vertices, isolated ones too.
    fn vertex_count(&self) -> usize;

    /// The number of faces; 0 where the structure has none.
    fn face_count(&self) -> usize;

    /// What a query costs.
    fn cost(&self, query: Query) -> Cost;

    /// The memory that the connectivity takes, in bytes, without coordinates.
    fn memory_bytes(&self) -> usize;

    /// Calls with every edge once, in the structure's order.
    ///
    /// # Errors
    /// The structure does not tell edges.
    fn visit_edges(&self, _visit: &mut Visitor<'_, EdgeId>) -> Answered {
        Err(self.unanswered(Query::EV))
    }

    /// Calls with the vertices that an edge joins to a vertex.
    ///
    /// # Errors
    /// The structure cannot answer; so for all nine.
    fn vertex_vertices(&self, _vertex: VertexId, _visit: &mut Visitor<'_, VertexId>) -> Answered {
        Err(self.unanswered(Query::VV))
    }

    /// Calls with the edges at a vertex.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn vertex_edges(&self, _vertex: VertexId, _visit: &mut Visitor<'_, EdgeId>) -> Answered {
        Err(self.unanswered(Query::VE))
    }

    /// Calls with the faces at a vertex.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn vertex_faces(&self, _vertex: VertexId, _visit: &mut Visitor<'_, FaceId>) -> Answered {
        Err(self.unanswered(Query::VF))
    }

    /// Calls with the two vertices of an edge.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn edge_vertices(&self, _edge: EdgeId, _visit: &mut Visitor<'_, VertexId>) -> Answered {
        Err(self.unanswered(Query::EV))
    }

    /// Calls with the edges that share a vertex with an edge.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn edge_edges(&self, _edge: EdgeId, _visit: &mut Visitor<'_, EdgeId>) -> Answered {
        Err(self.unanswered(Query::EE))
    }

    /// Calls with the faces that have an edge as side.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn edge_faces(&self, _edge: EdgeId, _visit: &mut Visitor<'_, FaceId>) -> Answered {
        Err(self.unanswered(Query::EF))
    }

    /// Calls with the corners of a face, in order.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn face_vertices(&self, _face: FaceId, _visit: &mut Visitor<'_, VertexId>) -> Answered {
        Err(self.unanswered(Query::FV))
    }

    /// Calls with the sides of a face, in order.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn face_edges(&self, _face: FaceId, _visit: &mut Visitor<'_, EdgeId>) -> Answered {
        Err(self.unanswered(Query::FE))
    }

    /// Calls with the faces that share an edge with a face.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn face_faces(&self, _face: FaceId, _visit: &mut Visitor<'_, FaceId>) -> Answered {
        Err(self.unanswered(Query::FF))
    }

    /// Any of the nine, with plain numbers.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn visit(&self, query: Query, element: u32, visit: &mut Visitor<'_, u32>) -> Answered {
        match query {
            Query::VV => self.vertex_vertices(VertexId(element), &mut |found| visit(found.0)),
            Query::VE => self.vertex_edges(VertexId(element), &mut |found| visit(found.0)),
            Query::VF => self.vertex_faces(VertexId(element), &mut |found| visit(found.0)),
            Query::EV => self.edge_vertices(EdgeId(element), &mut |found| visit(found.0)),
            Query::EE => self.edge_edges(EdgeId(element), &mut |found| visit(found.0)),
            Query::EF => self.edge_faces(EdgeId(element), &mut |found| visit(found.0)),
            Query::FV => self.face_vertices(FaceId(element), &mut |found| visit(found.0)),
            Query::FE => self.face_edges(FaceId(element), &mut |found| visit(found.0)),
            Query::FF => self.face_faces(FaceId(element), &mut |found| visit(found.0)),
        }
    }

    /// The answer to any of the nine as a list.
    ///
    /// # Errors
    /// The structure cannot answer.
    fn answer(&self, query: Query, element: u32) -> Result<Vec<u32>, Unanswered> {
        let mut found = Vec::new();
        self.visit(query, element, &mut |element| {
            found.push(element);
            ControlFlow::Continue(())
        })?;
        Ok(found)
    }

    /// Every edge, in the structure's order.
    ///
    /// # Errors
    /// The structure does not tell edges.
    fn edges(&self) -> Result<Vec<EdgeId>, Unanswered> {
        let mut found = Vec::new();
        self.visit_edges(&mut |edge| {
            found.push(edge);
            ControlFlow::Continue(())
        })?;
        Ok(found)
    }

    /// That this structure cannot answer.
    fn unanswered(&self, query: Query) -> Unanswered {
        Unanswered { structure: self.name(), query }
    }
}
