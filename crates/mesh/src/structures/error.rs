//! Why a structure cannot hold a mesh.

use std::fmt;

use shapeloom_core::{Category, Diagnostic, OverBudget, Stop};

use crate::MeshError;

/// Why a structure cannot hold a mesh, with the elements at fault.
///
/// Where more elements than one are at fault, the first in the order of their numbers is named, and how many there are.
#[derive(Clone, Debug, PartialEq)]
pub enum StructureError {
    /// Numbers that make no mesh.
    Mesh(MeshError),
    /// A face that names a vertex twice.
    RepeatedCorner {
        /// The face.
        face: u32,
        /// The vertex.
        vertex: u32,
        /// How many faces do so.
        count: usize,
    },
    /// An edge with more than two faces.
    NonManifoldEdge {
        /// Its vertices, the smaller first.
        vertices: [u32; 2],
        /// Its faces, rising.
        faces: Vec<u32>,
        /// How many edges have more than two faces.
        count: usize,
    },
    /// An edge that both its faces pass in the same direction: their orientations disagree.
    Orientation {
        /// Its vertices, the smaller first.
        vertices: [u32; 2],
        /// Its faces, rising.
        faces: [u32; 2],
        /// How many such edges there are.
        count: usize,
    },
    /// A vertex at which faces form more than one fan.
    NonManifoldVertex {
        /// The vertex.
        vertex: u32,
        /// How many fans meet there.
        fans: usize,
        /// How many such vertices there are.
        count: usize,
    },
    /// A surface with one side: a ring of faces, each sharing an edge with the next and the last with the first, that comes back
    /// turned over.
    NotOrientable {
        /// The ring.
        faces: Vec<u32>,
        /// How many parts of the surface have one side.
        count: usize,
    },
    /// Edges where the structure needs faces.
    NoFaces,
    /// Parts of the structure that contradict each other.
    Inconsistent {
        /// What kind of element.
        kind: &'static str,
        /// Which one.
        index: u32,
        /// What is wrong with it.
        what: &'static str,
    },
    /// The memory budget does not allow it.
    OverBudget(OverBudget),
    /// The caller stopped it.
    Stop(Stop),
}

impl From<MeshError> for StructureError {
    fn from(error: MeshError) -> Self {
        Self::Mesh(error)
    }
}

impl From<OverBudget> for StructureError {
    fn from(error: OverBudget) -> Self {
        Self::OverBudget(error)
    }
}

impl From<Stop> for StructureError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

/// `(and 3 more)`, or nothing.
struct Others(usize);

impl fmt::Display for Others {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            0 | 1 => Ok(()),
            count => write!(f, " (and {} more)", count - 1),
        }
    }
}

impl fmt::Display for StructureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mesh(error) => error.fmt(f),
            Self::RepeatedCorner { face, vertex, count } => {
                write!(f, "face {face}: found vertex {vertex} twice, expected different corners{}", Others(*count))
            }
            Self::NonManifoldEdge { vertices: [a, b], faces, count } => {
                write!(f, "edge {a}-{b}: found {} faces (", faces.len())?;
                for (i, face) in faces.iter().take(8).enumerate() {
                    write!(f, "{}{face}", if i == 0 { "" } else { ", " })?;
                }
                let rest = if faces.len() > 8 { ", ..." } else { "" };
                write!(f, "{rest}), expected at most two{}", Others(*count))
            }
            Self::Orientation { vertices: [a, b], faces: [f0, f1], count } => write!(
                f,
                "edge {a}-{b}: found faces {f0} and {f1} passing it in the same direction, expected opposite ones{}; orient the \
                 mesh first",
                Others(*count)
            ),
            Self::NonManifoldVertex { vertex, fans, count } => {
                write!(f, "vertex {vertex}: found {fans} fans of faces, expected one{}", Others(*count))
            }
            Self::NotOrientable { faces, count } => {
                f.write_str("faces ")?;
                for (i, face) in faces.iter().take(12).enumerate() {
                    write!(f, "{}{face}", if i == 0 { "" } else { ", " })?;
                }
                let rest = if faces.len() > 12 { ", ..." } else { "" };
                let length = faces.len();
                write!(
                    f,
                    "{rest}: found a ring of {length} that turns over, expected a surface with two sides{}",
                    Others(*count)
                )
            }
            Self::NoFaces => f.write_str("found edges alone, expected faces"),
            Self::Inconsistent { kind, index, what } => write!(f, "{kind} {index}: {what}"),
            Self::OverBudget(error) => error.fmt(f),
            Self::Stop(stop) => stop.fmt(f),
        }
    }
}

impl std::error::Error for StructureError {}

impl Diagnostic for StructureError {
    fn code(&self) -> &'static str {
        match self {
            Self::Mesh(error) => error.code(),
            Self::RepeatedCorner { .. } => "E-structure-corner",
            Self::NonManifoldEdge { .. } => "E-structure-edge",
            Self::Orientation { .. } => "E-structure-orientation",
            Self::NonManifoldVertex { .. } => "E-structure-vertex",
            Self::NotOrientable { .. } => "E-structure-one-sided",
            Self::NoFaces => "E-structure-faces",
            Self::Inconsistent { .. } => "E-structure-inconsistent",
            Self::OverBudget(error) => error.code(),
            Self::Stop(stop) => stop.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Mesh(error) => error.category(),
            Self::OverBudget(error) => error.category(),
            Self::Stop(stop) => stop.category(),
            Self::Inconsistent { .. } => Category::Malformed,
            _ => Category::Unsupported,
        }
    }
}
