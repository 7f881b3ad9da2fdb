//! STL: triangles without order, in text or in binary little endian, read and written.
//!
//! Conventions: corners at exactly the same position are one vertex of what is read, unless
//! [`weld`](crate::ReadOptions) is off; stored normals are not kept, since corners say them. Each solid of a text is a
//! part. Colours of binary facets are a face column in bytes: see [`color`].

mod ascii;
mod binary;
mod color;
mod read;
#[cfg(test)]
mod tests;
mod weld;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// STL.
pub(crate) const FORMAT: Format = Format {
    id: "stl",
    name: "STL",
    extensions: &["stl"],
    media_type: "model/stl",
    text: false,
    up: None,
    precision: Precision::F32,
    kinds: &[Kind::TriMesh],
    keeps: &[Keeps::Colors, Keeps::Names, Keeps::Parts],
    read_options: &["weld"],
    write_options: &["encoding"],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

/// Bytes before the facets of a binary file: a comment of 80, then the number of facets.
const HEADER: usize = 84;

/// Where in the header the number of facets is.
const COUNT: usize = 80;

/// Bytes of a binary facet: a normal and three corners in single precision, and two bytes of which some programs make a
/// colour.
const FACET: usize = 50;

/// A text with facets or the end of a solid, or a file of exactly the length that its count says.
fn sniff(input: &[u8]) -> Sniff {
    if binary::length_fits(input) || (ascii::begins(input) && ascii::goes_on(input)) {
        Sniff::Likely
    } else {
        Sniff::No
    }
}
