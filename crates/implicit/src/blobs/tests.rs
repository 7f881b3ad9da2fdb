//! Blobs against closed forms and against adding up all of them.

use std::f64::consts::LN_2;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, CancelFlag, Exec, Field, Interval, OverBudget, Restricted, Stop};

use super::*;
use crate::laws::Numbers;
use crate::{Operation, Tree};

/// What a blob adds, by the formulas of the papers, without a cutoff.
fn published(form: BlobForm, blob: &Blob, point: DVec3) -> f64 {
    let [first, second] = blob.parameters;
    let r = blob.center.distance(point);
    match form {
        BlobForm::Blinn => first * (-second * r * r).exp(),
        BlobForm::Blobby => (-second * r * r / (first * first) + second).exp(),
        BlobForm::Metaballs if r <= first / 3.0 => second * (1.0 - 3.0 * r * r / (first * first)),
        BlobForm::Metaballs if r <= first => 1.5 * second * (1.0 - r / first).powi(2),
        BlobForm::SoftObjects if r <= first => {
            let p = r / first;
            second * (1.0 - 22.0 / 9.0 * p.powi(2) + 17.0 / 9.0 * p.powi(4) - 4.0 / 9.0 * p.powi(6))
        }
        BlobForm::Metaballs | BlobForm::SoftObjects => 0.0,
    }
}

fn brute_force(blobs: &Blobs, point: DVec3) -> f64 {
    blobs.threshold() - blobs.blobs().iter().map(|blob| published(blobs.form(), blob, point)).sum::<f64>()
}

/// Blobs of sizes from a to 3 a in a cube, a fifth of them taken off where the form has that.
fn cloud(form: BlobForm, count: u32, radius: f64, reach: f64, seed: u64) -> Blobs {
    let mut numbers = Numbers::new(seed);
    let blob = |i: u32| {
        let size = radius * numbers.within(1.0, 3.0);
        let strength = if i % 5 == 4 { -0.7 } else { numbers.within(0.5, 2.0) };
        let [first, second] = match form {
            BlobForm::Blinn => [strength, 1.0 / (size * size)],
            BlobForm::Blobby => [size, numbers.within(0.5, 3.0)],
            BlobForm::Metaballs | BlobForm::SoftObjects => [2.0 * size, strength],
        };
        Blob::new(numbers.point(reach), first, second)
    };
    Blobs::try_new(form, 0.8, (0..count).map(blob).collect()).unwrap()
}

fn along_x(blobs: &Blobs, at: f64) -> f64 {
    blobs.value(DVec3::new(at, 0.0, 0.0))
}

/// Where the field changes its sign between two places.
fn root(f: impl Fn(f64) -> f64, mut inside: f64, mut outside: f64) -> f64 {
    for _ in 0..200 {
        let middle = inside * 0.5 + outside * 0.5;
        if f(middle) < 0.0 { inside = middle } else { outside = middle }
    }
    inside
}

#[test]
fn one_blob_is_the_sphere_of_the_closed_form() {
    let center = DVec3::new(0.3, -2.0, 5.0);
    let way = DVec3::new(2.0, -6.0, 3.0) / 7.0;
    let surface = |form, threshold, first, second| {
        let blobs = Blobs::try_new(form, threshold, vec![Blob::new(center, first, second)]).unwrap();
        root(|r| blobs.value(center + way * r), 0.0, 100.0)
    };
    for radius in [1.7, 1e-3, 40.0] {
        for blobbiness in [0.3, 1.0, 2.0, 8.0, 64.0] {
            // Off by the cutoff, over the slope 2 B / R.
            let found = surface(BlobForm::Blobby, 1.0, radius, blobbiness);
            let bound = radius * (Blobs::CUTOFF / (2.0 * blobbiness) + 1e-12);
            assert!((found - radius).abs() <= bound, "{radius} {blobbiness} {found}");
        }
        // a exp(-b r²) = T.
        let found = surface(BlobForm::Blinn, 0.5, 3.0, 2.0 / (radius * radius));
        assert!((found - radius * (6.0_f64.ln() / 2.0).sqrt()).abs() < 1e-7 * radius);
        // Both sides of R/3: 1 - 3 ρ² = 0.8, and 3/2 (1 - ρ)² = 0.25.
        let found = surface(BlobForm::Metaballs, 1.6, radius, 2.0);
        assert!((found - radius * (0.2_f64 / 3.0).sqrt()).abs() < 1e-12 * radius);
        let found = surface(BlobForm::Metaballs, 0.5, radius, 2.0);
        assert!((found - radius * (1.0 - (0.25_f64 / 1.5).sqrt())).abs() < 1e-12 * radius);
        let found = surface(BlobForm::SoftObjects, 0.5, radius, 1.0);
        assert!((found - radius / 2.0).abs() < 1e-12 * radius);
    }
}

