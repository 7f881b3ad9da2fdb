//! SVG: polylines of a plane as paths, written only.
//!
//! x goes to the right and y up: the file has y turned, as SVG counts it downward. z is left out. Each part is a path with its name as
//! title, closed ones end in `Z`; a view box holds them all with a margin. Where the shape has a unit, the picture has its size
//! in millimetres.

#[cfg(test)]
mod tests;
mod write;

use shapeloom_shape::Kind;

use crate::{Format, Keeps, Precision, Sniff};

/// Scalable Vector Graphics.
pub(crate) const FORMAT: Format = Format {
    id: "svg",
    name: "Scalable Vector Graphics",
    extensions: &["svg"],
    media_type: "image/svg+xml",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::Polyline],
    keeps: &[Keeps::Names, Keeps::Parts, Keeps::Units],
    read_options: &[],
    write_options: &[],
    sniff: |_| Sniff::No,
    reads: None,
    writes: Some(write::write),
};
