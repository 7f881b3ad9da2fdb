//! The table of formats.

use std::fmt;
use std::io::Write;

use shapeloom_core::Report;
use shapeloom_shape::{Kind, Shape, UpAxis};

use crate::{
    ReadContext, ReadError, ReadShape, WriteContext, WriteError, asc, bpt, dem, gltf, implicit_text, metaimage, nrrd,
    obj, off, pdb, pgm, ply, png, raw, slc, stl, svg, tiff, vti, vtk, xyz_molecule,
};

/// Reads a whole file. Errors need not name the input: [`read`](crate::read()) does.
pub type ReadFn = fn(&[u8], &ReadContext) -> Result<ReadShape, ReadError>;

/// Writes a whole file. The kinds of the parts are in [`Format::kinds`]: [`write()`](crate::write()) has checked.
pub type WriteFn = fn(&Shape, &WriteContext, &mut dyn Write) -> Result<Report, WriteError>;

/// What the first bytes of an input say about a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sniff {
    /// It is not this format.
    No,
    /// The content looks like it, and other formats may look the same.
    Likely,
    /// It begins with the format's own mark.
    Certain,
}

/// The numbers in which a format stores positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    /// Single precision.
    F32,
    /// Double precision, or decimal text of any length.
    F64,
}

impl Precision {
    /// The name: `f32` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// Something beyond positions and faces that a format can keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Keeps {
    /// Normals.
    Normals,
    /// Texture coordinates.
    Texcoords,
    /// Colours.
    Colors,
    /// Columns of any name on vertices.
    VertexColumns,
    /// Columns of any name on faces.
    FaceColumns,
    /// Columns of any name on the edges of graphs.
    EdgeColumns,
    /// Columns of lists.
    Lists,
    /// Values that differ between the faces around a vertex.
    Wedges,
    /// Part names.
    Names,
    /// Several parts.
    Parts,
    /// Placements of parts, and geometries shared between them.
    Instances,
    /// Materials.
    Materials,
    /// The unit of length, by convention or by word.
    Units,
    /// The up axis, by convention or by word.
    UpAxis,
    /// Rows that are no elements of a part.
    Tables,
    /// Comments.
    Comments,
}

impl Keeps {
    /// Everything, in the order of the documentation.
    pub const ALL: [Self; 16] = [
        Self::Normals,
        Self::Texcoords,
        Self::Colors,
        Self::VertexColumns,
        Self::FaceColumns,
        Self::EdgeColumns,
        Self::Lists,
        Self::Wedges,
        Self::Names,
        Self::Parts,
        Self::Instances,
        Self::Materials,
        Self::Units,
        Self::UpAxis,
        Self::Tables,
        Self::Comments,
    ];

    /// The name, in lower case with hyphens.
    pub fn name(self) -> &'static str {
        match self {
            Self::Normals => "normals",
            Self::Texcoords => "texcoords",
            Self::Colors => "colors",
            Self::VertexColumns => "vertex-columns",
            Self::FaceColumns => "face-columns",
            Self::EdgeColumns => "edge-columns",
            Self::Lists => "lists",
            Self::Wedges => "wedges",
            Self::Names => "names",
            Self::Parts => "parts",
            Self::Instances => "instances",
            Self::Materials => "materials",
            Self::Units => "units",
            Self::UpAxis => "up-axis",
            Self::Tables => "tables",
            Self::Comments => "comments",
        }
    }
}

impl fmt::Display for Keeps {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// A file format: all that choosing, reading, writing and documenting it needs.
#[derive(Debug)]
pub struct Format {
    /// The short name on command lines, lower case: `glb`.
    pub id: &'static str,
    /// The name for people: `glTF 2.0 binary`.
    pub name: &'static str,
    /// File name extensions without the dot, lower case, the customary one first.
    pub extensions: &'static [&'static str],
    /// The media type.
    pub media_type: &'static str,
    /// Whether files are text.
    pub text: bool,
    /// The up axis that the format implies; none where it says nothing.
    pub up: Option<UpAxis>,
    /// How positions are stored by the writer.
    pub precision: Precision,
    /// The kinds of representation that it can hold.
    pub kinds: &'static [Kind],
    /// What it keeps beside positions and faces.
    pub keeps: &'static [Keeps],
    /// The fields of [`ReadOptions`](crate::ReadOptions) that the reader heeds beside those that all heed.
    pub read_options: &'static [&'static str],
    /// The fields of [`WriteOptions`](crate::WriteOptions) that the writer heeds.
    pub write_options: &'static [&'static str],
    /// What the input says, above all its first bytes. No more than a few thousand are looked at.
    pub sniff: fn(&[u8]) -> Sniff,
    /// The reader, if there is one.
    pub reads: Option<ReadFn>,
    /// The writer, if there is one.
    pub writes: Option<WriteFn>,
}

impl Format {
    /// Whether the writer takes this kind of part.
    pub fn holds(&self, kind: Kind) -> bool {
        self.kinds.contains(&kind)
    }
}

/// Formats are the same when their ids are.
impl PartialEq for Format {
    fn eq(&self, other: &Self) -> bool {
        self.id == other.id
    }
}

/// Every format, in the order in which content is tried.
pub static FORMATS: &[Format] = &[
    gltf::GLB,
    gltf::GLTF,
    bpt::FORMAT,
    ply::FORMAT,
    obj::FORMAT,
    off::FORMAT,
    stl::FORMAT,
    png::FORMAT,
    tiff::FORMAT,
    pgm::FORMAT,
    asc::FORMAT,
    dem::FORMAT,
    nrrd::FORMAT,
    vti::FORMAT,
    vtk::FORMAT,
    metaimage::FORMAT,
    slc::FORMAT,
    raw::FORMAT,
    svg::FORMAT,
    pdb::FORMAT,
    xyz_molecule::FORMAT,
    implicit_text::VM,
    implicit_text::SHAPE,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_extensions_are_lower_case_and_unambiguous() {
        let mut seen = std::collections::HashSet::new();
        for format in FORMATS {
            assert!(format.reads.is_some() || format.writes.is_some(), "{}", format.id);
            assert!(!format.extensions.is_empty() && !format.kinds.is_empty(), "{}", format.id);
            assert!(format.media_type.contains('/'), "{}", format.id);
            for word in format.extensions {
                assert!(seen.insert(*word), "{word}");
                assert_eq!(word.to_ascii_lowercase(), *word);
            }
        }
    }

    #[test]
    fn no_format_is_sure_of_another_ones_mark() {
        let marks: [(&str, &[u8]); 13] = [
            ("glb", b"glTF\x02\0\0\0"),
            ("ply", b"ply\nformat ascii 1.0\n"),
            ("png", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"),
            ("tiff", b"II*\0\x08\0\0\0"),
            ("tiff", b"MM\0*\0\0\0\x08"),
            ("pgm", b"P5\n2 2\n255\n"),
            ("pgm", b"P2# made\n"),
            ("nrrd", b"NRRD0004\n"),
            ("vti", b"<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\""),
            ("vtk", b"# vtk DataFile Version 3.0\n"),
            ("mha", b"ObjectType = Image\nNDims = 3\n"),
            ("slc", b"11111\n66 66 66 8\n"),
            ("asc", b"NCOLS 3\nnrows 2\n"),
        ];
        for (id, mark) in marks {
            let sure: Vec<&str> = FORMATS
                .iter()
                .filter(|format| (format.sniff)(mark) == Sniff::Certain)
                .map(|format| format.id)
                .collect();
            assert_eq!(sure, [id]);
        }
    }
}
