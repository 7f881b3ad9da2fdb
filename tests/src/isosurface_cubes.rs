//! Marching cubes and tetrahedra: closed and 2-manifold on any samples by the judge, and with exact topology joined as the trilinear
//! interpolant is, by counting on a fine lattice.

use shapeloom::core::glam::{DMat3, DVec3};
use shapeloom::core::{Affine, Convert, Deviation, Exec};
use shapeloom::isosurface::{
    Border, InsideChoice, IsoValue, Lattice, MarchingCubes, MarchingTetrahedra, Topology as CellTopology,
};
use shapeloom::judge::Topology;
use shapeloom::mesh::{Domain, NORMAL, TriMesh};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};

use crate::support::{Dice, shared_data};

fn grid(dimensions: [u32; 3], samples: Vec<f32>) -> VoxelGrid {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).expect("a lattice");
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).expect("as many samples")
}

fn exact() -> MarchingCubes {
    MarchingCubes { topology: CellTopology::Exact, ..MarchingCubes::new() }
}

/// The surfaces by all algorithms.
fn all(grid: &VoxelGrid, border: Border) -> [(&'static str, TriMesh); 3] {
    let run = |cubes: MarchingCubes| MarchingCubes { border, ..cubes }.convert(grid).expect("a surface").value;
    let tetrahedra = MarchingTetrahedra { border, ..MarchingTetrahedra::new() };
    [
        ("table", run(MarchingCubes::new())),
        ("exact", run(exact())),
        ("tetrahedra", tetrahedra.convert(grid).expect("a surface").value),
    ]
}

fn topology(mesh: &TriMesh) -> Topology {
    Topology::of(mesh, &Exec::default()).expect("memory enough")
}

/// Closed, 2-manifold, oriented, every vertex used, no triangle twice.
fn assert_sound(mesh: &TriMesh, what: &dyn Fn() -> String) -> Topology {
    let found = topology(mesh);
    assert!(found.boundary.is_empty(), "{}: open edges", what());
    assert!(found.non_manifold_edges.is_empty(), "{}: edges of {:?}", what(), found.non_manifold_edges);
    assert!(found.non_manifold_vertices.is_empty(), "{}: {:?}", what(), found.non_manifold_vertices);
    assert!(found.inconsistent_edges.is_empty() && found.is_oriented(), "{}: not oriented", what());
    assert!(found.duplicate_faces.is_empty() && found.repeating_faces.is_empty(), "{}: faces twice", what());
    assert!(found.isolated_vertices.is_empty(), "{}: vertices of no triangle", what());
    found
}

/// A sample that is inside or not, of a size between 0.05 and 1.
fn sample(dice: &mut Dice, inside: bool) -> f32 {
    let size = (0.05 + 0.95 * dice.unit()) as f32;
    if inside { -size } else { size }
}

#[test]
fn every_choice_of_corners_gives_a_closed_surface_around_the_inside() {
    let mut dice = Dice(1);
    for mask in 0..256u32 {
        for round in 0..4 {
            let samples: Vec<f32> = (0..8).map(|corner| sample(&mut dice, mask >> corner & 1 == 1)).collect();
            let grid = grid([2, 2, 2], samples);
            for (name, mesh) in all(&grid, Border::Closed) {
                let found = assert_sound(&mesh, &|| format!("{name} of {mask:08b}, round {round}"));
                assert_eq!(found.faces == 0, mask == 0, "{mask:08b}");
                let volume = mesh.volume();
                assert!(mask == 0 || volume > 0.0 && volume <= 1.0 + 1e-12, "{name} of {mask:08b}: {volume}");
            }
        }
    }
}

#[test]
fn random_signs_of_all_sizes_give_closed_manifolds() {
    let mut dice = Dice(2);
    for number in 0..2500 {
        let dimensions = [0; 3].map(|_| 2 + (dice.next() % 5) as u32);
        let density = [0.5, 0.2, 0.8, 0.35][number % 4];
        let samples = (0..dimensions.iter().product())
            .map(|_| {
                let inside = dice.unit() < density;
                // Some equal the iso value, some are no numbers.
                match dice.next() % 40 {
                    0 => 0.0,
                    1 if number % 10 == 0 => f32::NAN,
                    2 if number % 10 == 0 => f32::NEG_INFINITY,
                    _ => sample(&mut dice, inside),
                }
            })
            .collect();
        let grid = grid(dimensions, samples);
        for (name, mesh) in all(&grid, Border::Closed) {
            assert_sound(&mesh, &|| format!("{name} of {grid:?}"));
            assert!(mesh.volume() >= -1e-9, "{name}");
        }
        for (name, mesh) in all(&grid, Border::Open) {
            let found = topology(&mesh);
            let sound = found.non_manifold_edges.is_empty()
                && found.non_manifold_vertices.is_empty()
                && found.inconsistent_edges.is_empty()
                && found.isolated_vertices.is_empty();
            assert!(sound, "{name}, open, of {grid:?}");
            let far = DVec3::from(dimensions.map(|count| f64::from(count - 1)));
            for vertex in found.boundary.edges().as_flattened() {
                let at = mesh.positions()[*vertex as usize];
                assert!((0..3).any(|axis| at[axis] == 0.0 || at[axis] == far[axis]), "{name}: open at {at}");
            }
        }
    }
}

#[test]
fn white_noise_gives_a_closed_manifold() {
    let mut dice = Dice(3);
    let samples = (0..40 * 70 * 33).map(|_| (dice.unit() - 0.5) as f32).collect();
    let noise = grid([70, 40, 33], samples);
    // Mirrored, cells that the table does not tell are turned over too.
    let mirrored = noise.transformed(&Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0)));
    for ((name, mesh), (_, other)) in all(&noise, Border::Closed).into_iter().zip(all(&mirrored, Border::Closed)) {
        assert_sound(&mesh, &|| name.to_owned());
        assert_sound(&other, &|| format!("{name}, mirrored"));
        assert!(mesh.volume() > 0.0 && (mesh.volume() - other.volume()).abs() < 1e-6 * mesh.volume(), "{name}");
    }
}

