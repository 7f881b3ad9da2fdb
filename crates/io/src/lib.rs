//! Files: bytes to [`Shape`](shapeloom_shape::Shape) and back.
//!
//! - [`FORMATS`]: one table says what each format is called, how it is recognized, what it can hold and keep, and how it
//!   is read and written. [`detect()`], [`format_by_id`] and [`format_for_output`] choose from it.
//! - [`read()`]: a slice of bytes under [`Limits`](shapeloom_core::Limits) and an [`Exec`](shapeloom_core::Exec) gives a
//!   shape, what was odd about the file, and what of it the shape does not hold. [`slurp`] gets the bytes.
//! - [`write()`]: a shape gives bytes and the [`Report`](shapeloom_core::Report) of what they do not hold and how far
//!   positions were rounded. The same shape always gives the same bytes.
//! - [`EXPLANATIONS`]: what each code of this crate means.
//!
//! Formats that begin with text share [`text`]: lines and tokens with their places, numbers by a strict grammar.
//!
//! ```
//! use shapeloom_io::{ReadContext, WriteContext, detect, format_by_id, read, write};
//!
//! let file = b"1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n";
//! let format = detect(file, Some("saddle.bpt"))?;
//! let saddle = read(file, format, &ReadContext::named("saddle.bpt"))?;
//! let mut copy = Vec::new();
//! let bpt = format_by_id("bpt")?;
//! let report = write(&saddle.shape, bpt, &WriteContext::default(), &mut copy)?;
//! assert_eq!(copy, file);
//! assert!(report.losses.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod text;

mod asc;
mod audit;
mod bpt;
mod color;
mod cut;
mod dem;
mod detect;
mod explanations;
mod faces;
mod format;
mod gltf;
mod heights;
mod implicit_text;
mod memory;
mod metaimage;
mod nrrd;
mod obj;
mod off;
mod options;
mod parts;
mod pdb;
mod pgm;
mod placed;
mod ply;
mod png;
mod raw;
mod read;
mod read_error;
mod read_molecule;
mod siblings;
mod sink;
mod slc;
mod stl;
mod svg;
#[cfg(test)]
mod test_data;
mod tiff;
mod volumes;
mod vti;
mod vtk;
mod write;
mod write_error;
mod xyz_molecule;

pub use detect::{DetectError, detect, format_by_id, format_for_output};
pub use explanations::{EXPLANATIONS, explanation};
pub use format::{FORMATS, Format, Keeps, Precision, ReadFn, Sniff, WriteFn};
pub use options::{ByteOrder, Encoding, HeightEncoding, Instances, ReadOptions, ScalarType, WriteOptions};
pub use pdb::read_pdb;
pub use read::{ReadContext, ReadShape, read, slurp, slurp_sized};
pub use read_error::{Fault, ReadError};
pub use read_molecule::ReadMolecule;
pub use siblings::{SiblingError, SiblingName, SiblingOutputs, Siblings};
pub use write::{WriteContext, write};
pub use write_error::WriteError;
pub use xyz_molecule::{looks_like_xyz_molecule, read_xyz_molecule};
