//! Signed distances against brute force, closed forms and the laws of fields.

use glam::DVec3;
use shapeloom_core::{Aabb, CancelFlag, Exec, Field, Restricted};

use super::*;
use crate::fixtures::{Draws, bumpy_ball};
use crate::generalized_winding_number;
use crate::triangle_point::closest_on_triangle;

type Mesh = (Vec<DVec3>, Vec<[u32; 3]>);

fn build(mesh: &Mesh) -> SignedDistance {
    SignedDistance::build(&mesh.0, &mesh.1, &Exec::default()).unwrap()
}

fn cube() -> Mesh {
    let positions = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    (positions, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The signed distance to the unit cube, by its formula.
fn to_cube(p: DVec3) -> f64 {
    let q = (p - DVec3::splat(0.5)).abs() - DVec3::splat(0.5);
    q.max(DVec3::ZERO).length() + q.max_element().min(0.0)
}

fn brute_force(mesh: &Mesh, query: DVec3) -> f64 {
    let corners = mesh.1.iter().map(|triangle| triangle.map(|corner| mesh.0[corner as usize]));
    let squared = corners.map(|corners| closest_on_triangle(&corners, query).distance_squared);
    let distance = squared.fold(f64::INFINITY, f64::min).sqrt();
    let turns = generalized_winding_number(&mesh.0, &mesh.1, query, &Exec::default()).unwrap();
    if turns.value > 0.5 { -distance } else { distance }
}

fn open_ball() -> Mesh {
    let (positions, triangles) = bumpy_ball(12, DVec3::ZERO, 1.0, 0.1);
    (positions, triangles.into_iter().enumerate().filter(|(i, _)| i % 9 != 0 && *i < 400).map(|(_, t)| t).collect())
}

#[test]
fn a_cube_has_its_closed_form() {
    let distance = build(&cube());
    assert!(distance.is_closed());
    let mut draws = Draws::new(1);
    for _ in 0..2000 {
        let query = draws.point() * 1.5 + DVec3::splat(0.5);
        assert!((distance.distance(query) - to_cube(query)).abs() < 1e-15, "{query}");
        let found = distance.signed_closest(query).unwrap();
        assert!((found.closest.point.distance(query) - found.distance.abs()).abs() < 1e-15);
    }
}

#[test]
fn agrees_with_brute_force() {
    let mut draws = Draws::new(2);
    for (mesh, closed) in [(bumpy_ball(12, DVec3::ONE, 1.0, 0.3), true), (open_ball(), false)] {
        let distance = build(&mesh);
        assert_eq!(distance.is_closed(), closed);
        for _ in 0..500 {
            let query = draws.point() * 1.5 + if closed { DVec3::ONE } else { DVec3::ZERO };
            assert_eq!(distance.distance(query), brute_force(&mesh, query));
        }
    }
}

#[test]
fn rules_tell_shells_apart() {
    let mut mesh: Mesh = Default::default();
    for (radius, inward) in [(1.0, true), (2.0, false), (3.0, false), (5.0, true)] {
        let (positions, triangles) = bumpy_ball(12, DVec3::ZERO, radius, 0.02);
        let first = mesh.0.len() as u32;
        mesh.0.extend(positions);
        let turn = |[a, b, c]: [u32; 3]| if inward { [a, c, b] } else { [a, b, c] };
        mesh.1.extend(triangles.into_iter().map(|triangle| turn(triangle.map(|corner| corner + first))));
    }
    // Winding numbers from the inside: 0, 1, 0, −1 and 0 outside.
    for (radius, positive, non_zero, odd) in [
        (0.5, false, false, false),
        (1.5, true, true, true),
        (2.5, false, false, false),
        (4.0, false, true, true),
        (6.0, false, false, false),
    ] {
        let query = DVec3::new(0.6, 0.0, -0.8) * radius;
        for (rule, wanted) in
            [(InsideRule::Positive, positive), (InsideRule::NonZero, non_zero), (InsideRule::Odd, odd)]
        {
            let distance = build(&mesh).with_rule(rule);
            assert_eq!(distance.distance(query) < 0.0, wanted, "{rule:?} {radius}");
            assert_eq!(distance.is_inside(query), wanted);
        }
    }
    assert!(InsideRule::Odd.holds(3.2) && InsideRule::Odd.holds(-1.0) && !InsideRule::Odd.holds(2.0));
    assert!(!InsideRule::Positive.holds(f64::NAN) && !InsideRule::Odd.holds(f64::NAN));
}

/// Half an ulp or a few beside faces, the exact side decides.
#[test]
fn a_whisker_from_a_closed_surface_the_sign_is_right() {
    for offset in [DVec3::ZERO, DVec3::new(5e6, -3e6, 1e6)] {
        let mesh = bumpy_ball(9, offset, 1.0, 0.2);
        let distance = build(&mesh);
        let mut draws = Draws::new(3);
        for triangle in &mesh.1 {
            let [a, b, c] = triangle.map(|corner| mesh.0[corner as usize]);
            let normal = (b - a).cross(c - a).normalize();
            for away in [1e-3, 1e-9, 1e-12, 1e-15, 0.0] {
                let weights = DVec3::new(1.2 + draws.signed(), 1.2 + draws.signed(), 1.2 + draws.signed());
                let on = (a * weights.x + b * weights.y + c * weights.z) / (weights.x + weights.y + weights.z);
                let query = on + normal * (away * draws.signed());
                let side = shapeloom_core::predicates::orient3d(a, b, c, query);
                if away > 1e-6 * (1.0 + offset.x) {
                    continue;
                }
                let found = distance.distance(query);
                match side {
                    std::cmp::Ordering::Less => assert!(found.is_sign_negative(), "{query} {found}"),
                    _ => assert!(found.is_sign_positive(), "{query} {found}"),
                }
            }
        }
    }
}

#[test]
fn batches_and_slices_give_the_same_bits() {
    let mut draws = Draws::new(4);
    for mesh in [bumpy_ball(20, DVec3::ZERO, 1.0, 0.2), open_ball()] {
        let distance = build(&mesh);
        let mut queries: Vec<DVec3> = (0..3000).map(|i| draws.point() * if i % 50 == 0 { 30.0 } else { 1.3 }).collect();
        queries.extend([DVec3::NAN, DVec3::splat(1e300)]);
        let wanted: Vec<u64> = queries.iter().map(|&query| distance.distance(query).to_bits()).collect();
        for threads in 1..=3 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (mut found, mut points) = (vec![0.0; queries.len()], vec![None; queries.len()]);
            pool.install(|| {
                let distance = build(&mesh);
                distance.distances(&queries, &mut found, &Exec::default()).unwrap();
                distance.signed_closest_points(&queries, &mut points, &Exec::default()).unwrap();
            });
            assert!(found.iter().map(|found| found.to_bits()).eq(wanted.iter().copied()), "{threads}");
            assert!(points.iter().zip(&queries).all(|(&found, &query)| found == distance.signed_closest(query)));
        }
        let (x, y): (Vec<f32>, Vec<f32>) = (0..400).map(|i| (i as f32 * 0.006 - 1.2, 0.1)).unzip();
        let mut out = vec![0.0; 400];
        distance.values(DVec3::Z * 0.2, &x, &y, &x, &mut out);
        for i in 0..400 {
            let point = DVec3::Z * 0.2 + DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(x[i]));
            assert_eq!(out[i], distance.value(point) as f32);
        }
    }
}

