//! Samples without a header, which options describe: read.
//!
//! `--set dimensions=256x256x128 --set scalar=u16 --set byte_order=big --set skip=512 --set voxel_size=0.5x0.5x2`; the first
//! dimension is the fastest.

mod read;

pub(crate) use read::voxel_size;

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// Raw samples.
pub(crate) const FORMAT: Format = Format {
    id: "raw",
    name: "Raw volume, described by options",
    extensions: &["raw"],
    media_type: "application/octet-stream",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[],
    read_options: &["dimensions", "scalar", "byte_order", "skip", "voxel_size"],
    write_options: &[],
    sniff: |_| Sniff::No,
    reads: Some(read::read),
    writes: None,
};
