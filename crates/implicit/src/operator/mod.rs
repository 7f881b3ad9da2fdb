//! The operators that trees are made of and programs run: on numbers, on numbers with derivatives, on intervals.

mod binary;
mod dual;
mod enclosure;
mod unary;

pub use binary::{Binary, Choice};
pub use dual::Dual;
pub use enclosure::Enclosure;
pub use unary::Unary;
