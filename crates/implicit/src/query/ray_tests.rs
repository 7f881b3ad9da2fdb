//! Rays held against closed forms, Sturm chains and dense samples.

use super::*;
use crate::laws::Numbers;
use crate::query::{FieldRays, SphereTracing, TraceEnd};
use crate::{Primitive, Program, Quadric, Tree};
use shapeloom_core::{CancelFlag, Rays, Stop};

const FINE: f64 = 1e-7;

fn ray(origin: DVec3, direction: DVec3, to: f64) -> Ray {
    Ray::new(origin, direction).unwrap().within(Interval::new(0.0, to))
}

fn all(program: &Program, ray: &Ray) -> RayCrossings {
    RayIntervals::new(FINE).intersect(program, ray, &Exec::default()).unwrap()
}

/// Distances at which a ray meets a ball of radius 1 about the origin.
fn ball_roots(ray: &Ray) -> Vec<f64> {
    let along = -ray.origin().dot(ray.direction());
    let inside = 1.0 - (ray.origin() + ray.direction() * along).length_squared();
    if inside < 0.0 {
        return Vec::new();
    }
    [along - inside.sqrt(), along + inside.sqrt()].into_iter().filter(|t| *t > 0.0).collect()
}

fn same(found: &RayCrossings, expected: &[f64], room: f64) {
    let places: Vec<f64> = found.changes().map(|crossing| crossing.distance).collect();
    assert!(found.complete);
    assert_eq!(places.len(), expected.len(), "{places:?} {expected:?}");
    for (place, truth) in places.iter().zip(expected) {
        assert!((place - truth).abs() <= room, "{place} {truth}");
    }
}

#[test]
fn balls_are_met_where_the_closed_form_says() {
    let forms: [Tree; 3] = [Tree::sphere(1.0), Quadric::Ellipsoid(DVec3::ONE).into(), Tree::sphere(1.0).power(3)];
    let mut numbers = Numbers::new(21);
    for program in forms.map(|tree| tree.compile().unwrap()) {
        for _ in 0..150 {
            let origin = numbers.point(2.5);
            let ray = ray(origin, numbers.point(1.0) - origin * 0.3, 9.0);
            let expected = ball_roots(&ray);
            if expected.len() == 2 && expected[1] - expected[0] < 1e-3 {
                continue;
            }
            let found = all(&program, &ray);
            same(&found, &expected, 1e-9);
            for crossing in found.changes() {
                assert!(crossing.interval.contains(crossing.distance));
                // The cube has no slope at its zeros.
                if crossing.normal == DVec3::ZERO {
                    continue;
                }
                assert!((crossing.normal - crossing.point.normalize()).length() < 1e-6);
                let entering = crossing.normal.dot(ray.direction()) < 0.0;
                assert_eq!(crossing.kind() == CrossingKind::Entering, entering);
                assert_eq!(crossing.certainty, Certainty::Proven);
            }
        }
    }
}

/// How many roots a polynomial has in (a, b], by its Sturm chain.
fn sturm(polynomial: &[f64], a: f64, b: f64) -> usize {
    let mut chain: Vec<Vec<f64>> = vec![polynomial.to_vec()];
    chain.push(polynomial.iter().enumerate().skip(1).map(|(i, c)| c * i as f64).collect());
    while chain.last().unwrap().len() > 1 {
        let divisor = chain[chain.len() - 1].clone();
        let mut rest = chain[chain.len() - 2].clone();
        while rest.len() >= divisor.len() {
            let factor = rest[rest.len() - 1] / divisor[divisor.len() - 1];
            let shift = rest.len() - divisor.len();
            for (i, c) in divisor.iter().enumerate() {
                rest[shift + i] -= factor * c;
            }
            rest.pop();
        }
        chain.push(rest.into_iter().map(|c| -c).collect());
    }
    let changes = |x: f64| {
        let values = chain.iter().map(|p| p.iter().rev().fold(0.0, |sum, c| sum * x + c)).filter(|v| *v != 0.0);
        let signs: Vec<bool> = values.map(|v| v > 0.0).collect();
        signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
    };
    changes(a) - changes(b)
}