/// A trilinear interpolant on a fine lattice: how many components its inside has, and its Euler number.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Counted {
    components: usize,
    euler: i64,
}

/// Steps of the fine lattice, and of a finer one for thin tunnels.
const FINE: usize = 60;
const FINER: usize = 250;

fn trilinear(corners: &[f64; 8], [x, y, z]: [f64; 3]) -> f64 {
    let part = |bit: bool, x: f64| if bit { x } else { 1.0 - x };
    (0..8).map(|c| corners[c] * part(c & 1 == 1, x) * part(c & 2 == 2, y) * part(c & 4 == 4, z)).sum()
}

/// A row of points of the fine lattice, a bit each.
type FineRow = [u64; 4];

fn common(rows: &[FineRow]) -> FineRow {
    [0, 1, 2, 3].map(|word| rows.iter().fold(u64::MAX, |common, row| common & row[word]))
}

/// How many points a row has less how many steps between neighbours: 1 for a run, 0 for nothing.
fn runs(row: FineRow) -> i64 {
    let points: u32 = row.iter().map(|word| word.count_ones()).sum();
    let next = |word: usize| row[word] >> 1 | row.get(word + 1).map_or(0, |next| next << 63);
    let steps: u32 = (0..4).map(|word| (row[word] & next(word)).count_ones()).sum();
    i64::from(points) - i64::from(steps)
}

/// Counts on the fine lattice: points inside, steps, squares and cubes all whose corners are inside. A row of points lies on a line
/// of the interpolant, which is linear there: its inside is one run.
fn counted(corners: &[f64; 8], iso: f64, steps: usize) -> Counted {
    let fine = |i: usize| i as f64 / steps as f64;
    let mut rows = vec![[0u64; 4]; (steps + 1) * (steps + 1)];
    for (at, row) in rows.iter_mut().enumerate() {
        let (y, z) = (fine(at % (steps + 1)), fine(at / (steps + 1)));
        let (start, end) = (trilinear(corners, [0.0, y, z]) - iso, trilinear(corners, [1.0, y, z]) - iso);
        if start < 0.0 || end < 0.0 {
            (0..=steps).filter(|&i| start + (end - start) * fine(i) < 0.0).for_each(|i| row[i / 64] |= 1 << (i % 64));
        }
    }
    let at = |j: usize, k: usize| rows[k * (steps + 1) + j];
    let mut euler = 0;
    let mut parent: Vec<usize> = (0..rows.len()).collect();
    fn root(parent: &mut [usize], mut at: usize) -> usize {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    }
    for k in 0..=steps {
        for j in 0..=steps {
            let own = k * (steps + 1) + j;
            euler += runs(at(j, k));
            let mut join = |other: usize| {
                let both = common(&[rows[own], rows[other]]);
                if both != [0; 4] {
                    let (a, b) = (root(&mut parent, own), root(&mut parent, other));
                    parent[a] = b;
                }
                runs(both)
            };
            if j < steps {
                euler -= join(own + 1);
            }
            if k < steps {
                euler -= join(own + steps + 1);
            }
            if j < steps && k < steps {
                euler += runs(common(&[at(j, k), at(j + 1, k), at(j, k + 1), at(j + 1, k + 1)]));
            }
        }
    }
    let components = (0..rows.len()).filter(|&row| rows[row] != [0; 4] && parent[row] == row).count();
    Counted { components, euler }
}

