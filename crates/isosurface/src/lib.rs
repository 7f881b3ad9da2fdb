//! Isosurfaces: the surface where samples on a lattice reach a value.
//!
//! Every algorithm reads a [`Slabs`], a lattice of samples that is filled slab by slab, so that the same code serves dense grids,
//! sampled fields and files larger than memory.

mod border;
mod cell_topology;
mod cube_cycles;
mod dual;
mod dual_contouring;
mod edge_batch;
mod error;
mod field_slabs;
mod growth;
mod inside_bits;
mod iso_value;
mod lattice;
mod lattice_bits;
mod lattice_vertices;
mod level;
mod manifold_surface_nets;
mod marching;
mod marching_cubes;
mod marching_report;
mod marching_tetrahedra;
mod otsu;
mod pattern;
mod qef;
mod result;
mod sample_range;
mod slab_window;
mod slabs;
mod surface_nets;
mod trilinear_cell;

pub use border::Border;
pub use dual_contouring::DualContouring;
pub use error::LatticeError;
pub use field_slabs::FieldSlabs;
pub use iso_value::IsoValue;
pub use lattice::Lattice;
pub use level::{Inside, InsideChoice, IsoWords, Level};
pub use manifold_surface_nets::ManifoldSurfaceNets;
pub use marching_cubes::{MarchingCubes, Topology};
pub use marching_tetrahedra::MarchingTetrahedra;
pub use otsu::{Otsu, otsu_threshold};
pub use sample_range::{SampleRange, sample_range};
pub use slabs::Slabs;
pub use surface_nets::SurfaceNets;
