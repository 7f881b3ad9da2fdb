//! Why a shape was not written.

use std::fmt;
use std::io;

use shapeloom_core::{Category, Diagnostic, OverBudget, Stop};
use shapeloom_shape::Kind;

/// Why a shape was not written.
#[derive(Clone, Debug, PartialEq)]
pub enum WriteError {
    /// The format has no writer.
    NoWriter {
        /// The id of the format.
        format: &'static str,
    },
    /// The format cannot hold a part's kind.
    Unsupported {
        /// The id of the format.
        format: &'static str,
        /// Which part.
        part: usize,
        /// Its kind.
        kind: Kind,
        /// The kinds that the format holds.
        holds: &'static [Kind],
    },
    /// A position that is infinite or NaN, or becomes so where it is placed or in the numbers of the format.
    NotFinite {
        /// The id of the format.
        format: &'static str,
        /// Which part.
        part: usize,
        /// Its name, if it has one.
        name: String,
        /// What kind of element: a vertex, a control point.
        element: &'static str,
        /// Which one.
        index: usize,
    },
    /// Nothing that the format could hold: it has no empty files.
    Empty {
        /// The id of the format.
        format: &'static str,
    },
    /// A height field or voxel grid whose axes do not run along those of space, in a format without directions.
    Turned {
        /// The id of the format.
        format: &'static str,
        /// Which part.
        part: usize,
        /// Its name, if it has one.
        name: String,
    },
    /// More than the format can count.
    TooLarge {
        /// The id of the format.
        format: &'static str,
        /// What there is too much of.
        what: &'static str,
        /// How much.
        found: u64,
        /// The most that the format can hold.
        max: u64,
    },
    /// An implicit shape that the format cannot express.
    Tree {
        /// The id of the format.
        format: &'static str,
        /// What was found, and what was expected.
        reason: String,
        /// The code of the reason.
        code: &'static str,
        /// Its category.
        category: Category,
    },
    /// The output failed.
    Io {
        /// What kind of failure.
        kind: io::ErrorKind,
        /// What the system said.
        message: String,
    },
    /// The caller stopped it.
    Stop(Stop),
    /// The memory budget does not have what the output needs.
    OverBudget(OverBudget),
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let code = self.code();
        match self {
            Self::NoWriter { format } => {
                write!(f, "{format}: found a format that is not written, expected one that is ({code})")
            }
            Self::Unsupported { format, part, kind, holds } => {
                let holds = holds.iter().map(|kind| kind.name()).collect::<Vec<_>>().join(", ");
                write!(f, "{format}: part {part}: found a {kind}, expected one of: {holds} ({code})")
            }
            Self::NotFinite { format, part, name, element, index } => {
                let name = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
                write!(
                    f,
                    "{format}: part {part}{name}, {element} {index}: found a position that is not finite in the file's \
                     numbers, expected finite coordinates ({code})"
                )
            }
            Self::Empty { format } => write!(f, "{format}: found no parts, expected one ({code})"),
            Self::Turned { format, part, name } => {
                let name = if name.is_empty() { String::new() } else { format!(" \"{name}\"") };
                write!(
                    f,
                    "{format}: part {part}{name}: found a grid that is turned or sheared, expected rows and \
                     columns along the axes and heights upward ({code})"
                )
            }
            Self::TooLarge { format, what, found, max } => {
                write!(f, "{format}: found {found} {what}, expected at most {max} ({code})")
            }
            Self::Tree { format, reason, .. } => write!(f, "{format}: {reason} ({code})"),
            Self::Io { message, .. } => write!(f, "output: found {message}, expected a writable output ({code})"),
            Self::Stop(stop) => stop.fmt(f),
            Self::OverBudget(over) => over.fmt(f),
        }
    }
}

impl std::error::Error for WriteError {}

impl Diagnostic for WriteError {
    fn code(&self) -> &'static str {
        match self {
            Self::NoWriter { .. } => "E-write-format",
            Self::Unsupported { .. } => "E-write-kind",
            Self::NotFinite { .. } => "E-write-finite",
            Self::Empty { .. } => "E-write-empty",
            Self::Turned { .. } => "E-write-turned",
            Self::TooLarge { .. } => "E-write-size",
            Self::Tree { code, .. } => code,
            Self::Io { .. } => "E-write-io",
            Self::Stop(stop) => stop.code(),
            Self::OverBudget(over) => over.code(),
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::NoWriter { .. } | Self::Unsupported { .. } | Self::Turned { .. } => Category::Unsupported,
            Self::NotFinite { .. } => Category::Failed,
            Self::Empty { .. } | Self::TooLarge { .. } | Self::Io { .. } => Category::CannotWrite,
            Self::Tree { category, .. } => *category,
            Self::Stop(stop) => stop.category(),
            Self::OverBudget(over) => over.category(),
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::NoWriter { .. } => Some("choose another format".into()),
            Self::Unsupported { holds, .. } if holds.contains(&Kind::TriMesh) => {
                Some("convert the part to triangles first".into())
            }
            Self::Unsupported { .. } => Some("convert the part to a kind that the format holds first".into()),
            Self::NotFinite { .. } => Some("repair the shape first".into()),
            Self::Empty { .. } => Some("check that the input holds what was meant to be written".into()),
            Self::Turned { .. } => {
                Some("turn it back, or convert it to triangles and choose a format of meshes".into())
            }
            Self::TooLarge { .. } => Some("write fewer parts a file, simplify, or choose another format".into()),
            Self::Tree { .. } => Some("convert the part to triangles, or write the shape language".into()),
            Self::Io { .. } => None,
            Self::Stop(stop) => stop.advice(),
            Self::OverBudget(_) => Some("raise the memory limit".into()),
        }
    }
}

impl From<io::Error> for WriteError {
    fn from(error: io::Error) -> Self {
        Self::Io { kind: error.kind(), message: error.to_string() }
    }
}

impl From<Stop> for WriteError {
    fn from(stop: Stop) -> Self {
        Self::Stop(stop)
    }
}

impl From<OverBudget> for WriteError {
    fn from(over: OverBudget) -> Self {
        Self::OverBudget(over)
    }
}
