use super::*;
use crate::{Quantity, Samples, VoxelGrid};
use shapeloom_mesh::TriangulatePolygons;

fn grid(dimensions: [u32; 3], full: impl Fn([u32; 3]) -> bool) -> VoxelGrid {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).unwrap();
    let samples = (0..lattice.samples()).map(|at| u8::from(full(lattice.coordinates(at)))).collect();
    VoxelGrid::try_new(lattice, Samples::U8(samples), Quantity::Occupancy).unwrap()
}

/// How often each directed edge is used, with how often the other way.
fn unmatched(mesh: &PolyMesh) -> usize {
    let mut edges = std::collections::BTreeMap::<(u32, u32), i32>::new();
    for face in mesh.faces() {
        for (n, &a) in face.iter().enumerate() {
            let b = face[(n + 1) % face.len()];
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { 100 };
        }
    }
    edges.values().filter(|&&uses| uses != 101).count()
}

#[test]
fn one_cell_is_a_cube_around_its_sample() {
    let converted = CellFaces::new().convert(&grid([1, 1, 1], |_| true)).unwrap();
    let mesh = &converted.value;
    assert_eq!((mesh.positions().len(), mesh.face_count()), (8, 6));
    let bounds = mesh.bounds();
    assert_eq!((bounds.min, bounds.max), (DVec3::splat(-0.5), DVec3::splat(0.5)));
    let triangles = TriangulatePolygons::new().convert(mesh).unwrap().value;
    assert!((triangles.volume() - 1.0).abs() < 1e-15, "faces look outward: {}", triangles.volume());
}

#[test]
fn volume_and_area_count_cells_and_faces_also_when_merged_and_mirrored() {
    let mut state = 3u64;
    let mut cells = [[[false; 6]; 5]; 4];
    for cell in cells.as_flattened_mut().as_flattened_mut() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        *cell = state >> 63 == 1;
    }
    let source = grid([6, 5, 4], |[i, j, k]| cells[k as usize][j as usize][i as usize]);
    let count = cells.as_flattened().as_flattened().iter().filter(|&&full| full).count() as f64;
    let mirrored = source.transformed(&Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    for source in [source, mirrored] {
        let mut areas = Vec::new();
        for (merge, separate) in [(false, true), (false, false), (true, true)] {
            let converted = CellFaces { merge, separate, ..CellFaces::new() }.convert(&source).unwrap();
            let triangles = TriangulatePolygons::new().convert(&converted.value).unwrap().value;
            assert!((triangles.volume() - count).abs() < 1e-10, "{merge} {separate}: {}", triangles.volume());
            areas.push(triangles.area());
            assert_eq!(merge, converted.value.face_count() < converted.report.find("cell_faces").unwrap() as usize);
            if !merge {
                assert_eq!(unmatched(&converted.value) == 0, separate);
            }
        }
        assert!(areas.iter().all(|area| (area - areas[0]).abs() < 1e-10), "{areas:?}");
    }
}

#[test]
fn a_block_merges_to_six_rectangles() {
    let block = grid([9, 7, 5], |[i, j, k]| (2..8).contains(&i) && j > 2 && k > 0);
    let converted = CellFaces { merge: true, ..CellFaces::new() }.convert(&block).unwrap();
    assert_eq!((converted.value.face_count(), converted.value.positions().len()), (6, 8));
    assert!(unmatched(&converted.value) == 0);
}

/// Two cells that touch along an edge whose ends other cells join: by cell alone its two copies would have the same
/// vertices.
#[test]
fn an_edge_joined_at_both_ends_is_still_two() {
    let ring = grid([2, 2, 3], |[i, j, k]| k != 1 || i == j);
    let converted = CellFaces::new().convert(&ring).unwrap();
    assert_eq!(converted.report.find("touching_edges"), Some(1.0));
    assert_eq!(unmatched(&converted.value), 0);
    let together = CellFaces { separate: false, ..CellFaces::new() }.convert(&ring).unwrap();
    assert_eq!(together.report.findings.iter().next().unwrap().code, "W-cells-touch");
    assert_eq!(unmatched(&together.value), 1);
}

#[test]
fn nothing_gives_nothing_and_says_so() {
    let converted = CellFaces::new().convert(&grid([3, 2, 2], |_| false)).unwrap();
    assert_eq!(converted.value.face_count(), 0);
    assert_eq!(converted.report.findings.iter().next().unwrap().code, "W-iso-empty");
}
