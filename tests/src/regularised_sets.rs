//! Two boxes that touch on a face intersect in nothing: as implicits and as octrees.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::implicit::{PointPlace, Tree, classify_regularised};
use shapeloom::isosurface::{FieldSlabs, Lattice, ManifoldSurfaceNets, MarchingCubes};
use shapeloom::voxels::Octree;

fn boxes(apart: f64) -> (Tree, Tree) {
    (Tree::cuboid(1.0, 1.0, 1.0), Tree::cuboid(1.0, 1.0, 1.0).translate(apart, 0.0, 0.0))
}

/// Lattices with samples on the common face, and without.
fn lattices() -> [Lattice; 2] {
    let along = |shift: f64| {
        Lattice::along_axes([33, 25, 25], DVec3::new(-0.75, -0.75, -0.75) + shift, DVec3::splat(1.0 / 16.0)).unwrap()
    };
    [along(0.0), along(0.011)]
}

#[test]
fn boxes_that_touch_have_no_surface_in_common() {
    for (apart, empty) in [(1.0, true), (0.75, false)] {
        let (a, b) = boxes(apart);
        let program = a.intersection(b).compile().unwrap();
        for lattice in lattices() {
            let samples = FieldSlabs::new(&program, lattice);
            let cubes = MarchingCubes::new().convert(&samples).unwrap().value;
            let nets = ManifoldSurfaceNets::new().convert(&samples).unwrap().value;
            assert_eq!((cubes.triangles().is_empty(), nets.triangles().is_empty()), (empty, empty), "{apart}");
        }
    }
}

#[test]
fn octrees_of_boxes_that_touch_have_no_cell_in_common() {
    let exec = Exec::default();
    for (apart, empty) in [(1.0, true), (0.75, false)] {
        let (a, b) = boxes(apart);
        for lattice in lattices() {
            let tree = |solid: &Tree| Octree::from_field(&solid.compile().unwrap(), lattice, &exec).unwrap();
            let (first, second) = (tree(&a), tree(&b));
            let both = first.intersection(&second, &exec).unwrap();
            assert_eq!(both.full_cells() == 0, empty, "{apart}");
            // Cell for cell, so that nothing is left that is no cell: what one has of the other is taken away whole.
            let rest = first.difference(&second, &exec).unwrap();
            assert_eq!(rest.full_cells() + both.full_cells(), first.full_cells());
        }
    }
}

#[test]
fn the_common_face_is_outside_the_intersection_and_inside_the_union() {
    let (a, b) = boxes(1.0);
    let place = |tree: Tree| classify_regularised(&tree.compile().unwrap(), DVec3::X * 0.5, 1e-3).unwrap().place;
    assert_eq!(place(a.clone().intersection(b.clone())), PointPlace::Outside);
    assert_eq!(place(a.union(b)), PointPlace::Inside);
}
