//! Distances against closed forms, against dense sampling, and their laws.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{CancelFlag, Exec, Stop, Threads};
use shapeloom_spatial::{BvhError, TriangleBvh};

use super::*;
use crate::JudgeError;

type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

fn shape((positions, triangles): &Mesh) -> Simplices<'_> {
    Simplices::new(&positions[..], &triangles[..])
}

fn exact() -> Distances {
    Distances { relative_gap: 1e-6, samples: 500, ..Distances::new() }
}

fn between(options: &Distances, a: &Mesh, b: &Mesh) -> Hausdorff {
    options.hausdorff(&shape(a), &shape(b), &Exec::default()).unwrap()
}

/// The bounds hold `wanted` and are as near to it as `gap`, relative.
fn assert_bounds(found: &DirectedHausdorff, wanted: f64, gap: f64) {
    assert!(found.lower <= wanted * (1.0 + 1e-15) && wanted <= found.upper * (1.0 + 1e-15), "{found:?} {wanted}");
    assert!(found.upper - found.lower <= gap * wanted && found.converged, "{found:?} {wanted}");
}

fn moved(mesh: &Mesh, f: impl Fn(DVec3) -> DVec3) -> Mesh {
    (mesh.0.iter().map(|&p| f(p)).collect(), mesh.1.clone())
}

