//! Dual isosurfaces: manifold whatever the samples, oriented, and where they should be.

use shapeloom::core::glam::{DMat3, DVec3};
use shapeloom::core::{Affine, AxisAngle, Category, Convert, Converted, Deviation, Exec, Field, Threads};
use shapeloom::isosurface::{
    Border, DualContouring, FieldSlabs, InsideChoice, IsoValue, Lattice, ManifoldSurfaceNets, SurfaceNets,
};
use shapeloom::judge::Topology;
use shapeloom::mesh::{Domain, NORMAL, TriMesh};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};

use crate::support::Dice;

fn grid(dimensions: [u32; 3], samples: Vec<f32>) -> VoxelGrid {
    let lattice = Lattice::along_axes(dimensions, DVec3::ZERO, DVec3::ONE).expect("a lattice");
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).expect("as many as the lattice has")
}

fn on(placement: Affine, grid: &VoxelGrid) -> VoxelGrid {
    let lattice = Lattice::try_new(grid.lattice().dimensions(), placement).expect("a lattice");
    VoxelGrid::try_new(lattice, grid.samples().clone(), grid.quantity()).expect("as many as the lattice has")
}

fn nets(source: &VoxelGrid) -> Converted<TriMesh> {
    ManifoldSurfaceNets::new().convert(source).expect("nets of finite samples")
}

fn is_inside(grid: &VoxelGrid, at: [i64; 3]) -> bool {
    let dimensions = grid.lattice().dimensions();
    let exists = (0..3).all(|axis| at[axis] >= 0 && at[axis] < i64::from(dimensions[axis]));
    exists && grid.sample(at.map(|i| i as u32)) < 0.0
}

/// The Euler number of the surface. The inside, cut along the lattice, is a ball for each component of inside corners of a cell, a disc
/// for each one of a face, a segment for each edge with an inside end: their numbers, with alternating signs, are that of the solid, and
/// its border has twice that.
///
/// Corners are joined along edges alone, so two that are diagonal across a face are two discs; where both cells would have the two
/// segments on that face in one piece they are joined to one.
fn expected_euler(grid: &VoxelGrid) -> i64 {
    let [nx, ny, nz] = grid.lattice().dimensions().map(i64::from);
    let mut sum = 0;
    for (k, j, i) in (-1..=nz).flat_map(|k| (-1..=ny).flat_map(move |j| (-1..=nx).map(move |i| (k, j, i)))) {
        for axes in 0..8usize {
            // The element of the lattice that runs from here along these axes.
            let spans: Vec<usize> = (0..8).filter(|corner| corner & !axes == 0).collect();
            let at = |c: usize| [i + (c & 1) as i64, j + (c >> 1 & 1) as i64, k + (c >> 2) as i64];
            let inside: Vec<usize> = spans.into_iter().filter(|&corner| is_inside(grid, at(corner))).collect();
            let mut name: Vec<usize> = (0..8).collect();
            for &p in &inside {
                for &q in inside.iter().filter(|&&q| (p ^ q).is_power_of_two()) {
                    let (p, q) = (name[p], name[q]);
                    name.iter_mut().filter(|name| **name == q).for_each(|name| *name = p);
                }
            }
            let components = inside.iter().filter(|&&corner| name[corner] == corner).count() as i64;
            sum += if axes.count_ones() % 2 == 1 { components } else { -components };
        }
    }
    2 * (sum + double_faces(grid))
}

/// Checks everything that holds for a closed result.
fn check_closed(mesh: &TriMesh, what: &str) -> Topology {
    let topology = Topology::of(mesh, &Exec::default()).expect("a mesh of finite size");
    assert!(topology.boundary.edges().is_empty(), "{what}: open edges");
    assert!(topology.non_manifold_edges.is_empty(), "{what}: {:?}", topology.non_manifold_edges);
    assert!(topology.non_manifold_vertices.is_empty(), "{what}: {:?}", topology.non_manifold_vertices);
    assert!(topology.inconsistent_edges.is_empty() && topology.is_oriented(), "{what}: not oriented");
    assert!(topology.isolated_vertices.is_empty(), "{what}: vertices without triangles");
    assert!(topology.repeating_faces.is_empty() && topology.duplicate_faces.is_empty(), "{what}: odd faces");
    topology
}