#[test]
fn two_blobs_meet_where_the_closed_form_says() {
    let pair = |form, threshold, [a, b]: [f64; 2]| {
        let blobs = [-1.0, 1.0].map(|x| Blob::new(DVec3::new(x, 0.0, 0.0), a, b));
        Blobs::try_new(form, threshold, blobs.to_vec()).unwrap()
    };
    // Half-way, both add exp(-b): the neck opens at T = 2 exp(-b).
    for (threshold, joined) in [(2.0 * (-1.0_f64).exp() - 1e-6, true), (2.0 * (-1.0_f64).exp() + 1e-6, false)] {
        assert_eq!(along_x(&pair(BlobForm::Blinn, threshold, [1.0, 1.0]), 0.0) < 0.0, joined);
    }
    // Its radius: 2 exp(-b (1 + y²)) = T.
    let neck = pair(BlobForm::Blinn, 0.5, [1.0, 1.0]);
    let y = root(|y| neck.value(DVec3::new(0.0, y, 0.0)), 0.0, 5.0);
    assert!((y - (4.0_f64.ln() - 1.0).sqrt()).abs() < 1e-7, "{y}");
    // Blobby: 2 exp(B - B (1 + z²) / R²) = 1, so z² = R² (1 + ln 2 / B) - 1.
    let neck = pair(BlobForm::Blobby, 1.0, [1.2, 3.0]);
    let z = root(|z| neck.value(DVec3::new(0.0, 0.0, z)), 0.0, 5.0);
    assert!((z * z - (1.44 * (1.0 + LN_2 / 3.0) - 1.0)).abs() < 1e-6, "{z}");
    // Metaballs that reach 2: at the middle both are at half of their reach, 3/2 · 1/4 of α.
    assert!((along_x(&pair(BlobForm::Metaballs, 1.0, [2.0, 2.0]), 0.0) - (1.0 - 2.0 * 0.75)).abs() < 1e-15);
    assert!((along_x(&pair(BlobForm::SoftObjects, 0.7, [2.0, 1.0]), 0.0) - (0.7 - 1.0)).abs() < 1e-15);
    // A blob and its opposite are nothing.
    let opposite =
        vec![Blob::new(DVec3::ZERO, 1.5, 1.0), Blob::new(DVec3::X, -2.5, 1.0), Blob::new(DVec3::X, 2.5, 1.0)];
    let field = Blobs::try_new(BlobForm::Blinn, 1.0, opposite).unwrap();
    assert!((along_x(&field, 1.0) - (1.0 - 1.5 * (-1.0_f64).exp())).abs() < 2e-7);
}

