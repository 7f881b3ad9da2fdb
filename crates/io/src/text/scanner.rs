//! Text scanned line by line at full speed.

use shapeloom_core::{Limits, Place};

use super::decimal::{decimal, digits};
use super::lines::quoted;
use super::numbers::{CountFault, NumberFault, parse_count, parse_number};
use crate::Fault;

/// A place in a text from which words and numbers are read, without copies and without counting lines.
///
/// Lines end in LF, CRLF or CR; blanks are spaces, tabs, vertical tabs and form feeds. Places are offsets in bytes:
/// lines are counted when an error or a finding needs them, by [`line_at`].
#[derive(Clone, Debug)]
pub(crate) struct Scanner<'a> {
    text: &'a [u8],
    at: usize,
}

impl<'a> Scanner<'a> {
    /// From an offset of a text on.
    pub(crate) fn new(text: &'a [u8], at: usize) -> Self {
        Self { text, at: at.min(text.len()) }
    }

    /// Where it stands, as an offset into the text.
    #[inline]
    pub(crate) fn offset(&self) -> usize {
        self.at
    }

    /// The bytes that are left.
    #[inline]
    pub(crate) fn rest(&self) -> &'a [u8] {
        &self.text[self.at..]
    }

    /// The next byte; none at the end of the text.
    #[inline]
    pub(crate) fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Passes over bytes that were looked at.
    #[inline]
    pub(crate) fn advance(&mut self, bytes: usize) {
        self.at = (self.at + bytes).min(self.text.len());
    }

    /// Passes over blanks, and returns the byte after them; none at the end of the text.
    #[inline]
    pub(crate) fn skip_blanks(&mut self) -> Option<u8> {
        loop {
            match self.text.get(self.at) {
                Some(byte) if is_blank(*byte) => self.at += 1,
                found => return found.copied(),
            }
        }
    }

    /// Whether nothing but blanks is left on the line, after passing over them.
    #[inline]
    pub(crate) fn at_line_end(&mut self) -> bool {
        matches!(self.skip_blanks(), None | Some(b'\n' | b'\r'))
    }

    /// Whether nothing but blanks or a comment from `#` is left on the line.
    #[inline]
    pub(crate) fn at_line_end_or_comment(&mut self) -> bool {
        matches!(self.skip_blanks(), None | Some(b'\n' | b'\r' | b'#'))
    }

    /// Passes over the rest of the line and its end. Returns whether there was a line to pass over.
    #[inline]
    pub(crate) fn next_line(&mut self) -> bool {
        let rest = self.rest();
        // Ends are mostly right here: after the last word of a line.
        let end = match rest.first() {
            None => return false,
            Some(b'\n' | b'\r') => 0,
            Some(_) => memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len()),
        };
        self.at += match (rest.get(end), rest.get(end + 1)) {
            (Some(b'\r'), Some(b'\n')) => end + 2,
            (Some(_), _) => end + 1,
            (None, _) => end,
        };
        true
    }

    /// Passes over lines that are blank or comments from `#`. Returns whether something is left.
    #[inline]
    pub(crate) fn skip_empty_lines(&mut self) -> bool {
        loop {
            match self.skip_blanks() {
                None => return false,
                Some(b'\n' | b'\r' | b'#') => self.next_line(),
                Some(_) => return true,
            };
        }
    }

    /// The next word of the line, after blanks; empty at the end of the line.
    #[inline]
    pub(crate) fn word(&mut self) -> &'a [u8] {
        self.skip_blanks();
        let rest = self.rest();
        let end = rest.iter().position(|&byte| is_blank(byte) || matches!(byte, b'\n' | b'\r')).unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    /// The rest of the line without blanks at its ends; it stays there.
    pub(crate) fn rest_of_line(&self) -> &'a [u8] {
        let rest = self.rest();
        let end = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        rest[..end].trim_ascii()
    }

    /// The next number of the line, after blanks. On failure it stands before the word at fault.
    ///
    /// # Errors
    /// The word is no number; [`NumberFault::Syntax`] too where the line has no further word.
    #[inline]
    pub(crate) fn number(&mut self) -> Result<f64, NumberFault> {
        self.skip_blanks();
        match decimal(self.rest()) {
            Ok((value, taken)) if self.ends_word(taken) => {
                self.at += taken;
                Ok(value)
            }
            Err(NumberFault::Overflow) => Err(NumberFault::Overflow),
            Ok(_) | Err(_) => Err(self.clone().number_fault()),
        }
    }

    /// Why the word that comes next is no number.
    #[cold]
    fn number_fault(mut self) -> NumberFault {
        parse_number(self.word()).err().unwrap_or(NumberFault::Syntax)
    }

    /// The next whole number of the line, after blanks. On failure it stands before the word at fault.
    ///
    /// # Errors
    /// The word is no count; [`CountFault::Syntax`] too where the line has no further word.
    #[inline]
    pub(crate) fn count(&mut self) -> Result<u64, CountFault> {
        self.skip_blanks();
        let (value, end) = digits(self.text, self.at, 0);
        let length = end - self.at;
        if length == 0 || length > 19 || !self.ends_word(length) {
            let word = self.clone().word();
            let value = parse_count(word)?;
            self.at += word.len();
            return Ok(value);
        }
        self.at = end;
        Ok(value)
    }

    /// A whole number that may be negative and need not end its word: its size and whether it is negative. Passes over
    /// it.
    ///
    /// # Errors
    /// No digit follows, or more than 19; it stands where it stood.
    #[inline]
    pub(crate) fn signed_part(&mut self) -> Result<(u64, bool), CountFault> {
        let negative = self.peek() == Some(b'-');
        let first = self.at + usize::from(negative);
        let (value, end) = digits(self.text, first, 0);
        match end - first {
            0 => Err(CountFault::Syntax),
            1..=19 => {
                self.at = end;
                Ok((value, negative))
            }
            _ => Err(CountFault::Overflow),
        }
    }

    #[inline]
    fn ends_word(&self, taken: usize) -> bool {
        match self.text.get(self.at + taken) {
            None => true,
            Some(&byte) => is_blank(byte) || matches!(byte, b'\n' | b'\r'),
        }
    }

    /// What a message calls the thing that comes next: the word, quoted, or what ends here.
    pub(crate) fn found(&self) -> String {
        let mut ahead = self.clone();
        match ahead.skip_blanks() {
            None => "the end of the file".to_owned(),
            Some(b'\n' | b'\r') => "the end of the line".to_owned(),
            Some(_) => quoted(ahead.word()),
        }
    }

    /// The place where it stands, after blanks, as an offset that [`in_lines`] makes a line of.
    pub(crate) fn place(&self) -> Place {
        let mut ahead = self.clone();
        ahead.skip_blanks();
        Place::Byte(ahead.at as u64)
    }
}

