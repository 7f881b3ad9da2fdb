//! Protein Data Bank files: atoms with their places, read.
//!
//! Of the records `ATOM` and `HETATM` in fixed columns (format 3.3), so that solvent and ligands come with the rest. Of several models the
//! first alone; of alternate locations the one that each residue names first. The element stands in columns 77 and 78, in old files in the
//! name of the atom alone. `TITLE` is kept, everything else passed over.

mod read;
#[cfg(test)]
mod tests;

pub use read::read_pdb;