/// Nishimura's two parabolas meet with value and slope, not with curvature; both end flat.
#[test]
fn metaballs_are_smooth_once_and_soft_objects_twice_at_their_ends() {
    let reach = 3.0;
    let one = |form| Blobs::try_new(form, 0.5, vec![Blob::new(DVec3::ZERO, reach, 1.0)]).unwrap();
    let metaball = one(BlobForm::Metaballs);
    let jump = |blobs: &Blobs, at: f64, step: f64| {
        let (ahead, here, behind) = (along_x(blobs, at + step), along_x(blobs, at), along_x(blobs, at - step));
        [(ahead - here) / step - (here - behind) / step, (ahead - 2.0 * here + behind) / (step * step)]
    };
    for at in [reach / 3.0, reach] {
        for step in [1e-3, 1e-4, 1e-5] {
            // One-sided slopes differ by the step times the second derivatives, at most 6/R².
            assert!(jump(&metaball, at, step)[0].abs() < 2.0 * 6.0 / (reach * reach) * step + 1e-10, "{at} {step}");
        }
        let ends = [at - 1e-9, at + 1e-9].map(|x| metaball.gradient(DVec3::new(x, 0.0, 0.0)).x);
        assert!((ends[0] - ends[1]).abs() < 1e-8, "{ends:?}");
    }
    assert!((along_x(&metaball, reach / 3.0) - (0.5 - 2.0 / 3.0)).abs() < 1e-15);
    // Second derivatives of the sum on both sides of R/3: -6/R² and 3/R².
    let second = |at: f64| jump(&metaball, at, 1e-4)[1] * reach * reach;
    assert!((second(0.9) - 6.0).abs() < 1e-4 && (second(1.1) + 3.0).abs() < 1e-4);
    let soft = one(BlobForm::SoftObjects);
    assert_eq!((along_x(&soft, 0.0), along_x(&soft, reach)), (-0.5, 0.5));
    assert!(along_x(&soft, reach / 2.0).abs() < 1e-15);
    assert!(jump(&soft, reach, 1e-4)[0].abs() < 1e-3);
}

#[test]
fn values_are_those_of_all_blobs_added_up() {
    for form in BlobForm::ALL {
        for (count, seed) in [(1, 1), (7, 2), (600, 3)] {
            let blobs = cloud(form, count, 0.15, 1.5, seed);
            let mut numbers = Numbers::new(seed + 10);
            let mut touched = 0;
            for _ in 0..400 {
                let p = numbers.point(2.5);
                let (value, exact) = (blobs.value(p), brute_force(&blobs, p));
                assert!((value - exact).abs() <= blobs.cutoff_error() + 1e-12, "{form:?} {value} {exact}");
                touched += usize::from(value != blobs.threshold());
            }
            assert!(count < 600 || touched > 100, "{form:?} {touched}");
        }
    }
    for (cutoff, bound) in [(1e-12, 1e-12), (0.1, 0.1)] {
        let loose = cloud(BlobForm::Blinn, 200, 0.2, 1.0, 5);
        let blobs =
            Blobs::try_new_with(BlobForm::Blinn, 1.0, loose.blobs().to_vec(), cutoff, &Exec::default()).unwrap();
        assert_eq!(blobs.cutoff_error(), bound);
        let mut worst = 0.0_f64;
        let mut numbers = Numbers::new(4);
        for _ in 0..500 {
            let p = numbers.point(1.5);
            worst = worst.max((blobs.value(p) - brute_force(&blobs, p)).abs());
        }
        // The bound is used, not only kept.
        assert!(worst <= bound + 1e-13 && worst >= bound / 100.0, "{cutoff} {worst}");
    }
}

#[test]
fn gradients_are_those_of_all_blobs() {
    for form in BlobForm::ALL {
        let blobs = cloud(form, 60, 0.3, 1.0, 6);
        let mut numbers = Numbers::new(7);
        let step = 1e-6;
        for _ in 0..300 {
            let p = numbers.point(1.5);
            let slope = |axis: DVec3| {
                (brute_force(&blobs, p + axis * step) - brute_force(&blobs, p - axis * step)) / (2.0 * step)
            };
            let quotient = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z));
            assert!((blobs.gradient(p) - quotient).length() < 1e-5 * (1.0 + quotient.length()), "{form:?} {p}");
        }
    }
}

