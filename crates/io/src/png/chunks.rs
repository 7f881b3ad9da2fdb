//! The chunks of a file, checked before anything is decoded.

use shapeloom_core::{Findings, Place, Severity};

use super::calibration::{Calibration, PixelSize};
use crate::Fault;
use crate::text::quoted;

pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// What the chunks say beside the pixels.
#[derive(Debug)]
pub(super) struct Chunks {
    pub(super) columns: u32,
    pub(super) rows: u32,
    /// Bits of a pixel.
    pub(super) bits: u32,
    /// Where the header and the first piece of data begin.
    pub(super) header_at: u64,
    pub(super) data_at: u64,
    /// The bytes of all data.
    pub(super) data: u64,
    pub(super) calibration: Option<Calibration>,
    pub(super) pixel_size: Option<PixelSize>,
}

fn within(fault: Box<Fault>, kind: &[u8]) -> Box<Fault> {
    fault.within(format!("chunk {}", String::from_utf8_lossy(kind).escape_debug()))
}

fn number(bytes: &[u8]) -> u32 {
    bytes.iter().take(4).fold(0, |value, byte| value << 8 | u32::from(*byte))
}

impl Chunks {
    /// # Errors
    /// Another signature, a chunk that reaches past the end, a wrong sum of a chunk that is needed, no header or no data.
    pub(super) fn read(input: &[u8], findings: &mut Findings) -> Result<Self, Box<Fault>> {
        if !input.starts_with(SIGNATURE) {
            let cut = SIGNATURE.starts_with(input);
            let code = if cut { "E-png-truncated" } else { "E-png-magic" };
            let found = if cut { "the end of the file".to_owned() } else { quoted(&input[..input.len().min(8)]) };
            return Err(Fault::new(code, Place::Byte(0), found, "the mark of a PNG file"));
        }
        let mut header: Option<Self> = None;
        let mut at = SIGNATURE.len();
        loop {
            let place = Place::Byte(at as u64);
            let rest = &input[at.min(input.len())..];
            let (Some(length), Some(kind)) = (rest.get(..4), rest.get(4..8)) else {
                let found = "the end of the file";
                return Err(Fault::new("E-png-truncated", Place::Byte(input.len() as u64), found, "the chunk IEND"));
            };
            let length = number(length) as usize;
            let (Some(body), Some(sum)) = (rest.get(8..8 + length), rest.get(8 + length..12 + length)) else {
                let found = format!("a chunk of {length} bytes and {} bytes to the end", rest.len().saturating_sub(12));
                return Err(within(Fault::new("E-png-truncated", place, found, "the whole chunk"), kind));
            };
            // Letters in capitals mark what a reader must understand.
            let critical = kind[0].is_ascii_uppercase();
            let sound = crc32fast::hash(&rest[4..8 + length]) == number(sum);
            if !sound && critical {
                let fault = Fault::new("E-png-checksum", place, "a wrong checksum", "the checksum of what is there");
                return Err(within(fault, kind));
            }
            if !sound {
                let message = "chunks that are not needed have wrong checksums: they were passed over";
                findings.push("W-png-checksum", Severity::Warning, place.clone(), message);
            }
            at += 12 + length;
            let Some(chunks) = header.as_mut() else {
                if kind != b"IHDR" {
                    let fault = Fault::new("E-png-order", place, quoted(kind), "the chunk IHDR first");
                    return Err(within(fault, kind));
                }
                header = Some(Self::header(body, place)?);
                continue;
            };
            match kind {
                b"IDAT" => {
                    if chunks.data == 0 {
                        chunks.data_at = (at - 12 - length) as u64;
                    }
                    chunks.data += length as u64;
                }
                b"pCAL" if sound => chunks.calibration = Calibration::parse(body, place, findings),
                b"sCAL" if sound => chunks.pixel_size = PixelSize::parse(body, place, findings),
                b"IEND" => break,
                _ => {}
            }
        }
        let end = Place::Byte(input.len() as u64);
        let none = || Fault::new("E-png-truncated", end, "the end of the file", "a header and data");
        let chunks = header.filter(|chunks| chunks.data > 0).ok_or_else(none)?;
        if at < input.len() {
            let message = format!("{} bytes follow after the chunk IEND; they were not read", input.len() - at);
            findings.push("W-png-trailing", Severity::Warning, Place::Byte(at as u64), message);
        }
        Ok(chunks)
    }

    fn header(body: &[u8], place: Place) -> Result<Self, Box<Fault>> {
        let header_at = if let Place::Byte(at) = place { at } else { 0 };
        let fault =
            |found: String, expected: &str| within(Fault::new("E-png-header", place.clone(), found, expected), b"IHDR");
        let &[_, _, _, _, _, _, _, _, depth, color, compression, filter, interlace] = body else {
            return Err(fault(format!("{} bytes", body.len()), "a header of 13 bytes"));
        };
        let samples = match (color, depth) {
            (0, 1 | 2 | 4 | 8 | 16) | (3, 1 | 2 | 4 | 8) => 1,
            (2, 8 | 16) => 3,
            (4, 8 | 16) => 2,
            (6, 8 | 16) => 4,
            _ => return Err(fault(format!("colour type {color} with {depth} bits"), "one of the pairs that PNG has")),
        };
        if compression != 0 || filter != 0 || interlace > 1 {
            let found = format!("compression {compression}, filter {filter}, interlace {interlace}");
            return Err(fault(found, "0, 0, and 0 or 1"));
        }
        Ok(Self {
            columns: number(body),
            rows: number(&body[4..]),
            bits: samples * u32::from(depth),
            header_at,
            data_at: 0,
            data: 0,
            calibration: None,
            pixel_size: None,
        })
    }
}
