//! OFF, Geomview's object file format: polygons over shared vertices, in text or in binary big endian, read and written.
//!
//! Conventions: colours in whole numbers are sRGB bytes and stay bytes; colours in fractions are taken as linear, as they
//! are, so that they come back in the same bits. Geomview says nothing of their meaning. An index into a colour map is
//! the face column [`COLORMAP`].

mod binary;
mod body;
mod color;
mod counts;
mod header;
mod rows;
#[cfg(test)]
mod tests;
mod text;
mod write;

use shapeloom_core::Loss;
use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, ReadContext, ReadError, ReadShape, Sniff};

/// OFF.
pub(crate) const FORMAT: Format = Format {
    id: "off",
    name: "Geomview OFF",
    extensions: &["off"],
    media_type: "model/vnd.off",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::PointCloud, Kind::PolyMesh, Kind::TriMesh],
    keeps: &[Keeps::Normals, Keeps::Texcoords, Keeps::Colors],
    read_options: &[],
    write_options: &["encoding"],
    sniff: |input| if header::begins(crate::detect::head(input)) { Sniff::Certain } else { Sniff::No },
    reads: Some(read),
    writes: Some(write::write),
};

/// The face column of indices into a colour map that the file does not have.
const COLORMAP: &str = "colormap";

/// What a face without an index has in that column.
const NO_INDEX: u32 = u32::MAX;

fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let unmarked = input.strip_prefix(b"\xef\xbb\xbf").unwrap_or(input);
    match header::binary_body(unmarked) {
        Some((header, body)) => binary::read(unmarked, &header, body, context),
        None => {
            let mut read = text::read(input, context)?;
            if memchr::memchr(b'#', input).is_some() {
                read.losses
                    .push(Loss::new("comments", "those of OFF stand between rows, for which shapes have no place"));
            }
            Ok(read)
        }
    }
}
