//! Whether a mesh is fit for a purpose.

mod angles;
mod profile;
mod shells;
#[cfg(test)]
mod tests;
mod verdict;

pub use profile::{Profile, RULES, Rule};
pub use shells::Shell;
pub use verdict::{NotPolyhedron, Verdict};
