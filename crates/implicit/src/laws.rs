//! The laws of fields, run on trees that hold every kind of node.

use std::f64::consts::PI;
use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, AxisAngle, Field, Restricted};

use crate::*;

/// Numbers without an order that anyone would see, the same in each run.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    pub(crate) fn within(&mut self, lo: f64, hi: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        lo + (hi - lo) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub(crate) fn point(&mut self, reach: f64) -> DVec3 {
        DVec3::new(self.within(-reach, reach), self.within(-reach, reach), self.within(-reach, reach))
    }
}

struct Ramp;

impl Field for Ramp {
    fn value(&self, point: DVec3) -> f64 {
        point.x * point.y - point.z
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        DVec3::new(point.y, point.x, -1.0)
    }
}

/// A tree for every kind of node and every variant of its parameters.
pub(crate) fn samples() -> Vec<Tree> {
    let ball = || Tree::sphere(1.1).translate(0.3, -0.2, 0.1);
    let block = || Tree::cuboid(1.4, 1.0, 2.2);
    let turn = AxisAngle::new(DVec3::new(1.0, 2.0, -0.5), 0.8).unwrap();
    let mut trees = vec![
        Tree::constant(0.7),
        Tree::x(),
        Tree::z() * 3.0 + Tree::y() / 2.0 - 0.4,
        Tree::distance_to(DVec3::new(0.2, 0.3, -0.4)) - 0.8,
        Tree::x().power(3) - Tree::y().power(-2) * 0.01 + Tree::z().power(5),
        Tree::plane(DVec3::new(1.0, -2.0, 0.5), 0.3),
        Primitive::Sphere { center: DVec3::new(0.4, 0.1, 0.0), radius: 1.3 }.into(),
        block(),
        Tree::rounded_box(DVec3::new(1.5, 2.0, 1.1), 0.3),
        Tree::cylinder(0.8, 1.9),
        Tree::cone(1.2, 0.4, 1.7),
        Tree::cone(1.2, 0.0, 1.7),
        Tree::cone(0.0, 1.0, 1.5),
        Tree::capsule(DVec3::new(-0.8, 0.2, 0.0), DVec3::new(0.9, 0.5, 0.7), 0.4),
        Tree::capsule(DVec3::X, DVec3::X, 0.4),
        Tree::torus(1.2, 0.4),
        Tree::torus(0.5, 0.9),
        Primitive::QuarticTorus { major: 1.2, minor: 0.4 }.into(),
        Tree::prism(3, 1.1, 1.4),
        Tree::prism(6, 1.1, 1.4),
        Tree::circle(0.9),
        Tree::rectangle(1.2, 1.9),
        ball().complement(),
        ball().offset(0.2),
        ball().shell(0.3),
        ball().displace(Tree::x().unary(Unary::Sine) * 0.2),
        ball().union(block()),
        ball().intersection(block()),
        ball().difference(block()),
        Tree::union_of([ball(), block(), Tree::torus(1.4, 0.3)]),
        block().rotate(turn).scale(0.7),
        block().transform(Affine::from_scale(DVec3::new(1.0, 0.4, 2.0))),
        block().substitute(Tree::y(), Tree::z() * 0.5, Tree::x() + Tree::y().unary(Unary::Cosine)),
        ball().named("ball"),
        Tree::foreign("ramp", Arc::new(Ramp), false).rotate(turn).translate(0.1, 0.0, 0.2),
        Tree::foreign("ramp", Arc::new(Ramp), false).in_domain(Domain::Twist { rate: 0.4 }),
        Tree::circle(0.6).translate(0.1, 0.2, 0.0).extrude(1.4),
        Tree::rectangle(0.6, 0.9).revolve(1.0),
    ];
    for quadric in [
        Quadric::Ellipsoid(DVec3::new(1.0, 0.7, 1.3)),
        Quadric::EllipticCylinder([1.0, 0.6]),
        Quadric::Cone(DVec3::new(0.8, 0.9, 1.1)),
        Quadric::OneSheetHyperboloid(DVec3::new(0.5, 0.6, 0.7)),
        Quadric::TwoSheetHyperboloid(DVec3::new(0.5, 0.6, 0.7)),
        Quadric::EllipticParaboloid([0.8, 1.2]),
        Quadric::HyperbolicParaboloid([0.8, 1.2]),
        Quadric::General([1.0, -0.5, 0.3, 0.2, 0.1, -0.4, 0.3, 0.6, -0.2, -0.7]),
    ] {
        trees.push(quadric.into());
    }
    for set in SetOperation::ALL {
        for form in [
            BlendForm::RFunction { alpha: 1.0 },
            BlendForm::RFunction { alpha: 0.0 },
            BlendForm::RFunction { alpha: -0.7 },
            BlendForm::Displaced { alpha: 0.0, amount: 0.3, first: 0.5, second: 0.8 },
            BlendForm::Smooth { radius: 0.6 },
        ] {
            trees.push(ball().blend(block(), set, form));
        }
    }
    for domain in [
        Domain::Twist { rate: 0.7 },
        Domain::Bend { rate: 0.5 },
        Domain::Bend { rate: -0.5 },
        Domain::Taper { height: 1.5, factor: 0.4 },
        Domain::Repeat { spacing: DVec3::new(1.3, 0.0, 2.1), copies: None },
        Domain::Repeat { spacing: DVec3::new(1.3, 0.9, 2.1), copies: Some([1, 0, 2]) },
        Domain::Mirror { axis: Axis::Y },
        Domain::Elongate { size: DVec3::new(0.5, 0.0, 1.0) },
        Domain::Extrude { height: 1.1 },
        Domain::Revolve { offset: 0.3 },
    ] {
        trees.push(block().translate(0.2, 0.1, 0.0).in_domain(domain));
    }
    let mut numbers = Numbers::new(99);
    for form in BlobForm::ALL {
        for (count, radius) in [(5, 1.2), (300, 0.4)] {
            let blob = |i: u32| {
                let size = radius * (1.0 + 0.5 * f64::from(i % 3));
                let strength = if i % 5 == 4 { -0.6 } else { 1.0 };
                let [first, second] = match form {
                    BlobForm::Blinn => [strength, 4.0 / (size * size)],
                    BlobForm::Blobby => [size / 2.0, 1.5],
                    BlobForm::Metaballs | BlobForm::SoftObjects => [size, strength],
                };
                Blob::new(numbers.point(1.6), first, second)
            };
            trees.push(Tree::blobs(Blobs::try_new(form, 0.5, (0..count).map(blob).collect()).unwrap()));
        }
    }
    for operator in Unary::ALL {
        trees.push((Tree::x() * 0.3 + Tree::y() * Tree::z() * 0.2).unary(operator));
    }
    for operator in Binary::ALL {
        trees.push((Tree::x() + Tree::y() * Tree::z()).binary(operator, Tree::z() - Tree::x() * 0.7));
        trees.push((Tree::x() + Tree::y()).binary(operator, 0.6));
        trees.push(Tree::from(1.3).binary(operator, Tree::x() - Tree::y() * Tree::y()));
    }
    trees
}

