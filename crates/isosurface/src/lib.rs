//! Isosurfaces: the surface where samples on a lattice reach a value.
//!
//! Every algorithm reads a [`Slabs`], a lattice of samples that is filled slab by slab, so that the same code serves dense grids,
//! sampled fields and files larger than memory.

mod border;
mod dual;
mod dual_contouring;
mod error;
mod field_slabs;
mod inside_bits;
mod iso_value;
mod lattice;
mod level;
mod manifold_surface_nets;
mod otsu;
mod qef;
mod result;
mod slabs;
mod surface_nets;

pub use border::Border;
pub use dual_contouring::DualContouring;
pub use error::LatticeError;
pub use field_slabs::FieldSlabs;
pub use iso_value::IsoValue;
pub use lattice::Lattice;
pub use level::{Inside, InsideChoice, Level};
pub use manifold_surface_nets::ManifoldSurfaceNets;
pub use otsu::{Otsu, otsu_threshold};
pub use slabs::Slabs;
pub use surface_nets::SurfaceNets;
