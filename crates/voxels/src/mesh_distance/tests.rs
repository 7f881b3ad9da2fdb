use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Convert, Deviation, Exec, Threads};
use shapeloom_isosurface::Lattice;
use shapeloom_mesh::TriMesh;
use shapeloom_spatial::generalized_winding_number;

use super::{FarField, MeshToDistance};
use crate::fixtures::{Dice, block, brute_distance, cylinder, icosahedron, some, soup, together, torus};
use crate::{Samples, VoxelGrid};

fn with_resolution(resolution: u32) -> MeshToDistance {
    MeshToDistance { resolution, ..MeshToDistance::new() }
}

fn values(grid: &VoxelGrid) -> &[f32] {
    match grid.samples() {
        Samples::F32(values) => values,
        other => panic!("{} samples", other.name()),
    }
}

fn messy() -> TriMesh {
    let ball = icosahedron();
    let flipped = some(&ball, |i| i % 5 == 0).reversed();
    together(&[
        some(&ball, |i| i != 3),
        flipped,
        torus(18, 9),
        block(DVec3::splat(-0.3), DVec3::splat(0.6)),
        soup(20, 0.2, 9),
    ])
}

fn shapes() -> Vec<(&'static str, TriMesh)> {
    let needles = TriMesh::try_new(
        vec![
            DVec3::ZERO,
            DVec3::new(1.0, 1e-9, 0.0),
            DVec3::new(2.0, 0.0, 0.3),
            DVec3::X,
            DVec3::X,
            DVec3::new(0.2, 0.9, 0.4),
        ],
        vec![[0, 1, 2], [3, 4, 5], [3, 3, 3], [0, 2, 1]],
    );
    vec![
        ("block", block(DVec3::new(-1.0, -0.5, 0.1), DVec3::new(1.0, 0.7, 0.9))),
        ("block on samples", block(DVec3::ZERO, DVec3::ONE)),
        ("torus", torus(40, 20)),
        ("icosahedron", icosahedron()),
        ("cylinder", cylinder()),
        ("two that overlap", together(&[icosahedron(), block(DVec3::ZERO, DVec3::splat(1.5))])),
        ("open torus", some(&torus(40, 20), |i| i % 97 > 9)),
        ("half a ball", some(&icosahedron(), |i| i < 11)),
        ("inward", icosahedron().reversed()),
        ("messy", messy()),
        ("soup", soup(150, 0.3, 3)),
        ("needles", needles.unwrap()),
    ]
}

/// Every sample within the band against all triangles in double precision; beyond the band none is nearer.
#[test]
fn distances_in_the_band_are_those_of_brute_force() {
    for (name, mesh) in shapes() {
        for (resolution, far) in [(14, FarField::Clamp), (31, FarField::Sweep)] {
            let method = MeshToDistance { far, ..with_resolution(resolution) };
            let made = method.convert(&mesh).unwrap();
            let (lattice, grid) = (*made.value.lattice(), values(&made.value));
            let band = 3.0 * lattice.spacing().x;
            let mut dice = Dice(1);
            let mut in_band = 0;
            for _ in 0..2500 {
                let at = dice.next() % lattice.samples();
                let truth = brute_distance(&mesh, lattice.position(lattice.coordinates(at)));
                let found = f64::from(grid[at as usize].abs());
                if truth <= band {
                    in_band += 1;
                    let rounding = 2f64.powi(-23) * truth + 1e-14;
                    assert!((found - truth).abs() <= rounding, "{name} {resolution}: {found} {truth}");
                } else {
                    assert!(found >= band * 0.999_999, "{name} {resolution}: {found} {truth}");
                    if far == FarField::Clamp {
                        assert!(found <= band * (1.0 + 1e-7), "{name}: {found}");
                    }
                }
            }
            assert!(in_band > 100, "{name}: {in_band}");
        }
    }
}

