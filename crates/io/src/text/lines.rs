//! Lines and tokens.

use shapeloom_core::{Category, Limits, Place};

use crate::Fault;

/// The text of a file: bytes that need not be UTF-8, with lines that end in LF, CRLF or CR.
#[derive(Clone, Copy, Debug)]
pub struct Text<'a> {
    bytes: &'a [u8],
    max_line: u64,
    mark: bool,
}

impl<'a> Text<'a> {
    /// The text of an input; a UTF-8 byte order mark is passed over.
    ///
    /// # Errors
    /// The input begins with the mark of UTF-16 or UTF-32.
    pub fn try_new(input: &'a [u8], limits: &Limits) -> Result<Self, Box<Fault>> {
        if input.starts_with(b"\xff\xfe") || input.starts_with(b"\xfe\xff") || input.starts_with(b"\0\0\xfe\xff") {
            return Err(no_utf8("the mark of UTF-16 or UTF-32"));
        }
        let unmarked = input.strip_prefix(b"\xef\xbb\xbf");
        Ok(Self { bytes: unmarked.unwrap_or(input), max_line: limits.max_line, mark: unmarked.is_some() })
    }

    /// Whether it began with a UTF-8 byte order mark.
    pub fn had_mark(&self) -> bool {
        self.mark
    }

    /// The bytes after the mark.
    pub(crate) fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The lines in order.
    pub fn lines(&self) -> Lines<'a> {
        Lines { rest: self.bytes, number: 0, max_line: self.max_line }
    }

    /// The tokens between white space, comments from `#` to the end of the line passed over.
    pub fn tokens(&self) -> Tokens<'a> {
        Tokens { lines: self.lines(), rest: &[], number: 0, column: 0 }
    }
}

pub(super) fn no_utf8(found: &'static str) -> Box<Fault> {
    Fault::new("E-text-encoding", Place::Byte(0), found, "UTF-8 text")
        .category(Category::Unsupported)
        .advice("save the file as UTF-8")
}

pub(super) fn long_line(place: Place, bytes: usize, most: u64) -> Box<Fault> {
    Fault::new("E-text-line", place, format!("{bytes} bytes"), format!("lines of at most {most}"))
        .category(Category::OverLimit)
}

/// A line without its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line<'a> {
    /// Counted from 1.
    pub number: u64,
    /// The bytes.
    pub bytes: &'a [u8],
}

/// The lines of a [`Text`]. A line end at the end of the text starts no further line.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    rest: &'a [u8],
    number: u64,
    max_line: u64,
}

impl<'a> Lines<'a> {
    /// The number of bytes that are left.
    pub fn remaining(&self) -> usize {
        self.rest.len()
    }

    /// The next line, none at the end.
    ///
    /// # Errors
    /// The line is longer than the limit.
    pub fn next_line(&mut self) -> Result<Option<Line<'a>>, Box<Fault>> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        self.number += 1;
        let end = self.rest.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(self.rest.len());
        let (bytes, rest) = self.rest.split_at(end);
        self.rest = rest.strip_prefix(b"\r\n").unwrap_or(rest.get(1..).unwrap_or(&[]));
        if bytes.len() as u64 > self.max_line {
            return Err(long_line(Place::line(self.number), bytes.len(), self.max_line));
        }
        Ok(Some(Line { number: self.number, bytes }))
    }
}

/// A run of bytes without white space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    /// The bytes.
    pub bytes: &'a [u8],
    /// The line, counted from 1.
    pub line: u64,
    /// The column in bytes, counted from 1.
    pub column: u64,
}

impl Token<'_> {
    /// The line as a place.
    pub fn place(&self) -> Place {
        Place::line(self.line)
    }
}

/// The tokens of a [`Text`].
#[derive(Clone, Debug)]
pub struct Tokens<'a> {
    lines: Lines<'a>,
    rest: &'a [u8],
    number: u64,
    column: u64,
}

impl<'a> Tokens<'a> {
    /// The number of bytes that are left.
    pub fn remaining(&self) -> usize {
        self.rest.len() + self.lines.remaining()
    }