/// A square of side 1 with `n` by `n` cells, its diagonals all one way.
fn grid(n: u32) -> Mesh {
    let positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| [i, j]))
        .map(|[i, j]| DVec3::new(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), 0.0));
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let triangles = (0..n * n).flat_map(|k| {
        let (i, j) = (k % n, k / n);
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    (positions.collect(), triangles.collect())
}

fn cube() -> Mesh {
    let positions = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - 0.5);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (positions.collect(), quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

fn octahedron() -> Mesh {
    let positions = vec![DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let triangles = vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    (positions, triangles)
}

/// A ball of `rings` by twice as many cells, with radii between `1 - bump` and `1 + bump`.
fn ball(rings: u32, bump: f64) -> Mesh {
    let (sectors, mut dice) = (2 * rings, Dice(7));
    let mut positions = vec![DVec3::Z, -DVec3::Z];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            let direction = DVec3::new(polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos());
            positions.push(direction * (1.0 + bump * dice.signed()));
        }
    }
    let at = |ring: u32, sector: u32| match ring {
        0 => 0,
        ring if ring == rings => 1,
        ring => 2 + (ring - 1) * sectors + sector % sectors,
    };
    let cells = (0..rings * sectors).flat_map(|k| {
        let (ring, sector) = (k / sectors, k % sectors);
        let [a, b, c, d] = [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(i, j)| at(ring + i, sector + j));
        [[a, c, d], [a, d, b]]
    });
    (positions, cells.filter(|[a, b, c]| a != b && b != c && c != a).collect())
}

struct Dice(u64);

impl Dice {
    fn signed(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn point(&mut self) -> DVec3 {
        DVec3::new(self.signed(), self.signed(), self.signed())
    }

    fn soup(&mut self, count: u32, size: f64) -> Mesh {
        let positions = (0..count).flat_map(|_| {
            let center = self.point();
            [0; 3].map(|_| center + self.point() * size)
        });
        (positions.collect(), (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect())
    }
}

/// The distance from a point to a triangle, by the regions of its corners and sides: another way than the code's.
fn to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let to_segment = |a: DVec3, b: DVec3| {
        let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        p.distance(a + (b - a) * if t.is_nan() { 0.0 } else { t })
    };
    let n = (b - a).cross(c - a);
    let left = |from: DVec3, to: DVec3| n.cross(to - from).dot(p - from) >= 0.0;
    if n.length_squared() > 0.0 && left(a, b) && left(b, c) && left(c, a) {
        return (p - a).dot(n.normalize()).abs();
    }
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}

/// The largest distance of the points of a lattice on each triangle, and how far another point may be from one of them.
fn sampled(a: &Mesh, b: &Mesh, steps: u32) -> (f64, f64) {
    let corners = |mesh: &Mesh, i: usize| mesh.1[i].map(|c| mesh.0[c as usize]);
    let (mut largest, mut reach) = (0.0f64, 0.0f64);
    for i in 0..a.1.len() {
        let [p, q, r] = corners(a, i);
        let longest = p.distance(q).max(q.distance(r)).max(r.distance(p));
        reach = reach.max(longest / f64::from(steps) / 3f64.sqrt());
        for k in 0..=steps {
            for j in 0..=steps - k {
                let place =
                    p + (q - p) * (f64::from(j) / f64::from(steps)) + (r - p) * (f64::from(k) / f64::from(steps));
                let distance = (0..b.1.len()).map(|i| to_triangle(place, corners(b, i))).fold(f64::INFINITY, f64::min);
                largest = largest.max(distance);
            }
        }
    }
    (largest, reach)
}

#[test]
fn bounds_hold_what_dense_sampling_finds() {
    let mut dice = Dice(1);
    for (count, size) in [(1, 1.0), (2, 1.0), (6, 0.5), (20, 0.3), (20, 1.5)] {
        let (a, b) = (dice.soup(count, size), dice.soup(count + 1, size));
        let found = between(&exact(), &a, &b);
        for (way, from, to) in [(&found.a_to_b, &a, &b), (&found.b_to_a, &b, &a)] {
            let (largest, reach) = sampled(from, to, 24);
            assert!(way.converged && way.upper >= largest - 1e-14 && way.lower <= largest + reach, "{way:?} {largest}");
            assert!(way.upper - way.lower <= 1e-6 * way.upper + 1e-6 * 4.0);
            // The witness is what it says: a point of the one shape, whose nearest point is that far away.
            let [on, near] = [(from, way.witness.element), (to, way.witness.nearest_element)]
                .map(|(mesh, element)| mesh.1[element as usize].map(|corner| mesh.0[corner as usize]));
            assert!(to_triangle(way.witness.point, on) < 1e-13 && to_triangle(way.witness.nearest, near) < 1e-13);
            let least =
                to.1.iter().map(|t| to_triangle(way.witness.point, t.map(|c| to.0[c as usize]))).fold(9.0, f64::min);
            assert!((least - way.witness.point.distance(way.witness.nearest)).abs() < 1e-13);
            assert!(least >= way.lower && least <= way.lower + 1e-9, "{least} {way:?}");
        }
    }
}

#[test]
fn closed_forms_are_met() {
    // Parallel squares, one larger: corners are farthest from the small one, nothing is farther than the gap from the
    // large one.
    let (small, large) = (grid(3), moved(&grid(7), |p| (p * 3.0) - DVec3::new(1.0, 1.0, 0.5)));
    let found = between(&exact(), &small, &large);
    assert_bounds(&found.a_to_b, 0.5, 1e-6);
    assert_bounds(&found.b_to_a, (2.0f64 + 0.25).sqrt(), 1e-5);
    // A cube within a cube: corner to corner, and from the faces inward.
    let found = between(&exact(), &cube(), &moved(&cube(), |p| p * 2.0));
    assert_bounds(&found.a_to_b, 0.5, 1e-5);
    assert_bounds(&found.b_to_a, 0.75f64.sqrt(), 1e-5);
    // A cube moved along an axis by less than half its side: its own far face is nearest to what it left.
    let found = between(&exact(), &cube(), &moved(&cube(), |p| p + DVec3::X * 0.25));
    assert_bounds(&found.a_to_b, 0.25, 1e-5);
    assert_bounds(&found.b_to_a, 0.25, 1e-5);
    // Octahedra about one centre: |x| + |y| + |z| = 1 and 2. From the inner one every face is (2 - 1)/√3 away, from the
    // outer one the corners are 1 away.
    let found = between(&exact(), &octahedron(), &moved(&octahedron(), |p| p * 2.0));
    assert_bounds(&found.a_to_b, 1.0 / 3f64.sqrt(), 1e-5);
    assert_bounds(&found.b_to_a, 1.0, 1e-5);
    // A polygon's prism in a prism of more sides: the distance is largest in the middle of the coarse sides.
    let prism = |n: u32| {
        let ring = |z: f64| {
            (0..n).map(move |i| {
                let turn = std::f64::consts::TAU * f64::from(i) / f64::from(n);
                DVec3::new(turn.cos(), turn.sin(), z)
            })
        };
        let triangles = (0..n).flat_map(|i| [[i, (i + 1) % n, n + i], [(i + 1) % n, n + (i + 1) % n, n + i]]);
        (ring(0.0).chain(ring(3.0)).collect(), triangles.collect())
    };
    let (coarse, fine): (Mesh, Mesh) = (prism(8), prism(16));
    let found = between(&exact(), &fine, &coarse);
    let sagitta = 1.0 - (std::f64::consts::PI / 8.0).cos();
    assert_bounds(&found.a_to_b, sagitta * 1.0, 1e-4);
    // From the middle of a coarse side the nearest fine sides pass at that slant.
    let middle =
        (std::f64::consts::PI / 16.0).cos() - (std::f64::consts::PI / 8.0).cos() * (std::f64::consts::PI / 16.0).cos();
    assert_bounds(&found.b_to_a, middle, 1e-3);
}

/// Schwarz's lantern: its corners lie on a cylinder, its area grows without limit with the number of its layers, and its
/// distance from the cylinder does not. Its nearest points to the axis are the middles of the level sides.
#[test]
fn a_lantern_is_as_far_from_a_prism_as_its_sides_are_deep() {
    use std::f64::consts::PI;
    let (sides, layers, fine) = (8u32, 150u32, 128u32);
    let at = |turn: f64, z: f64| DVec3::new(turn.cos(), turn.sin(), z);
    let ring = |layer: u32| {
        (0..sides).map(move |i| at((f64::from(2 * i + layer % 2)) * PI / 8.0, f64::from(layer) / f64::from(150)))
    };
    let positions: Vec<DVec3> = (0..=layers).flat_map(ring).collect();
    let triangles = (0..layers * sides).flat_map(|k| {
        let (layer, i) = (k / sides, k % sides);
        let corner = |above: u32, i: u32| (layer + above) * sides + i % sides;
        // The ring that is turned by half a side is that of odd layers.
        let (odd, even) = (layer % 2, 1 - layer % 2);
        [[corner(0, i), corner(0, i + 1), corner(1, i + odd)], [corner(1, i), corner(1, i + 1), corner(0, i + even)]]
    });
    let lantern: Mesh = (positions, triangles.collect());
    // The prism's sides have their middles where the lantern's corners and level sides have theirs.
    let prism = |low: f64, high: f64| -> Mesh {
        let ring = |z: f64| (0..fine).map(move |i| at(f64::from(2 * i + 1) * PI / 128.0, z));
        let next = |i: u32| (i + 1) % fine;
        let triangles = (0..fine).flat_map(|i| [[i, next(i), fine + i], [next(i), fine + next(i), fine + i]]);
        (ring(low).chain(ring(high)).collect(), triangles.collect())
    };
    let there = between(&exact(), &lantern, &prism(-1.0, 2.0)).a_to_b;
    assert_bounds(&there, (PI / 128.0).cos() - (PI / 8.0).cos(), 1e-4);
    // From the prism, straight inward: never deeper.
    let back = between(&Distances::new(), &lantern, &prism(0.0, 1.0)).b_to_a;
    let sagitta = 1.0 - (PI / 8.0).cos();
    assert!(back.converged && back.upper <= sagitta * 1.01 && back.lower > 0.0, "{back:?}");
    // The lantern's area is more than ten times that of the cylinder.
    let area = |mesh: &Mesh| {
        let corners = mesh.1.iter().map(|t| t.map(|c| mesh.0[c as usize]));
        corners.map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).sum::<f64>()
    };
    let wanted = 2.0 * 150.0 * 8.0 * (PI / 8.0).sin() * (1.0 / 150f64.powi(2) + sagitta * sagitta).sqrt();
    assert!((area(&lantern) / wanted - 1.0).abs() < 1e-12 && wanted > 10.0 * std::f64::consts::TAU, "{wanted}");
}

#[test]
fn points_and_segments_take_part() {
    let mut dice = Dice(3);
    let cloud: Vec<DVec3> = (0..500).map(|_| dice.point()).collect();
    let exec = Exec::default();
    let small = DVec3::new(1e-3, 2e-3, 2e-3);
    let near: Vec<DVec3> = cloud.iter().map(|&p| p + small).collect();
    let found = exact().measure(&Simplices::points(&cloud[..]), &Simplices::points(&near[..]), &exec).unwrap();
    assert_bounds(&found.hausdorff.a_to_b, 3e-3, 1e-9);
    assert!((found.a_to_b.mean.value - 3e-3).abs() < 1e-12 && (found.b_to_a.rms.value - 3e-3).abs() < 1e-12);
    assert!((found.chamfer() - 3e-3).abs() < 1e-12 && (found.chamfer_squared() - 9e-6).abs() < 1e-14);
    // The middle of a segment is farthest from its ends; the ends lie on it.
    let ends = [DVec3::ZERO, DVec3::new(3.0, 4.0, 0.0)];
    let line = Simplices::segments(&ends[..], &[[0, 1]]);
    let found = exact().measure(&line, &Simplices::points(&ends[..]), &exec).unwrap();
    assert_bounds(&found.hausdorff.a_to_b, 2.5, 1e-5);
    assert_eq!(found.hausdorff.b_to_a.upper, 0.0);
    assert!((found.a_to_b.mean.value - 1.25).abs() < 1e-6, "{:?}", found.a_to_b);
    assert!((found.a_to_b.rms.value - 2.5 / 3f64.sqrt()).abs() < 1e-4);
    // The same line in many pieces.
    let many: Vec<DVec3> = (0..=1000).map(|k| ends[1] * (f64::from(k) / 1000.0)).collect();
    let pieces: Vec<[u32; 2]> = (0..1000).map(|k| [k, k + 1]).collect();
    let found = exact().hausdorff(&line, &Simplices::segments(&many[..], &pieces), &exec).unwrap();
    assert!(found.upper() <= 5e-6 && found.converged() && found.a_to_b.splits < 20_000, "{found:?}");
    // A circle's polygon to its centre, and a triangle to its corners: farthest is the circumcentre.
    let triangle = (
        vec![DVec3::X, DVec3::new(-0.5, 0.75f64.sqrt(), 0.0), DVec3::new(-0.5, -0.75f64.sqrt(), 0.0)],
        vec![[0, 1, 2]],
    );
    let found = exact().hausdorff(&shape(&triangle), &Simplices::points(&triangle.0[..]), &exec).unwrap();
    assert_bounds(&found.a_to_b, 1.0, 1e-5);
}

#[test]
fn a_shape_is_nowhere_away_from_itself() {
    for mesh in [grid(5), cube(), octahedron(), ball(20, 0.2), Dice(9).soup(300, 0.4)] {
        let found = between(&exact(), &mesh, &mesh);
        assert_eq!((found.lower(), found.upper()), (0.0, 0.0), "{found:?}");
        let means = exact().measure(&shape(&mesh), &shape(&mesh), &Exec::default()).unwrap().a_to_b;
        assert!(means.mean.value < 1e-14 && means.mean.upper < 1e-13 && means.rms.upper < 1e-13, "{means:?}");
    }
}

#[test]
fn other_triangles_of_the_same_surface_are_nowhere_away() {
    for (a, b) in
        [(grid(60), grid(1)), (grid(17), grid(23)), (grid(40), moved(&grid(40), |p| DVec3::new(p.y, p.x, p.z)))]
    {
        let found = between(&exact(), &a, &b);
        assert!(found.converged() && found.upper() <= 1e-6 * 2f64.sqrt() && found.lower() < 1e-13, "{found:?}");
        let splits = found.a_to_b.splits + found.b_to_a.splits;
        assert!(splits < 60 * (a.1.len() + b.1.len()) as u64, "{splits}");
    }
}

#[test]
fn distances_are_symmetric_and_keep_the_triangle_inequality() {
    let mut dice = Dice(21);
    let options = Distances { relative_gap: 1e-3, ..exact() };
    for _ in 0..6 {
        let [a, b, c] = [0.3, 0.5, 0.9].map(|size| dice.soup(8, size));
        let (there, back) = (between(&options, &a, &b), between(&options, &b, &a));
        assert_eq!((there.a_to_b.lower, there.a_to_b.upper), (back.b_to_a.lower, back.b_to_a.upper));
        let (bc, ac) = (between(&options, &b, &c), between(&options, &a, &c));
        assert!(ac.lower() <= there.upper() + bc.upper());
        assert!(ac.a_to_b.lower <= there.a_to_b.upper + bc.a_to_b.upper);
    }
}

#[test]
fn scaled_and_moved_shapes_have_scaled_and_equal_distances() {
    let (a, b) = (ball(8, 0.2), ball(6, 0.1));
    let options = Distances { relative_gap: 1e-3, ..exact() };
    let plain = options.measure(&shape(&a), &shape(&b), &Exec::default()).unwrap();
    for exponent in [-900, -30, 1, 30, 900] {
        let scale = 2f64.powi(exponent);
        let [sa, sb] = [&a, &b].map(|mesh| moved(mesh, |p| p * scale));
        let scaled = options.measure(&shape(&sa), &shape(&sb), &Exec::default()).unwrap();
        assert_eq!(scaled.hausdorff.lower(), plain.hausdorff.lower() * scale, "{exponent}");
        assert_eq!(scaled.hausdorff.upper(), plain.hausdorff.upper() * scale);
        assert_eq!(scaled.b_to_a.rms.value, plain.b_to_a.rms.value * scale);
        assert_eq!(scaled.diagonal, plain.diagonal * scale);
    }
    for (scale, offset) in [(1e-9, 0.0), (1e150, 0.0), (1.0, 5e6)] {
        let [sa, sb] = [&a, &b].map(|mesh| moved(mesh, |p| p * scale + DVec3::splat(offset)));
        let found = options.measure(&shape(&sa), &shape(&sb), &Exec::default()).unwrap();
        assert!(found.hausdorff.converged(), "{scale} {offset} {found:?}");
        // Rounding at the offset moves corners by 1e-9.
        let near = |x: f64, y: f64, gap: f64| ((x / scale - y) / y).abs() < gap;
        assert!(near(found.hausdorff.upper(), plain.hausdorff.upper(), 2e-3), "{found:?}");
        assert!(near(found.a_to_b.mean.value, plain.a_to_b.mean.value, 1e-7), "{found:?}");
    }
    let turn = DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(1.1);
    let [sa, sb] = [&a, &b].map(|mesh| moved(mesh, |p| turn * p));
    let found = between(&options, &sa, &sb);
    assert!((found.upper() / plain.hausdorff.upper() - 1.0).abs() < 2e-3);
}

#[test]
fn threads_change_no_bit() {
    let (a, b) = (ball(16, 0.1), ball(11, 0.1));
    let options = Distances { relative_gap: 1e-4, ..exact() };
    let alone = Exec::default().with_threads(Threads::Sequential);
    let wanted = options.measure(&shape(&a), &shape(&b), &alone).unwrap();
    assert!(wanted.hausdorff.a_to_b.rounds > 3, "{wanted:?}");
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let found = pool.install(|| options.measure(&shape(&a), &shape(&b), &Exec::default()).unwrap());
        assert_eq!(found, wanted, "{threads}");
    }
}

