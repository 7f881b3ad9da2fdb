//! Wavefront OBJ, read and written.
//!
//! Conventions: decimal numbers are the shortest that read back to the same bits; texture coordinates have v running
//! up; colours follow the position as fractions in sRGB; each part is an object `o`; lines are `l`, points `p`. Groups,
//! smoothing groups and materials of faces are columns. Texture coordinates and normals that are equal bit by bit are
//! written once in a file; materials go into a library beside it.

mod assemble;
mod columns;
mod freeform;
mod labels;
mod mtl;
mod owners;
mod read;
#[cfg(test)]
mod read_tests;
mod sides;
mod statements;
#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::text::{Text, parse_number};
use crate::{Format, Keeps, Precision, Sniff};

/// The word of programs for no material.
const NO_MATERIAL: &str = "(null)";

/// Wavefront OBJ.
pub(crate) const FORMAT: Format = Format {
    id: "obj",
    name: "Wavefront OBJ",
    extensions: &["obj"],
    media_type: "model/obj",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::PointCloud, Kind::Polyline, Kind::GeometricGraph, Kind::PolyMesh, Kind::TriMesh],
    keeps: &[
        Keeps::Normals,
        Keeps::Texcoords,
        Keeps::Colors,
        Keeps::Wedges,
        Keeps::Names,
        Keeps::Parts,
        Keeps::Materials,
    ],
    read_options: &[],
    write_options: &[],
    sniff,
    reads: Some(read::read),
    writes: Some(write::write),
};

/// Only lines that OBJ has, and a vertex among them. The last line may be cut off.
fn sniff(input: &[u8]) -> Sniff {
    let head = crate::detect::head(input);
    const WORDS: [&[u8]; 14] =
        [b"v", b"vt", b"vn", b"vp", b"f", b"l", b"p", b"o", b"g", b"s", b"mtllib", b"usemtl", b"usemap", b"end"];
    let Ok(text) = Text::try_new(head, &Default::default()) else {
        return Sniff::No;
    };
    let mut lines = text.lines();
    let mut vertices = 0;
    while let Ok(Some(line)) = lines.next_line() {
        if lines.remaining() == 0 && vertices > 0 {
            break;
        }
        let mut words = line.bytes.split(|byte| byte.is_ascii_whitespace()).filter(|word| !word.is_empty());
        match words.next() {
            None => {}
            Some(word) if word.starts_with(b"#") => {}
            Some(b"v") => {
                if words.filter(|word| parse_number(word).is_ok()).count() < 3 {
                    return Sniff::No;
                }
                vertices += 1;
            }
            Some(word) if WORDS.contains(&word) => {}
            Some(_) => return Sniff::No,
        }
    }
    if vertices > 0 { Sniff::Likely } else { Sniff::No }
}