#[inline]
pub(crate) fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\x0b' | b'\x0c')
}

/// The line, counted from 1, in which the byte at an offset lies. An end of line belongs to the line that it ends; the
/// end of the text to the last line that has any byte. Cost: one pass over the bytes before.
pub(crate) fn line_at(text: &[u8], offset: usize) -> u64 {
    // At the end of a text that ends in a line end no further line begins.
    let offset = if offset >= text.len() { text.len().saturating_sub(1) } else { offset };
    let before = &text[..offset];
    let mut lines = 1;
    let mut from = 0;
    while let Some(found) = memchr::memchr2(b'\n', b'\r', &before[from..]) {
        let end = from + found;
        // The feed of CRLF belongs to the line that it ends, whether or not it is before the offset.
        let pair = before[end] == b'\r' && text.get(end + 1) == Some(&b'\n');
        from = if pair { end + 2 } else { end + 1 };
        if from > offset {
            break;
        }
        lines += 1;
        if from >= before.len() {
            break;
        }
    }
    lines
}

/// The same fault with an offset made a line of its text.
pub(crate) fn in_lines(text: &[u8], mut fault: Box<Fault>) -> Box<Fault> {
    fault.place = line_place(text, fault.place);
    fault
}

/// An offset made a line of its text; other places stay, and so does an offset where there is no text.
pub(crate) fn line_place(text: &[u8], place: Place) -> Place {
    match place {
        Place::Byte(offset) if !text.is_empty() => {
            Place::line(line_at(text, usize::try_from(offset).unwrap_or(usize::MAX)))
        }
        place => place,
    }
}

/// Where a text ends: the line of its last byte, or the next one where that ends its line.
pub(crate) fn end_place(text: &[u8]) -> Place {
    let last = line_at(text, text.len());
    Place::line(if matches!(text.last(), Some(b'\n' | b'\r')) { last + 1 } else { last })
}

