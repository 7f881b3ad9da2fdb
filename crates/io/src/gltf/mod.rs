//! glTF 2.0, after the specification of the Khronos Group: GLB, and JSON with buffers in data URIs or sibling files.
//! JSON is written with its one buffer in a data URI.
//!
//! Conventions, kept by reader and writer alike:
//!
//! - **Scene.** A part is a primitive under a node: placements are node matrices, multiplied along the hierarchy, and
//!   parts that share a geometry share its accessors. glTF has y up and lengths in metres, so a shape with z up or
//!   another unit is written under one root node that turns it (exactly) and scales it; what is read has y up, metres,
//!   and the root's turn in the placements.
//! - **Positions** are single precision. A geometry that would lose by this because it lies far from the origin is
//!   stored relative to a local origin, which goes into its node: see [`origin`]. The largest rounding is measured.
//! - **Texture coordinates** have v running up in shapes and down in glTF: `v = 1 - v'` both ways, in every set.
//! - **Colours** in floating columns are linear and stay; whole numbers are sRGB in shapes and linear in glTF.
//! - **Other columns** of numbers are application-specific attributes: column `heat` is `_heat`. Whole numbers of up to
//!   16 bits keep their type, larger ones become the narrowest type that holds the values, up to 2²⁴.
//! - **Materials of faces.** A mesh whose faces name materials is written as a mesh of one primitive a material, each with
//!   its own vertices. Every primitive is read as a part of its own.
//! - **Textures** are names of files in the folder of the document or below.
//! - **Wedges.** Vertices are split exactly where the values of the corners around them differ: see [`split`].

mod accessor;
mod allowance;
mod base64;
mod bin;
mod buffers;
mod by_material;
mod changes;
mod columns;
mod container;
mod document;
mod encode;
mod ignored;
mod json;
mod lines;
mod looks;
mod materials;
mod origin;
mod primitive;
mod read;
mod scene;
mod sparse;
mod split;
mod stored;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

const KINDS: &[Kind] = &[Kind::PointCloud, Kind::Polyline, Kind::GeometricGraph, Kind::TriMesh];

const KEEPS: &[Keeps] = &[
    Keeps::Normals,
    Keeps::Texcoords,
    Keeps::Colors,
    Keeps::VertexColumns,
    Keeps::Wedges,
    Keeps::Names,
    Keeps::Parts,
    Keeps::Instances,
    Keeps::Materials,
    Keeps::Units,
    Keeps::UpAxis,
];

/// glTF 2.0 in one binary file.
pub(crate) const GLB: Format = Format {
    id: "glb",
    name: "glTF 2.0 binary",
    extensions: &["glb"],
    media_type: "model/gltf-binary",
    text: false,
    up: Some(UpAxis::Y),
    precision: Precision::F32,
    kinds: KINDS,
    keeps: KEEPS,
    read_options: &[],
    write_options: &["instances"],
    sniff: |head| if head.starts_with(b"glTF") { Sniff::Certain } else { Sniff::No },
    reads: Some(read::read_glb),
    writes: Some(write::write_glb),
};

/// glTF 2.0 in JSON.
pub(crate) const GLTF: Format = Format {
    id: "gltf",
    name: "glTF 2.0 JSON",
    extensions: &["gltf"],
    media_type: "model/gltf+json",
    text: true,
    up: Some(UpAxis::Y),
    precision: Precision::F32,
    kinds: KINDS,
    keeps: KEEPS,
    read_options: &[],
    write_options: &["instances"],
    sniff: sniff_json,
    reads: Some(read::read_gltf),
    writes: Some(write::write_gltf),
};

/// An object that speaks of an asset.
fn sniff_json(input: &[u8]) -> Sniff {
    let head = crate::detect::head(input);
    let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
    let open = head.iter().find(|byte| !byte.is_ascii_whitespace()) == Some(&b'{');
    if open && head.windows(7).any(|word| word == b"\"asset\"") { Sniff::Likely } else { Sniff::No }
}