#[test]
fn means_hold_closed_forms_within_their_bounds() {
    // A square above another at a slope: the distance rises evenly from 0 to 1.
    let (flat, tilted) =
        (moved(&grid(1), |p| p * 9.0 - DVec3::new(4.0, 4.0, 0.0)), moved(&grid(2), |p| p + DVec3::Z * p.x));
    let found =
        Distances { samples: 4000, ..exact() }.measure(&shape(&tilted), &shape(&flat), &Exec::default()).unwrap();
    for (estimate, wanted) in [(found.a_to_b.mean, 0.5), (found.a_to_b.rms, 1.0 / 3f64.sqrt())] {
        assert!(estimate.lower <= wanted && wanted <= estimate.upper, "{estimate:?}");
        assert!((estimate.value - wanted).abs() < 1e-9 && estimate.upper - estimate.lower < 0.02, "{estimate:?}");
    }
    assert!((found.a_to_b.largest_sampled - 1.0).abs() < 1e-12 && found.a_to_b.samples >= 4000);
    // From the centre of a square to its corners: the mean of the distance to the nearest corner of the unit square is
    // (√2 + asinh 1) / 6.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 0.0)];
    let square = grid(1);
    let options = Distances { samples: 20_000, ..exact() };
    let found = options.measure(&shape(&square), &Simplices::points(&corners[..]), &Exec::default()).unwrap().a_to_b;
    let wanted = (2f64.sqrt() + 1f64.asinh()) / 6.0;
    assert!((found.mean.value - wanted).abs() < 1e-5, "{found:?} {wanted}");
    assert!(found.mean.lower <= wanted && wanted <= found.mean.upper && found.mean.upper - found.mean.lower < 0.01);
    // The mean square is that of x² + y² over a quarter: 2/12.
    assert!((found.rms.value.powi(2) - 1.0 / 6.0).abs() < 1e-5, "{found:?}");
}

