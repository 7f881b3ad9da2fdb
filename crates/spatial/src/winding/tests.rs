//! Winding numbers against closed forms, the definition and the laws they keep.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use glam::{DMat3, DVec3};
use shapeloom_core::{CancelFlag, Exec, Stop};

use super::*;
use crate::BvhError;
use crate::fixtures::{Draws, bumpy_ball};

type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

fn tree(mesh: &Mesh) -> WindingTree {
    WindingTree::build(&mesh.0, &mesh.1, &Exec::default()).unwrap()
}

fn reference(mesh: &Mesh, query: DVec3) -> WindingNumber {
    generalized_winding_number(&mesh.0, &mesh.1, query, &Exec::default()).unwrap()
}

fn flipped(mesh: &Mesh) -> Mesh {
    (mesh.0.clone(), mesh.1.iter().map(|&[a, b, c]| [a, c, b]).collect())
}

fn joined(meshes: &[Mesh]) -> Mesh {
    let mut all: Mesh = Default::default();
    for (positions, triangles) in meshes {
        let first = all.0.len() as u32;
        all.0.extend(positions);
        all.1.extend(triangles.iter().map(|triangle| triangle.map(|corner| corner + first)));
    }
    all
}

/// The square `[-1, 1]²` at z = 0, facing up.
fn square() -> Mesh {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    (corners.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec(), vec![[0, 1, 2], [0, 2, 3]])
}

