//! An output that writers fill in small pieces.

use std::fmt;
use std::io::Write;

use shapeloom_core::Exec;

use crate::WriteError;

const BLOCK: usize = 1 << 16;

/// Collects small pieces into blocks, and polls for cancelling at each block.
pub(crate) struct Sink<'o> {
    out: &'o mut dyn Write,
    exec: &'o Exec,
    block: Vec<u8>,
}

impl<'o> Sink<'o> {
    pub(crate) fn new(out: &'o mut dyn Write, exec: &'o Exec) -> Self {
        Self { out, exec, block: Vec::with_capacity(BLOCK + 256) }
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.block.extend_from_slice(bytes);
        if self.block.len() >= BLOCK { self.pass_on() } else { Ok(()) }
    }

    pub(crate) fn text(&mut self, text: fmt::Arguments<'_>) -> Result<(), WriteError> {
        self.block.write_fmt(text)?;
        self.bytes(&[])
    }

    /// The block, to append to; then call [`Sink::spill`].
    #[inline]
    pub(crate) fn block(&mut self) -> &mut Vec<u8> {
        &mut self.block
    }

    /// Passes the block on if it is full.
    #[inline]
    pub(crate) fn spill(&mut self) -> Result<(), WriteError> {
        if self.block.len() >= BLOCK { self.pass_on() } else { Ok(()) }
    }

    pub(crate) fn finish(mut self) -> Result<(), WriteError> {
        self.pass_on()
    }

    fn pass_on(&mut self) -> Result<(), WriteError> {
        self.exec.check()?;
        self.out.write_all(&self.block)?;
        self.block.clear();
        Ok(())
    }
}
