//! USGS DEM, the elevation models of the United States Geological Survey in text: read.
//!
//! Blocks of 1024 bytes: a record A of fixed columns with the unit of places and heights, the quadrangle and the
//! resolution; for each profile a record B with its first place and its heights, from south to north; a record C that says
//! how exact all is, which is passed over (USGS, "Standards for Digital Elevation Models", part 2, 1998). Profiles begin and
//! end where the quadrangle does, so that corners of the grid are holes. Numbers may have Fortran's `D` for their exponent.

mod header;
mod read;
#[cfg(test)]
mod tests;

use shapeloom_shape::{Kind, UpAxis};

use crate::{Format, Keeps, Precision, Sniff};

/// USGS DEM.
pub(crate) const FORMAT: Format = Format {
    id: "dem",
    name: "USGS DEM",
    extensions: &["dem"],
    media_type: "application/octet-stream",
    text: true,
    up: Some(UpAxis::Z),
    precision: Precision::F64,
    kinds: &[Kind::HeightField],
    keeps: &[Keeps::UpAxis, Keeps::Units, Keeps::Names],
    read_options: &["exaggeration"],
    write_options: &[],
    sniff: |input| if header::looks_right(input) { Sniff::Certain } else { Sniff::No },
    reads: Some(read::read),
    writes: None,
};
