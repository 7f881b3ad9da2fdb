//! The bytes of a file, for a decoder that unpacks a whole strip in one call.

use std::cell::Cell;
use std::io::{Cursor, Error, Read, Result, Seek, SeekFrom};

use shapeloom_core::{Exec, Stop};

/// How many bytes are given at once. Compressed ones become a thousand times as many at most, in milliseconds.
const MOST: usize = 4096;

/// Whether, and why, the caller stopped the decoder.
#[derive(Default)]
pub(super) struct Stopped(Cell<Option<Stop>>);

impl Stopped {
    /// # Errors
    /// The caller stopped the decoder: whatever that told instead is for no one.
    pub(super) fn check(&self) -> std::result::Result<(), Stop> {
        self.0.get().map_or(Ok(()), Err)
    }
}

/// Bytes that end with an error once the caller wants to stop.
pub(super) struct Source<'a> {
    bytes: Cursor<&'a [u8]>,
    /// Where they end, if not with the file.
    end: u64,
    exec: &'a Exec,
    stopped: &'a Stopped,
}

impl<'a> Source<'a> {
    pub(super) fn new(bytes: &'a [u8], exec: &'a Exec, stopped: &'a Stopped) -> Self {
        Self { bytes: Cursor::new(bytes), end: u64::MAX, exec, stopped }
    }

    /// Lets the bytes end where a strip does: some decoders go on until they have enough.
    pub(super) fn end_at(&mut self, end: u64) {
        self.end = end;
    }
}

impl Read for Source<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> Result<usize> {
        if let Err(stop) = self.exec.check() {
            self.stopped.0.set(Some(stop));
            return Err(Error::other("the caller stopped"));
        }
        let left = usize::try_from(self.end.saturating_sub(self.bytes.position())).unwrap_or(usize::MAX);
        let most = buffer.len().min(MOST).min(left);
        self.bytes.read(&mut buffer[..most])
    }
}

impl Seek for Source<'_> {
    fn seek(&mut self, to: SeekFrom) -> Result<u64> {
        self.bytes.seek(to)
    }
}
