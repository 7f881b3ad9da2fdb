//! Trees as text: a small readable language, and the machine listings of other programs.
//!
//! [`parse`] reads the language of `.shape` files, [`to_text`] writes it: what was written reads back to an equal tree.
//! The page `docs/formats/shape_language.md` describes it whole. [`parse_vm`] and [`print_vm`] do the same for lists of
//! arithmetic steps.

mod bind;
mod calls;
mod error;
mod foreign;
mod functions;
mod names;
mod number;
mod parser;
mod printer;
mod quoted;
mod tokens;
mod transforms;
mod value;
mod vm;

#[cfg(test)]
mod tests;

pub use error::{TextError, TextProblem};
pub use foreign::{ForeignCall, ResolveError, Resolved, Resolver};
pub use parser::{Parsed, parse};
pub use printer::to_text;
pub use vm::{VmError, VmProblem, VmWriteError, parse_vm, print_vm};
