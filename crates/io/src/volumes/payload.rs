//! The bytes of samples, plain or unpacked, piece by piece.

use std::borrow::Cow;

use flate2::bufread::GzDecoder;
use shapeloom_core::{Findings, Place, Severity};
use shapeloom_voxels::Samples;

use super::{Intake, Scalar, ZlibStream};
use crate::memory::Memory;
use crate::{Fault, ReadContext, ReadError};

/// Deflate gives at most about 1032 bytes for one.
pub(crate) const MOST_FROM_A_BYTE: u64 = 1032;

/// What there is to say of packed samples that end within their checksum.
pub(crate) const NO_CHECKSUM: &str =
    "the packed data end before their checksum: all samples are there, but nothing shows that they are right";

/// Where the bytes of samples are.
pub(crate) enum Packing {
    Plain,
    Gzip,
    Zlib,
}

/// The bytes of samples with where they come from.
pub(crate) struct Payload<'a> {
    pub(crate) bytes: Cow<'a, [u8]>,
    /// Where they begin in the input; none for those of another file.
    pub(crate) at: Option<u64>,
    /// What a message calls them: `payload`, or the name of their file.
    pub(crate) name: String,
}

/// How the bytes are to be read.
pub(crate) struct Coding {
    pub(crate) packing: Packing,
    pub(crate) scalar: Scalar,
    pub(crate) big: bool,
    /// How many bytes come before the samples once they are unpacked.
    pub(crate) skip: u64,
}

impl<'a> Payload<'a> {
    /// What follows in the input from an offset on.
    pub(crate) fn attached(input: &'a [u8], at: usize) -> Self {
        let at = at.min(input.len());
        Self { bytes: Cow::Borrowed(&input[at..]), at: Some(at as u64), name: "payload".into() }
    }

    pub(crate) fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    /// A place at an offset, if the bytes are a part of the input.
    pub(crate) fn place(&self, offset: u64) -> Place {
        self.at.map_or(Place::Whole, |at| Place::Byte(at + offset))
    }

