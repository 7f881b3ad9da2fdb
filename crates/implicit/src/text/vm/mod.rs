//! Lists of arithmetic steps, as the program fidget keeps them in `.vm` files.
//!
//! A line is a name, an opcode and the names of its operands: `_2 add _0 _1`. `const` is followed by a number; `var-x`,
//! `var-y` and `var-z` are the coordinates. Empty lines and lines that begin with `#` say nothing. The last line is the
//! field.

mod error;
mod read;
mod write;

pub use error::{VmError, VmProblem, VmWriteError};
pub use read::parse_vm;
pub use write::print_vm;