/// The quartic (t² + 2bt + c + R² - r²)² - 4R²(x² + y²) along a ray.
fn torus_quartic(ray: &Ray, major: f64, minor: f64) -> Vec<f64> {
    let (o, d) = (ray.origin(), ray.direction());
    let (b, c) = (2.0 * o.dot(d), o.length_squared() + major * major - minor * minor);
    let flat = [o.x * o.x + o.y * o.y, 2.0 * (o.x * d.x + o.y * d.y), d.x * d.x + d.y * d.y];
    let whole = 4.0 * major * major;
    vec![c * c - whole * flat[0], 2.0 * b * c - whole * flat[1], b * b + 2.0 * c - whole * flat[2], 2.0 * b, 1.0]
}

#[test]
fn tori_have_the_roots_that_sturm_counts() {
    let (major, minor) = (2.0, 0.7);
    let forms = [Tree::torus(major, minor), Primitive::QuarticTorus { major, minor }.into()];
    let mut numbers = Numbers::new(22);
    let mut four = 0;
    for program in forms.map(|tree| tree.compile().unwrap()) {
        for _ in 0..150 {
            let origin = numbers.point(3.0);
            let ray = ray(origin, numbers.point(1.5) * DVec3::new(1.0, 1.0, 0.3) - origin, 12.0);
            let quartic = torus_quartic(&ray, major, minor);
            let found = all(&program, &ray);
            let places: Vec<&RayCrossing> = found.changes().collect();
            if places.windows(2).any(|pair| pair[1].distance - pair[0].distance < 1e-3)
                || found.crossings.len() > places.len()
            {
                continue;
            }
            assert_eq!(places.len(), sturm(&quartic, 0.0, 12.0), "{ray:?}");
            four += usize::from(places.len() == 4);
            for crossing in places {
                let value = quartic.iter().rev().fold(0.0, |sum, c| sum * crossing.distance + c);
                assert!(value.abs() < 1e-9, "{value}");
            }
        }
    }
    assert!(four > 10, "{four}");
}

fn random_solid(numbers: &mut Numbers) -> Tree {
    let mut tree = Tree::sphere(1.0);
    for _ in 0..6 {
        let at = numbers.point(1.0);
        let part = match (numbers.within(0.0, 4.0)) as u32 {
            0 => Tree::sphere(numbers.within(0.3, 0.9)),
            1 => Tree::cuboid(numbers.within(0.3, 1.5), numbers.within(0.3, 1.5), 0.8),
            2 => Tree::cylinder(numbers.within(0.2, 0.6), 1.7),
            _ => Tree::torus(0.8, 0.25),
        };
        let part = part.translate(at.x, at.y, at.z);
        tree = match numbers.within(0.0, 3.0) as u32 {
            0 => tree.union(part),
            1 => tree.difference(part),
            _ => tree.smooth_union(part, 0.2),
        };
    }
    tree
}

#[test]
fn random_solids_change_sides_where_dense_samples_do() {
    let mut numbers = Numbers::new(23);
    let mut crossings = 0;
    for _ in 0..25 {
        let program = random_solid(&mut numbers).compile().unwrap();
        for _ in 0..12 {
            let origin = numbers.point(2.0);
            let ray = ray(origin, numbers.point(0.8) - origin, 5.0);
            let found = all(&program, &ray);
            assert!(found.complete);
            let samples = 4000;
            for i in 0..=samples {
                let t = 5.0 * f64::from(i) / f64::from(samples);
                if found.crossings.iter().any(|crossing| crossing.interval.contains(t)) {
                    continue;
                }
                // The side that the crossings before it leave behind.
                let first = found.crossings.first().and_then(|crossing| crossing.before);
                let last = found.crossings.iter().rev().find(|crossing| crossing.interval.hi <= t);
                let side = last.map_or(first, |crossing| crossing.after);
                let truth = Side::of(program.value(ray.at(t)));
                assert!(side.is_none_or(|side| side == truth), "{t} {found:?}");
            }
            crossings += found.changes().count();
            let first = RayIntervals::new(FINE).first_change(&program, &ray, &Exec::default()).unwrap();
            assert_eq!(first, found.changes().next().copied());
        }
    }
    assert!(crossings > 200, "{crossings}");
}