/// How many faces between two cells have inside corners diagonal that a path of edges joins in both cells.
fn double_faces(grid: &VoxelGrid) -> i64 {
    let [nx, ny, nz] = grid.lattice().dimensions().map(i64::from);
    let mut count = 0;
    for axis in 0..3 {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for k in -1..=nz {
            for j in -1..=ny {
                for i in -1..=nx {
                    let step = |corner: [i64; 3], axis: usize, by: i64| {
                        let mut moved = corner;
                        moved[axis] += by;
                        moved
                    };
                    let p = [i, j, k];
                    let (q, s) = (step(p, b, 1), step(p, c, 1));
                    let r = step(q, c, 1);
                    let [ip, iq, ir, is] = [p, q, r, s].map(|at| is_inside(grid, at));
                    if !(ip == ir && iq == is && ip != iq) {
                        continue;
                    }
                    // Double on a side: the four samples there join the two inside ones by a path of edges.
                    let double = |by: i64| {
                        let side = [p, q, r, s].map(|at| is_inside(grid, step(at, axis, by)));
                        let (from, to) = if ip { (0, 2) } else { (1, 3) };
                        let path = |way: usize| side[from] && side[to] && side[way];
                        path((from + 1) % 4) || path((from + 3) % 4)
                    };
                    count += i64::from(double(1) && double(-1));
                }
            }
        }
    }
    count
}

#[test]
fn every_choice_of_eight_corners_is_manifold() {
    for corners in 0..256u32 {
        let samples = (0..8).map(|c| if corners >> c & 1 == 1 { -1.0 } else { 1.0 }).collect();
        let source = grid([2; 3], samples);
        let mesh = nets(&source).value;
        let topology = check_closed(&mesh, &format!("{corners:08b}"));
        assert_eq!(topology.euler_characteristic(), expected_euler(&source), "{corners:08b}");
        assert!(mesh.volume() >= 0.0, "{corners:08b}");
    }
}

/// Every pattern of 4 x 4 x 2 random signs and larger, so that cells with double faces meet.
#[test]
fn random_signs_are_manifold_and_have_the_right_euler_number() {
    let mut dice = Dice(99);
    let (mut tries, mut doubles) = (0, 0);
    for _ in 0..6 {
        for index in 0..125 {
            let dimensions = [2 + index % 5, 2 + index / 5 % 5, 2 + index / 25];
            let share = [0.2, 0.5, 0.75][dice.next() as usize % 3];
            let samples: Vec<f32> = (0..dimensions.iter().product())
                .map(|_| if dice.unit() < share { -1.0 - dice.unit() as f32 } else { dice.unit() as f32 })
                .collect();
            let source = grid(dimensions, samples);
            let mesh = nets(&source).value;
            let topology = check_closed(&mesh, &format!("{dimensions:?} {:?}", source.samples()));
            doubles += double_faces(&source);
            assert_eq!(topology.euler_characteristic(), expected_euler(&source), "{dimensions:?}");
            tries += 1;
        }
    }
    assert!(tries == 750 && doubles > 100, "{doubles}");
}

