//! Text as formats share it: lines and tokens with their places, numbers by a strict grammar.

mod decimal;
mod lines;
mod numbers;
mod pieces;
mod print;
mod scanner;

pub use lines::{Line, Lines, Text, Token, Tokens, quoted};
pub use numbers::{CountFault, NumberFault, parse_count, parse_number, shortest};
pub(crate) use pieces::{never_joined, pieces};
pub(crate) use print::{print_f32, print_f64, print_whole};
pub(crate) use scanner::{Scanner, in_lines, is_blank, line_at, line_place, plain_text};
