//! Protein Data Bank files: atoms with their places, read.
//!
//! Of the records `ATOM` and `HETATM` in fixed columns (format 3.3), so that solvent and ligands come with the rest. Of several models the
//! first alone; of alternate locations the one that each residue names first. The element stands in columns 77 and 78, in old files in the
//! name of the atom alone. `TITLE` is kept, everything else passed over.

mod read;
#[cfg(test)]
mod tests;

pub use read::read_pdb;

use shapeloom_shape::Kind;

use crate::{Format, Precision, Sniff};

/// Protein Data Bank.
pub(crate) const FORMAT: Format = Format {
    id: "pdb",
    name: "Protein Data Bank",
    extensions: &["pdb", "ent"],
    media_type: "chemical/x-pdb",
    text: true,
    up: None,
    precision: Precision::F64,
    kinds: &[Kind::Implicit],
    keeps: &[],
    read_options: &["blobbiness", "atom_scale"],
    write_options: &[],
    sniff: |input| {
        let mut lines = crate::detect::head(input).split(|&byte| byte == b'\n').take(1000);
        let atom = |line: &[u8]| line.len() >= 54 && (line.starts_with(b"ATOM  ") || line.starts_with(b"HETATM"));
        if lines.any(atom) { Sniff::Likely } else { Sniff::No }
    },
    reads: Some(|input, context| read_pdb(input, context)?.into_shape(context)),
    writes: None,
};