#[test]
fn gradients_are_difference_quotients() {
    let mut draws = Draws::new(5);
    let distance = build(&cube());
    let mut kept = 0;
    for _ in 0..2000 {
        let point = draws.point() + DVec3::splat(0.5);
        let step = 1e-6;
        let slope = |axis: DVec3| {
            let [high, low] = [1.0, -1.0].map(|side| distance.value(point + axis * (side * step)));
            (high - low) / (2.0 * step)
        };
        let gradient = distance.gradient(point);
        let wanted = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
        // Across the medial surface the quotient is no derivative, and shorter.
        if wanted.length() > 0.999 {
            assert!((gradient - wanted).length() < 1e-5, "{point} {gradient} {wanted}");
            kept += 1;
        }
        assert!((gradient.length() - 1.0).abs() < 1e-12);
    }
    assert!(kept > 1900);
    assert_eq!(distance.gradient(DVec3::new(0.25, 0.5, 0.0)), DVec3::NEG_Z);
    assert_eq!(distance.gradient(DVec3::new(1.0, 0.25, 0.5)), DVec3::X);
    assert_eq!(distance.gradient(DVec3::new(1.0, 1.0, 0.5)), DVec3::ZERO);
    let inward = cube().1.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let inward = build(&(cube().0, inward)).with_rule(InsideRule::NonZero);
    assert_eq!(inward.gradient(DVec3::new(1.0, 0.25, 0.5)), DVec3::X);
    let sheet = build(&(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]));
    // Just under half of all directions: outside on both sides.
    assert_eq!(sheet.gradient(DVec3::new(0.25, 0.25, 0.0)), DVec3::ZERO);
}

