//! VTI, the image data of VTK in XML: samples in text, in base64 inside the elements, or appended raw or in base64, plain
//! or compressed by zlib: read, and written with raw samples appended.
//!
//! The array that `Scalars` names is read, else the first of one component; of points, or of cells where points have none:
//! then samples are the middles of cells. Sample `(i, j, k)` of the extent is at the origin plus the direction matrix times
//! `(i, j, k)` times the spacing. Arrays named `occupancy` and `signed-distance` are what their names say.

mod blocks;
mod read;
#[cfg(test)]
mod tests;
mod write;
mod xml;

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// VTK image data in XML.
pub(crate) const FORMAT: Format = Format {
    id: "vti",
    name: "VTK XML image data",
    extensions: &["vti"],
    media_type: "application/x-vtk-image",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::VoxelGrid],
    keeps: &[],
    read_options: &[],
    write_options: &[],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

fn sniff(input: &[u8]) -> Sniff {
    let head = &input[..input.len().min(4096)];
    let Some(at) = memchr::memmem::find(head, b"<VTKFile") else { return Sniff::No };
    let tag = &head[at..at + memchr::memchr(b'>', &head[at..]).unwrap_or(head.len() - at)];
    if memchr::memmem::find(tag, b"ImageData").is_some() { Sniff::Certain } else { Sniff::No }
}
