//! Sizes far apart, and shapes that overlap themselves.

use shapeloom_core::Exec;
use shapeloom_core::glam::DVec3;

use super::*;

fn measure(a: &Simplices<'_>, b: &Simplices<'_>) -> Measured {
    Distances { samples: 200, ..Distances::new() }.measure(a, b, &Exec::default()).unwrap()
}

/// True bounds that are near to each other, and means no larger.
fn assert_near(way: &DirectedHausdorff, mean: &MeanDistance, wanted: f64) {
    assert!(way.lower <= wanted && wanted <= way.upper * (1.0 + 1e-15), "{way:?} {wanted}");
    assert!(way.converged && way.upper - way.lower <= 0.0101 * wanted, "{way:?} {wanted}");
    let numbers = [mean.mean.lower, mean.mean.value, mean.mean.upper];
    assert!(numbers.is_sorted() && numbers[2] <= way.upper && mean.rms.upper <= way.upper, "{mean:?} {way:?}");
}

#[test]
fn a_shape_that_is_tiny_beside_the_other_has_true_bounds() {
    let ends = [DVec3::X, DVec3::Y];
    let segment = Simplices::segments(&ends[..], &[[0, 1]]);
    for exponent in [-140, -150, -153, -154, -155, -160, -200, -250, -290, -300, -305] {
        let size = 10f64.powi(exponent);
        let places =
            [DVec3::new(1.0, 2.0, 0.0), DVec3::new(-1.0, 0.5, 2.0), DVec3::new(0.0, -1.0, 1.0)].map(|p| p * size);
        let shapes = [
            Simplices::points(&places[..1]),
            Simplices::points(&places[..]),
            Simplices::segments(&places[..], &[[0, 1], [1, 2]]),
            Simplices::new(&places[..], &[[0, 1, 2]][..]),
        ];
        for tiny in &shapes {
            // The ends are 1 away from it, the middle is nearest.
            let (there, back) = (measure(&segment, tiny), measure(tiny, &segment));
            for (far, far_mean, near, near_mean) in [
                (&there.hausdorff.a_to_b, &there.a_to_b, &there.hausdorff.b_to_a, &there.b_to_a),
                (&back.hausdorff.b_to_a, &back.b_to_a, &back.hausdorff.a_to_b, &back.a_to_b),
            ] {
                assert_near(far, far_mean, 1.0);
                assert_near(near, near_mean, 0.5f64.sqrt());
                let wanted = (1.0 + 1f64.asinh() / 2f64.sqrt()) / 2.0;
                assert!((far_mean.mean.value - wanted).abs() < 0.01, "{far_mean:?} {wanted}");
            }
        }
    }
}

#[test]
fn one_shape_in_sizes_far_apart_has_true_bounds() {
    let corners = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for (large, small) in [(1.0, 1e-300), (1e300, 1.0), (1e300, 1e-300), (1.0, 1e-160), (1e-10, 1e-170)] {
        let [a, b] = [large, small].map(|size| corners.map(|p| p * size));
        let [a, b] = [&a, &b].map(|positions| Simplices::new(&positions[..], &triangles[..]));
        let found = measure(&a, &b);
        assert_near(&found.hausdorff.a_to_b, &found.a_to_b, large);
        assert_near(&found.hausdorff.b_to_a, &found.b_to_a, large / 3f64.sqrt());
    }
}

/// A length whose square vanishes is no zero.
#[test]
fn lengths_that_vanish_when_squared_still_count() {
    let corners = [DVec3::ZERO, DVec3::X * 1e-170, DVec3::Z, DVec3::X + DVec3::Z, DVec3::Y + DVec3::Z];
    let a = Simplices::new(&corners[..], &[[2, 3, 4], [0, 1, 1]][..]);
    let b = Simplices::new(&corners[..], &[[0, 0, 0], [1, 1, 1], [2, 3, 4]][..]);
    let found = measure(&a, &b).hausdorff.a_to_b;
    assert!(found.upper >= 5e-171 && found.upper <= 1e-12 && found.lower == 0.0, "{found:?}");
}

/// Vertices lie on other triangles, triangles twice in one place, some have no area.
#[test]
fn a_shape_that_overlaps_itself_is_nowhere_away_from_itself() {
    let mut state = 5u64;
    let mut draw = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut positions, mut triangles): (Vec<DVec3>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    for k in 0..60u32 {
        // All in one slanted plane, rounded off it.
        positions.extend([0; 3].map(|_| {
            let (x, y) = (draw(), draw());
            DVec3::new(x, y, 0.3 * x - 0.7 * y)
        }));
        let first = 3 * k;
        triangles.extend([[first, first + 1, first + 2], [first + 1, first + 2, first], [first, first + 1, first]]);
        triangles.push([first, first, first]);
    }
    let shape = Simplices::new(positions, triangles);
    let found = measure(&shape, &shape);
    assert_eq!((found.hausdorff.lower(), found.hausdorff.upper(), found.chamfer()), (0.0, 0.0, 0.0));
    for mean in [found.a_to_b, found.b_to_a] {
        assert_eq!((mean.mean, mean.rms, mean.largest_sampled), Default::default());
    }
}