#[test]
fn rays_that_graze_are_told_as_unresolved() {
    let forms = [Tree::sphere(1.0), Quadric::Ellipsoid(DVec3::ONE).into()];
    for program in forms.map(|tree| tree.compile().unwrap()) {
        let touching = all(&program, &ray(DVec3::new(-3.0, 1.0, 0.0), DVec3::X, 6.0));
        let [only] = touching.crossings.as_slice() else { panic!("{touching:?}") };
        assert_eq!(only.kind(), CrossingKind::Unresolved);
        assert!(only.interval.contains(3.0) && only.interval.length() < 0.01, "{only:?}");
        assert!((only.distance - 3.0).abs() < 1e-3, "{only:?}");
        // A little farther out it misses, a little farther in it passes twice.
        let missing = all(&program, &ray(DVec3::new(-3.0, 1.0 + 1e-6, 0.0), DVec3::X, 6.0));
        assert_eq!(missing.changes().count(), 0);
        let depth = 1e-8_f64;
        let twice = all(&program, &ray(DVec3::new(-3.0, 1.0 - depth, 0.0), DVec3::X, 6.0));
        let half = (2.0 * depth).sqrt();
        same(&twice, &[3.0 - half, 3.0 + half], 1e-7);
    }
    // Two roots 2e-4 apart where bounds decide nothing over a stretch many times as long: samples tell them apart.
    let close = (Tree::x().power(3) - Tree::x() * 3.0 + (2.0 - 3e-8)).compile().unwrap();
    let found = RayIntervals::new(1e-6).intersect(&close, &ray(DVec3::ZERO, DVec3::X, 2.0), &Exec::default()).unwrap();
    assert!(found.crossings.iter().any(|crossing| crossing.interval.length() > 1e-4), "{found:?}");
    same(&found, &[1.0 - 1e-4, 1.0 + 1e-4], 1e-8);
    // Along a face: one interval, not a million pieces.
    let block = Tree::cuboid(2.0, 2.0, 2.0).compile().unwrap();
    let along = all(&block, &ray(DVec3::new(-3.0, 1.0, 0.0), DVec3::X, 6.0));
    assert!(along.complete && along.steps < 50_000, "{}", along.steps);
    for t in [2.0, 2.5, 4.0] {
        assert!(along.crossings.iter().any(|crossing| crossing.interval.contains(t)));
    }
    // Through an edge of a box, and through a corner.
    let edge = all(&block, &ray(DVec3::new(-2.0, 2.0, 0.0), DVec3::new(-1.0, -1.0, 0.0) * -1.0, 6.0));
    assert_eq!(edge.changes().count(), 0);
    let corner = all(&block, &ray(DVec3::splat(-2.0), DVec3::ONE, 9.0));
    same(&corner, &[3.0_f64.sqrt(), 3.0 * 3.0_f64.sqrt()], 1e-9);
}

#[test]
fn rays_may_start_inside_or_on_the_surface() {
    let program = Tree::sphere(1.0).compile().unwrap();
    same(&all(&program, &ray(DVec3::ZERO, DVec3::Y, 5.0)), &[1.0], 1e-12);
    for (direction, after, rest) in [(DVec3::X, Side::Outside, 0), (DVec3::NEG_X, Side::Inside, 1)] {
        let found = all(&program, &ray(DVec3::X, direction, 5.0));
        assert_eq!((found.crossings[0].before, found.crossings[0].after), (None, Some(after)));
        assert_eq!(found.crossings[0].interval.lo, 0.0);
        assert_eq!(found.changes().count(), rest);
    }
}

