//! The bytes of an array: a count of them, or compressed blocks behind a table of their sizes.

use std::io::ErrorKind;

use shapeloom_core::{Findings, Place, Severity};
use shapeloom_voxels::Samples;

use crate::memory::Memory;
use crate::volumes::{Intake, MOST_FROM_A_BYTE, NO_CHECKSUM, Scalar, ZlibStream};
use crate::{Fault, ReadContext, ReadError};

/// The bytes of a checksum.
const CHECKSUM: usize = 4;

/// How the file writes counts and numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) big: bool,
    /// The bytes of a count: 4 or 8.
    pub(super) count_size: usize,
    pub(super) compressed: bool,
}

/// The bytes of an array with the place where they begin, and whether other things follow them.
pub(super) struct Stored<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) place: Place,
    /// Whether nothing else follows.
    pub(super) alone: bool,
    pub(super) within: String,
}

impl Layout {
    fn count(self, bytes: &[u8]) -> Option<u64> {
        let bytes = bytes.get(..self.count_size)?;
        let digit = |value: u64, byte: &u8| value << 8 | u64::from(*byte);
        Some(if self.big { bytes.iter().fold(0, digit) } else { bytes.iter().rev().fold(0, digit) })
    }
}

impl Stored<'_> {
    fn fault(&self, code: &'static str, found: String, expected: String) -> Box<Fault> {
        Fault::new(code, self.place.clone(), found, expected).within(self.within.clone())
    }

    /// The size that an array may have: of bytes of this kind as many as they unpack to.
    pub(super) fn most(&self, layout: Layout) -> u64 {
        let bytes = self.bytes.len() as u64;
        if layout.compressed { bytes.saturating_mul(MOST_FROM_A_BYTE) } else { bytes }
    }

    /// As many samples as wanted.
    pub(super) fn samples(
        &self,
        count: u64,
        scalar: Scalar,
        layout: Layout,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Samples, ReadError> {
        let wanted = count.saturating_mul(scalar.size() as u64);
        let mut intake = Intake::with_room(count, scalar, memory)?;
        let used = if layout.compressed {
            self.unpack(wanted, layout, &mut intake, context, memory, findings)?
        } else {
            let said = layout.count(self.bytes);
            let said = said.ok_or_else(|| self.short("the number of bytes of the array"))?;
            if said != wanted {
                let found = format!("{said} bytes");
                let expected = format!("{wanted} for {count} samples of type {}", scalar.name());
                return Err(self.fault("E-vti-length", found, expected).into());
            }
            let data = self.bytes[layout.count_size..].get(..usize::try_from(wanted).unwrap_or(usize::MAX));
            let data = data.ok_or_else(|| self.short(&format!("{wanted} bytes of samples")))?;
            for piece in data.chunks(1 << 16) {
                context.exec.check()?;
                context.exec.progress(intake.taken() as f64 / count.max(1) as f64);
                intake.bytes(piece, layout.big);
            }
            layout.count_size + data.len()
        };
        if self.alone && used < self.bytes.len() {
            let message = format!("{} bytes follow after the samples; they were not read", self.bytes.len() - used);
            findings.push("W-volume-trailing", Severity::Warning, self.place.clone(), message);
        }
        Ok(intake.finish(findings))
    }

    fn short(&self, expected: &str) -> Box<Fault> {
        let found = format!("the end of the data after {} bytes", self.bytes.len());
        self.fault("E-volume-truncated", found, expected.to_owned())
    }

    /// The blocks one after another; returns how many bytes they and their table take.
    fn unpack(
        &self,
        wanted: u64,
        layout: Layout,
        intake: &mut Intake,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<usize, ReadError> {
        let size = layout.count_size;
        let table = |at: u64| {
            let at = usize::try_from(at).ok()?.checked_mul(size)?;
            layout.count(self.bytes.get(at..)?)
        };
        let (Some(blocks), Some(block), Some(last)) = (table(0), table(1), table(2)) else {
            return Err(self.short("a table of blocks").into());
        };
        let whole = if last == 0 { blocks } else { blocks.saturating_sub(1) };
        let said = u128::from(whole) * u128::from(block) + u128::from(if blocks == 0 { 0 } else { last });
        if said != u128::from(wanted) {
            let found = format!("{blocks} blocks of {block} bytes, the last of {last}");
            return Err(self.fault("E-vti-length", found, format!("{wanted} bytes in all")).into());
        }
        let data = blocks.checked_add(3).and_then(|counts| counts.checked_mul(size as u64));
        let data = data.and_then(|data| usize::try_from(data).ok()).filter(|data| *data <= self.bytes.len());
        let mut at = data.ok_or_else(|| self.short(&format!("the sizes of {blocks} blocks")))?;
        // What inflating keeps, and a piece that never ends within a number.
        memory.take(1, (1 << 16) + (1 << 17))?;
        let mut piece = vec![0u8; 1 << 16];
        let (mut filled, mut cut) = (0, 0);
        for number in 0..blocks {
            let packed = table(3 + number).and_then(|packed| usize::try_from(packed).ok());
            let rest = &self.bytes[at..];
            let bytes = packed.and_then(|packed| match rest.get(..packed) {
                // All but a part of the last checksum may be there.
                None if number + 1 == blocks && packed - rest.len() <= CHECKSUM => Some(rest),
                own => own,
            });
            let bytes = bytes.ok_or_else(|| self.short(&format!("{blocks} blocks, of which {number} are there")))?;
            at += bytes.len();
            let mut left = if number + 1 == blocks && last > 0 { last } else { block };
            let mut stream = ZlibStream::new(bytes);
            let broken = |found: String| {
                let fault = self.fault("E-volume-data", found, "sound compressed data".to_owned());
                let within = fault.within.clone().unwrap_or_default();
                fault.within(format!("{within}, block {number}"))
            };
            let early = |left: u64| ReadError::from(broken(format!("the end of the block, {left} bytes too early")));
            loop {
                context.exec.check()?;
                let most = (piece.len() - filled).min(usize::try_from(left).unwrap_or(usize::MAX));
                if most == 0 && left > 0 {
                    intake.bytes(&piece, layout.big);
                    filled = 0;
                    continue;
                }
                if left == 0 {
                    // The checksum is read with the end.
                    let mut beyond = [0u8];
                    match stream.read(&mut beyond) {
                        Ok(0) => break,
                        Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                            cut += 1;
                            break;
                        }
                        Ok(_) => {
                            let found = "a block with more bytes than the table says".to_owned();
                            return Err(self.fault("E-volume-trailing", found, format!("{block} bytes")).into());
                        }
                        Err(error) => return Err(broken(error.to_string()).into()),
                    }
                }
                match stream.read(&mut piece[filled..filled + most]) {
                    Ok(0) => return Err(early(left)),
                    Ok(more) => {
                        filled += more;
                        left -= more as u64;
                    }
                    Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Err(early(left)),
                    Err(error) => return Err(broken(error.to_string()).into()),
                }
            }
        }
        if cut > 0 {
            findings.push_many("W-volume-truncated", Severity::Warning, self.place.clone(), NO_CHECKSUM, cut);
        }
        intake.bytes(&piece[..filled], layout.big);
        Ok(at)
    }
}