fn compiled() -> Vec<(Tree, Program)> {
    samples().into_iter().map(|tree| (tree.clone(), tree.compile().unwrap())).collect()
}

fn near(a: f64, b: f64, tolerance: f64) -> bool {
    (a - b).abs() <= tolerance * (1.0 + a.abs().max(b.abs())) || (a.is_nan() && b.is_nan()) || a == b
}

#[test]
fn batches_agree_with_points() {
    let mut numbers = Numbers::new(1);
    for (tree, program) in compiled() {
        let points: Vec<DVec3> = (0..300).map(|_| numbers.point(2.0)).collect();
        let along = |axis: usize| points.iter().map(|point| point[axis] as f32).collect::<Vec<f32>>();
        let (x, y, z) = (along(0), along(1), along(2));
        let mut out = vec![0.0; 300];
        program.values(DVec3::ZERO, &x, &y, &z, &mut out);
        let mut wrong = 0;
        for i in 0..300 {
            let point = DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            wrong += usize::from(!near(f64::from(out[i]), program.value(point), 1e-4));
        }
        // Near a jump or a pole rounding may fall on the other side.
        assert!(wrong <= 3, "{tree:?} {wrong}");
    }
}

#[test]
fn batches_keep_precision_far_from_the_origin() {
    let far = DVec3::new(5e6, -3e6, 1e6);
    let tree = Tree::cone(1.2, 0.4, 1.7).union(Tree::torus(1.2, 0.4)).translate(far.x, far.y, far.z);
    let tree = tree.union(Tree::foreign("ramp", Arc::new(Ramp), false).translate(far.x, far.y, far.z));
    let program = tree.compile().unwrap();
    let mut numbers = Numbers::new(2);
    for _ in 0..200 {
        let p = numbers.point(2.0).as_vec3();
        let mut out = [0.0];
        program.values(far, &[p.x], &[p.y], &[p.z], &mut out);
        assert!((f64::from(out[0]) - program.value(far + p.as_dvec3())).abs() < 1e-6);
    }
}

