//! Fields from elsewhere, named in text.

use std::fmt::{self, Write};
use std::sync::Arc;

use shapeloom_core::{Category, Field};

use super::functions::is_known;
use super::number::shortest;
use super::quoted::quoted;
use super::tokens::{Token, Tokens};

/// A call of a function that the language does not have, with text: `mesh("tooth.stl")`.
#[derive(Clone, Debug, PartialEq)]
pub struct ForeignCall {
    /// The function, such as `mesh`.
    pub function: String,
    /// The text, such as `tooth.stl`.
    pub argument: String,
    /// Numbers by their names, in the order written; no name twice.
    pub numbers: Vec<(String, f64)>,
}

impl ForeignCall {
    /// The number of that name.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(of, _)| of == name).map(|(_, value)| *value)
    }

    /// The call in text, always the same for the same call. It is what [`Foreign::source`](crate::Foreign::source)
    /// holds.
    pub fn text(&self) -> String {
        if self.function == WORDS {
            return self.argument.clone();
        }
        self.to_string()
    }

    /// The call that a text is, where it is written as [`ForeignCall::text`] writes it.
    fn of_text(text: &str) -> Option<Self> {
        let mut tokens = Tokens::new(text, 0);
        let mut next = || tokens.next().map(|placed| placed.token).ok();
        let Token::Name(function) = next()? else { return None };
        if !next()?.is('(') {
            return None;
        }
        let Token::Text(argument) = next()? else { return None };
        let mut numbers: Vec<(String, f64)> = Vec::new();
        loop {
            match next()? {
                Token::Sign(')') => break,
                Token::Sign(',') => {}
                _ => return None,
            }
            let Token::Name(name) = next()? else { return None };
            if !next()?.is(':') || numbers.iter().any(|(known, _)| known == name) {
                return None;
            }
            let value = match next()? {
                Token::Number(value) => value,
                Token::Sign('-') => match next()? {
                    Token::Number(value) => -value,
                    _ => return None,
                },
                _ => return None,
            };
            numbers.push((name.to_owned(), value));
        }
        let call = Self { function: function.to_owned(), argument, numbers };
        (!is_known(function) && call.function != WORDS && call.to_string() == text).then_some(call)
    }
}

/// As text writes it.
impl fmt::Display for ForeignCall {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}({}", self.function, quoted(&self.argument))?;
        for (name, value) in &self.numbers {
            write!(f, ", {name}: {}", shortest(*value))?;
        }
        f.write_char(')')
    }
}

/// The function under which words that are no call stand in text: `foreign("any words")`.
pub(super) const WORDS: &str = "foreign";

/// A foreign field's source as text that reads back to it.
pub(super) fn written(source: &str) -> String {
    match ForeignCall::of_text(source) {
        Some(_) => source.to_owned(),
        None => format!("{WORDS}({})", quoted(source)),
    }
}

/// Finds the fields that text names.
pub trait Resolver {
    /// The field that a call stands for.
    ///
    /// Asked once for each different call of a text. A call `foreign("any words")` comes with the function `foreign`.
    ///
    /// # Errors
    /// Whatever keeps the field from being made, in words that need not repeat the call.
    fn resolve(&self, call: &ForeignCall) -> Result<Resolved, ResolveError>;

    /// The functions that it answers, for messages.
    fn functions(&self) -> Vec<String> {
        Vec::new()
    }
}

/// A field found for a call.
#[derive(Clone)]
pub struct Resolved {
    /// The field.
    pub field: Arc<dyn Field>,
    /// Whether its values are signed distances up to rounding.
    pub exact: bool,
}

/// Why a call gave no field.
#[derive(Clone, Debug, PartialEq)]
pub enum ResolveError {
    /// There is no such function.
    UnknownFunction,
    /// The function failed.
    Failed {
        /// Why: what was found and what was expected.
        reason: String,
        /// The kind of failure.
        category: Category,
    },
}