fn cube() -> Mesh {
    let positions = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (positions, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// All three ways to ask, with the bounds of the last two held.
fn assert_all(mesh: &Mesh, query: DVec3, wanted: f64, slack: f64) {
    let tree = tree(mesh);
    for found in [reference(mesh, query), tree.winding_number_exact(query)] {
        assert!(found.bound <= slack.max(1e-8), "{query}: {found:?}");
        assert!((found.value - wanted).abs() <= slack.max(found.bound), "{query}: {found:?}, wanted {wanted}");
    }
    for tolerance in [0.3, 1e-2, 1e-4] {
        let found = tree.winding_number_within(query, tolerance);
        assert!(found.bound <= tolerance, "{query}: {found:?}");
        assert!((found.value - wanted).abs() <= slack + found.bound, "{query}: {found:?}, wanted {wanted}");
    }
    let fast = tree.winding_number(query);
    assert!((fast - wanted).abs() <= slack + 6e-3, "{query}: {fast}, wanted {wanted}");
}

#[test]
fn balls_have_one_inside_and_nothing_outside() {
    let ball = bumpy_ball(40, DVec3::new(1.0, -2.0, 3.0), 1.5, 0.02);
    let mut draws = Draws::new(1);
    for _ in 0..60 {
        let direction = draws.point().normalize();
        let center = DVec3::new(1.0, -2.0, 3.0);
        // Facets are inside the sphere by less than 0.01 of the radius.
        for (radius, wanted) in [(0.1, 1.0), (1.3, 1.0), (1.45, 1.0), (1.55, 0.0), (2.0, 0.0), (50.0, 0.0)] {
            assert_all(&ball, center + direction * radius, wanted, 1e-11);
            assert_all(&flipped(&ball), center + direction * radius, -wanted, 1e-11);
        }
    }
}

#[test]
fn a_square_on_its_axis_has_its_closed_form() {
    let square = square();
    for height in [1e-6, 0.1, 0.5, 1.0, 3.0, 100.0] {
        // Ω = 4 atan(1 / (h √(h² + 2))) for half sides of 1.
        let wanted = -4.0 * (1.0 / (height * f64::sqrt(height * height + 2.0))).atan() / (4.0 * PI);
        // The closer, the more the side of the shared diagonal asks of the numbers.
        assert_all(&square, DVec3::Z * height, wanted, 1e-14 / height.min(0.1));
        assert_all(&square, -DVec3::Z * height, -wanted, 1e-14 / height.min(0.1));
    }
    // One face of a cube seen from the cube's centre.
    assert!((reference(&square, -DVec3::Z).value - 1.0 / 6.0).abs() < 1e-15);
}

#[test]
fn half_a_ball_covers_half_of_all_directions() {
    let (positions, triangles) = bumpy_ball(32, DVec3::ZERO, 1.0, 0.0);
    let above = |triangle: &[u32; 3]| triangle.iter().all(|&corner| positions[corner as usize].z > -1e-9);
    let half = (positions.clone(), triangles.iter().copied().filter(above).collect::<Vec<_>>());
    assert_eq!(half.1.len() * 2, triangles.len());
    assert_all(&half, DVec3::ZERO, 0.5, 1e-12);
    // On the axis the rim is a circle: what it covers is 2π(1 − cos) for a regular polygon nearly.
    for height in [-2.0, -0.5, 0.4] {
        let found = reference(&half, DVec3::Z * height).value;
        let wanted = (1.0 + height / f64::sqrt(1.0 + height * height)) / 2.0;
        assert!((found - wanted).abs() < 2e-3, "{height}: {found} {wanted}");
    }
}

#[test]
fn on_the_surface_the_mean_of_a_small_ball_counts() {
    let cube = cube();
    let of = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let (face, edge, corner) = ([of(0.3, 0.4, 0.0), of(0.5, 0.5, 1.0)], [of(0.3, 0.0, 0.0), of(1.0, 1.0, 0.7)], 0.125);
    for query in face {
        assert_all(&cube, query, 0.5, 1e-12);
    }
    for query in edge {
        assert_all(&cube, query, 0.25, 1e-12);
    }
    for &query in &cube.0 {
        assert_all(&cube, query, corner, 1e-12);
    }
    // In a face's plane, beside the cube.
    assert_all(&cube, of(1.5, 0.5, 0.0), 0.0, 1e-12);
    // Far from the origin, turned and at a corner, as long as numbers go.
    let turn = DMat3::from_rotation_x(0.3) * DMat3::from_rotation_z(1.1);
    let moved: Mesh = (cube.0.iter().map(|&p| turn * p + DVec3::new(5e6, -3e6, 1e6)).collect(), cube.1.clone());
    for &query in &moved.0 {
        let found = tree(&moved).winding_number_exact(query);
        assert!((found.value - 0.125).abs() < 1e-6, "{found:?}");
    }
}

#[test]
fn a_whisker_from_a_face_the_side_is_right() {
    let ball = bumpy_ball(12, DVec3::ZERO, 1.0, 0.2);
    let tree = tree(&ball);
    let mut draws = Draws::new(7);
    for triangle in &ball.1 {
        let [a, b, c] = triangle.map(|corner| ball.0[corner as usize]);
        let weights = DVec3::new(1.2 + draws.signed(), 1.2 + draws.signed(), 1.2 + draws.signed());
        let on = (a * weights.x + b * weights.y + c * weights.z) / (weights.x + weights.y + weights.z);
        let normal = (b - a).cross(c - a).normalize();
        for away in [1e-3, 1e-9, 1e-13, 1e-15] {
            for side in [-1.0, 1.0] {
                let query = on + normal * (away * side);
                // What rounding made of it decides, in exact arithmetic.
                let wanted = match shapeloom_core::predicates::orient3d(a, b, c, query) {
                    std::cmp::Ordering::Less => 1.0,
                    std::cmp::Ordering::Equal => 0.5,
                    std::cmp::Ordering::Greater => 0.0,
                };
                let exact = tree.winding_number_exact(query);
                assert!((exact.value - wanted).abs() < 1e-10 && exact.bound < 1e-9, "{away}: {exact:?} {wanted}");
                let found = tree.winding_number_within(query, 0.2);
                assert!((found.value - wanted).abs() <= found.bound && found.bound <= 0.2);
                assert!((tree.winding_number(query) - wanted).abs() < 0.01);
                assert!((reference(&ball, query).value - wanted).abs() < 1e-10);
            }
        }
    }
}

#[test]
fn shells_add_up() {
    let shells: Vec<Mesh> = (1..=4).map(|i| bumpy_ball(16, DVec3::ZERO, f64::from(i), 0.02)).collect();
    let all = joined(&[shells[0].clone(), flipped(&shells[1]), shells[2].clone(), shells[3].clone()]);
    for (radius, wanted) in [(0.5, 2.0), (1.5, 1.0), (2.5, 2.0), (3.5, 1.0), (4.5, 0.0)] {
        assert_all(&all, DVec3::new(0.6, 0.0, 0.8) * radius, wanted, 1e-11);
    }
    let twice = joined(&[shells[0].clone(), shells[0].clone(), flipped(&shells[0]), shells[0].clone()]);
    assert_all(&twice, DVec3::splat(0.1), 2.0, 1e-11);
}

#[test]
fn coincident_flat_and_missing_triangles_are_taken() {
    let many: Mesh = (square().0, vec![[0, 1, 2]; 16_000]);
    let one: Mesh = (square().0, vec![[0, 1, 2]]);
    let query = DVec3::new(0.3, -0.2, -0.5);
    let wanted = reference(&one, query).value * 16_000.0;
    let found = tree(&many).winding_number_within(query, 0.5);
    assert!((found.value - wanted).abs() <= found.bound && found.bound <= 0.5, "{found:?} {wanted}");
    assert!((tree(&many).winding_number(query) / wanted - 1.0).abs() < 1e-3);
    let flat: Mesh = (
        vec![DVec3::ZERO, DVec3::X, DVec3::X * 3.0, DVec3::ONE, DVec3::splat(0.3), DVec3::splat(0.7)],
        vec![[0, 1, 2], [0, 0, 0], [3, 4, 4], [3, 4, 5], [2, 2, 1]],
    );
    for query in [DVec3::X * 2.0, DVec3::splat(0.5), DVec3::ZERO, DVec3::Y] {
        assert_all(&flat, query, 0.0, 1e-14);
    }
    let nothing = tree(&Default::default());
    assert!(nothing.is_empty() && nothing.winding_number(DVec3::ONE) == 0.0);
    assert_eq!(nothing.winding_number_exact(DVec3::ONE), WindingNumber { value: 0.0, bound: 0.0 });
    assert_eq!(nothing.winding_number_within(DVec3::ONE, 0.0), WindingNumber { value: 0.0, bound: 0.0 });
    let point = tree(&(vec![DVec3::ONE], vec![[0, 0, 0]; 100]));
    assert_eq!(point.winding_number(DVec3::ONE), 0.0);
    assert!(point.winding_number(DVec3::ZERO).abs() < 1e-15);
}

#[test]
fn units_and_places_change_nothing() {
    let mut draws = Draws::new(8);
    let plain = draws.soup(300, |draws, _| draws.point());
    let plain_tree = tree(&plain);
    for exponent in [-700, -30, 30, 500] {
        let scale = 2f64.powi(exponent);
        let scaled: Mesh = (plain.0.iter().map(|&p| p * scale).collect(), plain.1.clone());
        let scaled_tree = tree(&scaled);
        for _ in 0..50 {
            let query = draws.point() * 2.0;
            assert_eq!(scaled_tree.winding_number(query * scale), plain_tree.winding_number(query));
            assert_eq!(scaled_tree.winding_number_exact(query * scale), plain_tree.winding_number_exact(query));
            assert_eq!(reference(&scaled, query * scale), reference(&plain, query));
        }
    }
    let ball = bumpy_ball(20, DVec3::ZERO, 1.0, 0.05);
    for (scale, offset) in [(1e-9, 0.0), (1e150, 0.0), (1.0, 5e6), (1e-3, 5e6)] {
        let offset = DVec3::new(offset, -offset, offset * 0.7);
        let moved: Mesh = (ball.0.iter().map(|&p| p * scale + offset).collect(), ball.1.clone());
        for (at, wanted) in [(0.5, 1.0), (0.9, 1.0), (1.1, 0.0), (7.0, 0.0)] {
            assert_all(&moved, DVec3::new(0.6, 0.0, 0.8) * (at * scale) + offset, wanted, 1e-6);
        }
    }
}

#[test]
fn wild_queries_are_told() {
    let ball = bumpy_ball(6, DVec3::ZERO, 1e-200, 0.1);
    let tree = tree(&ball);
    for query in [DVec3::NAN, DVec3::INFINITY, DVec3::new(0.0, f64::NEG_INFINITY, 0.0)] {
        assert!(tree.winding_number(query).is_nan());
        let found = tree.winding_number_within(query, 0.1);
        assert!(found.value.is_nan() && found.bound == f64::INFINITY);
        assert!(tree.winding_number_exact(query).value.is_nan() && reference(&ball, query).value.is_nan());
    }
    for query in [DVec3::splat(1e300), DVec3::splat(1.0), DVec3::splat(-f64::MAX)] {
        assert_eq!(tree.winding_number(query), 0.0);
        assert!(tree.winding_number_within(query, 0.0).bound < 1e-16 && reference(&ball, query).value == 0.0);
    }
    for tolerance in [f64::NAN, -1.0, 0.0, 1e-300] {
        let found = tree.winding_number_within(DVec3::ZERO, tolerance);
        assert!((found.value - 1.0).abs() < 1e-12 && found.bound < 1e-9, "{found:?}");
    }
    assert_eq!(tree.winding_number_within(DVec3::ZERO, f64::INFINITY).value.round(), 1.0);
    assert!(self::tree(&ball).with_accuracy(f32::NAN).winding_number(DVec3::ZERO).is_finite());
}

#[test]
fn wrong_input_budgets_and_cancelling_are_told() {
    let exec = Exec::default();
    let found = WindingTree::build(&[DVec3::ZERO; 3], &[[0, 1, 2], [0, 7, 1]], &exec).unwrap_err();
    assert_eq!(found, BvhError::Index { triangle: 1, corner: 1, found: 7, positions: 3 });
    let positions = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::NAN, 0.0)];
    let found = generalized_winding_number(&positions, &[[0, 1, 1], [0, 1, 2]], DVec3::ONE, &exec).unwrap_err();
    assert!(matches!(found, BvhError::NotFinite { triangle: 1, position: 2, .. }));
    let ball = bumpy_ball(40, DVec3::ZERO, 1.0, 0.0);
    let small = Exec::default().with_memory(1000);
    assert!(matches!(WindingTree::build(&ball.0, &ball.1, &small), Err(BvhError::OverBudget(_))));
    let flag = CancelFlag::default();
    flag.cancel();
    let stopped = Exec::default().with_cancel(&flag);
    assert_eq!(WindingTree::build(&ball.0, &ball.1, &stopped).unwrap_err(), BvhError::Stop(Stop::Cancelled));
    let tree = WindingTree::build(&ball.0, &ball.1, &exec).unwrap();
    let stored = size_of_val(&tree.blocks[..]) + tree.levels.iter().map(|level| size_of_val(&level[..])).sum::<usize>();
    assert!(exec.memory_taken() >= stored as u64);
    assert!(tree.winding_numbers(&[DVec3::ZERO], &mut [0.0], &stopped).is_err());
    drop(tree);
    assert_eq!(exec.memory_taken(), 0);
}