/// A text without its byte order mark, within the limits of lines.
///
/// # Errors
/// The mark of UTF-16 or UTF-32; text in UTF-16 without one, told by its zero bytes; a line longer than the limit.
pub(crate) fn plain_text<'a>(input: &'a [u8], limits: &Limits) -> Result<&'a [u8], Box<Fault>> {
    let text = super::Text::try_new(input, limits)?.bytes();
    if let [a, b, c, d, ..] = *text
        && ((a != 0 && b == 0 && c != 0 && d == 0) || (a == 0 && b != 0 && c == 0 && d != 0))
    {
        return Err(super::lines::no_utf8("text in UTF-16"));
    }
    // Only a text longer than the limit can have a line that is.
    if text.len() as u64 > limits.max_line {
        let mut from = 0;
        while from < text.len() {
            let end = memchr::memchr2(b'\n', b'\r', &text[from..]).map_or(text.len(), |found| from + found);
            if (end - from) as u64 > limits.max_line {
                let fault = super::lines::long_line(Place::Byte(from as u64), end - from, limits.max_line);
                return Err(in_lines(text, fault));
            }
            from = end + 1;
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_numbers_and_lines_are_read_in_turn() {
        let mut scan = Scanner::new(b" v 1.5 -2e1\t7\r\n\r\n  # note\rlast 99999999999999999999 x1", 0);
        assert_eq!(scan.word(), b"v");
        assert_eq!((scan.number(), scan.number(), scan.count()), (Ok(1.5), Ok(-20.0), Ok(7)));
        assert!(scan.at_line_end() && scan.next_line());
        // One end of line, not the half of one.
        assert_eq!((scan.offset(), scan.peek()), (15, Some(b'\r')));
        assert!(scan.skip_empty_lines());
        assert_eq!(scan.word(), b"last");
        assert_eq!(scan.count(), Err(CountFault::Overflow));
        assert_eq!(scan.word(), b"99999999999999999999");
        assert_eq!((scan.count(), scan.number()), (Err(CountFault::Syntax), Err(NumberFault::Syntax)));
        assert_eq!((scan.found(), scan.place()), ("\"x1\"".to_owned(), Place::Byte(52)));
        assert_eq!(scan.word(), b"x1");
        assert!(scan.at_line_end() && !scan.next_line() && scan.word().is_empty());
        assert_eq!(scan.found(), "the end of the file");
    }

    #[test]
    fn numbers_end_where_their_word_ends() {
        for (text, fault) in [
            ("1,5", NumberFault::Syntax),
            ("0x1p3", NumberFault::Syntax),
            ("3.1+e2", NumberFault::Syntax),
            ("nan", NumberFault::NotFinite),
            ("-1.#IND", NumberFault::NotFinite),
            ("1e400", NumberFault::Overflow),
            ("\n5", NumberFault::Syntax),
        ] {
            let mut scan = Scanner::new(text.as_bytes(), 0);
            assert_eq!(scan.number(), Err(fault), "{text}");
        }
    }

    #[test]
    fn lines_are_counted_by_every_kind_of_end() {
        let text = b"a\nb\r\nc\rd\n\ne\n";
        let lines: Vec<u64> = (0..text.len() + 2).map(|offset| line_at(text, offset)).collect();
        assert_eq!(lines, [1, 1, 2, 2, 2, 3, 3, 4, 4, 5, 6, 6, 6, 6]);
        assert_eq!((line_at(b"", 0), line_at(b"abc", 9), line_at(b"a\r\nb", 3)), (1, 1, 2));
    }

    #[test]
    fn other_encodings_and_long_lines_are_refused() {
        let limits = Limits { max_line: 4, ..Limits::default() };
        assert_eq!(plain_text(b"\xef\xbb\xbfOFF", &limits).unwrap(), b"OFF");
        for utf16 in [&b"O\0F\0F\0"[..], b"\0O\0F\0F", b"\xff\xfeO\0"] {
            assert_eq!(plain_text(utf16, &limits).unwrap_err().code, "E-text-encoding");
        }
        let fault = plain_text(b"1234\n12345\n", &limits).unwrap_err();
        assert_eq!((fault.code, fault.place), ("E-text-line", Place::line(2)));
    }
}