#[test]
fn batches_are_close_and_the_same_bits_however_they_are_split() {
    let mut numbers = Numbers::new(8);
    for form in BlobForm::ALL {
        for (origin, count) in [(DVec3::ZERO, 500), (DVec3::new(5e6, -3e6, 1e6), 80)] {
            let near = cloud(form, count, 0.2, 1.0, 9);
            let moved = near.blobs().iter().map(|blob| Blob { center: blob.center + origin, ..*blob });
            let blobs = Blobs::try_new(form, 0.8, moved.collect()).unwrap();
            // A row, and points all over the place.
            for row in [true, false] {
                let points: Vec<DVec3> = (0..333)
                    .map(|i| if row { DVec3::new(f64::from(i) * 0.01 - 1.6, 0.21, -0.4) } else { numbers.point(1.5) })
                    .collect();
                let [x, y, z] = [0, 1, 2].map(|axis| points.iter().map(|p| p[axis] as f32).collect::<Vec<f32>>());
                let mut whole = vec![0.0; points.len()];
                blobs.values(origin, &x, &y, &z, &mut whole);
                for (i, value) in whole.iter().enumerate() {
                    let p = origin + DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
                    let exact = blobs.value(p);
                    let sizes: f64 = blobs.blobs().iter().map(|blob| published(form, blob, p).abs()).sum();
                    assert!((f64::from(*value) - exact).abs() <= 3e-6 * (1.0 + sizes), "{form:?} {value} {exact}");
                }
                for piece in [1, 2, 7, 16, 63, 65, 200] {
                    let mut parts = vec![0.0; points.len()];
                    for start in (0..points.len()).step_by(piece) {
                        let end = (start + piece).min(points.len());
                        let part = start..end;
                        blobs.values(origin, &x[part.clone()], &y[part.clone()], &z[part.clone()], &mut parts[part]);
                    }
                    let bits = |values: &[f32]| values.iter().map(|value| value.to_bits()).collect::<Vec<u32>>();
                    assert_eq!(bits(&whole), bits(&parts), "{form:?} {piece}");
                }
            }
        }
    }
}