/// The same of a mesh around the inside of a cell: every part of the inside and of the outside of a cell reaches the cell's border,
/// so the parts of the surface are those of the inside, and the Euler number of a closed surface is twice that of what it is around.
fn of_mesh(corners: &[f64; 8]) -> Counted {
    let grid = grid([2, 2, 2], corners.map(|corner| corner as f32).to_vec());
    let mesh = exact().convert(&grid).expect("a surface").value;
    let found = assert_sound(&mesh, &|| format!("{corners:?}"));
    assert_eq!(found.euler_characteristic() % 2, 0);
    Counted { components: found.components.len(), euler: found.euler_characteristic() / 2 }
}

/// Cells whose topology is the same at near iso values, so that the fine lattice shows it.
fn stable(corners: &[f64; 8]) -> Option<Counted> {
    let wanted = counted(corners, 0.0, FINE);
    [-0.02, -0.01, 0.01, 0.02].into_iter().all(|iso| counted(corners, iso, FINE) == wanted).then_some(wanted)
}

/// Whether a finer lattice has what was found: thin tunnels fall through the fine one.
fn agrees(corners: &[f64; 8], found: Counted, wanted: Counted) -> bool {
    found == wanted || counted(corners, 0.0, FINER) == found
}

fn random_corners(dice: &mut Dice, mask: usize) -> [f64; 8] {
    // Of very different sizes: tunnels need weak corners beside strong ones.
    [0, 1, 2, 3, 4, 5, 6, 7].map(|corner| {
        let size = 0.04 * 25f64.powf(dice.unit());
        f64::from(if mask >> corner & 1 == 1 { -size as f32 } else { size as f32 })
    })
}

#[test]
fn exact_topology_is_that_of_the_trilinear_interpolant() {
    let mut dice = Dice(4);
    let (mut compared, mut skipped) = (0, 0);
    for round in 0..2560usize {
        let corners = random_corners(&mut dice, round % 256);
        let Some(wanted) = stable(&corners) else {
            skipped += 1;
            continue;
        };
        let found = of_mesh(&corners);
        assert!(agrees(&corners, found, wanted), "{corners:?}: {found:?}, expected {wanted:?}");
        compared += 1;
    }
    assert!(compared > 2000, "{compared} compared, {skipped} skipped");
}

/// The cases of Chernyaev (1995) that faces alone do not tell, each with a tunnel and without: corners that are inside.
const HARD: [(&str, [usize; 2]); 6] = [
    ("4", [0b1000_0001, 0b0111_1110]),
    ("6", [0b1000_0011, 0b0111_1100]),
    ("7", [0b1001_0010, 0b0110_1101]),
    ("10", [0b1100_0011, 0b0011_1100]),
    ("12", [0b0110_1010, 0b1001_0101]),
    ("13", [0b0110_1001, 0b1001_0110]),
];

#[test]
fn hard_cases_occur_with_a_tunnel_and_without() {
    let mut dice = Dice(5);
    for (case, masks) in HARD {
        let (mut with, mut without) = (0, 0);
        for round in 0..3000 {
            let mask = masks[round % 2];
            let mut corners = random_corners(&mut dice, mask);
            // A tunnel joins strong corners between weak ones.
            let strong = [f64::from(u8::from(round % 4 < 2)), 2.0][usize::from(round % 3 == 0)];
            for corner in corners.iter_mut().filter(|corner| f64::from(u8::from(**corner < 0.0)) == strong) {
                *corner = f64::from((corner.signum() * (0.5 + 0.5 * corner.abs())) as f32);
            }
            // Most have no tunnel: those are counted on the fine lattice now and then only.
            let found = of_mesh(&corners);
            let tunnel = found.euler < found.components as i64;
            if !tunnel && round % 32 != 0 {
                continue;
            }
            if let Some(wanted) = stable(&corners) {
                assert!(agrees(&corners, found, wanted), "case {case}: {corners:?}: {found:?}, expected {wanted:?}");
                without += usize::from(!tunnel);
            }
            // The fine lattice may miss a thin tunnel, but it makes none up.
            with += usize::from(tunnel && counted(&corners, 0.0, FINE) == found);
        }
        assert!(with > 0 && without > 0, "case {case}: {with} with a tunnel, {without} without");
    }
}