#[test]
fn gradients_are_difference_quotients() {
    let mut numbers = Numbers::new(3);
    let step = 1e-6;
    for (tree, program) in compiled() {
        let mut wrong = 0;
        for _ in 0..200 {
            let p = numbers.point(2.0);
            let along = |axis: DVec3| {
                let (ahead, behind) = (program.value(p + axis * step), program.value(p - axis * step));
                (ahead - behind) / (2.0 * step)
            };
            let quotient = DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z));
            let gradient = program.gradient(p);
            let same = (quotient - gradient).length() <= 1e-4 * (1.0 + quotient.length());
            wrong += usize::from(quotient.is_finite() && !same);
        }
        // Some points lie within a step of a crease.
        assert!(wrong <= 2, "{tree:?}: {wrong} of 200");
    }
}

#[test]
fn ranges_hold_values() {
    let mut numbers = Numbers::new(4);
    for (tree, program) in compiled() {
        for round in 0..60 {
            let (a, size) = (numbers.point(2.0), 10.0_f64.powi(-(round % 4)));
            let region = Aabb::from_corners(a, a + numbers.point(size));
            let range = program.range(&region);
            for _ in 0..20 {
                let part = (numbers.point(0.5) + 0.5).to_array();
                let point = region.min + DVec3::from_array(part) * region.size();
                let point = point.clamp(region.min, region.max);
                let value = program.value(point);
                assert!(value.is_nan() || range.contains(value), "{tree:?} {region:?} {point} {value} {range:?}");
                assert!(!(value.is_nan() && range.hi < 0.0), "{tree:?} {region:?} {point}");
            }
        }
    }
}

#[test]
fn restrictions_agree_inside_their_box() {
    let mut numbers = Numbers::new(5);
    let (mut simpler, mut decided) = (0, 0);
    for (tree, program) in compiled() {
        for round in 0..60 {
            let (a, size) = (numbers.point(2.0), 10.0_f64.powi(-(round % 3)));
            let region = Aabb::from_corners(a, a + numbers.point(size));
            let restricted = program.restrict(&region);
            for _ in 0..10 {
                let part = DVec3::from_array((numbers.point(0.5) + 0.5).to_array());
                let point = (region.min + part * region.size()).clamp(region.min, region.max);
                let value = program.value(point);
                match &restricted {
                    Restricted::Positive => assert!(value > 0.0 || value.is_nan(), "{tree:?}"),
                    Restricted::Negative => assert!(value < 0.0, "{tree:?}"),
                    Restricted::Same => {}
                    Restricted::Simpler(field) => {
                        assert_eq!(field.value(point).to_bits(), value.to_bits(), "{tree:?} {point}");
                        let (p, mut of_whole, mut of_part) = (point.as_vec3(), [0.0], [0.0]);
                        program.values(DVec3::ZERO, &[p.x], &[p.y], &[p.z], &mut of_whole);
                        field.values(DVec3::ZERO, &[p.x], &[p.y], &[p.z], &mut of_part);
                        let close = near(f64::from(of_whole[0]), f64::from(of_part[0]), 1e-5);
                        assert!(close, "{tree:?} {of_whole:?} {of_part:?}");
                    }
                }
            }
            simpler += usize::from(matches!(restricted, Restricted::Simpler(_)));
            decided += usize::from(matches!(restricted, Restricted::Positive | Restricted::Negative));
        }
    }
    assert!(simpler > 100 && decided > 1000, "{simpler} {decided}");
}

