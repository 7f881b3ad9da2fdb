//! Places in a file or a shape.

use std::fmt;

/// Where in an input something was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The input as a whole.
    Whole,
    /// A line of text, counted from 1, and if known the column in bytes, counted from 1.
    Line {
        /// The line, counted from 1.
        line: u64,
        /// The column in bytes, counted from 1.
        column: Option<u64>,
    },
    /// An offset in bytes, counted from 0.
    Byte(u64),
    /// An element of a shape: `vertex 7`, `patch 3`, counted from 0.
    Element {
        /// What kind of element.
        kind: &'static str,
        /// Its index, counted from 0.
        index: u64,
    },
    /// Two elements of one kind, counted from 0: `faces 3 and 9`.
    Pair {
        /// What kind of elements, in the plural.
        kind: &'static str,
        /// Their indices.
        indices: [u64; 2],
    },
    /// The edge between two vertices, counted from 0.
    Edge {
        /// The indices of the vertices.
        vertices: [u64; 2],
    },
}

impl Place {
    /// A line of text, counted from 1.
    pub fn line(line: u64) -> Self {
        Self::Line { line, column: None }
    }

    /// An element of a shape, counted from 0.
    pub fn element(kind: &'static str, index: u64) -> Self {
        Self::Element { kind, index }
    }

    /// Two elements of one kind, which is named in the plural.
    pub fn pair(kind: &'static str, a: u32, b: u32) -> Self {
        Self::Pair { kind, indices: [a, b].map(u64::from) }
    }

    /// The edge between two vertices.
    pub fn edge(a: u32, b: u32) -> Self {
        Self::Edge { vertices: [a, b].map(u64::from) }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => f.write_str("the whole input"),
            Self::Line { line, column: None } => write!(f, "line {line}"),
            Self::Line { line, column: Some(column) } => write!(f, "line {line}, column {column}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
            Self::Element { kind, index } => write!(f, "{kind} {index}"),
            Self::Pair { kind, indices: [a, b] } => write!(f, "{kind} {a} and {b}"),
            Self::Edge { vertices: [a, b] } => write!(f, "edge {a}-{b}"),
        }
    }
}