#[test]
fn scales_far_places_and_limits() {
    for scale in [1e-9, 1e9, 1e100] {
        let program = Tree::sphere(scale).compile().unwrap();
        let ray = ray(DVec3::new(-2.0, 0.6, 0.0) * scale, DVec3::X, 5.0 * scale);
        let found = RayIntervals::new(scale * 1e-9).intersect(&program, &ray, &Exec::default()).unwrap();
        same(&found, &[1.2 * scale, 2.8 * scale], 1e-12 * scale);
    }
    let far = DVec3::new(5e6, -3e6, 1e6);
    let program = Tree::sphere(1.0).translate(far.x, far.y, far.z).compile().unwrap();
    same(&all(&program, &ray(far - DVec3::X * 3.0, DVec3::X, 6.0)), &[2.0, 4.0], 1e-8);

    let whole = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
    let refused = |tolerance: f64, ray: &Ray| RayIntervals::new(tolerance).intersect(&program, ray, &Exec::default());
    assert!(matches!(refused(0.1, &whole), Err(QueryError::Reach { .. })));
    assert!(matches!(refused(0.1, &whole.within(Interval::new(f64::NAN, 1.0))), Err(QueryError::Reach { .. })));
    assert!(matches!(refused(0.0, &whole), Err(QueryError::Option(_))));
    assert!(Ray::new(DVec3::NAN, DVec3::X).is_err());
    let flag = CancelFlag::default();
    flag.cancel();
    let stopped = RayIntervals::new(0.1).intersect(
        &program,
        &ray(DVec3::ZERO, DVec3::X, 1.0),
        &Exec::default().with_cancel(&flag),
    );
    assert_eq!(stopped, Err(QueryError::Stop(Stop::Cancelled)));

    let hard = (Tree::x() * 1e4).unary(crate::Unary::Sine).compile().unwrap();
    let limited = RayIntervals { max_steps: 500, ..RayIntervals::new(1e-9) };
    let found = limited.intersect(&hard, &ray(DVec3::X * -1.0, DVec3::X, 2.0), &Exec::default()).unwrap();
    assert!(!found.complete && found.crossings.last().unwrap().interval.hi == 2.0);
    let found = RayIntervals::new(1e-7).intersect(&hard, &ray(DVec3::X * 1e-5, DVec3::X, 0.1), &Exec::default());
    // Zeros at multiples of π / 10⁴.
    assert_eq!(found.unwrap().changes().count(), (0.10001 * 1e4 / std::f64::consts::PI) as usize);
}

#[test]
fn sphere_tracing_finds_the_first_of_all_crossings() {
    let mut numbers = Numbers::new(24);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..25 {
        let program = random_solid(&mut numbers).compile().unwrap();
        for _ in 0..12 {
            let origin = numbers.point(2.0);
            let ray = ray(origin, numbers.point(0.8) - origin, 5.0);
            let first = all(&program, &ray).changes().next().copied();
            let mut steps = [0; 2];
            for (round, over_relaxation) in [1.0, 1.4].into_iter().enumerate() {
                let tracing = SphereTracing { over_relaxation, ..SphereTracing::new(1e-6) };
                let traced = tracing.trace(&program, &ray, &Exec::default()).unwrap();
                steps[round] = traced.steps;
                match (traced.end, first) {
                    (TraceEnd::Hit(hit), Some(first)) => {
                        hits += 1;
                        assert!((hit.distance - first.distance).abs() < 1e-6, "{hit:?} {first:?}");
                        assert_eq!(hit.kind(), first.kind());
                    }
                    (TraceEnd::Miss, None) => misses += 1,
                    other => panic!("{ray:?} {other:?}"),
                }
            }
        }
    }
    assert!(hits > 100 && misses > 10, "{hits} {misses}");
}

