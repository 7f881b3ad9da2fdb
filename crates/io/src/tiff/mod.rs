//! TIFF and GeoTIFF as heights: whole numbers and floating ones of 8 to 64 bits, in both byte orders, in strips and tiles,
//! plain or compressed by LZW, deflate or PackBits: read.
//!
//! Unsigned numbers are a picture, whose white the option `height` says, unless the file says where it lies on the Earth or
//! what has no data: then they are heights, as are signed and floating numbers always. Of the tags of GeoTIFF (OGC 19-008r4,
//! 2019) the distance of samples, the place of one of them, and whether places are degrees are read.

mod geo;
#[cfg(test)]
mod piece_tests;
mod pieces;
mod read;
mod source;
#[cfg(test)]
mod tests;
mod words;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

/// TIFF.
pub(crate) const FORMAT: Format = Format {
    id: "tiff",
    name: "TIFF and GeoTIFF height map",
    extensions: &["tif", "tiff"],
    media_type: "image/tiff",
    text: false,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::HeightField],
    keeps: &[Keeps::UpAxis, Keeps::Units],
    read_options: &["encoding", "height", "spacing", "exaggeration", "stack", "voxel_size"],
    write_options: &[],
    sniff: |input| match input {
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Sniff::Certain,
        _ => Sniff::No,
    },
    reads: Some(read::read),
    writes: None,
};
