//! PLY, written in binary little endian.
//!
//! Conventions: positions `x y z`, normals `nx ny nz`, texture coordinates `s t` with v running up, colours
//! `red green blue alpha` in bytes as sRGB; a column of another name is a property of that name, or `name_0`, `name_1`
//! and so on where it has several numbers. Faces are `vertex_indices`, and the texture coordinates of their corners the
//! customary list `texcoord`, two numbers a corner; segments of lines and edges of graphs are elements `edge`. Floating numbers are `float`
//! where that is exact, else `double`. Parts are put together where they are placed; a column is kept if every part has
//! it in the same type.

mod properties;
#[cfg(test)]
mod tests;
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
    keeps: &[Keeps::Normals, Keeps::Texcoords, Keeps::Colors, Keeps::VertexColumns, Keeps::FaceColumns],
    read_options: &[],
    write_options: &[],
    sniff: |head| {
        if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") { Sniff::Certain } else { Sniff::No }
    },
    reads: None,
    writes: Some(write::write),
};