#[test]
fn values_change_no_faster_than_stated() {
    let mut numbers = Numbers::new(6);
    let mut known = 0;
    for (tree, program) in compiled() {
        let Some(lipschitz) = program.lipschitz() else { continue };
        known += 1;
        for round in 0..400 {
            let a = numbers.point(2.0);
            let b = a + numbers.point(if round % 2 == 0 { 0.01 } else { 1.0 });
            let change = (program.value(a) - program.value(b)).abs();
            assert!(
                change <= lipschitz * a.distance(b) * (1.0 + 1e-9) + 1e-12,
                "{tree:?} {a} {b}: {change} {lipschitz}"
            );
        }
    }
    assert!(known > 40, "{known}");
}

/// Where values change at most as fast as the place, and the step along the gradient by the value ends on the surface, the value is the
/// distance.
#[test]
fn exact_distances_are_distances() {
    let mut numbers = Numbers::new(7);
    let mut known = 0;
    for (tree, program) in compiled().into_iter().filter(|(_, program)| program.nature().meaning() == Meaning::Exact) {
        known += 1;
        let mut off = 0;
        for _ in 0..300 {
            let p = numbers.point(2.5);
            let (value, gradient) = (program.value(p), program.gradient(p));
            let on_surface = program.value(p - gradient * value).abs() < 1e-9;
            off += usize::from((gradient.length() - 1.0).abs() > 1e-9 || !on_surface);
        }
        // Random points hardly ever lie on the medial axis.
        assert_eq!(off, 0, "{tree:?}");
    }
    assert!(known >= 16, "{known}");
}