/// Every sign that rounding does not leave open, against the sum over all triangles.
#[test]
fn signs_are_those_of_exact_winding_numbers() {
    for (name, mesh) in shapes() {
        let made = with_resolution(22).convert(&mesh).unwrap();
        let lattice = *made.value.lattice();
        let (mut inside, mut told) = (0, 0);
        for (at, value) in
            values(&made.value).iter().enumerate().step_by(if mesh.triangles().len() > 500 { 7 } else { 2 })
        {
            let place = lattice.position(lattice.coordinates(at as u64));
            let exact =
                generalized_winding_number(mesh.positions(), mesh.triangles(), place, &Exec::default()).unwrap();
            if (exact.value - 0.5).abs() > exact.bound + 1e-12 && value.abs() > 1e-12 {
                told += 1;
                assert_eq!(*value < 0.0, exact.value > 0.5, "{name} at {place}: {value} {exact:?}");
                inside += u32::from(exact.value > 0.5);
            }
        }
        assert!(told > 500, "{name}: {told}");
        if !["needles", "soup", "inward"].contains(&name) {
            assert!(inside > 20, "{name}: {inside} inside");
        }
    }
}

/// The sum over all triangles by Van Oosterom and Strackee, written here on its own.
fn winding_number(mesh: &TriMesh, place: DVec3) -> f64 {
    let angle = |corners: [DVec3; 3]| {
        let [a, b, c] = corners.map(|corner| corner - place);
        let (x, y, z) = (a.length(), b.length(), c.length());
        a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    (0..mesh.triangles().len()).map(|i| angle(mesh.corners(i))).sum::<f64>() / std::f64::consts::TAU
}

/// No sign is wrong, closed, open and messy, on finer lattices: at random samples and where winding numbers are near 1/2.
#[test]
fn no_sign_is_wrong() {
    let whole = torus(60, 30);
    let chance = |seed: u64| move |i: usize| Dice(seed ^ (i as u64) << 20).unit();
    let (missing, flipped, half) = (chance(1), chance(2), chance(3));
    let turned =
        |mesh: &TriMesh| together(&[some(mesh, |i| flipped(i) > 0.15), some(mesh, |i| flipped(i) <= 0.15).reversed()]);
    let ball = icosahedron();
    let overlapping = together(&[whole.clone(), block(DVec3::splat(-0.7), DVec3::new(1.3, 0.6, 0.2))]);
    for (name, mesh, least) in [
        ("closed", whole.clone(), 100),
        ("one hole", some(&whole, |i| i > 500), 100),
        ("many holes", some(&whole, |i| missing(i) > 0.1), 100),
        ("turned around", turned(&whole), 100),
        ("half of it", some(&whole, |i| half(i) > 0.45), 1),
        ("overlapping, with holes", turned(&some(&overlapping, |i| missing(i) > 0.05)), 100),
        ("overlapping, closed", together(&[ball, overlapping.clone()]), 100),
        ("soup", soup(900, 0.25, 7), 1),
    ] {
        let made = with_resolution(52).convert(&mesh).unwrap().value;
        let lattice = *made.lattice();
        let mut dice = Dice(11);
        let (mut told, mut inside) = (0, 0);
        for _ in 0..1500 {
            let at = dice.next() % lattice.samples();
            let value = values(&made)[at as usize];
            let place = lattice.position(lattice.coordinates(at));
            let winding = winding_number(&mesh, place);
            if (winding - 0.5).abs() > 1e-9 && value.abs() > 1e-9 {
                told += 1;
                inside += u32::from(winding > 0.5);
                assert_eq!(value < 0.0, winding > 0.5, "{name} at {place}: {value} {winding}");
            }
        }
        assert!(told > 1450 && inside >= least, "{name}: {told} {inside}");
    }
}

/// Holes in planes of samples: what closes them passes samples, some on the border between two such triangles. Another open shape
/// beside it makes winding numbers there differ from 1/2, to either side.
#[test]
fn plane_holes_on_samples_are_decided() {
    // A box with walls of many triangles, so that its holes have many corners: the lid of each side in turn is missing.
    let (n, size) = (6u32, 6.0);
    let mut most = 0;
    for side in 0..6 {
        let mut parts = Vec::new();
        for (axis, top) in (0..6).filter(|&other| other != side).map(|other| (other % 3, other >= 3)) {
            let corner = |i: u32, j: u32| {
                let mut p = [0.0; 3];
                (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) =
                    (if top { size } else { 0.0 }, f64::from(i), f64::from(j));
                DVec3::from_array(p)
            };
            let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| corner(i, j))).collect();
            let quads = (0..n).flat_map(|i| (0..n).map(move |j| i * (n + 1) + j));
            let triangles = quads.flat_map(|a| [[a, a + n + 1, a + n + 2], [a, a + n + 2, a + 1]]).collect();
            let wall = TriMesh::try_new(positions, triangles).unwrap();
            parts.push(if top { wall } else { wall.reversed() });
        }
        for shift in [0.0, 20.0, -14.0] {
            let cup = some(&block(DVec3::splat(shift), DVec3::splat(shift + 9.0)), |i| i % 3 > 0);
            let mesh = together(&[parts.clone(), if shift == 0.0 { vec![] } else { vec![cup] }].concat());
            let lattice = Lattice::along_axes([11; 3], DVec3::splat(-1.0), DVec3::splat(0.8)).unwrap();
            let finer = Lattice::along_axes([17; 3], DVec3::splat(-1.0), DVec3::splat(0.5)).unwrap();
            for lattice in [lattice, finer] {
                let made = with_resolution(1).onto(&mesh, lattice, &Exec::default()).unwrap().value;
                let mut on_lid = 0;
                for at in 0..lattice.samples() {
                    let (value, place) = (values(&made)[at as usize], lattice.position(lattice.coordinates(at)));
                    let exact = generalized_winding_number(mesh.positions(), mesh.triangles(), place, &Exec::default())
                        .unwrap();
                    let in_plane = place[side % 3] == if side >= 3 { size } else { 0.0 };
                    if value.abs() > 1e-9 && (exact.value - 0.5).abs() > 1e-12 {
                        on_lid += u32::from(in_plane && value < 0.0);
                        assert_eq!(value < 0.0, exact.value > 0.5, "{side} {shift} {place}: {value} {exact:?}");
                    }
                }
                most = most.max(on_lid);
            }
        }
    }
    assert!(most > 50, "{most}");
}