/// Larger noise, which crosses words and blocks of layers, mirrored, sheared, and on any number of threads.
#[test]
fn white_noise_is_manifold_however_it_is_placed_and_the_same_on_any_number_of_threads() {
    let mut dice = Dice(5);
    for dimensions in [[70u32, 9, 40], [5, 6, 97], [130, 4, 35]] {
        let samples = (0..dimensions.iter().product()).map(|_| dice.unit() as f32 - 0.5).collect();
        let source = grid(dimensions, samples);
        let shear = Affine {
            linear: DMat3::from_cols(DVec3::new(-0.5, 0.1, 0.0), DVec3::new(0.3, 0.7, 0.1), DVec3::new(0.0, 0.2, 1.1)),
            translation: DVec3::new(5e6, -3.0, 2.0),
        };
        for (placement, mirrors) in [(*source.lattice().placement(), false), (shear, true)] {
            assert_eq!(placement.reverses_orientation(), mirrors);
            let placed = on(placement, &source);
            let nets = ManifoldSurfaceNets { normals: true, ..ManifoldSurfaceNets::new() };
            let alone = nets.convert_with(&placed, &Exec::default().with_threads(Threads::Sequential));
            let alone = alone.expect("nets of noise");
            check_closed(&alone.value, &format!("{dimensions:?}"));
            assert!(alone.value.volume() > 0.0);
            for threads in [1, 2, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
                let found = pool.install(|| nets.convert(&placed)).expect("nets of noise");
                assert!(found == alone, "{dimensions:?} on {threads} threads");
            }
        }
    }
}

fn ball(side: u32, radius: f64) -> VoxelGrid {
    let spacing = 2.0 / f64::from(side - 1);
    let lattice = Lattice::along_axes([side; 3], DVec3::splat(-1.0), DVec3::splat(spacing)).expect("a lattice");
    let center = DVec3::new(0.013, -0.021, 0.007);
    let sample = |at: u64| (lattice.position(lattice.coordinates(at)).distance(center) - radius) as f32;
    let samples = (0..lattice.samples()).map(sample).collect();
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).expect("as many as the lattice has")
}

#[test]
fn area_and_volume_of_a_ball_converge_at_second_order() {
    let radius = 0.7f64;
    let (volume, area) =
        (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3), 4.0 * std::f64::consts::PI * radius.powi(2));
    let errors = [20, 40, 80].map(|side| {
        let converted = nets(&ball(side, radius));
        let mesh = converted.value;
        assert_eq!(check_closed(&mesh, "a ball").euler_characteristic(), 2);
        [(mesh.volume() / volume - 1.0).abs(), (mesh.area() / area - 1.0).abs()]
    });
    for quantity in 0..2 {
        let [coarse, middle, fine] = errors.map(|error| error[quantity]);
        // Halving the cells divides the error by four; by three at least where it is not smooth.
        assert!(coarse > 3.0 * middle && middle > 3.0 * fine && fine < 2e-3, "{errors:?}");
    }
}

#[test]
fn normals_of_a_ball_point_outward() {
    let converter = ManifoldSurfaceNets { normals: true, ..ManifoldSurfaceNets::new() };
    for mirror in [1.0, -1.0] {
        let source = ball(32, 0.7);
        let placement = Affine::from_scale(DVec3::new(2.0, mirror, 1.0)) * *source.lattice().placement();
        let mesh = converter.convert(&on(placement, &source)).expect("a ball").value;
        let normals = mesh.attribute(Domain::Vertex, NORMAL).expect("normals");
        assert!(mesh.volume() > 0.0);
        for (vertex, &position) in mesh.positions().iter().enumerate() {
            let [x, y, z] = (position - placement.vector(DVec3::ZERO)).to_array();
            let center = DVec3::new(0.013 * 2.0, -0.021 * mirror, 0.007);
            let true_normal = (DVec3::new(x / 4.0, y, z) - center * DVec3::new(0.25, 1.0, 1.0)).normalize();
            let normal = normals.vector(vertex);
            assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(true_normal) > 0.99, "{vertex}");
        }
    }
}