#[test]
fn spheres_converge_at_second_order() {
    let error = |cells: u32, tetrahedra: bool| {
        let step = 3.0 / f64::from(cells);
        let origin = DVec3::new(-1.5, -1.48, -1.53);
        let lattice = Lattice::along_axes([cells + 1; 3], origin, DVec3::splat(step)).expect("a lattice");
        let samples = (0..lattice.samples())
            .map(|at| (lattice.position(lattice.coordinates(at)).length() - 1.0) as f32)
            .collect();
        let grid = VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).expect("a grid");
        let mesh = match tetrahedra {
            true => MarchingTetrahedra::new().convert(&grid).expect("a sphere").value,
            false => MarchingCubes::new().convert(&grid).expect("a sphere").value,
        };
        let found = assert_sound(&mesh, &|| format!("a sphere of {cells} cells"));
        assert_eq!((found.components.len(), found.euler_characteristic()), (1, 2));
        let pi = std::f64::consts::PI;
        [(mesh.area() - 4.0 * pi).abs() / (4.0 * pi), (mesh.volume() - 4.0 * pi / 3.0).abs() / (4.0 * pi / 3.0)]
    };
    for tetrahedra in [false, true] {
        let (coarse, fine) = (error(16, tetrahedra), error(64, tetrahedra));
        for part in 0..2 {
            // A quarter of the step: a sixteenth of the error, a little more or less.
            let ratio = coarse[part] / fine[part];
            assert!((11.0..24.0).contains(&ratio), "{tetrahedra}: {coarse:?} {fine:?}");
        }
    }
}

#[test]
fn lattices_that_mirror_or_shear_have_outward_faces_and_normals() {
    let columns = [DVec3::new(-0.3, 0.1, 0.0), DVec3::new(0.05, 0.2, 0.1), DVec3::new(0.0, -0.1, 0.4)];
    for flip in [1.0, -1.0] {
        let linear = DMat3::from_cols(columns[0] * flip, columns[1], columns[2]) * 0.5;
        let placement = Affine { linear, translation: DVec3::new(5e6, -3.0, 1.0) };
        let lattice = Lattice::try_new([28, 34, 24], placement).expect("three directions");
        let center = lattice.position([14, 17, 12]);
        // An ellipsoid in space, so that normals are not those of the lattice.
        let value = |p: DVec3| (p - center).dot((p - center) * DVec3::new(1.0, 2.0, 0.7)) - 1.0;
        for sign in [1.0f32, -1.0] {
            let samples = (0..lattice.samples())
                .map(|at| sign * value(lattice.position(lattice.coordinates(at))) as f32)
                .collect();
            let quantity = if sign > 0.0 { Quantity::SignedDistance } else { Quantity::Density };
            let grid = VoxelGrid::try_new(lattice, Samples::F32(samples), quantity).expect("a grid");
            let iso = IsoValue::At(0.0);
            let meshes = [
                MarchingCubes { iso, normals: true, ..MarchingCubes::new() }.convert(&grid).expect("a surface").value,
                MarchingCubes { iso, normals: true, ..exact() }.convert(&grid).expect("a surface").value,
                MarchingTetrahedra { iso, normals: true, ..MarchingTetrahedra::new() }
                    .convert(&grid)
                    .expect("a surface")
                    .value,
            ];
            for mesh in meshes {
                assert_sound(&mesh, &|| format!("flip {flip}, sign {sign}"));
                let wanted = 4.0 / 3.0 * std::f64::consts::PI / (1.0f64 * 2.0 * 0.7).sqrt();
                assert!((mesh.volume() / wanted - 1.0).abs() < 0.05, "{}", mesh.volume());
                let normals = mesh.attribute(Domain::Vertex, NORMAL).expect("normals were asked for");
                for (vertex, &at) in mesh.positions().iter().enumerate() {
                    let outward = ((at - center) * DVec3::new(1.0, 2.0, 0.7)).normalize();
                    assert!(normals.vector(vertex).dot(outward) > 0.995, "{at}: {}", normals.vector(vertex));
                }
            }
        }
    }
}