/// Samples nearer to the surface than 1e-9 of a cell are on it, those farther away are not.
#[test]
fn samples_on_the_surface_are_zero() {
    for (away, wanted) in [(0.0, true), (0.9e-9, true), (-0.9e-9, true), (1.1e-9, false), (-1.1e-9, false)] {
        for open in [false, true] {
            let solid = block(DVec3::ONE, DVec3::new(5.0 + away, 5.0, 5.0));
            let solid = some(&solid, |i| !open || i != 4);
            let lattice = Lattice::along_axes([7; 3], DVec3::ZERO, DVec3::ONE).unwrap();
            let made = with_resolution(1).onto(&solid, lattice, &Exec::default()).unwrap().value;
            let value = made.sample([5, 3, 3]);
            assert_eq!(value == 0.0, wanted, "{away}: {value}");
            assert!(!open || value.is_sign_positive() || value < 0.0);
            assert!(wanted || (value < 0.0) == (away > 0.0), "{away}: {value}");
        }
    }
}

/// Closed forms: a box, whose distances are exact, and a ball, whose faces lie within their sagitta of it.
#[test]
fn a_box_has_its_closed_form() {
    let (low, high) = (DVec3::new(-1.0, -0.5, 0.25), DVec3::new(1.0, 0.5, 1.0));
    let made = MeshToDistance { band: 6.0, ..with_resolution(24) }.convert(&block(low, high)).unwrap();
    let lattice = *made.value.lattice();
    for (at, &value) in values(&made.value).iter().enumerate() {
        let p = lattice.position(lattice.coordinates(at as u64));
        let q = (p - (low + high) * 0.5).abs() - (high - low) * 0.5;
        let truth = q.max(DVec3::ZERO).length() + q.max_element().min(0.0);
        if truth.abs() < 6.0 * lattice.spacing().x {
            assert!((f64::from(value) - truth).abs() < 1e-7, "{p}: {value} {truth}");
        }
    }
    let Deviation::AtMost(bound) = made.report.deviation else { panic!("{:?}", made.report) };
    assert!((bound / lattice.cell_diagonal() - 2.0).abs() < 1e-5);
}