#[test]
fn ranges_hold_every_sample() {
    let mut draws = Draws::new(6);
    for mesh in [bumpy_ball(12, DVec3::ZERO, 1.0, 0.3), open_ball(), cube()] {
        let distance = build(&mesh);
        assert_eq!(distance.lipschitz().is_some(), distance.is_closed());
        for _ in 0..60 {
            let (center, half) = (draws.point() * 1.5, draws.point().abs() * draws.signed().abs());
            let region = Aabb::from_corners(center - half, center + half);
            let range = distance.range(&region);
            assert!(range.length() < 7.0);
            for i in 0..60 {
                let inner = if i < 8 { region.corners()[i] } else { center + draws.point() * half };
                assert!(range.contains(distance.value(inner)), "{region:?} {range:?}");
            }
        }
    }
    let distance = build(&cube());
    let at =
        |center: DVec3| distance.restrict(&Aabb::from_corners(center - DVec3::splat(0.1), center + DVec3::splat(0.1)));
    assert!(matches!(at(DVec3::splat(0.5)), Restricted::Negative));
    assert!(matches!(at(DVec3::splat(2.0)), Restricted::Positive));
    assert!(matches!(at(DVec3::ONE), Restricted::Same));
    assert_eq!(distance.range(&Aabb::EMPTY), shapeloom_core::Interval::ALL);
}

#[test]
fn closed_meshes_are_lipschitz() {
    let mut draws = Draws::new(7);
    let distance = build(&bumpy_ball(12, DVec3::ZERO, 1.0, 0.3));
    for i in 0..3000 {
        let p = draws.point() * 1.5;
        let q = p + draws.point() * 10f64.powi(-(i % 6));
        assert!((distance.value(p) - distance.value(q)).abs() <= p.distance(q) * (1.0 + 1e-12) + 1e-15);
    }
}

#[test]
fn sizes_and_wild_input_are_taken() {
    for scale in [1e-9, 1e150] {
        let mesh: Mesh = (cube().0.iter().map(|&p| p * scale).collect(), cube().1);
        let distance = build(&mesh);
        for p in [DVec3::splat(0.5), DVec3::new(0.2, 0.9, 0.6), DVec3::new(3.0, 0.5, 0.5)] {
            assert!((distance.distance(p * scale) / (to_cube(p) * scale) - 1.0).abs() < 1e-12);
        }
    }
    let nothing = build(&Default::default());
    assert_eq!(nothing.distance(DVec3::ONE), f64::INFINITY);
    assert!(nothing.distance(DVec3::NAN).is_nan() && nothing.signed_closest(DVec3::ONE).is_none());
    assert_eq!(nothing.gradient(DVec3::ONE), DVec3::ZERO);
    assert_eq!(nothing.range(&Aabb::from_corners(DVec3::ZERO, DVec3::ONE)).lo, f64::INFINITY);
    let point = build(&(vec![DVec3::ONE], vec![[0, 0, 0]]));
    assert_eq!((point.distance(DVec3::ZERO), point.distance(DVec3::ONE)), (3f64.sqrt(), 0.0));
    let many = build(&(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]; 16_000]));
    assert!(!many.is_closed() && many.distance(DVec3::new(0.2, 0.2, -0.5)) == -0.5);
    let found = SignedDistance::build(&[DVec3::NAN], &[[0, 0, 0]], &Exec::default()).unwrap_err();
    assert!(matches!(found, BvhError::NotFinite { .. }));
    let flag = CancelFlag::default();
    flag.cancel();
    let (mesh, stopped) = (cube(), Exec::default().with_cancel(&flag));
    assert!(SignedDistance::build(&mesh.0, &mesh.1, &stopped).is_err());
    let exec = Exec::default();
    drop(SignedDistance::build(&mesh.0, &mesh.1, &exec).unwrap());
    assert_eq!(exec.memory_taken(), 0);
}
