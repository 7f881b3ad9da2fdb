//! The strips or tiles of an image, and whether the file has them.

use shapeloom_core::{Findings, Place, Severity};
use tiff::decoder::{ChunkType, Decoder};
use tiff::tags::Tag;

use super::read::{MOST_FROM_A_BYTE, told};
use super::source::Source;
use crate::memory::Memory;
use crate::{Fault, ReadError};

/// The number of a compression that is none.
const PLAIN: u16 = 1;

/// Strips or tiles that are where the file says.
pub(super) struct Pieces {
    pub(super) tiles: bool,
    pub(super) count: u32,
    /// The columns and rows of one.
    pub(super) wide: u32,
    pub(super) high: u32,
    /// Where each begins, and how many bytes the file says it has.
    places: Vec<(u64, u64)>,
    length_name: &'static str,
    file: u64,
}

impl Pieces {
    /// Checks what the tags say of each strip or tile that has samples, before memory is taken for any.
    ///
    /// More bytes than needed are fine, as some programs write the length of a buffer; where they run past the end of the
    /// file, that is a finding.
    ///
    /// # Errors
    /// One that begins outside of the file, or has fewer bytes than its samples need.
    pub(super) fn check(
        decoder: &mut Decoder<Source<'_>>,
        (columns, rows): (u32, u32),
        bits: u8,
        file: u64,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Self, ReadError> {
        let tiles = decoder.get_chunk_type() == ChunkType::Tile;
        let (wide, high) = decoder.chunk_dimensions();
        let mut number = |tag: Tag| decoder.find_tag_unsigned::<u16>(tag).ok().flatten();
        let plain = number(Tag::Compression).unwrap_or(PLAIN) == PLAIN;
        let planar = number(Tag::PlanarConfiguration) == Some(2);
        let channels = if planar { 1 } else { number(Tag::SamplesPerPixel).unwrap_or(1) };
        let pixel = u64::from(channels).saturating_mul(u64::from(bits)) / 8;
        let tags = if tiles {
            [(Tag::TileOffsets, "TileOffsets"), (Tag::TileByteCounts, "TileByteCounts")]
        } else {
            [(Tag::StripOffsets, "StripOffsets"), (Tag::StripByteCounts, "StripByteCounts")]
        };
        let [(offset_tag, offset_name), (length_tag, length_name)] = tags;
        let offsets = decoder.get_tag_u64_vec(offset_tag).map_err(told)?;
        memory.take(offsets.len(), 3 * size_of::<(u64, u64)>())?;
        let lengths = decoder.get_tag_u64_vec(length_tag).map_err(told)?;
        let places: Vec<(u64, u64)> = offsets.into_iter().zip(lengths).collect();
        let count = u32::try_from(places.len()).unwrap_or(u32::MAX);
        let pieces = Self { tiles, count, wide, high, places, length_name, file };
        let (mut beyond, mut first) = (0u64, 0);
        for (piece, &(offset, length)) in pieces.places.iter().enumerate() {
            // The last strip ends with the image; tiles are whole.
            let top = if tiles { 0 } else { (piece as u64).saturating_mul(high.into()) };
            let (wide, high) = if tiles { (wide, u64::from(high)) } else { (columns, u64::from(high)) };
            let high = if tiles { high } else { high.min(u64::from(rows).saturating_sub(top)) };
            let bytes = u64::from(wide).saturating_mul(high).saturating_mul(pixel);
            let wrong = |tag: &str, found: String, expected: String| {
                let within = format!("image 0, {} {piece}, {tag}", pieces.word());
                Fault::new("E-tiff-strip", Place::Whole, found, expected).within(within)
            };
            if bytes == 0 {
                continue;
            }
            if offset < 8 || offset >= file {
                let expected = format!("a place after the header and before the end, byte {file}");
                return Err(wrong(offset_name, format!("byte {offset}"), expected).into());
            }
            let least = if plain { bytes } else { bytes.div_ceil(MOST_FROM_A_BYTE) };
            let samples = || format!("{wide} × {high} pixels");
            if length < least {
                let expected = format!("at least {least} for {}", samples());
                return Err(wrong(length_name, format!("{length} bytes"), expected).into());
            }
            if least > file - offset {
                let found = format!("byte {offset}, {} bytes before the end of the file", file - offset);
                let expected = format!("at least {least} bytes for {}", samples());
                return Err(wrong(offset_name, found, expected).into());
            }
            if length > file - offset {
                first = if beyond == 0 { piece } else { first };
                beyond += 1;
            }
        }
        if beyond > 0 {
            let word = pieces.word();
            let message = format!(
                "{length_name} of {word} {first} runs past the end of the file, though the {word} may well be whole; only \
                 what is needed was read"
            );
            findings.push_many("W-tiff-strip", Severity::Warning, Place::Whole, message, beyond);
        }
        Ok(pieces)
    }

    /// Where the bytes of one end by what the file says.
    pub(super) fn end(&self, piece: u32) -> u64 {
        self.places.get(piece as usize).map_or(u64::MAX, |&(offset, length)| offset.saturating_add(length))
    }

    /// Data that end within the pixels of one: its number of bytes is too small, or the file was cut off.
    pub(super) fn cut_off(&self, piece: u32) -> Box<Fault> {
        let length = self.places.get(piece as usize).map_or(0, |&(_, length)| length);
        let within = format!("image 0, {} {piece}", self.word());
        if self.end(piece) < self.file {
            let found = format!("{length} bytes, after which pixels are missing");
            let fault = Fault::new("E-tiff-strip", Place::Whole, found, "as many bytes as its pixels take");
            fault.within(format!("{within}, {}", self.length_name))
        } else {
            Fault::new("E-tiff-truncated", Place::Whole, "the end of the data", "all strips and tiles").within(within)
        }
    }

    /// What one is called.
    pub(super) fn word(&self) -> &'static str {
        if self.tiles { "tile" } else { "strip" }
    }
}