/// Fast sweeping is of first order: the error shrinks with the cells, and stays below some tenths of the distance.
#[test]
fn swept_distances_come_near_the_truth() {
    let mesh = torus(60, 30);
    let worst = [12, 24, 48].map(|resolution| {
        let method = MeshToDistance { margin: resolution / 4, ..with_resolution(resolution) };
        let made = method.convert(&mesh).unwrap();
        let lattice = *made.value.lattice();
        let step = (lattice.samples() / 1500).max(1) as usize;
        let errors = values(&made.value).iter().enumerate().step_by(step).map(|(at, &value)| {
            let truth = brute_distance(&mesh, lattice.position(lattice.coordinates(at as u64)));
            (f64::from(value.abs()) - truth).abs()
        });
        errors.fold(0.0, f64::max)
    });
    assert!(worst[1] < 0.75 * worst[0] && worst[2] < 0.75 * worst[1], "{worst:?}");
    assert!(worst[2] < 0.05, "{worst:?}");
}

#[test]
fn parts_thinner_than_a_cell_are_told() {
    let sheet = block(DVec3::new(-1.0, -1.0, 0.012), DVec3::new(1.0, 1.0, 0.02));
    let made = with_resolution(16).convert(&sheet).unwrap();
    assert_eq!(made.report.deviation, Deviation::Unknown);
    assert!(made.report.findings.iter().any(|finding| finding.code == "W-voxels-lost"));
    let made = with_resolution(16).convert(&together(&[block(DVec3::splat(-1.0), DVec3::splat(0.0)), sheet])).unwrap();
    assert_eq!(made.report.deviation, Deviation::Unknown);
    let made = with_resolution(16).convert(&icosahedron().reversed()).unwrap();
    assert_eq!(made.report.deviation, Deviation::Unknown);
}

#[test]
fn open_meshes_are_told() {
    let made = with_resolution(16).convert(&some(&icosahedron(), |i| i > 0)).unwrap();
    assert_eq!(made.report.deviation, Deviation::Unknown);
    assert!(made.report.findings.iter().any(|finding| finding.code == "W-voxels-open"));
}

#[test]
fn the_same_bits_on_any_number_of_threads() {
    for mesh in [torus(40, 20), messy()] {
        let method = with_resolution(70);
        let alone = method.convert_with(&mesh, &Exec::default().with_threads(Threads::Sequential)).unwrap();
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let found = pool.install(|| method.convert(&mesh).unwrap());
            assert!(found == alone, "{threads} threads");
        }
    }
}