    /// The line of the last token, or the last line at the end; 0 before the first token.
    pub fn line(&self) -> u64 {
        self.number
    }

    /// The next token, none at the end.
    ///
    /// # Errors
    /// A line is longer than the limit.
    pub fn next_token(&mut self) -> Result<Option<Token<'a>>, Box<Fault>> {
        loop {
            let start = self.rest.iter().position(|byte| !is_space(*byte)).unwrap_or(self.rest.len());
            self.column += start as u64;
            self.rest = &self.rest[start..];
            if !self.rest.is_empty() && self.rest[0] != b'#' {
                let end = self.rest.iter().position(|&byte| is_space(byte) || byte == b'#').unwrap_or(self.rest.len());
                let (bytes, rest) = self.rest.split_at(end);
                let token = Token { bytes, line: self.number, column: self.column + 1 };
                self.column += end as u64;
                self.rest = rest;
                return Ok(Some(token));
            }
            let Some(line) = self.lines.next_line()? else {
                self.rest = &[];
                return Ok(None);
            };
            (self.rest, self.number, self.column) = (line.bytes, line.number, 0);
        }
    }
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\x0b' | b'\x0c')
}

/// A piece of the input for a message: quoted, cut after 40 characters, what cannot be printed escaped.
pub fn quoted(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]);
    let mut shown: String = text.chars().take(40).flat_map(char::escape_debug).collect();
    if text.chars().nth(40).is_some() || bytes.len() > 200 {
        shown.push_str("...");
    }
    format!("\"{shown}\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(bytes: &[u8]) -> Text<'_> {
        Text::try_new(bytes, &Limits::default()).unwrap()
    }

    fn tokens(bytes: &[u8]) -> Vec<(String, u64, u64)> {
        let mut tokens = text(bytes).tokens();
        let mut all = Vec::new();
        while let Some(token) = tokens.next_token().unwrap() {
            all.push((String::from_utf8_lossy(token.bytes).into_owned(), token.line, token.column));
        }
        all
    }

    #[test]
    fn every_line_end_ends_one_line() {
        let mut lines = text(b"a\nb\r\nc\rd\n\ne").lines();
        let mut all = Vec::new();
        while let Some(line) = lines.next_line().unwrap() {
            all.push((line.number, line.bytes.to_vec()));
        }
        let expected = [(1, "a"), (2, "b"), (3, "c"), (4, "d"), (5, ""), (6, "e")];
        assert_eq!(all, expected.map(|(number, line)| (number, line.as_bytes().to_vec())));
        assert_eq!(text(b"").lines().next_line(), Ok(None));
        assert_eq!(lines.next_line(), Ok(None));
    }

    #[test]
    fn tokens_know_their_places_and_comments_are_passed_over() {
        let found = tokens(b"  1\t22 # three 4\r\n# five\n6#7\n");
        assert_eq!(found, [("1".into(), 1, 3), ("22".into(), 1, 5), ("6".into(), 3, 1)]);
    }

    #[test]
    fn byte_order_marks_are_told_apart() {
        assert_eq!(tokens(b"\xef\xbb\xbf7")[0], ("7".into(), 1, 1));
        assert!(text(b"\xef\xbb\xbf").had_mark() && !text(b"x").had_mark());
        let fault = Text::try_new(b"\xff\xfe7\0", &Limits::default()).unwrap_err();
        assert_eq!((fault.code, fault.category), ("E-text-encoding", Category::Unsupported));
    }

    #[test]
    fn long_lines_are_refused() {
        let limits = Limits { max_line: 3, ..Limits::default() };
        let mut lines = Text::try_new(b"abc\nabcd", &limits).unwrap().lines();
        assert!(lines.next_line().is_ok());
        assert_eq!(lines.next_line().unwrap_err().place, Place::line(2));
    }

    #[test]
    fn quotes_are_short_and_printable() {
        assert_eq!(quoted(b"a\x07\"\xff"), "\"a\\u{7}\\\"\u{fffd}\"");
        assert!(quoted(&[b'x'; 1000]).len() < 50);
    }
}
