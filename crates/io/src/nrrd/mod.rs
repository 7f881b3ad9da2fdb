//! NRRD: a header in text and samples in raw bytes, gzip or text, in one file (`.nrrd`) or in files beside it (`.nhdr`),
//! of which it names one, lists several or gives the pattern: read, and written in one file.
//!
//! The first axis is the fastest. Directions are `space directions`, else `spacings`; the first sample is at `space origin`,
//! else at `axis mins`. The name of the space, such as `left-posterior-superior`, is a comment of the shape and written
//! again; coordinates stay as they are in it. The key `quantity` says whether samples are occupancy, density or a signed
//! distance, in files of this project.

mod data;
mod fields;
mod files;
mod frame;
mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// NRRD.
pub(crate) const FORMAT: Format = Format {
    id: "nrrd",
    name: "NRRD volume",
    extensions: &["nrrd", "nhdr"],
    media_type: "application/x-nrrd",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[Keeps::Units, Keeps::Comments],
    read_options: &[],
    write_options: &["compress"],
    sniff: |input| if input.starts_with(b"NRRD000") { Sniff::Certain } else { Sniff::No },
    reads: Some(read::read),
    writes: Some(write::write),
};

/// How a comment of the shape begins that names the space of its coordinates.
const SPACE: &str = "space: ";
