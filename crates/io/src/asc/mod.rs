//! ESRI ASCII grids: heights in text with their places, read and written.
//!
//! A header of keywords, then the samples from the northern row on, wherever lines end. Samples are the middles of cells:
//! `xllcorner` and `yllcorner` are half a cell to the south-west of the first one, `xllcenter` and `yllcenter` are its
//! place. Without the word `NODATA_value` it is -9999, as ESRI has it.

mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

/// ESRI ASCII grid.
pub(crate) const FORMAT: Format = Format {
    id: "asc",
    name: "ESRI ASCII grid",
    extensions: &["asc"],
    media_type: "text/plain",
    text: true,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::HeightField],
    keeps: &[Keeps::UpAxis],
    read_options: &["exaggeration"],
    write_options: &[],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

/// A word of the header and a number, then another such word.
fn sniff(input: &[u8]) -> Sniff {
    let mut words = crate::detect::head(input).split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    let mut known = || words.next().is_some_and(|word| read::Key::from_word(word).is_some());
    let first = known();
    let number = words.next().is_some_and(|word| crate::text::parse_number(word).is_ok());
    let mut known = || words.next().is_some_and(|word| read::Key::from_word(word).is_some());
    if first && number && known() { Sniff::Certain } else { Sniff::No }
}
