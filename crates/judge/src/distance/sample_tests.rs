//! Distances between what can be sampled: formulas against closed forms, sizes at both ends of the numbers, wrong samples.

use std::f64::consts::{PI, TAU};

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Closest, ClosestPoint, Exec, Threads};
use shapeloom_spatial::{BvhError, TriangleBvh};

use super::*;
use crate::JudgeError;

/// A sphere by its formula: no triangle anywhere.
struct Sphere {
    center: DVec3,
    radius: f64,
    /// Bands of equal height, each of which has twice as many cells.
    bands: usize,
}

impl ClosestPoint for Sphere {
    fn closest_within(&self, query: DVec3, max_distance: f64) -> Option<Closest> {
        let point = self.center + (query - self.center).try_normalize().unwrap_or(DVec3::X) * self.radius;
        let distance = query.distance(point);
        let parameters = DVec2::ZERO;
        (distance <= max_distance).then_some(Closest {
            point,
            distance_squared: distance * distance,
            element: 0,
            parameters,
        })
    }
}

impl Samples for Sphere {
    fn count(&self) -> usize {
        2 * self.bands * self.bands
    }

    fn fill(&self, first: usize, out: &mut [Sample]) {
        let height = |band: f64| 1.0 - 2.0 * band / self.bands as f64;
        for (cell, sample) in (first..).zip(out) {
            let (band, sector) = (cell / (2 * self.bands), cell % (2 * self.bands));
            // Bands of equal height have equal areas (Archimedes).
            let z = height(band as f64 + 0.5);
            let turn = TAU * (sector as f64 + 0.5) / (2 * self.bands) as f64;
            let flat = (1.0 - z * z).sqrt();
            let direction = DVec3::new(flat * turn.cos(), flat * turn.sin(), z);
            // Along the meridian, then along the widest parallel.
            let [top, bottom] = [band, band + 1].map(|band| height(band as f64));
            let meridian = (top.acos() - z.acos()).abs().max((bottom.acos() - z.acos()).abs());
            let widest = if top * bottom <= 0.0 { 1.0 } else { (1.0 - top.abs().min(bottom.abs()).powi(2)).sqrt() };
            let radius = self.radius * (meridian + PI / (2 * self.bands) as f64 * widest);
            *sample = Sample { position: self.center + direction * self.radius, weight: 1.0, radius };
        }
    }
}

fn sampled<T: Samples + ClosestPoint>(shape: &T) -> Sampled<'_> {
    Sampled { samples: shape, closest: shape }
}

fn holds(estimate: &Estimate, wanted: f64, near: f64) {
    assert!(estimate.lower <= wanted && wanted <= estimate.upper, "{estimate:?} {wanted}");
    assert!((estimate.value / wanted - 1.0).abs() < near, "{estimate:?} {wanted}");
}

/// The mean of |x - c| over a sphere of radius r about a place at distance d > r from c is d + r²/3d, that of its square
/// d² + r².
#[test]
fn spheres_given_by_formulas_are_as_far_apart_as_they_are() {
    let (r, s, d) = (1.0, 0.5, 2.0);
    let a = Sphere { center: DVec3::ZERO, radius: r, bands: 60 };
    let b = Sphere { center: DVec3::new(d * 0.6, 0.0, d * 0.8), radius: s, bands: 60 };
    let found = distances_from_samples(sampled(&a), sampled(&b), &Exec::default()).unwrap().unwrap();
    let mean = |r: f64, s: f64| d + r * r / (3.0 * d) - s;
    let rms = |r: f64, s: f64| (d * d + r * r - 2.0 * s * (d + r * r / (3.0 * d)) + s * s).sqrt();
    for (way, r, s) in [(&found.a_to_b, r, s), (&found.b_to_a, s, r)] {
        holds(&way.mean, mean(r, s), 1e-4);
        holds(&way.rms, rms(r, s), 1e-4);
        assert!(way.mean.upper - way.mean.lower < 0.15 && way.samples == 7200, "{way:?}");
        assert!((way.largest_sampled / (d + r - s) - 1.0).abs() < 1e-3, "{way:?}");
    }
    assert!((found.chamfer() - (mean(r, s) + mean(s, r)) / 2.0).abs() < 1e-4);
    assert!((found.chamfer_squared() - (rms(r, s).powi(2) + rms(s, r).powi(2)) / 2.0).abs() < 1e-3);
    for exec in [Exec::default(), Exec::default().with_threads(Threads::Sequential)] {
        assert_eq!(distances_from_samples(sampled(&a), sampled(&b), &exec).unwrap().unwrap(), found);
    }
    // About one centre: the gap, from everywhere.
    let b = Sphere { center: DVec3::ZERO, ..b };
    let found = distances_from_samples(sampled(&a), sampled(&b), &Exec::default()).unwrap().unwrap();
    holds(&found.a_to_b.mean, 0.5, 1e-12);
    holds(&found.b_to_a.rms, 0.5, 1e-12);
}