#[test]
fn threads_and_batches_change_no_bit() {
    let ball = bumpy_ball(60, DVec3::ZERO, 1.0, 0.1);
    let mut draws = Draws::new(2);
    let mut queries: Vec<DVec3> = (0..2000).map(|i| draws.point() * (1.0 + f64::from(i % 7))).collect();
    queries.push(DVec3::NAN);
    let alone = Exec::default().with_threads(shapeloom_core::Threads::Sequential);
    let tree = WindingTree::build(&ball.0, &ball.1, &alone).unwrap();
    let wanted: Vec<u64> = queries.iter().map(|&query| tree.winding_number(query).to_bits()).collect();
    for threads in 1..=3 {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut found = vec![0.0; queries.len()];
        pool.install(|| {
            let tree = WindingTree::build(&ball.0, &ball.1, &Exec::default()).unwrap();
            tree.winding_numbers(&queries, &mut found, &Exec::default()).unwrap();
        });
        assert!(found.iter().map(|number| number.to_bits()).eq(wanted.iter().copied()), "{threads}");
    }
}

#[test]
fn open_meshes_follow_their_boundary() {
    // Surfaces with the same boundary differ by whole numbers: a disc and a tent over it, from below.
    let rim: Vec<DVec3> = (0..24).map(|i| DMat3::from_rotation_z(f64::from(i) * PI / 12.0) * DVec3::X).collect();
    let fan = |top: f64| -> Mesh {
        let positions = rim.iter().copied().chain([DVec3::Z * top]).collect();
        (positions, (0..24).map(|i| [i, (i + 1) % 24, 24]).collect())
    };
    let (low, high) = (reference(&fan(0.0), -DVec3::Z).value, reference(&fan(0.7), -DVec3::Z).value);
    assert!((low - high).abs() < 1e-13);
    let between = DVec3::Z * 0.3;
    assert!((reference(&fan(0.0), between).value + 1.0 - reference(&fan(0.7), between).value).abs() < 1e-13);
    // A circle seen from its axis at a distance of its radius: 2π(1 − 1/√2), for a polygon of 24 corners nearly.
    assert!((low - (1.0 - FRAC_1_SQRT_2) / 2.0).abs() < 2e-3);
}