#[test]
fn measures_are_the_closed_forms() {
    let volumes = [
        (Tree::sphere(1.1), 4.0 / 3.0 * PI * 1.1_f64.powi(3)),
        (Tree::cuboid(1.4, 1.0, 2.2), 1.4 * 2.2),
        (Tree::cylinder(0.8, 1.9), PI * 0.64 * 1.9),
        (Tree::cone(1.2, 0.4, 1.7), PI * 1.7 / 3.0 * (1.44 + 0.48 + 0.16)),
        (Tree::torus(1.2, 0.4), 2.0 * PI * PI * 1.2 * 0.16),
        (Primitive::QuarticTorus { major: 1.2, minor: 0.4 }.into(), 2.0 * PI * PI * 1.2 * 0.16),
        (Tree::capsule(DVec3::ZERO, DVec3::X, 0.4), PI * 0.16 + 4.0 / 3.0 * PI * 0.064),
        (Tree::prism(6, 1.1, 1.4), 1.5 * 3.0_f64.sqrt() * 1.21 * 1.4),
        (Tree::prism(3, 1.1, 1.4), 0.75 * 3.0_f64.sqrt() * 1.21 * 1.4),
        (Quadric::Ellipsoid(DVec3::new(1.0, 0.7, 1.3)).into(), 4.0 / 3.0 * PI * 0.91),
        (Tree::rounded_box(DVec3::splat(2.0), 1.0), 4.0 / 3.0 * PI),
        (Tree::rectangle(0.4, 0.6).revolve(1.0), 2.0 * PI * 0.24),
        (Tree::cuboid(1.0, 1.0, 1.0).transform(Affine::from_scale(DVec3::new(1.0, 0.4, 2.0))), 0.8),
        (Tree::sphere(0.5).in_domain(Domain::Elongate { size: DVec3::new(1.0, 0.0, 0.0) }), PI / 6.0 + PI / 4.0),
        (Tree::cuboid(0.5, 0.5, 2.0).in_domain(Domain::Twist { rate: 2.0 }), 0.5),
        // Cells across a bent bar keep their volume on the middle line: the ring's mean radius counts.
        (Tree::cuboid(2.0, 0.4, 0.6).in_domain(Domain::Bend { rate: 0.5 }), 0.48),
        (
            Tree::cuboid(0.4, 0.4, 0.4)
                .in_domain(Domain::Repeat { spacing: DVec3::new(0.7, 0.0, 0.9), copies: Some([1, 1, 1]) }),
            9.0 * 0.064,
        ),
        (
            Tree::cuboid(1.0, 1.0, 3.0).translate(0.0, 0.0, 0.75).in_domain(Domain::Taper { height: 1.5, factor: 0.5 }),
            // Below 0 a prism, then a truncated pyramid, then a thinner prism.
            0.75 + 1.5 / 3.0 * (1.0 + 0.5 + 0.25) + 0.75 * 0.25,
        ),
    ];
    for (tree, expected) in volumes {
        let program = tree.compile().unwrap();
        // Faces along the axes then lie between the samples.
        let size = 0.05;
        let (cells, reach) = (88, 2.2);
        let row: Vec<f32> = (0..cells).map(|i| ((f64::from(i) + 0.5) * size - reach) as f32).collect();
        let mut inside = 0;
        let mut out = vec![0.0; row.len()];
        for z in &row {
            for y in &row {
                program.values(DVec3::ZERO, &row, &vec![*y; row.len()], &vec![*z; row.len()], &mut out);
                inside += out.iter().filter(|value| **value < 0.0).count();
            }
        }
        let volume = inside as f64 * size.powi(3);
        assert!((volume - expected).abs() < 0.04 * expected.max(0.3), "{tree:?}: {volume}, expected {expected}");
    }
}

/// The zero set of an R-function is that of the minimum or maximum for every α.
#[test]
fn r_functions_keep_the_sets_sign() {
    let mut numbers = Numbers::new(8);
    for alpha in [-0.99, -0.5, 0.0, 0.5, 0.999, 1.0] {
        let form = BlendForm::RFunction { alpha };
        let [union, intersection, difference] =
            SetOperation::ALL.map(|set| Tree::x().blend(Tree::y(), set, form).compile().unwrap());
        for _ in 0..500 {
            let p = numbers.point(3.0);
            let same = |program: &Program, sharp: f64| assert_eq!(program.value(p) < 0.0, sharp < 0.0, "{alpha} {p}");
            same(&union, p.x.min(p.y));
            same(&intersection, p.x.max(p.y));
            same(&difference, p.x.max(-p.y));
        }
    }
}

#[test]
fn displaced_blends_take_the_stated_amount_off() {
    let form = |amount| BlendForm::Displaced { alpha: 0.3, amount, first: 0.5, second: 0.8 };
    let value = |tree: Tree, p: DVec3| tree.compile().unwrap().value(p);
    for (set, p) in
        [(SetOperation::Union, DVec3::new(0.4, -0.3, 0.0)), (SetOperation::Intersection, DVec3::new(0.1, 0.9, 0.0))]
    {
        let plain = value(Tree::x().blend(Tree::y(), set, BlendForm::RFunction { alpha: 0.3 }), p);
        let blended = value(Tree::x().blend(Tree::y(), set, form(0.7)), p);
        let expected = 0.7 / (1.0 + (p.x / 0.5).powi(2) + (p.y / 0.8).powi(2));
        assert!((plain - blended - expected).abs() < 1e-12);
    }
}

