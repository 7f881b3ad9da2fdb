//! Tiny closed shapes beside a triangle of size 1: the bounds hold at every size.

use glam::DVec3;
use shapeloom_core::Exec;

use super::{WindingNumber, WindingTree, generalized_winding_number};
use crate::SignedDistance;
use crate::fixtures::Draws;

/// Powers of two about 1e-9, 1e-30, 1e-60, 1e-107, 1e-109, 1e-150, 1e-200 and 1e-300.
const EXPONENTS: [i32; 8] = [-30, -100, -199, -355, -362, -498, -664, -996];

/// A tetrahedron about the origin with faces outward.
const TETRAHEDRON: [DVec3; 4] =
    [DVec3::ONE, DVec3::new(1.0, -1.0, -1.0), DVec3::new(-1.0, 1.0, -1.0), DVec3::new(-1.0, -1.0, 1.0)];
const FACES: [[u32; 3]; 4] = [[1, 3, 2], [0, 2, 3], [0, 3, 1], [0, 1, 2]];

type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

/// The tetrahedron at a size, and with it triangles of size 1 through X, Y and Z.
fn beside(size: f64, large: &[[u32; 3]]) -> Mesh {
    let positions = TETRAHEDRON.iter().map(|&corner| corner * size).chain([DVec3::X, DVec3::Y, DVec3::Z]);
    (positions.collect(), FACES.iter().chain(large).copied().collect())
}

/// Directions, how often the tetrahedron winds around them, and whether that is close to what jumps there. All are exact
/// binary fractions, so that scaling keeps them where they are.
fn places() -> Vec<(DVec3, f64)> {
    // The distances of the four planes are −(normal · p) < 1.
    let normals = [-DVec3::ONE, DVec3::new(-1.0, 1.0, 1.0), DVec3::new(1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, -1.0)];
    let depth = |p: DVec3| normals.iter().map(|normal| 1.0 - normal.dot(p)).fold(f64::INFINITY, f64::min);
    let mut places = vec![DVec3::ZERO];
    // Beside the middle of a face, by an eighth and by a few ulps.
    for away in [0.125, 2f64.powi(-40), 2f64.powi(-50)] {
        places.push(DVec3::new(-0.25, -0.5, -0.25 + away));
        places.push(DVec3::new(-0.25, -0.5, -0.25 - away));
    }
    let mut draws = Draws::new(31);
    places.extend((0..40).map(|_| (draws.point() * 1024.0).round() / 512.0));
    places.retain(|&place| depth(place) != 0.0);
    places.into_iter().map(|place| (place, f64::from(u8::from(depth(place) > 0.0)))).collect()
}

fn answers(mesh: &Mesh, query: DVec3) -> Vec<WindingNumber> {
    let exec = Exec::default();
    let tree = WindingTree::build(&mesh.0, &mesh.1, &exec).unwrap();
    let mut found = vec![generalized_winding_number(&mesh.0, &mesh.1, query, &exec).unwrap()];
    found.push(tree.winding_number_exact(query));
    found.extend([0.45, 1e-3, 0.0].map(|tolerance| tree.winding_number_within(query, tolerance)));
    // The fast one has no bound, but nothing is far here.
    found.push(WindingNumber { value: tree.winding_number(query), bound: 1e-9 });
    found
}

#[test]
fn tiny_shapes_beside_a_large_triangle_have_their_winding_number() {
    for exponent in EXPONENTS {
        let size = 2f64.powi(exponent);
        let mesh = beside(size, &[[4, 5, 6]]);
        for (place, inside) in places() {
            // An octant is an eighth of all directions, and the queries are at its apex but for rounding.
            let wanted = inside + 0.125;
            for found in answers(&mesh, place * size) {
                let error = (found.value - wanted).abs();
                // The larger the tetrahedron the farther from the apex: solid angles change by less than the way.
                assert!(error <= found.bound + 4.0 * size, "2^{exponent} {place}: {found:?}, wanted {wanted}");
                assert!(found.bound <= 1e-9, "2^{exponent} {place}: {found:?}");
            }
        }
    }
}

#[test]
fn tiny_closed_shapes_have_the_right_sign() {
    for exponent in EXPONENTS {
        let size = 2f64.powi(exponent);
        // A triangle and its reverse: closed, and nothing together.
        let (positions, triangles) = beside(size, &[[4, 5, 6], [6, 5, 4]]);
        let distance = SignedDistance::build(&positions, &triangles, &Exec::default()).unwrap();
        assert!(distance.is_closed());
        for (place, inside) in places() {
            assert_eq!(distance.is_inside(place * size), inside > 0.5, "2^{exponent} {place}");
        }
        assert!(distance.distance(DVec3::ZERO) < 0.0, "2^{exponent}");
    }
}

/// Queries a few tiny steps from corners of large triangles: two corners' lengths are far from the third's.
#[test]
fn queries_tiny_steps_from_corners_keep_the_bound() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mesh: Mesh = (positions, vec![[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]]);
    // The last one is subnormal: 2^-1060.
    for step in EXPONENTS.map(|exponent| 2f64.powi(exponent)).into_iter().chain([f64::from_bits(1 << 14)]) {
        for (x, y, z) in (0..27).map(|i| (i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) {
            let query = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * step;
            // On how many of the three planes the query lies, if it is in the octant.
            let zeros = [x, y, z].iter().filter(|&&x| x == 0).count();
            let outside = [x, y, z].contains(&-1);
            let wanted = if outside { 0.0 } else { 0.5f64.powi(zeros as i32) };
            for found in answers(&mesh, query) {
                let error = (found.value - wanted).abs();
                assert!(error <= found.bound && found.bound <= 1e-9, "{step} {query}: {found:?}, wanted {wanted}");
            }
        }
    }
}

/// A soup of tiny triangles spread over a box: moments of clusters underflow in single precision, and numbers too.
#[test]
fn clusters_of_tiny_triangles_keep_the_bound() {
    let exec = Exec::default();
    let mut draws = Draws::new(32);
    for size in [1e-15, 1e-19, 1e-21, 1e-23, 1e-60, 1e-200] {
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        // Each of three corners is at a place that holds the tiny step exactly: the origin of an axis.
        for i in 0..200u32 {
            let mut place = draws.point();
            place[i as usize % 3] = 0.0;
            place[(i as usize + 1) % 3] = 0.0;
            let [u, v] = [(i as usize) % 3, (i as usize + 1) % 3].map(|axis| DVec3::AXES[axis] * size);
            positions.extend([place, place + u, place + v]);
            triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
        }
        let tree = WindingTree::build(&positions, &triangles, &exec).unwrap();
        for _ in 0..40 {
            let query = draws.point() * 3.0;
            // The triangles are points to the query: n·r/|r|³ is their solid angle but for a share of size.
            let angle = |triangle: &[u32; 3]| {
                let [a, b, c] = triangle.map(|corner| positions[corner as usize]);
                let (u, v) = ((b - a) / size, (c - a) / size);
                let way = a - query;
                u.cross(v).dot(way) / way.length().powi(3)
            };
            // In units of the triangles' squared size.
            let wanted = triangles.iter().map(angle).sum::<f64>() / (8.0 * std::f64::consts::PI);
            for tolerance in [0.3, 1e-30] {
                let found = tree.winding_number_within(query, tolerance);
                let error = (found.value / size / size - wanted).abs();
                let bound = found.bound / size / size;
                assert!(error <= bound * (1.0 + 1e-6) + 1e-6 * wanted.abs(), "{size} {query}: {found:?}, {wanted}");
            }
        }
    }
}