#[test]
fn sphere_tracing_tells_grazing_ends_and_refusals() {
    let ball = Tree::sphere(1.0).compile().unwrap();
    let tracing = SphereTracing::new(1e-4);
    let trace = |y: f64| tracing.trace(&ball, &ray(DVec3::new(-3.0, y, 0.0), DVec3::X, 6.0), &Exec::default()).unwrap();
    let graze = trace(1.0 + 5e-5);
    assert_eq!(graze.end, TraceEnd::Miss);
    assert!(graze.grazes.len() == 1 && graze.grazes[0].contains(3.0), "{:?}", graze.grazes);
    let half = (1.0001_f64.powi(2) - 1.00005_f64.powi(2)).sqrt();
    assert!((graze.grazes[0].length() - 2.0 * half).abs() < 1e-3, "{:?} {half}", graze.grazes);
    assert!(trace(1.1).grazes.is_empty());
    let few = SphereTracing { max_steps: 3, ..tracing.clone() };
    let ended = few.trace(&ball, &ray(DVec3::new(-3.0, 1.001, 0.0), DVec3::X, 6.0), &Exec::default()).unwrap();
    assert!(ended.end == TraceEnd::OutOfSteps && ended.free > 1.0 && ended.free < 6.0, "{ended:?}");
    let quadric = Tree::from(Quadric::Ellipsoid(DVec3::ONE)).compile().unwrap();
    let refused = tracing.trace(&quadric, &ray(DVec3::ZERO, DVec3::X, 2.0), &Exec::default());
    assert_eq!(refused, Err(QueryError::Lipschitz));
    let from_surface = tracing.trace(&ball, &ray(DVec3::X, DVec3::X, 3.0), &Exec::default()).unwrap();
    assert_eq!(from_surface.end, TraceEnd::Miss);
    let into = tracing.trace(&ball, &ray(DVec3::ZERO, DVec3::X, 3.0), &Exec::default()).unwrap();
    assert!(matches!(into.end, TraceEnd::Hit(hit) if (hit.distance - 1.0).abs() < 1e-12));
}

#[test]
fn a_program_in_its_box_is_something_that_rays_meet() {
    let program = Tree::torus(2.0, 0.7).compile().unwrap();
    let bounds = Aabb::from_corners(DVec3::new(-2.8, -2.8, -0.8), DVec3::new(2.8, 2.8, 0.8));
    let rays = FieldRays::new(program, bounds, 1e-6).unwrap();
    let mut numbers = Numbers::new(25);
    let many: Vec<Ray> = (0..200)
        .map(|_| {
            let origin = numbers.point(6.0);
            Ray::new(origin, numbers.point(1.0) - origin * 0.4).unwrap()
        })
        .collect();
    let mut firsts = vec![None; many.len()];
    rays.first_hits(&many, &mut firsts, &Exec::default()).unwrap();
    let mut met = 0;
    for (ray, first) in many.iter().zip(firsts) {
        let mut hits = Vec::new();
        rays.all_hits(ray, &mut hits);
        assert_eq!(hits.first().copied(), first);
        assert_eq!(rays.any_hit(ray), first.is_some());
        let quartic = torus_quartic(ray, 2.0, 0.7);
        assert_eq!(hits.len(), sturm(&quartic, 0.0, 30.0), "{ray:?} {hits:?}");
        met += hits.len();
        assert!(hits.windows(2).all(|pair| pair[0].distance < pair[1].distance && pair[0].back != pair[1].back));
    }
    assert!(met > 100, "{met}");
    assert!(FieldRays::new(Tree::sphere(1.0).compile().unwrap(), Aabb::EMPTY, 1e-6).is_err());
}
