//! XYZ files of molecules: a count, a comment, then an element and a place a line, read.
//!
//! The same ending stands for plain lists of points: [`looks_like_xyz_molecule`] tells them apart. Of several frames the first is read.
//! Columns after the place (charges, speeds) are passed over.

mod read;
#[cfg(test)]
mod tests;

pub use read::{looks_like_xyz_molecule, read_xyz_molecule};
