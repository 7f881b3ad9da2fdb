//! Where a command reads and writes.

use std::io::{self, IsTerminal, Read, Write};

/// Standard input, output and error of a command, which tests replace.
pub struct Streams {
    /// Standard input.
    pub input: Box<dyn Read + Send>,
    /// Standard output: data, and nothing else.
    pub out: Box<dyn Write + Send>,
    /// Standard error: words.
    pub err: Box<dyn Write + Send>,
    /// Whether standard error is a terminal, where progress can be shown.
    pub err_is_terminal: bool,
}

impl Streams {
    /// The streams of this process.
    pub fn of_process() -> Self {
        Self {
            input: Box::new(io::stdin()),
            out: Box::new(io::stdout()),
            err: Box::new(io::stderr()),
            err_is_terminal: io::stderr().is_terminal(),
        }
    }
}
