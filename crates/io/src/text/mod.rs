//! Text as formats share it: lines and tokens with their places, numbers by a strict grammar.

mod decimal;
mod lines;
mod lossy;
mod numbers;
mod pieces;
mod scanner;
mod shortest;

pub use lines::{Line, Lines, Text, Token, Tokens, quoted};
pub(crate) use lossy::lossy;
pub use numbers::{CountFault, NumberFault, parse_count, parse_number};
#[cfg(test)]
pub(crate) use pieces::cut;
pub(crate) use pieces::{never_joined, pieces, rows_before};
pub(crate) use scanner::{Scanner, end_place, in_lines, is_blank, line_at, line_place, plain_text};
pub use shortest::shortest;
pub(crate) use shortest::{push_count, push_integer, push_number, push_single};