/// A full lattice is cut off at its border: the box of the samples, exactly.
#[test]
fn full_lattices_give_their_box_and_thin_ones_are_closed() {
    for dimensions in [[4u32, 3, 5], [64, 2, 3], [63, 2, 2], [62, 3, 2]] {
        let count: u32 = dimensions.iter().product();
        for value in [-1.0, -3e38, -1e-40] {
            let mesh = nets(&grid(dimensions, vec![value; count as usize])).value;
            assert_eq!(check_closed(&mesh, "a full lattice").euler_characteristic(), 2);
            let [x, y, z] = dimensions.map(|count| f64::from(count - 1));
            // Edges and corners of the box are vertices, so nothing is cut off.
            assert!((mesh.volume() - x * y * z).abs() < 1e-12 * x * y * z, "{dimensions:?}: {}", mesh.volume());
            assert!((mesh.area() - 2.0 * (x * y + y * z + z * x)).abs() < 1e-11 * x * y, "{dimensions:?}");
        }
    }
    for dimensions in [[1u32, 1, 1], [1, 5, 4], [3, 1, 4], [4, 3, 1], [1, 70, 1], [70, 1, 1], [1, 1, 70]] {
        let mut dice = Dice(8);
        let samples = (0..dimensions.iter().product()).map(|_| if dice.unit() < 0.7 { -1.0 } else { 1.0 }).collect();
        let source = grid(dimensions, samples);
        let mesh = nets(&source).value;
        let topology = check_closed(&mesh, &format!("{dimensions:?}"));
        assert_eq!(topology.euler_characteristic(), expected_euler(&source));
        let open = ManifoldSurfaceNets { border: Border::Open, ..ManifoldSurfaceNets::new() };
        let converted = open.convert(&source).expect("nothing");
        assert!(converted.value.triangles().is_empty());
        assert!(converted.report.findings.iter().any(|finding| finding.code == "W-iso-empty"));
    }
}

#[test]
fn open_borders_have_no_quads_beyond_and_no_stray_vertices() {
    let mut dice = Dice(21);
    let open = ManifoldSurfaceNets { border: Border::Open, normals: true, ..ManifoldSurfaceNets::new() };
    for _ in 0..60 {
        let dimensions = [0; 3].map(|_| 2 + dice.next() as u32 % 5);
        let samples: Vec<f32> = (0..dimensions.iter().product()).map(|_| dice.unit() as f32 - 0.4).collect();
        let source = grid(dimensions, samples);
        let mesh = open.convert(&source).expect("an open surface").value;
        // By definition: edges inside the lattice, two triangles each.
        let mut expected = 0;
        for (axis, along) in [[1i64, 0, 0], [0, 1, 0], [0, 0, 1]].into_iter().enumerate() {
            for at in 0..source.lattice().samples() {
                let p = source.lattice().coordinates(at).map(i64::from);
                let q = [p[0] + along[0], p[1] + along[1], p[2] + along[2]];
                let within = (0..3).all(|other| {
                    let last = i64::from(dimensions[other]) - 1;
                    if other == axis { q[other] <= last } else { p[other] > 0 && p[other] < last }
                });
                expected += usize::from(within && is_inside(&source, p) != is_inside(&source, q));
            }
        }
        assert_eq!(mesh.triangles().len(), 2 * expected);
        let topology = Topology::of(&mesh, &Exec::default()).expect("a small mesh");
        assert!(topology.isolated_vertices.is_empty() && topology.non_manifold_edges.is_empty());
        assert!(topology.inconsistent_edges.is_empty());
    }
}

#[test]
fn grids_of_any_width_give_the_same_surface() {
    let mut dice = Dice(77);
    let lattice = Lattice::along_axes([9, 7, 8], DVec3::ONE, DVec3::new(0.5, 1.0, 2.0)).expect("a lattice");
    let full: Vec<bool> = (0..lattice.samples()).map(|_| dice.unit() < 0.5).collect();
    let mut words = vec![0u64; full.len().div_ceil(64)];
    full.iter().enumerate().filter(|(_, full)| **full).for_each(|(i, _)| words[i / 64] |= 1 << (i % 64));
    let each = [
        Samples::F32(full.iter().map(|&full| f32::from(u8::from(full))).collect()),
        Samples::U8(full.iter().map(|&full| u8::from(full)).collect()),
        Samples::U16(full.iter().map(|&full| u16::from(full)).collect()),
        Samples::Bits(words),
    ];
    let meshes = each.map(|samples| {
        nets(&VoxelGrid::try_new(lattice, samples, Quantity::Occupancy).expect("as many as the lattice has"))
    });
    check_closed(&meshes[0].value, "occupancy");
    assert!(meshes.iter().all(|mesh| *mesh == meshes[0]));
}