/// An octahedron with corners on a sphere: the mean distance of its points is one less the mean of |x|, by quadrature of
/// another kind.
#[test]
fn a_mesh_and_a_formula_can_be_compared() {
    let exec = Exec::default();
    let positions = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let triangles = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    let shape = Simplices::new(&positions[..], &triangles[..]);
    let (cells, bvh) =
        (shape.cells(20_000, &exec).unwrap(), TriangleBvh::build(&positions, &triangles, &exec).unwrap());
    let sphere = Sphere { center: DVec3::ZERO, radius: 1.0, bands: 80 };
    let mesh = Sampled { samples: &cells, closest: &bvh };
    let found = distances_from_samples(mesh, sampled(&sphere), &exec).unwrap().unwrap();
    // In polar coordinates about the foot of the centre on a face, at 1/√3: over a sixth of the face, with the inner
    // radius ρ = 1/√6, the integral of √(h² + r²) r dr is ((h² + R²)^1.5 - h³)/3 with R = ρ/cos t.
    let (h, inner) = (1.0 / 3f64.sqrt(), 1.0 / 6f64.sqrt());
    let steps = 20_000;
    let integral: f64 = (0..steps)
        .map(|k| {
            let edge = inner / (PI / 3.0 * (f64::from(k) + 0.5) / f64::from(steps)).cos();
            ((h * h + edge * edge).powf(1.5) - h.powi(3)) / 3.0 * PI / 3.0 / f64::from(steps)
        })
        .sum();
    let area = inner * inner * 3f64.sqrt() / 2.0;
    holds(&found.a_to_b.mean, 1.0 - integral / area, 1e-3);
    // The other way by brute force: in the first octant the octahedron is x + y + z = 1, and the closest point takes the
    // same from each coordinate that stays above 0.
    let brute = |k: u32| {
        let (band, sector) = (f64::from(k / 400), f64::from(k % 400));
        let (z, turn) = (1.0 - (band + 0.5) / 200.0, TAU * (sector + 0.5) / 1600.0);
        let flat = (1.0 - z * z).sqrt();
        let place = DVec3::new(flat * turn.cos(), flat * turn.sin(), z);
        let mut sorted = place.to_array();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let takes = (1..4).map(|n| (sorted[..n].iter().sum::<f64>() - 1.0) / n as f64);
        let take = takes.fold(f64::NEG_INFINITY, f64::max);
        place.distance((place - take).max(DVec3::ZERO))
    };
    holds(&found.b_to_a.mean, (0..80_000).map(brute).sum::<f64>() / 80_000.0, 1e-3);
}

#[test]
fn sizes_at_both_ends_of_the_numbers_have_their_distances() {
    for size in [1e-300, 1e-170, 1e-9, 1.0, 1e9, 1e150, 1e170, 1e300] {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * size);
        let bvh = TriangleBvh::build(&positions, &[[0, 1, 2]], &Exec::default()).unwrap();
        for weight in [1e-300, 1.0, 1e300] {
            let sample = |z: f64| Sample { position: DVec3::new(0.25, 0.25, z) * size, weight, radius: 0.0 };
            let found =
                distance_from_samples(&[sample(1.0), sample(3.0)][..], &bvh, &Exec::default()).unwrap().unwrap();
            for (estimate, wanted) in [(&found.mean, 2.0 * size), (&found.rms, 5f64.sqrt() * size)] {
                holds(estimate, wanted, 1e-14);
                assert!(estimate.upper - estimate.lower < 1e-12 * wanted && estimate.lower > 0.0, "{estimate:?}");
            }
            assert_eq!(found.largest_sampled, 3.0 * size);
        }
    }
}

