//! Legacy VTK by hand.

use shapeloom_core::glam::DVec3;
use shapeloom_shape::Geometry;
use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

use crate::{ReadContext, format_by_id, read};

fn grid(fields: &str, data: &[u8]) -> VoxelGrid {
    let header = format!(
        "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET STRUCTURED_POINTS\n{fields}\nLOOKUP_TABLE default\n"
    );
    let bytes = [header.as_bytes(), data].concat();
    let read = read(&bytes, format_by_id("vtk").unwrap(), &ReadContext::named("a.vtk")).unwrap();
    let Geometry::VoxelGrid(grid) = &*read.shape.parts[0].geometry else { panic!("a grid") };
    grid.clone()
}

#[test]
fn samples_of_cells_are_their_middles() {
    let fields = "DIMENSIONS 3 2 1\nORIGIN 1 2 3\nSPACING 2 4 8\nCELL_DATA 2\nSCALARS a signed_char 1";
    let found = grid(fields, b"\x07\xf9");
    assert_eq!(found.lattice().dimensions(), [2, 1, 1]);
    assert_eq!(found.lattice().position([1, 0, 0]), DVec3::new(4.0, 4.0, 3.0));
    assert_eq!([0, 1].map(|at| found.samples().get(at)), [7.0, -7.0]);
}

/// VTK packs eight bits a byte, the first in the highest.
#[test]
fn bits_begin_with_the_highest() {
    let found = grid("DIMENSIONS 10 1 1\nPOINT_DATA 10\nSCALARS a bit 1", &[0b1100_0001, 0b0111_1111]);
    assert_eq!(found.samples(), &Samples::Bits(vec![0b10_1000_0011]));
    assert_eq!(found.quantity(), Quantity::Occupancy);
}
