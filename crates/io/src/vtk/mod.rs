//! Legacy VTK files of structured points, in text and in binary: read, and written in binary.
//!
//! Binary numbers are big endian. The first `SCALARS` of one component is read, or the first such array of a `FIELD`; of
//! points, else of cells: then samples are the middles of cells. Arrays named `occupancy` and `signed-distance` are what
//! their names say. The format has no directions: axes run along those of space. Its title, the second line, is a comment of
//! the shape; of several comments the first is written.

mod read;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// The title of files of shapes that have no comment.
const NO_TITLE: &str = "shapeloom";

/// Legacy VTK.
pub(crate) const FORMAT: Format = Format {
    id: "vtk",
    name: "Legacy VTK structured points",
    extensions: &["vtk"],
    media_type: "application/x-vtk",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[Keeps::Comments],
    read_options: &[],
    write_options: &[],
    sniff: |input| if input.starts_with(b"# vtk DataFile Version") { Sniff::Certain } else { Sniff::No },
    reads: Some(read::read),
    writes: Some(write::write),
};
