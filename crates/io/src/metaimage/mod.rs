//! MetaImage: a header of `Key = value` lines, with the samples after it (`.mha`) or in a file beside it (`.mhd`): read, and
//! written in one file.
//!
//! The first axis is the fastest. Of `TransformMatrix` three numbers each are the direction of an axis, of length 1; the
//! first sample is at `Offset`. Coordinates stay as they are written; `AnatomicalOrientation`, which only describes them, is
//! kept as a comment.

mod header;
mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// MetaImage.
pub(crate) const FORMAT: Format = Format {
    id: "mha",
    name: "MetaImage volume",
    extensions: &["mha", "mhd"],
    media_type: "application/x-metaimage",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[Keeps::Units, Keeps::Comments],
    read_options: &[],
    write_options: &["compress"],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

/// A known key in the first line that is not blank.
fn sniff(input: &[u8]) -> Sniff {
    let mut lines = crate::detect::head(input).split(|byte| matches!(byte, b'\n' | b'\r'));
    let first = lines.find(|line| !line.trim_ascii().is_empty()).unwrap_or_default();
    let key = memchr::memchr(b'=', first).map(|equals| first[..equals].trim_ascii());
    match key {
        Some(b"ObjectType" | b"NDims") => Sniff::Certain,
        Some(b"Comment") => Sniff::Likely,
        _ => Sniff::No,
    }
}