#[test]
fn ranges_and_restrictions_hold_for_many_blobs() {
    for form in BlobForm::ALL {
        let blobs = cloud(form, 2000, 0.05, 1.0, 11);
        let mut numbers = Numbers::new(12);
        let (mut simpler, mut decided, mut tight) = (0, 0, 0);
        for round in 0..300 {
            let a = numbers.point(1.2);
            let region = Aabb::from_corners(a, a + numbers.point([0.5, 0.1, 1e-3][round % 3]));
            let range = blobs.range(&region);
            let restricted = blobs.restrict(&region);
            let mut seen = Interval::new(f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..20 {
                let part =
                    if i < 8 { region.corners()[i] } else { region.min + (numbers.point(0.5) + 0.5) * region.size() };
                let p = part.clamp(region.min, region.max);
                let value = blobs.value(p);
                assert!(range.contains(value), "{form:?} {range:?} {value}");
                seen = Interval::new(seen.lo.min(value), seen.hi.max(value));
                match &restricted {
                    Restricted::Positive => assert!(value > 0.0),
                    Restricted::Negative => assert!(value < 0.0),
                    Restricted::Same => {}
                    Restricted::Simpler(field) => {
                        assert_eq!(field.value(p).to_bits(), value.to_bits());
                        assert_eq!(field.gradient(p), blobs.gradient(p));
                        // And once more in a part of the part.
                        let half = Aabb::from_corners(p, region.center());
                        if let Restricted::Simpler(less) = field.restrict(&half) {
                            assert_eq!(less.value(p).to_bits(), value.to_bits());
                        }
                    }
                }
            }
            tight += usize::from(round % 3 == 2 && range.length() < 0.2 + 4.0 * seen.length());
            simpler += usize::from(matches!(restricted, Restricted::Simpler(_)));
            decided += usize::from(matches!(restricted, Restricted::Positive | Restricted::Negative));
        }
        assert!(simpler > 40 && decided > 60 && tight > 80, "{form:?} {simpler} {decided} {tight}");
    }
}

#[test]
fn slopes_stay_below_the_stated_constant_and_come_near_it() {
    // One blob: the constant is its steepest slope.
    for (form, first, second, steepest) in [
        (BlobForm::Blinn, 2.0, 3.0, 2.0 * 6.0_f64.sqrt() * (-0.5_f64).exp()),
        (BlobForm::Blobby, 1.5, 2.0, 1.5_f64.exp() * 2.0 / 1.5),
        (BlobForm::Metaballs, 1.5, 2.0, 4.0 / 1.5),
    ] {
        let blobs = Blobs::try_new(form, 0.5, vec![Blob::new(DVec3::ZERO, first, second)]).unwrap();
        assert!((blobs.lipschitz().unwrap() / steepest - 1.0).abs() < 1e-9, "{form:?}");
        let found = (0..3000).map(|i| blobs.gradient(DVec3::X * f64::from(i) * 1e-3).length()).fold(0.0, f64::max);
        assert!(found <= steepest * (1.0 + 1e-12) && found > steepest * (1.0 - 1e-5), "{form:?} {found} {steepest}");
    }
    for form in BlobForm::ALL {
        let blobs = cloud(form, 3000, 0.03, 1.0, 13);
        let lipschitz = blobs.lipschitz().unwrap();
        let mut numbers = Numbers::new(14);
        let steepest = (0..3000).map(|_| blobs.gradient(numbers.point(1.1)).length()).fold(0.0, f64::max);
        // All terms together would be thousands of times as steep.
        assert!(steepest <= lipschitz && lipschitz < 150.0 * steepest, "{form:?} {steepest} {lipschitz}");
    }
}

/// Blobs that lie within one cell of the coarse lattice count there together, and nowhere else.
#[test]
fn slopes_add_up_in_the_cell_where_blobs_meet() {
    let places = [0.0, 8.0, 3.3, 3.3, 3.3, 3.3].map(|x| Blob::new(DVec3::splat(x), 0.01, 1.0));
    let blobs = Blobs::try_new(BlobForm::Metaballs, 0.5, places.to_vec()).unwrap();
    // 2 α/R each.
    assert!((blobs.lipschitz().unwrap() / 800.0 - 1.0).abs() < 1e-9, "{:?}", blobs.lipschitz());
}

/// A cutoff so coarse that single precision sees what is taken off.
#[test]
fn batches_are_cut_off_as_points_are() {
    let blobs = (0..3).map(|i| Blob::new(DVec3::X * f64::from(i), 1.5, 1.0)).collect();
    let blobs = Blobs::try_new_with(BlobForm::Blinn, 0.8, blobs, 0.1, &Exec::default()).unwrap();
    let x: Vec<f32> = (0..400).map(|i| i as f32 * 0.02 - 3.0).collect();
    let mut out = vec![0.0; 400];
    blobs.values(DVec3::ZERO, &x, &[0.5; 400], &[0.0; 400], &mut out);
    for (x, value) in x.iter().zip(out) {
        let exact = blobs.value(DVec3::new(f64::from(*x), 0.5, 0.0));
        assert!((f64::from(value) - exact).abs() < 2e-6, "{x} {value} {exact}");
    }
    assert_eq!(blobs.value(DVec3::X * 9.0), 0.8);
}

#[test]
fn the_box_holds_all_that_is_inside() {
    let radius = 1.3;
    let ball = Blobs::try_new(BlobForm::Blobby, 1.0, vec![Blob::new(DVec3::splat(7.0), radius, 2.0)]).unwrap();
    let found = ball.bounds();
    let sphere = Aabb::from_corners(DVec3::splat(7.0 - radius), DVec3::splat(7.0 + radius));
    assert!(found.contains(sphere.min + 1e-6) && found.contains(sphere.max - 1e-6));
    assert!(found.size().max_element() < 1.3 * 2.0 * radius, "{found:?}");
    for form in BlobForm::ALL {
        let blobs = cloud(form, 400, 0.1, 1.0, 15);
        let found = blobs.bounds();
        let mut numbers = Numbers::new(16);
        for _ in 0..4000 {
            let p = numbers.point(2.0);
            assert!(blobs.value(p) > 0.0 || found.contains(p), "{form:?} {p}");
        }
    }
}

#[test]
fn bad_numbers_are_named() {
    let make = |form, threshold, rows: &[[f64; 5]]| {
        let blobs = rows.iter().map(|&[x, y, z, a, b]| Blob::new(DVec3::new(x, y, z), a, b)).collect();
        Blobs::try_new(form, threshold, blobs)
    };
    let good = [0.0, 0.0, 0.0, 1.0, 1.0];
    assert_eq!(make(BlobForm::Blinn, 0.5, &[]), Err(BlobsError::Empty));
    for threshold in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(make(BlobForm::Blinn, threshold, &[good]), Err(BlobsError::Threshold { .. })));
    }
    assert_eq!(
        make(BlobForm::Metaballs, 2.0, &[good, good]),
        Err(BlobsError::Unreachable { threshold: 2.0, peaks: 2.0 })
    );
    let error = make(BlobForm::Metaballs, 0.5, &[good, [0.0, 0.0, 0.0, 0.0, 1.0]]).unwrap_err();
    assert_eq!(error.to_string(), "blob 1: found radius 0, expected a number from 1e-300 to 1e300");
    for form in BlobForm::ALL {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0] {
            for place in 0..2 {
                let mut row = good;
                row[3 + place] = bad;
                let error = make(form, 0.5, &[good, good, row]).unwrap_err();
                let parameter = form.parameters()[place];
                let named = matches!(error, BlobsError::Parameter { index: 2, parameter: p, .. } if p == parameter);
                assert!(named, "{error}");
            }
            if bad != 0.0 {
                let error = make(form, 0.5, &[good, [0.0, bad, 0.0, 1.0, 1.0]]).unwrap_err();
                assert!(matches!(error, BlobsError::Center { index: 1, .. }), "{error}");
            }
        }
    }
    for (form, row, parameter) in [
        (BlobForm::Blinn, [0.0, 0.0, 0.0, 1.0, -1.0], "decay"),
        (BlobForm::Blobby, [0.0, 0.0, 0.0, -1.0, 1.0], "radius"),
        (BlobForm::Blobby, [0.0, 0.0, 0.0, 1.0, -2.0], "blobbiness"),
        (BlobForm::Blobby, [0.0, 0.0, 0.0, 1.0, 65.0], "blobbiness"),
        (BlobForm::SoftObjects, [0.0, 0.0, 0.0, 1e-310, 1.0], "radius"),
    ] {
        let error = make(form, 0.5, &[row]).unwrap_err();
        assert!(matches!(error, BlobsError::Parameter { index: 0, parameter: p, .. } if p == parameter), "{error}");
    }
    assert!(matches!(make(BlobForm::Blinn, 0.5, &[[0.0, 0.0, 0.0, 1e38, 1.0]]), Err(BlobsError::Strength { .. })));
    for cutoff in [0.0, -1.0, f64::NAN, 0.2] {
        let blobs = vec![Blob::new(DVec3::ZERO, 1.0, 1.0)];
        let made = Blobs::try_new_with(BlobForm::Blinn, 0.5, blobs, cutoff, &Exec::default());
        assert!(matches!(made, Err(BlobsError::Cutoff { .. })));
    }
    let flag = CancelFlag::default();
    flag.cancel();
    let many = vec![Blob::new(DVec3::ZERO, 1.0, 1.0); 100];
    let run = |exec: &Exec| Blobs::try_new_with(BlobForm::Blinn, 0.5, many.clone(), 1e-7, exec);
    assert_eq!(run(&Exec::default().with_cancel(&flag)), Err(BlobsError::Stop(Stop::Cancelled)));
    assert!(matches!(run(&Exec::default().with_memory(1000)), Err(BlobsError::OverBudget(OverBudget { .. }))));
}