#[test]
fn narrow_samples_give_the_surface_of_wide_ones() {
    let mut dice = Dice(6);
    let numbers: Vec<u8> = (0..9 * 8 * 7).map(|_| (dice.next() % 256) as u8).collect();
    let lattice = Lattice::along_axes([9, 8, 7], DVec3::ZERO, DVec3::ONE).expect("a lattice");
    let run = |samples: Samples, quantity: Quantity, iso: IsoValue| {
        let grid = VoxelGrid::try_new(lattice, samples, quantity).expect("a grid");
        [
            MarchingCubes { iso, normals: true, ..MarchingCubes::new() }.convert(&grid).expect("a surface").value,
            MarchingCubes { iso, normals: true, ..exact() }.convert(&grid).expect("a surface").value,
            MarchingTetrahedra { iso, normals: true, ..MarchingTetrahedra::new() }.convert(&grid).expect("one").value,
        ]
    };
    let wide = |scale: f32| Samples::F32(numbers.iter().map(|&number| f32::from(number) * scale).collect());
    let iso = IsoValue::At(100.5);
    let wanted = run(wide(1.0), Quantity::Density, iso);
    assert!(run(Samples::U8(numbers.clone()), Quantity::Density, iso) == wanted);
    let words = Samples::U16(numbers.iter().map(|&number| u16::from(number)).collect());
    assert!(run(words, Quantity::Density, iso) == wanted);
    let mut bits = vec![0u64; numbers.len().div_ceil(64)];
    numbers.iter().enumerate().filter(|(_, number)| **number > 99).for_each(|(i, _)| bits[i / 64] |= 1 << (i % 64));
    let full = numbers.iter().map(|&number| f32::from(u8::from(number > 99))).collect();
    let wanted = run(Samples::F32(full), Quantity::Occupancy, IsoValue::Auto);
    assert!(run(Samples::Bits(bits), Quantity::Occupancy, IsoValue::Auto) == wanted);
}

#[test]
fn values_beyond_the_samples_give_nothing_or_the_whole_lattice() {
    let grid = grid([3, 3, 3], (0..27).map(|at| at as f32).collect());
    for (iso, faces) in [(-5.0, 0), (100.0, 1), (1e30, 1), (f64::from(f32::MIN), 0)] {
        let converted = MarchingCubes { iso: IsoValue::At(iso), ..MarchingCubes::new() }.convert(&grid).expect("one");
        assert_eq!(converted.value.triangles().len().min(1), faces, "{iso}");
        let empty = converted.report.findings.iter().any(|finding| finding.code == "W-iso-empty");
        assert_eq!(empty, faces == 0);
        // All samples inside: the box of the lattice.
        assert!(faces == 0 || (converted.value.volume() - 8.0).abs() < 1e-12);
    }
    for dimensions in [[1, 1, 1], [1, 4, 3], [5, 1, 1]] {
        let one = self::grid(dimensions, vec![-1.0; dimensions.iter().product::<u32>() as usize]);
        for (name, mesh) in all(&one, Border::Closed) {
            assert_sound(&mesh, &|| format!("{name} of {dimensions:?}"));
            assert!(mesh.volume() == 0.0 && !mesh.triangles().is_empty());
        }
        assert!(all(&one, Border::Open).iter().all(|(_, mesh)| mesh.positions().is_empty()));
    }
}

#[test]
fn samples_that_are_no_numbers_leave_the_deviation_unknown() {
    let mut samples = vec![-1.0f32; 27];
    samples[13] = f32::NAN;
    let converted = MarchingCubes::new().convert(&grid([3, 3, 3], samples)).expect("a surface");
    assert_eq!(converted.report.deviation, Deviation::Unknown);
    assert!(converted.report.findings.iter().any(|finding| finding.code == "W-iso-not-finite"));
    assert_eq!(assert_sound(&converted.value, &|| String::new()).components.len(), 2);
}

/// One sample of eight is larger than the value: a corner is cut off by one triangle.
#[test]
fn the_one_cell_file_has_one_triangle() {
    let Some(path) = shared_data("malformed/volume/one_cell.nrrd") else { return };
    let bytes = std::fs::read(path).expect("a file");
    let lattice = Lattice::along_axes([2, 2, 2], DVec3::ZERO, DVec3::ONE).expect("a lattice");
    let samples = Samples::U8(bytes[bytes.len() - 8..].to_vec());
    let grid = VoxelGrid::try_new(lattice, samples, Quantity::Density).expect("eight samples");
    let cubes = MarchingCubes { iso: IsoValue::At(4.5), border: Border::Open, ..MarchingCubes::new() };
    let mesh = cubes.convert(&grid).expect("a surface").value;
    assert_eq!(mesh.triangles().len(), 1);
    assert_eq!(mesh.corners(0), [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis * 0.5));
    // The inside is the other side: its triangle looks the other way.
    let below = MarchingCubes { inside: InsideChoice::Below, ..cubes };
    let mesh = below.convert(&grid).expect("a surface").value;
    assert_eq!(mesh.corners(0), [DVec3::X, DVec3::Z, DVec3::Y].map(|axis| axis * 0.5));
}