/// Mirrored lattices and lattices that hold a part of a mesh only see the same distances.
#[test]
fn a_lattice_inside_a_mesh_sees_what_is_outside_of_it() {
    let mesh = torus(40, 20);
    let whole = with_resolution(40).convert(&mesh).unwrap().value;
    let spacing = whole.lattice().spacing();
    for start in [[7u32, 3, 5], [20, 20, 6], [30, 10, 2]] {
        let dimensions = [6, 3, 7];
        let lattice = Lattice::along_axes(dimensions, whole.lattice().position(start), spacing).unwrap();
        let made = with_resolution(1).onto(&mesh, lattice, &Exec::default()).unwrap();
        assert_eq!(made.report.deviation, Deviation::Unknown);
        for at in 0..lattice.samples() {
            let [i, j, k] = lattice.coordinates(at);
            let (here, there) =
                (made.value.sample([i, j, k]), whole.sample([start[0] + i, start[1] + j, start[2] + k]));
            if f64::from(there.abs()) <= 3.0 * spacing.x {
                assert!((here - there).abs() < 1e-6, "{here} {there}");
            }
            assert_eq!(here < 0.0, there < 0.0);
        }
    }
}

#[test]
fn strange_sizes_and_places_are_taken_or_told() {
    let ball = icosahedron();
    let moved = |scale: f64, offset: f64| {
        let positions = ball.positions().iter().map(|&p| p * scale + DVec3::splat(offset)).collect();
        TriMesh::try_new(positions, ball.triangles().to_vec()).unwrap()
    };
    for (scale, offset) in [(1e-9, 0.0), (1.0, 5e6), (1e-3, 5e6), (1e20, 0.0), (1e-25, 0.0)] {
        let made = with_resolution(12).convert(&moved(scale, offset)).unwrap();
        let plain = with_resolution(12).convert(&ball).unwrap();
        let wrong = values(&made.value)
            .iter()
            .zip(values(&plain.value))
            .filter(|(a, b)| ((**a as f64 / scale) - f64::from(**b)).abs() > 1e-4);
        assert_eq!(wrong.count(), 0, "{scale} {offset}");
    }
    for scale in [1e-300, 1e150, 1e300] {
        let error = with_resolution(12).convert(&moved(scale, 0.0)).unwrap_err();
        assert_eq!(error.category(), Category::OverLimit, "{error}");
    }
    let error = with_resolution(12).convert(&moved(f64::NAN, 0.0)).unwrap_err();
    assert_eq!(error.category(), Category::Malformed, "{error}");
    for resolution in [5000, 1_000_000] {
        let error = with_resolution(resolution).convert(&ball).unwrap_err();
        assert_eq!(error.category(), Category::OverLimit, "{error}");
    }
    assert!(MeshToDistance { cell_size: 1e-12, ..MeshToDistance::new() }.convert(&ball).is_err());
    let nothing = MeshToDistance::new().convert(&TriMesh::default()).unwrap();
    assert!(values(&nothing.value).iter().all(|value| *value == f32::INFINITY));
    let point = TriMesh::try_new(vec![DVec3::ONE; 3], vec![[0, 1, 2]]).unwrap();
    let made = MeshToDistance::new().convert(&point).unwrap().value;
    let lattice = made.lattice();
    for at in 0..lattice.samples() {
        let truth = lattice.position(lattice.coordinates(at)).distance(DVec3::ONE);
        let found = f64::from(values(&made)[at as usize]);
        assert!(truth > 3.0 || (found - truth).abs() < 1e-6, "{found} {truth}");
    }
}

/// Rounding must not put samples of the faces of a box inside: the surface would have crumbs along the edges.
#[test]
fn faces_on_samples_are_not_inside() {
    for (low, high) in [(0.0, 1.0), (-0.5, 0.5), (0.1, 1.3)] {
        let solid = block(DVec3::splat(low), DVec3::splat(high));
        for resolution in [16, 50, 64, 90] {
            let grid = with_resolution(resolution).convert(&solid).unwrap().value;
            let inside = values(&grid).iter().filter(|&&value| value < 0.0).count();
            assert_eq!(inside, (resolution as usize - 1).pow(3), "{low} {high} {resolution}");
            let on_it = values(&grid).iter().filter(|&&value| value == 0.0).count();
            assert_eq!(on_it, 6 * (resolution as usize).pow(2) + 2, "{low} {high} {resolution}");
        }
    }
}
