//! SLC, the volumes of VolVis: bytes, plain or in run lengths slice by slice: read.
//!
//! Five lines of numbers: the mark 11111; the numbers of samples and the bits of one, 8; their distances; the unit, the
//! origin of the data, what was done to them, and 1 for run lengths; the size of a picture of three bytes a pixel that comes
//! before the samples. Each packed slice is its number of bytes, an `X`, and runs: a byte below 128 says how often the next
//! one is repeated, one above says how many follow as they are, less 128; 0 ends the slice.

mod read;

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// SLC.
pub(crate) const FORMAT: Format = Format {
    id: "slc",
    name: "SLC volume",
    extensions: &["slc"],
    media_type: "application/x-slc",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[],
    read_options: &[],
    write_options: &[],
    sniff: |input| match input {
        [b'1', b'1', b'1', b'1', b'1', b'\n' | b'\r' | b' ', ..] => Sniff::Certain,
        _ => Sniff::No,
    },
    reads: Some(read::read),
    writes: None,
};