#[test]
fn deep_trees_need_no_stack() {
    let run = || {
        let mut tree = Tree::sphere(1.0);
        let mut formula = Tree::x();
        for i in 0..100_000 {
            tree = if i % 2 == 0 { tree.union(Tree::sphere(0.5)) } else { tree.translate(1e-6, 0.0, 0.0) };
            formula = formula + Tree::y().unary(Unary::Sine);
        }
        let again = tree.clone().complement().complement();
        assert!(again != tree && tree == tree.clone());
        let program = tree.compile().unwrap();
        assert!((program.value(DVec3::new(2.05, 0.0, 0.0)) - 1.0).abs() < 1e-9);
        assert!((formula.compile().unwrap().value(DVec3::Y) - 1e5 * 1.0_f64.sin()).abs() < 1e-3);
        assert!(format!("{tree:?}").contains("nodes"));
    };
    std::thread::Builder::new().stack_size(128 << 10).spawn(run).unwrap().join().unwrap();
}

#[test]
fn shared_parts_do_not_multiply() {
    let mut tree = Tree::x() * Tree::y() + Tree::z();
    for _ in 0..60 {
        tree = tree.clone() + tree;
    }
    let program = tree.compile().unwrap();
    assert!(program.len() < 80, "{program:?}");
    assert!(tree == tree.clone() + 0.0 || tree.node_count() < 70);
    let mut doubling = Tree::sphere(1.0);
    for _ in 0..60 {
        doubling = doubling.clone().union(doubling.translate(0.1, 0.0, 0.0));
    }
    // 61 different places: shared ones stay shared.
    assert!(doubling.compile().unwrap().len() < 60_000);
    let mut bent = Tree::sphere(1.0);
    for i in 0..40 {
        let rate = 0.1 + f64::from(i) * 0.01;
        bent = bent.clone().union(bent.in_domain(Domain::Twist { rate }));
    }
    assert!(matches!(bent.compile(), Err(CompileError::TooLarge { .. })));
}

#[test]
fn bad_parameters_are_named() {
    let message = |tree: Tree| tree.compile().unwrap_err().to_string();
    assert_eq!(
        message(Tree::sphere(-1.0).named("head")),
        "part head: sphere: found radius -1, expected a finite number above 0"
    );
    assert_eq!(message(Tree::union_of([])), "union: found no parts, expected at least one");
    assert_eq!(
        message(Tree::x().blend(Tree::y(), SetOperation::Union, BlendForm::RFunction { alpha: -1.0 })),
        "r_union: found alpha -1, expected a number above -1 and at most 1"
    );
    for tree in [
        Tree::sphere(f64::NAN),
        Tree::sphere(f64::INFINITY),
        Tree::plane(DVec3::ZERO, 1.0),
        Tree::prism(2, 1.0, 1.0),
        Tree::rounded_box(DVec3::ONE, 0.6),
        Tree::cone(0.0, 0.0, 1.0),
        Tree::sphere(1.0).scale(0.0),
        Tree::sphere(1.0).translate(f64::NAN, 0.0, 0.0),
        Tree::sphere(1.0).offset(f64::NAN),
        Tree::circle(1.0).extrude(0.0),
        Tree::sphere(1.0).shell(-1.0),
        Tree::from(Quadric::General([f64::INFINITY; 10])),
    ] {
        assert!(matches!(tree.compile(), Err(CompileError::Parameter(_))), "{tree:?}");
    }
}

#[test]
fn fields_that_are_not_numbers_are_outside() {
    let tree = Tree::x().square_root() - 1e9;
    let program = tree.compile().unwrap();
    let region = Aabb::from_corners(DVec3::splat(-2.0), DVec3::splat(-1.0));
    assert!(program.value(DVec3::splat(-1.5)).is_nan());
    assert!(!matches!(program.restrict(&region), Restricted::Negative));
    // Of a union the part that is defined remains.
    let program = tree.union(Tree::sphere(3.0)).compile().unwrap();
    assert!(program.value(DVec3::splat(-1.0)) < 0.0);
}