#[test]
fn strange_samples_are_outside_and_told() {
    let mut dice = Dice(13);
    for strange in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.2e38, -3.2e38] {
        let samples: Vec<f32> =
            (0..7 * 8 * 66).map(|_| if dice.unit() < 0.2 { strange } else { dice.unit() as f32 - 0.5 }).collect();
        let count = samples.iter().filter(|sample| !sample.is_finite()).count() as u64;
        let source = grid([66, 7, 8], samples.clone());
        for normals in [false, true] {
            let converter = ManifoldSurfaceNets { normals, ..ManifoldSurfaceNets::new() };
            let Converted { value: mesh, report } = converter.convert(&source).expect("strange samples are taken");
            check_closed(&mesh, &format!("{strange}"));
            let told = report.findings.iter().find(|finding| finding.code == "W-iso-not-finite");
            assert_eq!(told.map_or(0, |finding| finding.count), count, "{strange}");
            assert_eq!(report.deviation == Deviation::Unknown, count > 0);
            if count > 0 {
                // The same surface as with outside samples in their place, but for where edges to them are crossed.
                let outside = samples.iter().map(|&sample| if sample.is_finite() { sample } else { 1.0 }).collect();
                assert_eq!(nets(&grid([66, 7, 8], outside)).value.triangles().len(), mesh.triangles().len());
            }
        }
    }
}

#[test]
fn iso_values_out_of_range_give_nothing_and_say_so() {
    let source = ball(12, 0.7);
    for (iso, inside, empty) in [
        (-5.0, InsideChoice::Below, true),
        (5.0, InsideChoice::Above, true),
        (5.0, InsideChoice::Below, false),
        (3e38, InsideChoice::Below, false),
        (-3e38, InsideChoice::Below, true),
    ] {
        let converter = ManifoldSurfaceNets { iso: IsoValue::At(iso), inside, ..ManifoldSurfaceNets::new() };
        let Converted { value: mesh, report } = converter.convert(&source).expect("nothing, or the whole lattice");
        assert_eq!(mesh.triangles().is_empty(), empty, "{iso}");
        assert_eq!(report.findings.iter().any(|finding| finding.code == "W-iso-empty"), empty, "{iso}");
        if !empty {
            assert!((mesh.volume() - 8.0).abs() < 1e-9, "{iso}: {}", mesh.volume());
        }
    }
    // Single precision does not hold it.
    let huge = ManifoldSurfaceNets { iso: IsoValue::At(1e300), ..ManifoldSurfaceNets::new() };
    assert_eq!(huge.convert(&source).unwrap_err().category(), Category::Usage);
}

/// The distance to a box around the origin, turned.
struct TurnedBox {
    half: DVec3,
    turn: Affine,
}

impl TurnedBox {
    fn corners(&self) -> [DVec3; 8] {
        let sign = |c: usize, bit: usize| if c >> bit & 1 == 1 { 1.0 } else { -1.0 };
        std::array::from_fn(|c| self.turn.point(self.half * DVec3::new(sign(c, 0), sign(c, 1), sign(c, 2))))
    }
}

