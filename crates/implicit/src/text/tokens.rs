//! Words and signs.

use super::error::{Fault, TextProblem, shortened};
use super::quoted::quoted;

/// A word or sign of a text.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// What stands in quotes, without them.
    Text(String),
    Sign(char),
    End,
}

impl Token<'_> {
    /// For messages.
    pub(super) fn described(&self) -> String {
        match self {
            Self::Number(value) => format!("the number {value}"),
            Self::Name(name) => shortened(name),
            Self::Text(text) => format!("the text {}", quoted(&shortened(text))),
            Self::Sign(sign) => format!("\"{sign}\""),
            Self::End => "the end".to_owned(),
        }
    }

    pub(super) fn is(&self, sign: char) -> bool {
        *self == Self::Sign(sign)
    }
}

/// A token and the byte at which it begins.
#[derive(Clone, Debug)]
pub(super) struct Placed<'a> {
    pub(super) token: Token<'a>,
    pub(super) at: usize,
}

/// Cuts a text into tokens, one at a time.
pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(text: &'a str, at: usize) -> Self {
        Self { text, at }
    }

    fn byte(&self, ahead: usize) -> Option<u8> {
        self.text.as_bytes().get(self.at + ahead).copied()
    }

    /// The rest of the text from a place between characters.
    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn digit_at(&self, ahead: usize) -> bool {
        self.byte(ahead).is_some_and(|byte| byte.is_ascii_digit())
    }

    fn skip_while(&mut self, holds: impl Fn(u8) -> bool) {
        while self.byte(0).is_some_and(&holds) {
            self.at += 1;
        }
    }

    pub(super) fn next(&mut self) -> Result<Placed<'a>, Fault> {
        loop {
            self.skip_while(|byte| matches!(byte, b' ' | b'\t' | b'\r' | b'\n'));
            if self.byte(0) != Some(b'#') {
                break;
            }
            self.skip_while(|byte| byte != b'\n');
        }
        let at = self.at;
        let token = match self.byte(0) {
            None => Token::End,
            Some(b'0'..=b'9') => self.number()?,
            Some(b'.') if self.digit_at(1) => self.number()?,
            Some(b'a'..=b'z' | b'A'..=b'Z' | b'_') => {
                self.skip_while(|byte| byte.is_ascii_alphanumeric() || byte == b'_');
                Token::Name(self.text.get(at..self.at).unwrap_or(""))
            }
            Some(b'"') => self.quoted()?,
            Some(
                sign @ (b'+' | b'-' | b'*' | b'/' | b'^' | b'|' | b'&' | b'\\' | b'~' | b'(' | b')' | b',' | b';'
                | b':' | b'.' | b'='),
            ) => {
                self.at += 1;
                Token::Sign(char::from(sign))
            }
            Some(_) => {
                let found = self.rest().chars().next().unwrap_or(' ');
                return Err(Fault::syntax(at, format!("the character {found:?}"), "a name, a number or an operator"));
            }
        };
        Ok(Placed { token, at })
    }

    fn number(&mut self) -> Result<Token<'a>, Fault> {
        let at = self.at;
        self.skip_while(|byte| byte.is_ascii_digit());
        if self.byte(0) == Some(b'.') && self.digit_at(1) {
            self.at += 1;
            self.skip_while(|byte| byte.is_ascii_digit());
        }
        if matches!(self.byte(0), Some(b'e' | b'E')) {
            let signed = usize::from(matches!(self.byte(1), Some(b'+' | b'-')));
            if self.digit_at(1 + signed) {
                self.at += 1 + signed;
                self.skip_while(|byte| byte.is_ascii_digit());
            }
        }
        let written = self.text.get(at..self.at).unwrap_or("");
        match written.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Token::Number(value)),
            _ => Err(Fault::new(at, TextProblem::Number { found: shortened(written) })),
        }
    }

    fn quoted(&mut self) -> Result<Token<'a>, Fault> {
        let start = self.at;
        self.at += 1;
        let mut content = String::new();
        let mut characters = self.rest().char_indices();
        let inside = self.at;
        while let Some((offset, character)) = characters.next() {
            match character {
                '"' => {
                    self.at = inside + offset + 1;
                    return Ok(Token::Text(content));
                }
                '\n' => break,
                '\\' => match characters.next() {
                    Some((_, escaped @ ('"' | '\\'))) => content.push(escaped),
                    Some((_, 'n')) => content.push('\n'),
                    Some((_, 't')) => content.push('\t'),
                    Some((_, 'r')) => content.push('\r'),
                    found => {
                        let found = found.map_or("the end".to_owned(), |(_, character)| format!("{character:?}"));
                        let expected = "one of \" \\ n t r after a backslash";
                        return Err(Fault::syntax(inside + offset, found, expected));
                    }
                },
                other => content.push(other),
            }
        }
        Err(Fault::syntax(start, "a text without end", "a quotation mark in the same line"))
    }
}
