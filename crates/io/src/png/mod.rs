//! PNG pictures as heights: every depth and kind of colour read, 16 bits of grey written.
//!
//! The brighter the higher; transparent pixels are holes. Colours are heights only where the option `encoding` says how, as
//! in terrain tiles, or where they all are grey. What the registered chunks `pCAL` (calibration of samples) and `sCAL`
//! (their size in metres) say is heeded, and they are written, so that heights come back within half a step of 65535.

mod calibration;
mod chunks;
mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

/// PNG.
pub(crate) const FORMAT: Format = Format {
    id: "png",
    name: "PNG height map",
    extensions: &["png"],
    media_type: "image/png",
    text: false,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::HeightField],
    keeps: &[Keeps::UpAxis, Keeps::Units],
    read_options: &["encoding", "height", "spacing", "exaggeration", "stack", "voxel_size"],
    write_options: &[],
    sniff: |input| if input.starts_with(chunks::SIGNATURE) { Sniff::Certain } else { Sniff::No },
    reads: Some(read::read),
    writes: Some(write::write),
};
