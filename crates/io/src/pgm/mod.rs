//! PGM, the grey pictures of Netpbm, as heights: text (`P2`) and binary (`P5`), of 8 and 16 bits, read.
//!
//! The largest value that the header says is white, whatever the picture has. Numbers of 16 bits begin with the high byte.
//! Comments run from `#` to the end of the line; in binary files they may stand in the header alone.

mod read;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

/// PGM.
pub(crate) const FORMAT: Format = Format {
    id: "pgm",
    name: "PGM height map",
    extensions: &["pgm", "pnm"],
    media_type: "image/x-portable-graymap",
    text: false,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::HeightField],
    keeps: &[Keeps::UpAxis],
    read_options: &["height", "spacing", "exaggeration"],
    write_options: &[],
    sniff,
    reads: Some(read::read),
    writes: None,
};

fn sniff(input: &[u8]) -> Sniff {
    match input {
        [b'P', b'2' | b'5', next, ..] if next.is_ascii_whitespace() || *next == b'#' => Sniff::Certain,
        _ => Sniff::No,
    }
}
