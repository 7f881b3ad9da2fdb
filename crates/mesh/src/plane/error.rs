//! Why outlines or edges cannot be triangulated.

use std::fmt;

use shapeloom_core::{Category, Diagnostic, Place};

/// Why outlines or edges in a plane cannot be triangulated.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PlaneError {
    /// Edges or sides of loops cross where that was to be refused.
    Crossing {
        /// What they are called: `edges`, `sides`.
        kind: &'static str,
        /// The first two. Sides are counted through all loops: the side from point `i` on has the number `i`.
        edges: [u64; 2],
        /// How many crossings there are in all.
        count: u64,
    },
    /// An edge that could not be put into the triangulation.
    Edge {
        /// The edge.
        edge: u64,
    },
    /// A vertex that could not be put between the edges.
    Vertex {
        /// The vertex of the triangulation that it lies near.
        near: u64,
    },
}

impl PlaneError {
    /// Where it is.
    pub fn place(&self) -> Place {
        match *self {
            Self::Crossing { kind, edges, .. } => Place::Pair { kind, indices: edges },
            Self::Edge { edge } => Place::element("edge", edge),
            Self::Vertex { near } => Place::element("vertex", near),
        }
    }
}

impl fmt::Display for PlaneError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let place = self.place();
        match self {
            Self::Crossing { count, .. } => {
                write!(f, "{place}: found {count} crossings, this the first, expected none")
            }
            Self::Vertex { .. } => write!(f, "{place}: found no way to put another vertex beside it between the edges"),
            Self::Edge { .. } => write!(f, "{place}: found no way to put it into the triangulation"),
        }
    }
}

impl std::error::Error for PlaneError {}

impl Diagnostic for PlaneError {
    fn code(&self) -> &'static str {
        match self {
            Self::Crossing { .. } => "E-plane-crossing",
            Self::Edge { .. } => "E-plane-edge",
            Self::Vertex { .. } => "E-plane-vertex",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Crossing { .. } => Category::Malformed,
            Self::Edge { .. } | Self::Vertex { .. } => Category::Failed,
        }
    }

    fn advice(&self) -> Option<String> {
        matches!(self, Self::Crossing { .. }).then(|| "set crossings=split to cut them where they cross".to_owned())
    }
}