#[test]
fn large_triangles_weigh_as_much_as_they_are_large() {
    // A square of area 1 at height 1 and one of area 9 at height 2, in few and in many triangles.
    let plane = moved(&grid(1), |p| p * 40.0 - DVec3::new(20.0, 20.0, 0.0));
    for n in [1, 5] {
        let (mut both, large) = (moved(&grid(6 - n), |p| p + DVec3::Z), moved(&grid(n), |p| p * 3.0 + DVec3::Z * 2.0));
        let first = both.0.len() as u32;
        both.0.extend(large.0);
        both.1.extend(large.1.iter().map(|triangle| triangle.map(|corner| corner + first)));
        let found = exact().measure(&shape(&both), &shape(&plane), &Exec::default()).unwrap();
        assert!((found.a_to_b.mean.value - 1.9).abs() < 1e-12, "{found:?}");
        assert!((found.a_to_b.rms.value - 3.7f64.sqrt()).abs() < 1e-12, "{found:?}");
        // The diagonal is that of the first shape.
        assert!((found.diagonal - 19f64.sqrt()).abs() < 1e-12, "{found:?}");
    }
}

#[test]
fn samples_of_anything_can_be_compared() {
    let (positions, triangles) = grid(2);
    let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
    let sample = |z: f64, weight: f64, radius: f64| Sample { position: DVec3::new(0.5, 0.5, z), weight, radius };
    let samples = [sample(1.0, 3.0, 0.25), sample(3.0, 1.0, 0.0)];
    let found = distance_from_samples(&samples[..], &bvh, &Exec::default()).unwrap().unwrap();
    assert!((found.mean.value - 1.5).abs() < 1e-15 && (found.rms.value - 3f64.sqrt()).abs() < 1e-15);
    assert!((found.mean.lower - 1.3125).abs() < 1e-12 && (found.mean.upper - 1.6875).abs() < 1e-12);
    assert_eq!((found.largest_sampled, found.samples), (3.0, 2));
    assert_eq!(distance_from_samples(&[][..], &bvh, &Exec::default()), Ok(None));
    let nothing = TriangleBvh::build(&[], &[], &Exec::default()).unwrap();
    assert_eq!(distance_from_samples(&samples[..], &nothing, &Exec::default()), Ok(None));
}

