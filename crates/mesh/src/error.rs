//! What can be wrong with a mesh or its attributes.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

/// The elements that carry attributes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Domain {
    /// The vertices, or the points of a cloud or polyline.
    Vertex,
    /// The faces.
    Face,
    /// The corners of faces, in the order of the faces.
    Wedge,
}

impl fmt::Display for Domain {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Vertex => "vertex",
            Self::Face => "face",
            Self::Wedge => "wedge",
        })
    }
}

/// Why numbers make no mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshError {
    /// A face names a vertex that does not exist.
    IndexOutOfRange {
        /// The face.
        face: u64,
        /// The vertex that it names.
        found: u64,
        /// How many vertices there are.
        vertices: u64,
    },
    /// An edge names a vertex that does not exist.
    EdgeOutOfRange {
        /// The edge.
        edge: u64,
        /// The vertex that it names.
        found: u64,
        /// How many vertices there are.
        vertices: u64,
    },
    /// A polygon has fewer than three corners.
    TooFewCorners {
        /// The face.
        face: u64,
        /// Its number of corners.
        found: u64,
    },
    /// A polygon where only triangles fit.
    NotTriangle {
        /// The face.
        face: u64,
        /// Its number of corners.
        found: u64,
    },
    /// Face starts that do not rise from 0 to the number of corners.
    FaceStarts {
        /// The first face at fault.
        face: u64,
    },
    /// More elements than ids of 32 bits can tell apart.
    TooMany {
        /// What kind of element.
        kind: &'static str,
        /// How many.
        found: u64,
    },
    /// A position that is infinite or NaN.
    NotFinite {
        /// What kind of element.
        kind: &'static str,
        /// Which one.
        index: u64,
    },
    /// A grid whose number of heights is not its columns times its rows.
    GridSize {
        /// The number of columns.
        columns: u64,
        /// The number of rows.
        rows: u64,
        /// The number of heights.
        found: u64,
    },
    /// An attribute that does not fit.
    Attribute(AttributeError),
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::IndexOutOfRange { face, found, vertices } => {
                write!(f, "face {face}: found vertex index {found}, expected one below {vertices}")
            }
            Self::EdgeOutOfRange { edge, found, vertices } => {
                write!(f, "edge {edge}: found vertex index {found}, expected one below {vertices}")
            }
            Self::TooFewCorners { face, found } => {
                write!(f, "face {face}: found {found} corners, expected at least 3")
            }
            Self::NotTriangle { face, found } => {
                write!(f, "face {face}: found {found} corners, expected a triangle")
            }
            Self::FaceStarts { face } => {
                write!(f, "face {face}: its corners start out of order")
            }
            Self::TooMany { kind, found } => {
                write!(f, "found {found} {kind}, expected at most {}", u32::MAX - 1)
            }
            Self::NotFinite { kind, index } => {
                write!(f, "{kind} {index}: found a position that is not finite, expected finite numbers")
            }
            Self::GridSize { columns, rows, found } => {
                write!(f, "height field: found {found} heights, expected {columns} columns x {rows} rows, both from 2")
            }
            Self::Attribute(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for MeshError {}

impl Diagnostic for MeshError {
    fn code(&self) -> &'static str {
        match self {
            Self::IndexOutOfRange { .. } => "E-mesh-index",
            Self::EdgeOutOfRange { .. } => "E-mesh-edge",
            Self::TooFewCorners { .. } => "E-mesh-corners",
            Self::NotTriangle { .. } => "E-mesh-triangle",
            Self::FaceStarts { .. } => "E-mesh-starts",
            Self::TooMany { .. } => "E-mesh-size",
            Self::NotFinite { .. } => "E-mesh-position",
            Self::GridSize { .. } => "E-mesh-grid",
            Self::Attribute(error) => error.code(),
        }
    }

    fn category(&self) -> Category {
        Category::Malformed
    }
}

impl From<AttributeError> for MeshError {
    fn from(error: AttributeError) -> Self {
        Self::Attribute(error)
    }
}

/// Why a column does not fit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum AttributeError {
    /// The number of values is no multiple of the width, or the width is 0.
    Width {
        /// The attribute.
        name: String,
        /// Values for each element.
        width: usize,
        /// How many values there are.
        values: usize,
    },
    /// A text column whose index has no name, or that is not of width 1 and copied.
    Text {
        /// The attribute.
        name: String,
    },
    /// List starts that do not rise from 0 to the number of values.
    ListStarts {
        /// The attribute.
        name: String,
        /// The first element at fault.
        element: usize,
    },
    /// A column for another number of elements.
    Length {
        /// The attribute.
        name: String,
        /// How many elements the column has.
        found: usize,
        /// How many elements there are.
        expected: usize,
    },
    /// A second column of the same name.
    Duplicate {
        /// The attribute.
        name: String,
    },
}

impl fmt::Display for AttributeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Width { name, width, values } => {
                write!(f, "attribute \"{name}\": found {values} values, expected a multiple of its width {width}")
            }
            Self::Text { name } => {
                write!(f, "attribute \"{name}\": expected text of width 1, copied, each index with a name")
            }
            Self::ListStarts { name, element } => {
                write!(f, "attribute \"{name}\", element {element}: found a list that starts out of order")
            }
            Self::Length { name, found, expected } => {
                write!(f, "attribute \"{name}\": found {found} elements, expected {expected}")
            }
            Self::Duplicate { name } => write!(f, "attribute \"{name}\": found a second one of that name"),
        }
    }
}

impl std::error::Error for AttributeError {}

impl Diagnostic for AttributeError {
    fn code(&self) -> &'static str {
        match self {
            Self::Width { .. } => "E-attribute-width",
            Self::Text { .. } => "E-attribute-text",
            Self::ListStarts { .. } => "E-attribute-list",
            Self::Length { .. } => "E-attribute-length",
            Self::Duplicate { .. } => "E-attribute-duplicate",
        }
    }

    fn category(&self) -> Category {
        Category::Malformed
    }
}