impl Field for TurnedBox {
    fn value(&self, point: DVec3) -> f64 {
        let local = self.turn.inverse().expect("a rotation").point(point).abs() - self.half;
        local.max(DVec3::ZERO).length() + local.max_element().min(0.0)
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        let local = self.turn.inverse().expect("a rotation").point(point);
        let beyond = local.abs() - self.half;
        let gradient = match beyond.max_element() > 0.0 {
            true => beyond.max(DVec3::ZERO).normalize() * local.signum(),
            false => {
                let axis = (0..3).max_by(|&a, &b| beyond[a].total_cmp(&beyond[b])).expect("three axes");
                DVec3::AXES[axis] * local[axis].signum()
            }
        };
        self.turn.vector(gradient)
    }
}

/// The largest distance from a corner to the nearest vertex.
fn corner_error(mesh: &TriMesh, field: &TurnedBox) -> f64 {
    let nearest = |corner: DVec3| mesh.positions().iter().map(|p| p.distance(corner)).fold(f64::INFINITY, f64::min);
    field.corners().map(nearest).into_iter().fold(0.0, f64::max)
}

#[test]
fn dual_contouring_keeps_the_edges_and_corners_of_a_box() {
    let lattice = Lattice::along_axes([31; 3], DVec3::splat(-1.0), DVec3::splat(2.0 / 30.0)).expect("a lattice");
    let cell = 2.0 / 30.0;
    let turned = Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, 3.0), 0.6).expect("an axis"));
    let half = DVec3::new(0.52, 0.43, 0.61);
    for (turn, straight) in [(Affine::IDENTITY, true), (turned, false)] {
        let field = TurnedBox { half, turn };
        let volume = 8.0 * half.x * half.y * half.z;
        let slabs = FieldSlabs::new(&field, lattice);
        let nets = ManifoldSurfaceNets::new().convert(&slabs).expect("a box").value;
        let sampled = DualContouring::new().convert(&slabs).expect("a box");
        let exact = DualContouring::new().field(&field, lattice, &Exec::default()).expect("a box");
        for mesh in [&nets, &sampled.value, &exact.value] {
            assert_eq!(check_closed(mesh, "a box").euler_characteristic(), 2);
            assert_eq!(mesh.triangles().len(), nets.triangles().len());
        }
        let errors = [&nets, &sampled.value, &exact.value].map(|mesh| corner_error(mesh, &field) / cell);
        let volumes = [&nets, &sampled.value, &exact.value].map(|mesh| (mesh.volume() / volume - 1.0).abs());
        // Surface nets cut corners by a good part of a cell; Hermite data meets them.
        assert!(errors[0] > 0.2, "{errors:?}");
        // Distances are round beyond an edge, so crossings of samples near it are off.
        assert!(errors[1] < 0.8 * errors[0] && errors[2] < 0.3 * errors[0], "{errors:?}");
        assert!(volumes[1] < 0.7 * volumes[0] && volumes[2] < 0.2 * volumes[0], "{volumes:?}");
        if straight {
            assert!(errors[2] < 1e-9 && volumes[2] < 1e-9, "{errors:?} {volumes:?}");
        }
    }
}

/// On smooth shapes it converges as surface nets do; normals point outward.
#[test]
fn dual_contouring_of_a_ball_converges() {
    let volume = 4.0 / 3.0 * std::f64::consts::PI * 0.7f64.powi(3);
    let converter = DualContouring { normals: true, ..DualContouring::new() };
    let errors = [20, 40, 80].map(|side| {
        let mesh = converter.convert(&ball(side, 0.7)).expect("a ball").value;
        assert_eq!(check_closed(&mesh, "a ball").euler_characteristic(), 2);
        let normals = mesh.attribute(Domain::Vertex, NORMAL).expect("normals");
        for (vertex, position) in mesh.positions().iter().enumerate() {
            assert!(normals.vector(vertex).dot(*position) > 0.6);
        }
        (mesh.volume() / volume - 1.0).abs()
    });
    // At least of second order; the errors inside and outside of the ball cancel in part, so that they do not fall evenly.
    assert!((0..3).all(|k| errors[k] < 1e-3 * 0.25f64.powi(k as i32)), "{errors:?}");
}

