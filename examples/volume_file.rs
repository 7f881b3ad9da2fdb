//! A volume from a file: its lattice, its samples, and the file written anew in another format.
//!
//! ```text
//! cargo run --release --example volume_file
//! ```

#![allow(clippy::print_stdout)]

use std::error::Error;

use shapeloom::core::Exec;
use shapeloom::io::{ReadContext, WriteContext, detect, format_by_id, read, write};
use shapeloom::shape::{Representation, Shape};
use shapeloom::voxels::VoxelGrid;
use shapeloom::voxels::isosurface::sample_range;

fn grid(shape: &Shape) -> Result<&VoxelGrid, Box<dyn Error>> {
    Ok(VoxelGrid::from_geometry(&shape.parts[0].geometry)?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../data/orbital.nrrd");
    let bytes = std::fs::read(path)?;
    let volume = read(&bytes, detect(&bytes, Some(path))?, &ReadContext::named(path))?;
    let density = grid(&volume.shape)?;

    let lattice = density.lattice();
    let [x, y, z] = lattice.dimensions();
    println!("{x} x {y} x {z} samples of {}, {} apart", density.samples().name(), lattice.spacing());
    println!("from {} on", lattice.position([0; 3]));
    println!("values {:?}", sample_range(density, &Exec::default())?.finite);

    // The part of space where the density is above an eighth, cell by cell.
    let above = (0..lattice.samples()).filter(|&at| density.samples().get(at) > 31.5).count();
    println!(
        "about {} cubic Bohr radii above an eighth of the largest",
        above as f64 * lattice.spacing().element_product()
    );

    for id in ["nrrd", "mha", "vti", "vtk"] {
        let mut copy = Vec::new();
        let report = write(&volume.shape, format_by_id(id)?, &WriteContext::default(), &mut copy)?;
        let again = read(&copy, format_by_id(id)?, &ReadContext::named(id))?;
        assert_eq!(grid(&again.shape)?, density);
        println!("{id}: {} bytes, {} losses", copy.len(), report.losses.len());
    }
    Ok(())
}
