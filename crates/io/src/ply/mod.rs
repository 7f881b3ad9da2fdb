//! PLY, read and written as text and in both binary orders.
//!
//! Conventions: positions `x y z`, normals `nx ny nz`, texture coordinates `s t` with v running up, colours
//! `red green blue alpha`, whole numbers as they are and fractions in sRGB; a column of another name is a property of
//! that name, or `name_0`, `name_1` and so on where it has several numbers, and a column of lists a list. Faces are
//! `vertex_indices`, and the texture coordinates of their corners the customary list `texcoord`, two numbers a corner;
//! segments of lines and edges of graphs are elements `edge`. Every other element is a table. Parts are put together
//! where they are placed; a column is kept if every part has it in the same type.
//!
//! A file is read in three steps: the header says what there is; each element gets a plan of what its properties become;
//! its rows are decoded, column by column where they are binary, line by line where they are text. At last the shape is
//! built from what the elements hold.

mod ascii;
mod binary;
mod build;
mod color;
mod encode;
mod header;
mod plan;
mod properties;
mod read;
#[cfg(test)]
mod read_tests;
mod rows;
mod shared;
mod strips;
#[cfg(test)]
mod tests;
mod types;
mod words;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// PLY.
pub(crate) const FORMAT: Format = Format {
    id: "ply",
    name: "Stanford PLY",
    extensions: &["ply"],
    media_type: "model/x-ply",
    text: false,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::PointCloud, Kind::Polyline, Kind::GeometricGraph, Kind::PolyMesh, Kind::TriMesh],
    keeps: &[
        Keeps::Normals,
        Keeps::Texcoords,
        Keeps::Colors,
        Keeps::VertexColumns,
        Keeps::FaceColumns,
        Keeps::EdgeColumns,
        Keeps::Lists,
        Keeps::Tables,
        Keeps::Comments,
    ],
    read_options: &[],
    write_options: &["encoding"],
    sniff: |head| {
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") { Sniff::Certain } else { Sniff::No }
    },
    reads: Some(read::read),
    writes: Some(write::write),
};