/// What vanishes beside the rest does not make a bound false: one batch is huge and light, another tiny and heavy.
#[test]
fn samples_of_all_sizes_and_weights_have_true_bounds() {
    let origin = TriangleBvh::build(&[DVec3::ZERO], &[[0, 0, 0]], &Exec::default()).unwrap();
    let sample = |size: f64, weight: f64| Sample { position: DVec3::X * size, weight, radius: 0.0 };
    let of = |samples: &[Sample]| distance_from_samples(samples, &origin, &Exec::default()).unwrap().unwrap();
    for batch in [1, 300] {
        let mut samples = vec![sample(1e200, 1e-200); batch];
        samples.extend(vec![sample(1e-200, 1e200); batch]);
        let found = of(&samples);
        // (1e200 · 1e-200 + 1e-200 · 1e200) / 1e200, and (1e400 · 1e-200 + ...) / 1e200.
        assert!(found.mean.lower <= 2e-200 && 2e-200 <= found.mean.upper && found.mean.upper < 1e-100, "{found:?}");
        assert!(found.rms.lower <= 1.0 && 1.0 <= found.rms.upper, "{found:?}");
        assert_eq!(found.largest_sampled, 1e200);
    }
    // A batch without weights beside one with them.
    let mut samples = vec![sample(1e300, 0.0); 256];
    samples.push(sample(1e-300, 1.0));
    let found = of(&samples);
    assert!((found.mean.value / 1e-300 - 1.0).abs() < 1e-12, "{found:?}");
    samples.reverse();
    assert_eq!(of(&samples).mean.value, found.mean.value);
}

#[test]
fn wrong_samples_are_named() {
    let (positions, triangles) = ([DVec3::ZERO, DVec3::X, DVec3::Y], [[0, 1, 2]]);
    let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
    let good = Sample { position: DVec3::ONE, weight: 1.0, radius: 0.0 };
    let far = DVec3::new(0.0, f64::INFINITY, 0.0);
    for (wrong, name) in [
        (Sample { radius: f64::NAN, ..good }, "radius"),
        (Sample { radius: -1.0, ..good }, "radius"),
        (Sample { radius: f64::INFINITY, ..good }, "radius"),
        (Sample { weight: f64::NAN, ..good }, "weight"),
        (Sample { weight: -1.0, ..good }, "weight"),
        (Sample { weight: f64::INFINITY, ..good }, "weight"),
        (Sample { position: far, ..good }, "position"),
        (Sample { position: DVec3::NAN, ..good }, "position"),
    ] {
        for at in [0, 255, 256, 700] {
            let mut samples = vec![good; 701];
            samples[at] = wrong;
            let found = distance_from_samples(&samples, &bvh, &Exec::default()).unwrap_err();
            assert!(matches!(found, JudgeError::Sample { sample, name: n, .. } if sample == at as u64 && n == name));
            let words = found.to_string();
            assert!(words.contains(&format!("sample {at}: {name}: found ")), "{words}");
        }
    }
    // The ends of the numbers: a radius and a distance whose sum is none, and a distance that is none.
    let all = Sample { position: DVec3::X * f64::MAX, weight: f64::MAX, radius: f64::MAX };
    let found = distance_from_samples(&[all, all][..], &bvh, &Exec::default()).unwrap().unwrap();
    assert!(found.mean.lower == 0.0 && found.mean.upper == f64::INFINITY && found.mean.value > 1e308, "{found:?}");
    let end = [DVec3::X * -f64::MAX];
    let bvh = TriangleBvh::build(&end, &[[0, 0, 0]], &Exec::default()).unwrap();
    let found = distance_from_samples(&[all][..], &bvh, &Exec::default()).unwrap_err();
    assert!(matches!(found, JudgeError::Sample { sample: 0, name: "distance", .. }), "{found:?}");
    let nothing = TriangleBvh::build(&[], &[], &Exec::default()).unwrap();
    assert_eq!(distance_from_samples(&[good][..], &nothing, &Exec::default()), Ok(None));
    assert_eq!(distance_from_samples(&[Sample { weight: 0.0, ..good }][..], &bvh, &Exec::default()), Ok(None));
}

