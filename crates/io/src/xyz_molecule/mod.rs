//! XYZ files of molecules: a count, a comment, then an element and a place a line, read.
//!
//! The same ending stands for plain lists of points: [`looks_like_xyz_molecule`] tells them apart. Of several frames the first is read.
//! Columns after the place (charges, speeds) are passed over.

mod read;
#[cfg(test)]
mod tests;

pub use read::{looks_like_xyz_molecule, read_xyz_molecule};

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// XYZ molecule.
pub(crate) const FORMAT: Format = Format {
    id: "molecule-xyz",
    name: "XYZ molecule",
    extensions: &["xyz"],
    media_type: "chemical/x-xyz",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::Implicit],
    keeps: &[],
    read_options: &["blobbiness", "atom_scale"],
    write_options: &[],
    sniff: |input| if looks_like_xyz_molecule(input) { Sniff::Likely } else { Sniff::No },
    reads: Some(|input, context| read_xyz_molecule(input, context)?.into_shape(context)),
    writes: None,
};
