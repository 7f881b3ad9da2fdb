//! Colours in the two bytes at the end of a binary facet.
//!
//! STL has no colours, but two programs put them there, and others followed. VisCAM and SolidView: bit 15 says that
//! there is one; red, green and blue have five bits each, blue lowest. Materialise Magics: the header has `COLOR=` and
//! four bytes, the colour of the whole; bit 15 says that the facet has that one, else its own follows, red lowest. Five
//! bits become eight by the nearest fraction, and so the five come back as they were.

use shapeloom_core::{Findings, OverBudget, Place, Severity};
use shapeloom_mesh::{COLOR, Column, Values};

use super::{COUNT, FACET, HEADER};
use crate::memory::Memory;

/// The bit that says whether a facet has a colour of its own.
pub(super) const OWN: u16 = 1 << 15;

/// Eight bits from five.
fn widened(five: u16) -> u8 {
    ((u32::from(five & 31) * 255 + 15) / 31) as u8
}

/// Five bits from eight: the nearest fraction.
pub(super) fn narrowed(eight: u8) -> u16 {
    (u16::from(eight) * 31 + 127) / 255
}

/// The largest change of a channel, in units of eight bits, by which a colour is stored.
pub(super) fn rounding(eight: u8) -> u8 {
    widened(narrowed(eight)).abs_diff(eight)
}

/// The colour of the whole in the header of Materialise Magics.
fn whole_color(header: &[u8]) -> Option<[u8; 4]> {
    const MARK: &[u8] = b"COLOR=";
    let at = memchr::memmem::find(header, MARK)? + MARK.len();
    header.get(at..at + 4)?.try_into().ok()
}

/// Whether the header has a colour for facets.
pub(super) fn in_header(input: &[u8]) -> bool {
    input.get(..COUNT).is_some_and(|header| whole_color(header).is_some())
}

/// The face column of a binary file whose facets, or whose header, have colours.
pub(super) fn column(
    input: &[u8],
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<Option<Column>, OverBudget> {
    let (header, facets) = input.split_at(HEADER.min(input.len()));
    let words = facets.chunks_exact(FACET).map(|facet| u16::from_le_bytes([facet[FACET - 2], facet[FACET - 1]]));
    let count = facets.len() / FACET;
    let whole = header.get(..COUNT).and_then(whole_color);
    let channels = |word: u16| [word, word >> 5, word >> 10].map(widened);
    let (width, values) = match whole {
        Some([r, g, b, alpha]) => {
            let width = if alpha == u8::MAX { 3 } else { 4 };
            memory.take(count, width)?;
            let mut values = Vec::with_capacity(count * width);
            for word in words {
                let color = if word & OWN == 0 { channels(word) } else { [r, g, b] };
                values.extend_from_slice(&color);
                if width == 4 {
                    values.push(alpha);
                }
            }
            (width, values)
        }
        None => {
            memory.take(count, 3)?;
            let mut values = Vec::with_capacity(count * 3);
            let (mut without, mut first) = (0, 0);
            for (facet, word) in words.enumerate() {
                let [blue, green, red] = channels(word);
                if word & OWN == 0 {
                    first = if without == 0 { facet } else { first };
                    without += 1;
                    values.extend_from_slice(&[u8::MAX; 3]);
                } else {
                    values.extend_from_slice(&[red, green, blue]);
                }
            }
            if without > 0 {
                let place = Place::Byte((HEADER + first * FACET) as u64);
                let message = "facets without a colour among others that have one were taken as white";
                findings.push_many("W-stl-color", Severity::Note, place, message, without);
            }
            (3, values)
        }
    };
    Ok(Column::try_new(COLOR, width, Values::U8(values)).ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_bits_survive_eight() {
        for five in 0..32 {
            assert_eq!(narrowed(widened(five)), five);
        }
        assert_eq!((widened(0), widened(31), widened(16)), (0, 255, 132));
        // Halfway between two of 32 steps of 255/31.
        assert_eq!((0..=255).map(rounding).max(), Some(4));
    }
}
