use std::slice;

use super::*;
use crate::laws::Numbers;

/// By brute force: dense samples of the curve, each then improved between its neighbours by golden section.
fn brute_force(pieces: &[Vec<DVec3>], point: DVec3) -> f64 {
    let bernstein = |control: &[DVec3], t: f64| {
        let n = control.len() - 1;
        let mut sum = DVec3::ZERO;
        let mut choose = 1.0;
        for (i, p) in control.iter().enumerate() {
            sum += *p * (choose * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32));
            choose = choose * (n - i) as f64 / (i + 1) as f64;
        }
        sum
    };
    let mut least = f64::INFINITY;
    for control in pieces {
        let at = |t: f64| bernstein(control, t.clamp(0.0, 1.0)).distance(point);
        let best = (0..=400).map(|i| f64::from(i) / 400.0).min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
        let (mut a, mut b) = (best - 1.0 / 400.0, best + 1.0 / 400.0);
        for _ in 0..100 {
            let (c, d) = (a + (b - a) * 0.381_966, a + (b - a) * 0.618_034);
            if at(c) < at(d) { b = d } else { a = c }
        }
        least = least.min(at((a + b) / 2.0));
    }
    least
}

#[test]
fn distances_are_those_of_brute_force() {
    let mut numbers = Numbers::new(11);
    for round in 0..30 {
        let degree = round % 6;
        let pieces: Vec<Vec<DVec3>> =
            (0..1 + round % 4).map(|_| (0..=degree).map(|_| numbers.point(1.0)).collect()).collect();
        let field = CurveDistance::try_new(&pieces, 0.25, 1e-3).unwrap();
        let mut rough = 0;
        for _ in 0..50 {
            let p = numbers.point(2.0);
            let expected = brute_force(&pieces, p) - 0.25;
            let off = (field.value(p) - expected).abs();
            assert!(off <= 1e-3, "degree {degree}: {off}");
            rough += usize::from(off > 1e-9);
        }
        // Two far places of the curve may be equally near within the tolerance; hardly ever.
        assert!(rough <= 1, "degree {degree}: {rough}");
    }
}

#[test]
fn batches_and_gradients_follow_the_values() {
    let points: Vec<DVec3> =
        (0..40).map(|i| DVec3::new(f64::from(i) * 0.1, f64::from(i % 7) * 0.2, f64::from(i).sin())).collect();
    let field = CurveDistance::polyline(&points, 0.3).unwrap();
    let mut numbers = Numbers::new(12);
    let (mut x, mut y, mut z) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..500 {
        let p = (numbers.point(2.0) + DVec3::X * 2.0).as_vec3();
        x.push(p.x);
        y.push(p.y);
        z.push(p.z);
    }
    let mut out = vec![0.0; 500];
    field.values(DVec3::ZERO, &x, &y, &z, &mut out);
    for i in 0..500 {
        let p = DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
        assert_eq!(out[i], field.value(p) as f32);
        let step = 1e-6;
        let slope = (field.value(p + DVec3::X * step) - field.value(p - DVec3::X * step)) / (2.0 * step);
        assert!((slope - field.gradient(p).x).abs() < 1e-4, "{p}");
        let region = Aabb::from_corners(p, p + numbers.point(0.5));
        let inner = region.min + region.size() * 0.3;
        assert!(
            field.range(&region).contains(field.value(inner)) && field.range(&region).contains(field.value(region.max))
        );
    }
}

#[test]
fn bad_curves_are_named() {
    let message =
        |pieces: &[Vec<DVec3>], radius, tolerance| CurveDistance::try_new(pieces, radius, tolerance).unwrap_err();
    let arc = vec![DVec3::ZERO, DVec3::X, DVec3::ONE];
    assert_eq!(message(&[], 1.0, 1.0), CurveError::Empty);
    assert_eq!(message(&[arc.clone(), vec![]], 1.0, 1.0), CurveError::Piece { index: 1 });
    assert_eq!(message(&[vec![DVec3::NAN]], 1.0, 1.0), CurveError::Piece { index: 0 });
    assert!(matches!(message(slice::from_ref(&arc), -1.0, 1.0), CurveError::Radius { .. }));
    assert!(matches!(message(slice::from_ref(&arc), 1.0, 0.0), CurveError::Tolerance { .. }));
    assert!(matches!(message(slice::from_ref(&arc), 1.0, 1e-300), CurveError::TooFine { .. }));
    let same = CurveDistance::polyline(&vec![DVec3::ONE; 1000], 0.5).unwrap();
    assert_eq!(same.value(DVec3::ZERO), 3.0_f64.sqrt() - 0.5);
    assert!(same.value(DVec3::NAN).is_nan());
}