#[test]
fn awkward_shapes_are_taken() {
    let exec = Exec::default();
    let one: Mesh = (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]);
    let equal: Mesh = (vec![DVec3::Z; 3], vec![[0, 1, 2], [2, 2, 1]]);
    assert_bounds(&between(&exact(), &equal, &one).a_to_b, 1.0, 1e-9);
    assert_bounds(&between(&exact(), &one, &equal).a_to_b, 2f64.sqrt(), 1e-5);
    let found = exact().measure(&shape(&equal), &shape(&equal), &exec).unwrap();
    assert_eq!((found.hausdorff.upper(), found.a_to_b.mean.value, found.diagonal), (0.0, 0.0, 0.0));
    let line: Mesh = (vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::X], vec![[0, 1, 2], [2, 1, 0]]);
    assert_bounds(&between(&exact(), &line, &one).a_to_b, 2.0, 1e-5);
    let mut many = one.clone();
    many.1 = vec![[0, 1, 2]; 16_000];
    assert_eq!(between(&exact(), &many, &one).upper(), 0.0);
    let away = moved(&one, |p| p * 2.0 + DVec3::new(0.3, 0.1, 0.5));
    assert_bounds(&between(&Distances::new(), &many, &away).a_to_b, between(&exact(), &one, &away).a_to_b.lower, 0.02);
    let mut fan: Mesh = (vec![DVec3::ZERO], Vec::new());
    for k in 0..5000 {
        let turn = f64::from(k) * std::f64::consts::TAU / 5000.0;
        fan.0.push(DVec3::new(turn.cos(), turn.sin(), 0.0));
        fan.1.push([0, 1 + k, 1 + (k + 1) % 5000]);
    }
    let found = between(&Distances::new(), &fan, &moved(&fan, |p| DVec3::new(p.x, p.z, p.y)));
    assert!(found.converged() && found.lower() <= 1.0 && found.upper() >= 1.0 - 1e-6, "{found:?}");
}

