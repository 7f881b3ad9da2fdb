//! Choosing a format.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

use crate::{FORMATS, Format, Sniff};

/// The format of an input, from its first bytes and its file name.
///
/// A format's own mark decides before everything else. Then come formats whose content looks right, the one of the
/// extension first, and at last the extension alone, so that a file whose first bytes are damaged is still refused by
/// the right reader, in its words. A few thousand bytes are enough for most formats; binary STL, which has no mark, is
/// told without its extension only from the whole input.
///
/// # Errors
/// Neither the content nor the extension is known.
pub fn detect(input: &[u8], file_name: Option<&str>) -> Result<&'static Format, DetectError> {
    let named = file_name.and_then(extension).and_then(|word| by_extension(&word));
    let sniffed = |wanted: Sniff| FORMATS.iter().filter(move |format| (format.sniff)(input) == wanted);
    if let Some(format) = sniffed(Sniff::Certain).next() {
        return Ok(format);
    }
    let likely = sniffed(Sniff::Likely).find(|&format| Some(format) == named);
    likely
        .or_else(|| sniffed(Sniff::Likely).next())
        .or(named)
        .ok_or_else(|| DetectError::Unknown { head: excerpt(input), file_name: file_name.map(str::to_owned) })
}

/// The format of that id.
///
/// # Errors
/// There is none.
pub fn format_by_id(id: &str) -> Result<&'static Format, DetectError> {
    FORMATS.iter().find(|format| format.id == id).ok_or_else(|| DetectError::Id { found: id.to_owned() })
}

/// The format in which a file of that name is written.
///
/// # Errors
/// No format has the extension, or it is not written.
pub fn format_for_output(file_name: &str) -> Result<&'static Format, DetectError> {
    let format = extension(file_name).and_then(|word| by_extension(&word));
    format.filter(|format| format.writes.is_some()).ok_or_else(|| DetectError::Output {
        file_name: file_name.to_owned(),
        read_only: format.map(|format| format.id),
    })
}

/// The part of an input that content heuristics look at line by line.
pub(crate) fn head(input: &[u8]) -> &[u8] {
    &input[..input.len().min(1 << 16)]
}

fn by_extension(word: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|format| format.extensions.contains(&word))
}

fn extension(file_name: &str) -> Option<String> {
    let base = file_name.rsplit(['/', '\\']).next()?;
    let (_, word) = base.rsplit_once('.')?;
    Some(word.to_ascii_lowercase())
}

fn excerpt(head: &[u8]) -> String {
    let shown: String = head.iter().take(16).map(|&byte| std::ascii::escape_default(byte).to_string()).collect();
    if head.len() > 16 { shown + "..." } else { shown }
}

/// Why no format was chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DetectError {
    /// Neither the content nor the extension of an input is known.
    Unknown {
        /// The first bytes, escaped.
        head: String,
        /// The file name, if there is one.
        file_name: Option<String>,
    },
    /// No format of that id.
    Id {
        /// The id asked for.
        found: String,
    },
    /// No format is written under that extension.
    Output {
        /// The file name.
        file_name: String,
        /// The format of the extension, if it is read only.
        read_only: Option<&'static str>,
    },
}

fn list(formats: impl Iterator<Item = &'static Format>) -> String {
    formats.map(|format| format.id).collect::<Vec<_>>().join(", ")
}

fn readable() -> impl Iterator<Item = &'static Format> {
    FORMATS.iter().filter(|format| format.reads.is_some())
}

fn writable() -> impl Iterator<Item = &'static Format> {
    FORMATS.iter().filter(|format| format.writes.is_some())
}

impl fmt::Display for DetectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let code = self.code();
        match self {
            Self::Unknown { head, file_name } => {
                let name = file_name.as_deref().unwrap_or("input");
                let seen = if head.is_empty() { "no bytes".to_owned() } else { format!("\"{head}\"") };
                write!(f, "{name}: found {seen}, expected a file in one of: {} ({code})", list(readable()))
            }
            Self::Id { found } => {
                write!(f, "format: found \"{found}\", expected one of: {} ({code})", list(FORMATS.iter()))
            }
            Self::Output { file_name, read_only: None } => {
                write!(f, "{file_name}: found no known extension, expected one of: {} ({code})", list(writable()))
            }
            Self::Output { file_name, read_only: Some(id) } => {
                let known = list(writable());
                write!(f, "{file_name}: found the format {id}, which is not written, expected one of: {known} ({code})")
            }
        }
    }
}

impl std::error::Error for DetectError {}

impl Diagnostic for DetectError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "E-format-unknown",
            Self::Id { .. } => "E-format-id",
            Self::Output { .. } => "E-format-output",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Unknown { .. } | Self::Output { .. } => Category::Unsupported,
            Self::Id { .. } => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        Some(match self {
            Self::Unknown { .. } => "name the format if you know it".into(),
            Self::Id { .. } => "see the list of formats".into(),
            Self::Output { .. } => "give the output one of these extensions, or name the format".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(head: &[u8], name: Option<&str>) -> Result<&'static str, DetectError> {
        detect(head, name).map(|format| format.id)
    }

    #[test]
    fn content_decides_before_the_extension() {
        assert_eq!(id(b"glTF\x02\0\0\0", Some("wrong.obj")), Ok("glb"));
        assert_eq!(id(b"ply\r\nformat", None), Ok("ply"));
        assert_eq!(id(b" \n{ \"asset\": {} }", Some("wrong.ply")), Ok("gltf"));
        assert_eq!(id(b"32\n3 3\n1.4 0.0 2.4\n", None), Ok("bpt"));
        assert_eq!(id(b"# made by hand\no box\nv 1 2 3\nv 1 2 4\n", None), Ok("obj"));
    }

    #[test]
    fn the_extension_decides_where_content_is_silent() {
        assert_eq!(id(b"glTX\x02\0\0\0", Some("dir.d/bad.GLB")), Ok("glb"));
        assert_eq!(id(b"", Some("empty.bpt")), Ok("bpt"));
        let error = id(b"\x00\x01something else of no format", Some("folder.glb/what")).unwrap_err();
        assert!(matches!(error, DetectError::Unknown { .. }));
        let text = error.to_string();
        assert!(text.contains("\\x00\\x01something else...") && text.contains("glb, gltf, bpt"), "{text}");
    }

    #[test]
    fn a_list_of_points_is_no_patch_set() {
        assert!(id(b"1 2 3\n4 5 6\n", None).is_err());
        assert!(id(b"3\n1 2 3\n4 5 6\n7 8 9\n", None).is_err());
    }

    #[test]
    fn outputs_are_chosen_by_extension_among_writers() {
        assert_eq!(format_for_output("a.b/c.Glb").unwrap().id, "glb");
        assert_eq!(format_for_output("c.gltf").unwrap().id, "gltf");
        assert!(format_for_output("c").is_err() && format_for_output("glb").is_err());
        assert_eq!(format_by_id("obj").unwrap().name, "Wavefront OBJ");
        assert!(format_by_id("GLB").is_err());
    }
}
