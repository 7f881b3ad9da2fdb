//! Text as formats share it: lines and tokens with their places, numbers by a strict grammar.

mod lines;
mod numbers;

pub use lines::{Line, Lines, Text, Token, Tokens, quoted};
pub use numbers::{CountFault, NumberFault, parse_count, parse_number, shortest};