#[test]
fn absurd_sizes_and_places_give_numbers() {
    for form in BlobForm::ALL {
        for (size, far) in
            [(1.0_f64, 0.0), (1e-9, 0.0), (1e-300, 0.0), (1e150, 0.0), (1.0, 5e6), (1.0, 1e300), (1e290, 1e300)]
        {
            let second = if form == BlobForm::Blinn { (1.0 / (size * size)).clamp(5e-324, 1e308) } else { 1.0 };
            let first = if form == BlobForm::Blinn { 1.0 } else { size };
            let blobs = (0..9).map(|i| Blob::new(DVec3::splat(far + size * 0.1 * f64::from(i % 3)), first, second));
            let blobs = Blobs::try_new(form, 0.5, blobs.collect()).unwrap();
            let center = DVec3::splat(far);
            assert!(blobs.value(center) < 0.0, "{form:?} {size} {far}");
            assert_eq!(blobs.value(center + DVec3::splat(1e306)), 0.5);
            assert_eq!(blobs.value(DVec3::INFINITY), 0.5);
            assert!(blobs.value(DVec3::NAN).is_nan());
            assert!(blobs.gradient(center + size * 0.3).is_finite());
            let mut out = [0.0; 3];
            blobs.values(center, &[0.0, f32::INFINITY, f32::NAN], &[0.0; 3], &[0.0; 3], &mut out);
            assert!(out[0] < 0.0 && out[1] == 0.5 && out[2].is_nan(), "{form:?} {size} {far} {out:?}");
            blobs.values(center, &[], &[], &[], &mut []);
            blobs.values(DVec3::NAN, &[0.0], &[0.0], &[0.0], &mut out[..1]);
            assert!(out[0].is_nan());
            assert_eq!(blobs.range(&Aabb::EMPTY), Interval::ALL);
            let around = Aabb::from_corners(center - size, center + size);
            assert!(blobs.range(&around).contains(blobs.value(center)));
            assert!(blobs.lipschitz().is_some_and(|slope| slope > 0.0) && blobs.bounds().contains(center));
        }
    }
}

