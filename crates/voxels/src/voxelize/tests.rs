use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Convert, Deviation, Exec, Threads};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;
use shapeloom_spatial::generalized_winding_number;

use super::{CellRule, VoxelizeMesh, VoxelizeMode};
use crate::VoxelGrid;
use crate::fixtures::{Dice, block, icosahedron, some, soup, torus};

fn method(mode: VoxelizeMode, rule: CellRule, resolution: u32) -> VoxelizeMesh {
    VoxelizeMesh { mode, rule, resolution, ..VoxelizeMesh::new() }
}

fn full(grid: &VoxelGrid) -> Vec<[u32; 3]> {
    let lattice = grid.lattice();
    let all = (0..lattice.samples()).map(|at| lattice.coordinates(at));
    all.filter(|&cell| grid.sample(cell) == 1.0).collect()
}

/// Whole numbers and halves, where touching counts: every cell by the exact test in integers (a triangle clipped to the cube).
#[test]
fn conservative_cells_are_those_that_clipping_leaves_something_in() {
    let lattice = Lattice::along_axes([9, 8, 7], DVec3::ZERO, DVec3::ONE).unwrap();
    let mut dice = Dice(8);
    for _ in 0..60 {
        let corners =
            [0; 3].map(|_| [8, 7, 6].map(|n| (dice.next() % (2 * n + 1)) as f64 / 2.0)).map(DVec3::from_array);
        let mesh = TriMesh::try_new(corners.to_vec(), vec![[0, 1, 2]]).unwrap();
        let made = method(VoxelizeMode::Surface, CellRule::Conservative, 1).onto(&mesh, lattice, &Exec::default());
        let found = full(&made.unwrap().value);
        let all = (0..lattice.samples()).map(|at| lattice.coordinates(at));
        let wanted: Vec<[u32; 3]> = all.filter(|cell| clipped(&corners, cell.map(f64::from).into())).collect();
        // Clipping rounds: cells that are touched at one place may differ, so neither misses what the other has by more.
        let nearly = |cell: &[u32; 3], grow: f64| clip(&corners, DVec3::from(cell.map(f64::from)), 0.5 + grow);
        for cell in &wanted {
            assert!(found.contains(cell), "{corners:?} {cell:?} is missed");
        }
        for cell in &found {
            assert!(nearly(cell, 1e-9), "{corners:?} {cell:?} is too much");
        }
    }
}

fn clipped(corners: &[DVec3; 3], center: DVec3) -> bool {
    clip(corners, center, 0.5)
}

/// Whether anything of a triangle is left when it is clipped to a cube (Sutherland and Hodgman 1974).
fn clip(corners: &[DVec3; 3], center: DVec3, half: f64) -> bool {
    let mut polygon = corners.map(|corner| corner - center).to_vec();
    for (axis, sign) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0), (2, 1.0), (2, -1.0)] {
        let beyond = |p: DVec3| p[axis] * sign - half;
        let mut kept = Vec::new();
        for i in 0..polygon.len() {
            let (p, q) = (polygon[i], polygon[(i + 1) % polygon.len()]);
            if beyond(p) <= 0.0 {
                kept.push(p);
            }
            if (beyond(p) < 0.0 && beyond(q) > 0.0) || (beyond(p) > 0.0 && beyond(q) < 0.0) {
                kept.push(p.lerp(q, beyond(p) / (beyond(p) - beyond(q))));
            }
        }
        polygon = kept;
    }
    !polygon.is_empty()
}

/// No place of a surface is outside of its full cells, however the cells lie.
#[test]
fn every_place_of_a_surface_is_in_a_full_cell() {
    let mut dice = Dice(2);
    for mesh in [torus(30, 15), icosahedron(), soup(80, 0.4, 6)] {
        let made = method(VoxelizeMode::Surface, CellRule::Conservative, 37).convert(&mesh).unwrap().value;
        let lattice = made.lattice();
        let (origin, step) = (lattice.position([0; 3]), lattice.spacing().x);
        for _ in 0..20_000 {
            let [a, b, c] = mesh.corners((dice.next() % mesh.triangles().len() as u64) as usize);
            let (s, t) = (dice.unit(), dice.unit());
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            let place = a + (b - a) * s + (c - a) * t;
            let cell = ((place - origin) / step).round().to_array().map(|x| x as u32);
            assert_eq!(made.sample(cell), 1.0, "{place}");
        }
    }
}

