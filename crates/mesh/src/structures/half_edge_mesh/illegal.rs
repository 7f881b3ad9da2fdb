//! Why an operator is refused.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

use crate::structures::{FaceId, VertexId};

/// Why an operator on a mesh is refused: the result would be no 2-manifold, have another topology, or faces turned
/// over.
///
/// The mesh is left as it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illegal {
    /// There is no such element, or it was deleted.
    Gone {
        /// What kind of element.
        kind: &'static str,
        /// Its number.
        index: u32,
    },
    /// No edge joins these vertices, or they are not there.
    NoEdge {
        /// The vertices.
        vertices: [VertexId; 2],
    },
    /// The edge lies on the border, where the operator needs two faces.
    BorderEdge {
        /// Its vertices.
        vertices: [VertexId; 2],
    },
    /// A face that has more than three corners, where the operator needs triangles.
    NotTriangle {
        /// The face.
        face: FaceId,
    },
    /// Corners that do not lie in one face, or are neighbours in it.
    NotApart {
        /// The corners' vertices.
        vertices: [VertexId; 2],
    },
    /// The link condition: a vertex that edges join to both ends, although no triangle beside the edge has it (Dey,
    /// Edelsbrunner, Guha and Nekhayev 1999). The edges would become one.
    LinkCondition {
        /// The vertex in both links.
        vertex: VertexId,
    },
    /// A face that has both ends of the edge, but not the edge; it would have a vertex twice.
    SharedFace {
        /// The face.
        face: FaceId,
    },
    /// An edge between these vertices is there already.
    DuplicateEdge {
        /// Its vertices.
        vertices: [VertexId; 2],
    },
    /// Two faces would have the same corners.
    DuplicateFace {
        /// One of them, or the one that would become it.
        face: FaceId,
    },
    /// A face would have a vertex twice.
    RepeatedCorner {
        /// The vertex.
        vertex: VertexId,
    },
    /// The border loop has three edges: it would close.
    ClosesBorder {
        /// The third vertex of the loop.
        vertex: VertexId,
    },
    /// Both ends lie on the border, but the edge does not: the border would touch itself.
    PinchesBorder {
        /// The ends.
        vertices: [VertexId; 2],
    },
    /// The vertex has so few edges that its removal would leave no face.
    ValenceTooLow {
        /// The vertex.
        vertex: VertexId,
        /// How many edges it has.
        valence: u32,
    },
    /// No triangulation of the hole has new edges alone: each would double an edge that is there.
    NoTriangulation {
        /// How many corners the hole has.
        corners: u32,
    },
    /// No fan cuts the hole by new edges alone: each would double an edge that is there. The hole has so many corners
    /// that other triangulations were not tried.
    NoFan {
        /// How many corners the hole has.
        corners: u32,
    },
    /// The normal of a face would turn too far, or the face lose its area.
    FoldsOver {
        /// The face, as it is now.
        face: FaceId,
    },
    /// An edge with more than two faces, where lists of faces are edited.
    NonManifoldEdge {
        /// Its vertices.
        vertices: [VertexId; 2],
    },
    /// There are as many elements as numbers of 32 bits can tell apart.
    Full,
}

impl fmt::Display for Illegal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gone { kind, index } => write!(f, "{kind} {index}: found none of that number, expected one in use"),
            Self::NoEdge { vertices: [a, b] } => write!(f, "{a} and {b}: found no edge between them, expected one"),
            Self::BorderEdge { vertices: [a, b] } => {
                write!(f, "edge {}-{}: found the border, expected a face on both sides", a.0, b.0)
            }
            Self::NotTriangle { face } => write!(f, "{face}: found more than three corners, expected a triangle"),
            Self::NotApart { vertices: [a, b] } => {
                write!(f, "{a} and {b}: expected corners of one face that are not neighbours")
            }
            Self::LinkCondition { vertex } => {
                write!(f, "{vertex} is joined to both ends without a triangle beside the edge (link condition)")
            }
            Self::SharedFace { face } => write!(f, "{face} has both ends of the edge, but not the edge"),
            Self::DuplicateEdge { vertices: [a, b] } => {
                write!(f, "edge {}-{} is there already, and would be there twice", a.0, b.0)
            }
            Self::DuplicateFace { face } => write!(f, "{face}: two faces would have the same corners"),
            Self::RepeatedCorner { vertex } => write!(f, "{vertex}: a face would have it twice"),
            Self::ClosesBorder { vertex } => {
                write!(f, "{vertex}: the border loop through it has three edges and would close")
            }
            Self::PinchesBorder { vertices: [a, b] } => {
                write!(f, "{a} and {b} lie on the border, their edge does not: the border would touch itself")
            }
            Self::ValenceTooLow { vertex, valence } => {
                write!(f, "{vertex}: found {valence} edges, too few to leave a face")
            }
            Self::NoTriangulation { corners } => {
                write!(f, "the hole of {corners} corners: every triangulation doubles an edge that is there")
            }
            Self::NoFan { corners } => write!(
                f,
                "the hole of {corners} corners: every fan doubles an edge that is there; of so many corners other \
                 triangulations are not tried"
            ),
            Self::FoldsOver { face } => write!(f, "{face} would turn over or lose its area"),
            Self::NonManifoldEdge { vertices: [a, b] } => {
                write!(f, "edge {}-{}: found more than two faces, expected at most two", a.0, b.0)
            }
            Self::Full => f.write_str("there are as many elements as numbers of 32 bits can tell apart"),
        }
    }
}

impl std::error::Error for Illegal {}

impl Diagnostic for Illegal {
    fn code(&self) -> &'static str {
        match self {
            Self::Gone { .. } | Self::NoEdge { .. } => "E-edit-gone",
            Self::BorderEdge { .. } | Self::ClosesBorder { .. } | Self::PinchesBorder { .. } => "E-edit-border",
            Self::NotTriangle { .. } | Self::NotApart { .. } => "E-edit-corners",
            Self::LinkCondition { .. } | Self::SharedFace { .. } | Self::RepeatedCorner { .. } => "E-edit-link",
            Self::DuplicateEdge { .. }
            | Self::DuplicateFace { .. }
            | Self::NoTriangulation { .. }
            | Self::NoFan { .. } => "E-edit-duplicate",
            Self::ValenceTooLow { .. } => "E-edit-valence",
            Self::FoldsOver { .. } => "E-edit-fold",
            Self::NonManifoldEdge { .. } => "E-edit-manifold",
            Self::Full => "E-edit-full",
        }
    }

    fn category(&self) -> Category {
        Category::Failed
    }
}
