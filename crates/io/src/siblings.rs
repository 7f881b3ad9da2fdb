//! Files that a file names.

use std::fmt;

/// The name of a file beside or below the input: relative, with forward slashes, never leaving the folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SiblingName(String);

impl SiblingName {
    /// The name as written in a file, backslashes taken as slashes.
    ///
    /// # Errors
    /// [`SiblingError::Forbidden`] for a name that is empty, absolute, has a drive or a scheme, or a component `..`.
    pub fn try_new(name: &str) -> Result<Self, SiblingError> {
        let name = name.replace('\\', "/");
        let outside = name.starts_with('/') || name.split('/').any(|part| part == "..");
        let foreign = name.contains(':') || name.contains('\0');
        if name.is_empty() || outside || foreign { Err(SiblingError::Forbidden) } else { Ok(Self(name)) }
    }

    /// The name in a URI reference, percent escapes decoded before the check.
    ///
    /// # Errors
    /// As [`SiblingName::try_new`], and for escapes that are no UTF-8.
    pub fn from_uri(uri: &str) -> Result<Self, SiblingError> {
        let mut bytes = Vec::with_capacity(uri.len());
        let mut rest = uri.as_bytes();
        while let Some((&byte, tail)) = rest.split_first() {
            let digits = tail.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
            let digits = digits.filter(|digits| digits.bytes().all(|digit| digit.is_ascii_hexdigit()));
            match digits.filter(|_| byte == b'%').and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
                Some(decoded) => {
                    bytes.push(decoded);
                    rest = &tail[2..];
                }
                None => {
                    bytes.push(byte);
                    rest = tail;
                }
            }
        }
        Self::try_new(std::str::from_utf8(&bytes).map_err(|_| SiblingError::Forbidden)?)
    }

    /// The name.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Why a file beside the input was not opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SiblingError {
    /// The name would leave the folder of the input.
    Forbidden,
    /// There is no such file.
    Missing,
    /// It could not be read.
    Io(String),
}

impl fmt::Display for SiblingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Forbidden => f.write_str("a name outside the folder of the input"),
            Self::Missing => f.write_str("no such file beside the input"),
            Self::Io(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for SiblingError {}

/// Opens the files that an input names: buffers, material libraries.
pub trait Siblings: Send + Sync {
    /// The file of that name, or if it is longer its first `max_bytes` bytes: no more is ever read or kept.
    ///
    /// # Errors
    /// It is missing or unreadable.
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError>;
}

/// Takes the files that are written beside an output: material libraries.
pub trait SiblingOutputs: Send + Sync {
    /// Writes a file beside the output, or keeps it to be written with it.
    ///
    /// # Errors
    /// It cannot be written.
    fn put(&self, name: &SiblingName, bytes: Vec<u8>) -> std::io::Result<()>;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_the_folder() {
        for name in ["a.bin", "sub/a.bin", "a..b", "sub\\a.bin", "mit leerzeichen.bin"] {
            assert!(SiblingName::try_new(name).is_ok(), "{name}");
        }
        for name in ["", "/etc/passwd", "../a", "a/../../b", "..\\a", "\\a", "C:\\a", "file:a", "a/..", "a\0b"] {
            assert_eq!(SiblingName::try_new(name), Err(SiblingError::Forbidden), "{name}");
        }
    }

    #[test]
    fn escapes_are_decoded_before_the_check() {
        assert_eq!(SiblingName::from_uri("a%20b.bin").unwrap().as_str(), "a b.bin");
        assert_eq!(SiblingName::from_uri("%2e%2e/a"), Err(SiblingError::Forbidden));
        assert_eq!(SiblingName::from_uri("%2Fetc"), Err(SiblingError::Forbidden));
        assert_eq!(SiblingName::from_uri("%ff"), Err(SiblingError::Forbidden));
        assert_eq!(SiblingName::from_uri("100%").unwrap().as_str(), "100%");
        assert_eq!(SiblingName::from_uri("%+1a").unwrap().as_str(), "%+1a");
    }
}