#[test]
fn equal_places_by_the_thousand_are_no_trouble() {
    let blobs = vec![Blob::new(DVec3::ONE, 1.0, 1.0); 5000];
    let field = Blobs::try_new(BlobForm::SoftObjects, 2500.0, blobs).unwrap();
    let mut out = [0.0; 100];
    let x: Vec<f32> = (0..100).map(|i| i as f32 * 0.02).collect();
    field.values(DVec3::ZERO, &x, &[1.0; 100], &[1.0; 100], &mut out);
    assert!((out[25]).abs() < 1.0 && out[50] < -2400.0 && out[0] == 2500.0);
}

#[test]
fn blobs_are_nodes_of_trees() {
    let blobs = cloud(BlobForm::Metaballs, 50, 0.2, 1.0, 17);
    let tree = Tree::blobs(blobs.clone());
    assert_eq!(tree.operation().name(), "metaballs");
    assert!(tree == Tree::blobs(blobs.clone()));
    let mut other = blobs.blobs().to_vec();
    other[3].center.x += 1e-9;
    assert!(tree != Tree::blobs(Blobs::try_new(BlobForm::Metaballs, 0.8, other).unwrap()));
    let program = tree.translate(1.0, 2.0, 3.0).union(Tree::sphere(0.1)).compile().unwrap();
    let p = DVec3::new(0.2, 0.1, -0.3);
    assert!((program.value(p + DVec3::new(1.0, 2.0, 3.0)) - blobs.value(p)).abs() < 1e-12);
    assert!(matches!(Tree::blobs(blobs).operation(), Operation::Blobs(_)));
}