    /// Passes over lines, as headers say that are put before other files.
    ///
    /// # Errors
    /// Fewer lines; the caller stopped.
    pub(crate) fn skip_lines(&mut self, lines: u64, context: &ReadContext) -> Result<(), ReadError> {
        let mut at = 0;
        for line in 0..lines {
            if line % 1024 == 0 {
                context.exec.check()?;
            }
            let Some(end) = memchr::memchr(b'\n', &self.bytes[at..]) else {
                let found = format!("the end of the data after {line} lines");
                return Err(self.fault("E-volume-truncated", self.len(), found, format!("{lines} lines")).into());
            };
            at += end + 1;
        }
        if at > 0 {
            self.at = self.at.map(|own| own + at as u64);
            self.bytes = match std::mem::take(&mut self.bytes) {
                Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[at..]),
                Cow::Owned(mut bytes) => {
                    bytes.drain(..at);
                    Cow::Owned(bytes)
                }
            };
        }
        Ok(())
    }

    /// An error with an offset among these bytes, made one of the input.
    pub(crate) fn moved(&self, error: ReadError) -> ReadError {
        match error {
            ReadError::Input(mut fault) => {
                if let Place::Byte(offset) = fault.place {
                    fault.place = self.place(offset);
                }
                ReadError::Input(fault)
            }
            other => other,
        }
    }

    fn fault(&self, code: &'static str, offset: u64, found: String, expected: String) -> Box<Fault> {
        Fault::new(code, self.place(offset), found, expected).within(self.name.clone())
    }

    /// As many samples as wanted.
    ///
    /// No more is unpacked than is needed, but for one byte that tells whether there is more.
    ///
    /// # Errors
    /// Too few bytes; more than needed after unpacking; damaged compression. More plain bytes are a finding.
    pub(crate) fn samples(
        &self,
        count: u64,
        coding: &Coding,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Samples, ReadError> {
        let mut intake = Intake::with_room(count, coding.scalar, memory)?;
        self.samples_into(&mut intake, count, coding, context, memory, findings)?;
        Ok(intake.finish(findings))
    }

    /// The same after the samples that are there already.
    ///
    /// # Errors
    /// As [`Payload::samples`].
    pub(crate) fn samples_into(
        &self,
        intake: &mut Intake,
        count: u64,
        coding: &Coding,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<(), ReadError> {
        let size = coding.scalar.size();
        if matches!(coding.packing, Packing::Plain) {
            let wanted = coding.skip.saturating_add(count.saturating_mul(size as u64));
            if self.len() < wanted {
                let found = format!("{} bytes", self.len());
                let expected = format!("{wanted} bytes for {count} samples of type {}", coding.scalar.name());
                return Err(self.fault("E-volume-truncated", self.len(), found, expected).into());
            }
            let own = &self.bytes[coding.skip as usize..wanted as usize];
            for piece in own.chunks(PIECE) {
                context.exec.check()?;
                context.exec.progress(intake.taken() as f64 / count.max(1) as f64);
                intake.bytes(piece, coding.big);
            }
            if self.len() > wanted {
                let message = format!("{} bytes follow after the last sample; they were not read", self.len() - wanted);
                findings.push("W-volume-trailing", Severity::Warning, self.place(wanted), message);
            }
            return Ok(());
        }
        // What inflating keeps, and a piece.
        memory.take(1, (1 << 17) + PIECE)?;
        let mut unpacked = Unpacked::new(&self.bytes, &coding.packing);
        let mut piece = vec![0u8; PIECE];
        let mut skip = coding.skip;
        let mut left = count.saturating_mul(size as u64);
        while skip > 0 || left > 0 {
            context.exec.check()?;
            context.exec.progress(intake.taken() as f64 / count.max(1) as f64);
            let most = if skip > 0 { skip } else { left }.min(PIECE as u64) as usize;
            let filled = self.fill(&mut unpacked, &mut piece[..most], context)?;
            if filled < most {
                let found = format!("the end of the data after {} complete samples", intake.taken());
                let expected = format!("{count} samples of type {}", coding.scalar.name());
                return Err(self.fault("E-volume-truncated", self.len(), found, expected).into());
            }
            if skip > 0 {
                skip -= most as u64;
            } else {
                intake.bytes(&piece[..most], coding.big);
                left -= most as u64;
            }
        }
        // This reads the checksum too.
        if self.fill(&mut unpacked, &mut piece[..1], context)? > 0 {
            let found = "more bytes after unpacking".to_owned();
            let expected = format!("{count} samples of type {}, as the header says", coding.scalar.name());
            return Err(self.fault("E-volume-trailing", unpacked.position(), found, expected).into());
        }
        if unpacked.cut {
            findings.push("W-volume-truncated", Severity::Warning, self.place(self.len()), NO_CHECKSUM);
        }
        let position = unpacked.position();
        if position < self.len() {
            let message =
                format!("{} bytes follow after the packed samples; they were not read", self.len() - position);
            findings.push("W-volume-trailing", Severity::Warning, self.place(position), message);
        }
        Ok(())
    }

    /// Fills a buffer as far as there are bytes.
    fn fill(&self, unpacked: &mut Unpacked<'_>, buffer: &mut [u8], context: &ReadContext) -> Result<usize, ReadError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match unpacked.read(&mut buffer[filled..]) {
                Ok(0) => {
                    context.exec.check()?;
                    if !unpacked.next_member() {
                        break;
                    }
                }
                Ok(more) => filled += more,
                Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
                    unpacked.cut = true;
                    break;
                }
                Err(error) => {
                    let expected = "sound compressed data".to_owned();
                    let fault = self.fault("E-volume-data", unpacked.position(), error.to_string(), expected);
                    return Err(fault.into());
                }
            }
        }
        Ok(filled)
    }
}

/// How many bytes become samples between two looks at whether to go on; a multiple of the size of all types.
const PIECE: usize = 1 << 16;

/// Compressed bytes.
struct Unpacked<'a> {
    decoder: Decoder<'a>,
    packed: usize,
    /// Whether they ended before the compression said so.
    cut: bool,
}

enum Decoder<'a> {
    Gzip(GzDecoder<&'a [u8]>),
    Zlib(ZlibStream<'a>),
}

impl<'a> Unpacked<'a> {
    fn new(bytes: &'a [u8], packing: &Packing) -> Self {
        let decoder = match packing {
            Packing::Zlib => Decoder::Zlib(ZlibStream::new(bytes)),
            Packing::Gzip | Packing::Plain => Decoder::Gzip(GzDecoder::new(bytes)),
        };
        Self { decoder, packed: bytes.len(), cut: false }
    }

    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        use std::io::Read;
        match &mut self.decoder {
            Decoder::Gzip(decoder) => decoder.read(buffer),
            Decoder::Zlib(stream) => stream.read(buffer),
        }
    }

    /// Goes on with the next member of a gzip file, if there is one.
    fn next_member(&mut self) -> bool {
        match &mut self.decoder {
            Decoder::Gzip(decoder) if decoder.get_ref().starts_with(&[0x1f, 0x8b]) => {
                *decoder = GzDecoder::new(*decoder.get_ref());
                true
            }
            _ => false,
        }
    }

    /// How many packed bytes were read.
    fn position(&self) -> u64 {
        let left = match &self.decoder {
            Decoder::Gzip(decoder) => decoder.get_ref().len(),
            Decoder::Zlib(stream) => stream.rest().len(),
        };
        (self.packed - left) as u64
    }
}
