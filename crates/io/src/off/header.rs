//! The keyword at the start, and what it says of vertices.

use shapeloom_core::{Findings, Severity};

use crate::Fault;
use crate::text::{Scanner, quoted};

/// What a keyword says: `[ST][C][N][4][n]OFF`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Header {
    /// Texture coordinates, two a vertex.
    pub texcoord: bool,
    /// A colour.
    pub color: bool,
    /// A normal.
    pub normal: bool,
    /// A homogeneous weight after the coordinates.
    pub weight: bool,
    /// Whether the number of coordinates is given before the counts.
    pub dimensioned: bool,
}

/// The keyword at the start of a word, and its length.
fn keyword(word: &[u8]) -> Option<(Header, usize)> {
    let mut rest = word;
    let mut take = |prefix: &[u8]| {
        let stripped = rest.strip_prefix(prefix);
        rest = stripped.unwrap_or(rest);
        stripped.is_some()
    };
    let header = Header {
        texcoord: take(b"ST"),
        color: take(b"C"),
        normal: take(b"N"),
        weight: take(b"4"),
        dimensioned: take(b"n"),
    };
    take(b"OFF").then(|| (header, word.len() - rest.len()))
}

/// The header and where it ends, if the input has a keyword, followed by the end of the word or by digits.
fn at_start(input: &[u8]) -> Option<(Header, usize)> {
    let mut scan = Scanner::new(input.strip_prefix(b"\xef\xbb\xbf").unwrap_or(input), 0);
    if !scan.skip_empty_lines() {
        return None;
    }
    let (header, length) = keyword(scan.rest())?;
    scan.advance(length);
    let ends = scan.peek().is_none_or(|byte| byte.is_ascii_whitespace() || byte.is_ascii_digit() || byte == b'#');
    ends.then(|| (header, scan.offset()))
}

/// Whether an input begins with a keyword.
pub(super) fn begins(input: &[u8]) -> bool {
    at_start(input).is_some()
}

/// The header of a binary file, and where its numbers begin: after the line that says so.
pub(super) fn binary_body(input: &[u8]) -> Option<(Header, usize)> {
    let (header, end) = at_start(input)?;
    let mut scan = Scanner::new(input, end);
    if scan.word() != b"BINARY" {
        return None;
    }
    // Comments after it are allowed; the numbers begin after one end of line.
    scan.next_line();
    Some((header, scan.offset()))
}

/// Passes over the keyword of a text, which may be absent.
pub(super) fn header(scan: &mut Scanner<'_>, findings: &mut Findings) -> Result<Header, Box<Fault>> {
    if !scan.skip_empty_lines() {
        return Ok(Header::default());
    }
    let Some((header, length)) = keyword(scan.rest()) else {
        // Files without a keyword begin with the counts.
        return match scan.peek() {
            Some(b'0'..=b'9') => Ok(Header::default()),
            _ => Err(no_keyword(scan)),
        };
    };
    let mut after = scan.clone();
    after.advance(length);
    match after.peek() {
        Some(b'0'..=b'9') => {
            let message = "the number of vertices is glued to the keyword, and was read as if there were a space";
            findings.push("W-off-header", Severity::Note, scan.place(), message);
        }
        Some(b'#') | None => {}
        Some(byte) if byte.is_ascii_whitespace() => {}
        Some(_) => return Err(no_keyword(scan)),
    }
    *scan = after;
    Ok(header)
}

#[cold]
fn no_keyword(scan: &Scanner<'_>) -> Box<Fault> {
    let found = quoted(scan.clone().word());
    let fault =
        Fault::new("E-off-header", scan.place(), found, "a keyword [ST][C][N][4][n]OFF, or the number of vertices");
    fault.advice("the file may have another format: name it")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_taken_apart() {
        let plain = Header::default();
        let all = Header { texcoord: true, color: true, normal: true, weight: true, dimensioned: true };
        for (word, wanted) in [
            ("OFF", Some((plain, 3))),
            ("STCN4nOFF\n", Some((all, 9))),
            ("NOFF ", Some((Header { normal: true, ..plain }, 4))),
            ("4OFF", Some((Header { weight: true, ..plain }, 4))),
            ("CSTOFF", None),
            ("off", None),
            ("OF", None),
        ] {
            assert_eq!(keyword(word.as_bytes()), wanted, "{word}");
        }
    }

    #[test]
    fn inputs_are_told_by_their_keyword() {
        for text in ["OFF", "OFF8 6 12", "# made\n\n \tSTOFF # x\n", "\u{feff}nOFF\r3", "COFF BINARY\n\0\0"] {
            assert!(begins(text.as_bytes()), "{text}");
        }
        for text in ["", "OFFICE", "OFF-road", "4 4 6", "off", "# OFF"] {
            assert!(!begins(text.as_bytes()), "{text}");
        }
        assert_eq!(binary_body(b"OFF BINARY\r\n\0").map(|(_, at)| at), Some(12));
        assert!(binary_body(b"OFF\nBINARY\n").is_none());
    }
}