#[test]
fn cells_cover_their_shape() {
    let exec = Exec::default();
    let positions = [DVec3::ZERO, DVec3::new(3.0, 0.5, 0.0), DVec3::new(1.0, 2.0, 1.0), DVec3::new(9.0, 9.0, 9.0)];
    let triangles = [[0, 1, 2], [1, 1, 3], [3, 3, 3], [2, 1, 3]];
    for size in [1e-170, 1.0, 1e170] {
        let positions = positions.map(|p| p * size);
        let all = |triangles: &[[u32; 3]], count: u32| {
            let shape = Simplices::new(&positions[..], triangles);
            let cells = shape.cells(count, &exec).unwrap();
            let mut samples = vec![Sample::default(); cells.count()];
            cells.fill(0, &mut samples);
            // Asked for one by one they are the same.
            for (index, &sample) in samples.iter().enumerate() {
                let mut one = [Sample::default()];
                cells.fill(index, &mut one);
                assert_eq!(one[0], sample);
            }
            samples
        };
        let middle = |samples: &[Sample]| {
            let weight: f64 = samples.iter().map(|sample| sample.weight).sum();
            samples.iter().map(|sample| sample.position / size * (sample.weight / weight)).sum::<DVec3>()
        };
        for count in [1, 2, 50, 300] {
            for triangle in [[0, 1, 2], [2, 3, 1]] {
                let [a, b, c] = triangle.map(|corner: u32| positions[corner as usize] / size);
                let samples = all(&[triangle], count);
                assert!(samples.len() >= count as usize && samples.len() <= 4 * count as usize);
                assert!((middle(&samples) - (a + b + c) / 3.0).length() < 1e-12);
                // Every point is within the radius of some sample, and no radius is larger than it must be.
                for k in 0..100 {
                    let (u, v) = (f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0);
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    let place = a + (b - a) * u + (c - a) * v;
                    let reached = |sample: &Sample| place.distance(sample.position / size) <= sample.radius / size;
                    assert!(samples.iter().any(reached), "{place}");
                }
                let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
                let parts = (samples.len() as f64).sqrt();
                assert!(samples.iter().all(|sample| sample.radius / size <= longest / parts * 0.7));
            }
            // A segment, and points.
            let line = all(&[[1, 1, 3], [3, 3, 3]], count);
            assert!(line.len() == count as usize, "{count}: {}", line.len());
            assert!((middle(&line) - (positions[1] + positions[3]) / size / 2.0).length() < 1e-12);
        }
        // Two areas, one of them 10 times the other in cells: weights are in proportion to areas; lines have none.
        let samples = all(&triangles, 100);
        let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
        let areas = [triangles[0], triangles[3]].map(|t| area(t.map(|corner| positions[corner as usize] / size)));
        let near = |sample: &&Sample| sample.position.z / size <= 1.0 && sample.position.x / size < 3.0;
        let total: f64 = samples.iter().map(|sample| sample.weight).sum();
        let first: f64 = samples.iter().filter(near).map(|sample| sample.weight).sum();
        assert!(first / total < 1.0 && first / total >= areas[0] / (areas[0] + areas[1]) - 1e-12, "{first} {total}");
        let points = all(&[[2, 2, 2], [0, 0, 0]], 7);
        assert_eq!(points.iter().map(|point| point.position).collect::<Vec<_>>(), [positions[2], positions[0]]);
        assert!(points.iter().all(|point| point.weight == 1.0 && point.radius == 0.0));
    }
    assert_eq!(Simplices::points(vec![]).cells(9, &exec).unwrap().count(), 0);
}

/// A shape's cells give the means that its quadrature gives, and wrong shapes are named.
#[test]
fn cells_of_a_shape_agree_with_its_quadrature() {
    let exec = Exec::default();
    let positions = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 1.0), DVec3::new(0.0, 1.0, 1.0), DVec3::X * 40.0];
    let shape = Simplices::new(&positions[..], &[[0, 1, 2], [0, 2, 3]][..]);
    let plane = [DVec3::new(-9.0, -9.0, 0.0), DVec3::new(40.0, -9.0, 0.0), DVec3::new(-9.0, 40.0, 0.0)];
    let bvh = TriangleBvh::build(&plane, &[[0, 1, 2]], &exec).unwrap();
    let found = distance_from_samples(&shape.cells(5000, &exec).unwrap(), &bvh, &exec).unwrap().unwrap();
    holds(&found.mean, 0.5, 1e-12);
    holds(&found.rms, 1.0 / 3f64.sqrt(), 1e-3);
    assert!(found.mean.upper - found.mean.lower < 0.06, "{found:?}");
    let lost = Simplices::new(&positions[..], &[[0, 1, 2], [0, 9, 3]][..]);
    let found = lost.cells(5, &exec).unwrap_err();
    assert!(matches!(found, JudgeError::Bvh(BvhError::Index { triangle: 1, corner: 1, found: 9, .. })));
    let broken = [DVec3::ZERO, DVec3::NAN];
    let found = Simplices::segments(&broken[..], &[[0, 1]]).cells(5, &exec).unwrap_err();
    assert!(matches!(found, JudgeError::Bvh(BvhError::NotFinite { triangle: 0, position: 1, .. })));
    let small = exec.with_memory(10);
    assert!(matches!(shape.cells(5, &small), Err(JudgeError::OverBudget(_))));
}