#[test]
fn centers_of_solids_are_those_with_winding_numbers_above_a_half() {
    for mesh in [torus(30, 15), some(&torus(30, 15), |i| i % 41 > 3)] {
        let made = method(VoxelizeMode::Solid, CellRule::Center, 20).convert(&mesh).unwrap().value;
        for at in (0..made.lattice().samples()).step_by(3) {
            let cell = made.lattice().coordinates(at);
            let place = made.lattice().position(cell);
            let exact =
                generalized_winding_number(mesh.positions(), mesh.triangles(), place, &Exec::default()).unwrap();
            if (exact.value - 0.5).abs() > exact.bound + 1e-12 {
                assert_eq!(made.sample(cell) == 1.0, exact.value > 0.5, "{place}");
            }
        }
    }
}

/// A box of whole cells: its volume is that of its full cells by centres; conservatively a layer touches it all around.
#[test]
fn a_box_fills_as_many_cells_as_it_has() {
    let mesh = block(DVec3::splat(-0.5), DVec3::new(5.5, 3.5, 2.5));
    let lattice = Lattice::along_axes([12, 10, 9], DVec3::splat(-3.0), DVec3::ONE).unwrap();
    let count = |mode, rule| {
        let made = method(mode, rule, 1).onto(&mesh, lattice, &Exec::default()).unwrap();
        made.report.find("full_cells").unwrap()
    };
    assert_eq!(count(VoxelizeMode::Solid, CellRule::Center), 6.0 * 4.0 * 3.0);
    assert_eq!(count(VoxelizeMode::Solid, CellRule::Conservative), 8.0 * 6.0 * 5.0);
    assert_eq!(count(VoxelizeMode::Surface, CellRule::Conservative), 8.0 * 6.0 * 5.0 - 4.0 * 2.0);
}

/// Nothing leaks over faces of cells through the thin voxels of a closed surface: a flood from the corner reaches no cell whose
/// centre is inside.
#[test]
fn thin_surfaces_hold_water() {
    for mesh in [torus(30, 15), icosahedron()] {
        let thin = method(VoxelizeMode::Surface, CellRule::Center, 33).convert(&mesh).unwrap().value;
        let thick = method(VoxelizeMode::Surface, CellRule::Conservative, 33).convert(&mesh).unwrap().value;
        let inside = method(VoxelizeMode::Solid, CellRule::Center, 33).convert(&mesh).unwrap().value;
        assert!(full(&thin).iter().all(|&cell| thick.sample(cell) == 1.0));
        assert!(full(&thin).len() < full(&thick).len());
        let lattice = thin.lattice();
        let mut seen = vec![false; lattice.samples() as usize];
        let mut stack = vec![[0u32; 3]];
        let (mut reached, mut inner) = (0, 0);
        while let Some(cell) = stack.pop() {
            let at = lattice.index(cell) as usize;
            if seen[at] || thin.sample(cell) == 1.0 {
                continue;
            }
            seen[at] = true;
            reached += 1;
            inner += u32::from(inside.sample(cell) == 1.0);
            for axis in 0..3 {
                for step in [-1i64, 1] {
                    let mut next = cell;
                    let to = i64::from(cell[axis]) + step;
                    if (0..i64::from(lattice.dimensions()[axis])).contains(&to) {
                        next[axis] = to as u32;
                        stack.push(next);
                    }
                }
            }
        }
        assert!(reached > 1000 && inner == 0, "{reached} reached, {inner} inside");
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    for (mode, rule) in [(VoxelizeMode::Solid, CellRule::Conservative), (VoxelizeMode::Surface, CellRule::Center)] {
        let (mesh, method) = (torus(40, 20), method(mode, rule, 71));
        let alone = method.convert_with(&mesh, &Exec::default().with_threads(Threads::Sequential)).unwrap();
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert!(pool.install(|| method.convert(&mesh).unwrap()) == alone, "{threads} threads");
        }
    }
}

#[test]
fn bounds_are_told_where_they_are_proven() {
    let made = method(VoxelizeMode::Solid, CellRule::Conservative, 20).convert(&icosahedron()).unwrap();
    assert!(matches!(made.report.deviation, Deviation::AtMost(_)), "{:?}", made.report);
    let made = method(VoxelizeMode::Surface, CellRule::Conservative, 4).convert(&soup(500, 0.5, 1)).unwrap();
    assert_eq!(made.report.deviation, Deviation::Unknown);
    let nothing = VoxelizeMesh::new().convert(&TriMesh::default()).unwrap();
    assert_eq!(nothing.report.find("full_cells"), Some(0.0));
    let error = VoxelizeMesh { resolution: 100_000, ..VoxelizeMesh::new() }.convert(&icosahedron()).unwrap_err();
    assert_eq!(error.category(), Category::OverLimit);
}