#[test]
fn wrong_input_is_named() {
    let exec = Exec::default();
    let (one, none) = (grid(1), (vec![DVec3::NAN], Vec::new()));
    let measure = |a: &Mesh, b: &Mesh, exec: &Exec| Distances::new().measure(&shape(a), &shape(b), exec).unwrap_err();
    assert_eq!(measure(&none, &one, &exec), JudgeError::NothingToCompare { shape: 0 });
    assert_eq!(measure(&one, &none, &exec), JudgeError::NothingToCompare { shape: 1 });
    let broken = moved(&one, |p| if p.x > 0.0 { p } else { DVec3::NAN });
    assert!(matches!(measure(&one, &broken, &exec), JudgeError::Bvh(BvhError::NotFinite { .. })));
    let infinite = moved(&one, |p| if p.x > 0.0 { p } else { DVec3::INFINITY });
    assert!(matches!(measure(&infinite, &one, &exec), JudgeError::Bvh(BvhError::NotFinite { .. })));
    let lost: Mesh = (one.0.clone(), vec![[0, 1, 9]]);
    assert!(matches!(measure(&lost, &one, &exec), JudgeError::Bvh(BvhError::Index { found: 9, .. })));
    // A position that nothing names may be anything.
    let mut odd = one.clone();
    odd.0.push(DVec3::NAN);
    assert_eq!(between(&exact(), &odd, &one).upper(), 0.0);
    for options in [
        Distances { relative_gap: -1.0, ..exact() },
        Distances { absolute_gap: f64::NAN, ..exact() },
        Distances { samples: 0, ..exact() },
    ] {
        let error = options.measure(&shape(&one), &shape(&one), &exec).unwrap_err();
        assert!(matches!(error, JudgeError::OutOfBounds { .. }), "{error:?}");
    }
    let flag = CancelFlag::default();
    flag.cancel();
    assert!(matches!(
        measure(&one, &one, &exec.clone().with_cancel(&flag)),
        JudgeError::Stop(Stop::Cancelled) | JudgeError::Bvh(BvhError::Stop(Stop::Cancelled))
    ));
    let error = measure(&one, &one, &exec.with_memory(100));
    assert!(matches!(error, JudgeError::OverBudget(_) | JudgeError::Bvh(BvhError::OverBudget(_))), "{error:?}");
}

#[test]
fn where_work_runs_out_the_bounds_are_wider_and_say_so() {
    // Nearly the same surface in other triangles: many pieces must be cut.
    let (a, b) = (grid(40), moved(&grid(23), |p| DVec3::new(p.x, p.y, 1e-3 * p.x)));
    let tight = Distances { relative_gap: 1e-5, absolute_gap: 0.0, ..exact() };
    let full = between(&tight, &a, &b);
    assert!(full.converged() && full.b_to_a.splits > 1000, "{full:?}");
    let short = between(&Distances { max_splits: 100, ..tight.clone() }, &a, &b);
    assert!(!short.converged() && short.upper() > full.upper() && short.lower() <= full.lower(), "{short:?}");
    let none = between(&Distances { max_splits: 0, ..tight.clone() }, &a, &b);
    assert!(!none.converged() && none.upper() >= short.upper() && none.a_to_b.splits == 0);
    // What the hierarchies need, and room for few cells beside.
    let exec = Exec::default().with_memory(2_300_000);
    let found = tight.hausdorff(&shape(&a), &shape(&b), &exec).unwrap();
    assert!(!found.converged() && found.upper() >= full.upper(), "{found:?}");
    assert_eq!(exec.memory_taken(), 0);
}