#[test]
fn dual_contouring_of_noise_is_manifold_and_the_same_on_any_number_of_threads() {
    let mut dice = Dice(3);
    let dimensions = [40u32, 5, 70];
    for strange in [false, true] {
        let samples = (0..dimensions.iter().product())
            .map(|_| if strange && dice.unit() < 0.1 { f32::NAN } else { dice.unit() as f32 - 0.5 })
            .collect();
        let source = grid(dimensions, samples);
        let alone = DualContouring::new().convert_with(&source, &Exec::default().with_threads(Threads::Sequential));
        let alone = alone.expect("noise");
        check_closed(&alone.value, "noise");
        assert!(alone.report.findings.iter().any(|finding| finding.code == "W-dual-contouring-held"));
        let nets = nets(&source).value;
        assert_eq!(nets.positions().len(), alone.value.positions().len());
        for threads in [1, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            assert!(pool.install(|| DualContouring::new().convert(&source)).expect("noise") == alone, "{threads}");
        }
    }
}

#[test]
fn surface_nets_of_a_ball_agree_with_the_manifold_ones() {
    for border in [Border::Closed, Border::Open] {
        for (radius, mirror) in [(0.7, 1.0), (1.2, -1.0)] {
            let source = ball(24, radius);
            let source = on(Affine::from_scale(DVec3::new(1.0, mirror, 1.0)) * *source.lattice().placement(), &source);
            let ours =
                ManifoldSurfaceNets { border, ..ManifoldSurfaceNets::new() }.convert(&source).expect("a ball").value;
            let converter = SurfaceNets { border, normals: true, ..SurfaceNets::new() };
            let Converted { value: theirs, report } = converter.convert(&source).expect("a ball");
            assert_eq!(theirs.triangles().len(), ours.triangles().len());
            assert_eq!(report.find("non_manifold_edges"), Some(0.0));
            let normals = theirs.attribute(Domain::Vertex, NORMAL).expect("normals");
            assert!((0..normals.len()).all(|vertex| (normals.vector(vertex).length() - 1.0).abs() < 1e-9));
            if border == Border::Closed {
                check_closed(&theirs, "a ball");
                assert!((theirs.volume() / ours.volume() - 1.0).abs() < 1e-4, "{} {}", theirs.volume(), ours.volume());
            }
            let mut pairs: [Vec<[i64; 3]>; 2] = [&ours, &theirs]
                .map(|mesh| mesh.positions().iter().map(|p| (*p * 1e4).round().to_array().map(|x| x as i64)).collect());
            pairs.iter_mut().for_each(|places| places.sort_unstable());
            let near = pairs[0].iter().zip(&pairs[1]).filter(|(a, b)| (0..3).all(|k| (a[k] - b[k]).abs() <= 1)).count();
            assert!(
                near * 100 >= pairs[0].len() * 99 && pairs[0].len() == pairs[1].len(),
                "{near} of {}",
                pairs[0].len()
            );
        }
    }
}

#[test]
fn surface_nets_of_noise_say_that_they_are_not_manifold() {
    let mut dice = Dice(12);
    let samples =
        (0..9 * 8 * 7).map(|_| if dice.unit() < 0.1 { f32::NAN } else { (dice.unit() as f32 - 0.5) * 3e38 }).collect();
    let Converted { value: mesh, report } = SurfaceNets::new().convert(&grid([9, 8, 7], samples)).expect("noise");
    let topology = Topology::of(&mesh, &Exec::default()).expect("a small mesh");
    assert!(topology.boundary.edges().is_empty() && mesh.first_non_finite().is_none());
    let counted = topology.non_manifold_edges.len();
    let told = report.findings.iter().find(|finding| finding.code == "W-surface-nets-edges");
    assert_eq!(told.map(|finding| finding.count), Some(counted as u64));
    assert!(counted > 0 && mesh.volume() > 0.0);
    assert!(report.findings.iter().any(|finding| finding.code == "W-iso-not-finite"));
}