#[test]
fn details_are_seen_beside_large_shapes() {
    let place = DVec3::new(0.7, 0.3, -0.9);
    let all = joined(&[bumpy_ball(6, DVec3::ZERO, 1.0, 0.0), bumpy_ball(40, place, 1e-6, 0.0)]);
    let tree = tree(&all);
    let mut draws = Draws::new(13);
    for _ in 0..100 {
        let direction = draws.point().normalize();
        for (radius, wanted) in [(0.7e-6, 1.0), (0.95e-6, 1.0), (1.05e-6, 0.0), (2e-6, 0.0)] {
            let found = tree.winding_number(place + direction * radius);
            assert!((found - wanted).abs() < 6e-3, "{radius}: {found}");
        }
    }
}

/// Close to an edge the two faces' angles depend on the last digits: the bounds say so.
#[test]
fn close_to_edges_rounding_stays_within_the_bound() {
    let ball = bumpy_ball(12, DVec3::ZERO, 1.0, 0.2);
    let tree = tree(&ball);
    let mut draws = Draws::new(14);
    for away in [1e-6, 1e-9, 1e-11] {
        for &[a, b, _] in &ball.1 {
            let [a, b] = [a, b].map(|corner| ball.0[corner as usize]);
            let query = a.lerp(b, draws.signed() * 0.4 + 0.5) + draws.point() * away;
            for found in [tree.winding_number_exact(query), reference(&ball, query)] {
                let error = (found.value - found.value.round()).abs();
                assert!(error <= found.bound && found.bound < 0.1, "{away}: {found:?}");
            }
        }
    }
}
