//! Faces of full cells, held to their promises by the judge.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::isosurface::Lattice;
use shapeloom::judge::Topology;
use shapeloom::voxels::{CellFaces, Quantity, Samples, VoxelGrid};

use crate::support::Dice;

fn random(dice: &mut Dice, dimensions: [u32; 3], density: f64) -> VoxelGrid {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).expect("a lattice");
    let samples = (0..lattice.samples()).map(|_| u8::from(dice.unit() < density)).collect();
    VoxelGrid::try_new(lattice, Samples::U8(samples), Quantity::Occupancy).expect("as many samples as the lattice has")
}

#[test]
fn random_cells_have_closed_manifold_faces() {
    let mut dice = Dice(77);
    let mut touching = 0.0;
    for round in 0..400 {
        let dimensions = std::array::from_fn(|_| 1 + (dice.next() % 7) as u32);
        let source = random(&mut dice, dimensions, 0.1 + 0.8 * f64::from(round % 9) / 8.0);
        let converted = CellFaces::new().convert(&source).expect("cells have faces");
        touching += converted.report.find("touching_edges").expect("a figure");
        if converted.value.face_count() == 0 {
            continue;
        }
        let topology = Topology::of(&converted.value, &Exec::default()).expect("a small mesh");
        assert!(topology.is_manifold() && topology.is_closed() && topology.is_oriented(), "{dimensions:?}");
        assert!(topology.isolated_vertices.is_empty() && topology.duplicate_faces.is_empty());
        // Without copies of vertices the edges of four faces are those that were counted.
        let together = CellFaces { separate: false, ..CellFaces::new() }.convert(&source).expect("cells have faces");
        let topology = Topology::of(&together.value, &Exec::default()).expect("a small mesh");
        let counted = together.report.find("touching_edges").expect("a figure");
        assert_eq!(topology.non_manifold_edges.len() as f64, counted);
        assert!(topology.boundary.is_empty());
        // Merged rectangles have corners among the same places.
        let merged = CellFaces { merge: true, ..CellFaces::new() }.convert(&source).expect("cells have faces");
        assert!(merged.value.face_count() <= together.value.face_count());
    }
    assert!(touching > 1000.0, "{touching}");
}
