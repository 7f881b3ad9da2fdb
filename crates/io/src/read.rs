//! Reading.

use std::io::Read;
use std::sync::Arc;

use shapeloom_core::{Category, Exec, Findings, Limits, Loss, Place};
use shapeloom_shape::Shape;

use crate::{Fault, Format, ReadError, ReadOptions, Siblings, audit};

/// What a reader needs beside the bytes.
#[derive(Clone, Default)]
pub struct ReadContext {
    /// What it accepts.
    pub limits: Limits,
    /// How files are read where there is a choice.
    pub options: ReadOptions,
    /// How it runs: memory is reserved before it is allocated in proportion to the input, and cancelling is polled.
    pub exec: Exec,
    /// What errors call the input.
    pub name: String,
    /// Where the files lie that the input names; none for an input that stands alone, such as standard input.
    pub siblings: Option<Arc<dyn Siblings>>,
}

impl ReadContext {
    /// The default context for an input of that name.
    pub fn named(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }
}

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadShape {
    /// The shape.
    pub shape: Shape,
    /// What was odd about the file and what was made of it.
    pub findings: Findings,
    /// What of the file the shape does not hold.
    pub losses: Vec<Loss>,
}

impl ReadShape {
    /// A shape of which nothing was lost.
    pub fn new(shape: Shape) -> Self {
        Self { shape, findings: Findings::default(), losses: Vec::new() }
    }
}

/// Reads a file that lies in memory.
///
/// The reader grows with what is really there, never with what a header claims. Memory that it needs beside `input` is
/// reserved while it runs; the result is the caller's.
///
/// # Errors
/// What is wrong with the input, named with its place; a format without a reader; limits and budgets passed;
/// cancelled.
pub fn read(input: &[u8], format: &Format, context: &ReadContext) -> Result<ReadShape, ReadError> {
    let reader = format.reads.ok_or_else(|| {
        let found = format!("a {} file", format.name);
        Fault::new("E-read-format", Place::Whole, found, "a format that is read")
            .category(Category::Unsupported)
            .advice("convert it to one of the formats that are read with another program")
    });
    let bytes = input.len() as u64;
    let result = reader.map_err(ReadError::from).and_then(|reader| {
        if bytes > context.limits.max_bytes {
            return Err(too_long(context.limits.max_bytes).into());
        }
        context.exec.check()?;
        let mut found = reader(input, context)?;
        if context.options.drop_non_finite {
            audit::drop_non_finite(&mut found.shape, &context.exec, &mut found.findings)?;
        }
        Ok(found)
    });
    result.map_err(|error| error.in_input(&context.name))
}

/// All bytes of a stream, as long as they are within the limit. Polls between pieces of a mebibyte; a stream that gives
/// nothing cannot be interrupted from here.
///
/// # Errors
/// More bytes than [`Limits::max_bytes`], the stream failed, or the reason to stop.
pub fn slurp(reader: impl Read, limits: &Limits, exec: &Exec) -> Result<Vec<u8>, ReadError> {
    slurp_sized(reader, 0, limits, exec)
}

/// The same for an input that says how long it is, such as a file: the bytes are then moved no more than needed. The
/// number is a hint: it is taken from the memory budget and believed no further.
///
/// # Errors
/// As [`slurp`], and a budget that does not have as many bytes as the hint.
pub fn slurp_sized(mut reader: impl Read, bytes: u64, limits: &Limits, exec: &Exec) -> Result<Vec<u8>, ReadError> {
    const PIECE: u64 = 1 << 20;
    let hint = bytes.min(limits.max_bytes);
    let _room = exec.reserve(hint)?;
    // A byte more shows that the end was reached without growing.
    let mut bytes = Vec::with_capacity(if hint == 0 { 0 } else { usize::try_from(hint).unwrap_or(0) + 1 });
    loop {
        let piece = reader.by_ref().take(PIECE).read_to_end(&mut bytes);
        exec.check()?;
        match piece {
            Ok(0) => return Ok(bytes),
            Ok(_) if bytes.len() as u64 > limits.max_bytes => return Err(too_long(limits.max_bytes).into()),
            Ok(_) => {}
            Err(error) => {
                let place = Place::Byte(bytes.len() as u64);
                return Err(Fault::new("E-read-io", place, error.to_string(), "a readable input").into());
            }
        }
    }
}

pub(crate) fn too_long(max_bytes: u64) -> Box<Fault> {
    Fault::new("E-read-size", Place::Byte(max_bytes), "more bytes", format!("at most {max_bytes} bytes"))
        .category(Category::OverLimit)
        .advice("raise the limit on input size (--max-memory) if the input is trusted")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FORMATS;
    use shapeloom_core::{CancelFlag, Diagnostic, Stop};

    #[test]
    fn slurping_stops_at_the_limit() {
        let limits = Limits { max_bytes: 4, ..Limits::default() };
        assert_eq!(slurp(&b"abcd"[..], &limits, &Exec::default()).unwrap(), b"abcd");
        let error = slurp(std::io::repeat(7), &limits, &Exec::default()).unwrap_err();
        assert_eq!((error.code(), error.category()), ("E-read-size", Category::OverLimit));
        struct Broken;
        impl Read for Broken {
            fn read(&mut self, _: &mut [u8]) -> std::io::Result<usize> {
                Err(std::io::Error::other("the disk is gone"))
            }
        }
        let error = slurp(Broken, &limits, &Exec::default()).unwrap_err();
        assert_eq!(error.to_string(), "input: byte 0: found the disk is gone, expected a readable input (E-read-io)");
    }

    #[test]
    fn every_reader_keeps_limits_and_stops_when_cancelled() {
        let flag = CancelFlag::default();
        flag.cancel();
        let cancelled = ReadContext { exec: Exec::default().with_cancel(&flag), ..ReadContext::default() };
        let limits = Limits { max_bytes: 3, ..Limits::default() };
        let limited = ReadContext { limits, ..ReadContext::named("x") };
        for format in FORMATS.iter().filter(|format| format.reads.is_some()) {
            assert_eq!(read(b"", format, &cancelled), Err(Stop::Cancelled.into()), "{}", format.id);
            assert_eq!(read(b"1234", format, &limited).unwrap_err().code(), "E-read-size");
        }
    }

    #[test]
    fn formats_without_a_reader_say_so() {
        let error =
            read(b"v 0 0 0", &Format { reads: None, ..crate::obj::FORMAT }, &ReadContext::named("a.obj")).unwrap_err();
        assert_eq!(error.category(), Category::Unsupported);
        assert!(error.to_string().starts_with("a.obj: found a Wavefront OBJ file"), "{error}");
    }
}
