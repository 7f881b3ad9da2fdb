//! What is written reads back to the same tree.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Aabb, Affine, AxisAngle};

use super::*;
use crate::laws::{Numbers, samples};

fn assert_comes_back(tree: &Tree) {
    let text = to_text(tree, None);
    let again = match parse(text.as_bytes(), Some(&Ramps)) {
        Ok(parsed) => parsed.tree,
        Err(error) => panic!("{error}\n{text}"),
    };
    assert!(again == *tree, "{tree:?} {again:?}\n{text}");
    assert_eq!(to_text(&again, None), text);
}

#[test]
fn every_kind_of_node_comes_back() {
    for tree in samples() {
        assert_comes_back(&tree);
    }
}

#[test]
fn constants_and_powers_are_not_computed_when_written() {
    let two = || Tree::constant(2.0);
    let mut trees = vec![
        two().power(3),
        two().power(-3),
        Tree::constant(-2.0).power(2),
        Tree::x().power(2).power(3).power(i32::MIN),
        (-Tree::x()).power(2),
        -(Tree::x().power(2)),
        -(-two()),
        two().complement().complement(),
        Tree::x().binary(Binary::Power, 2.0),
        two().binary(Binary::Power, Tree::x()),
        two().named("two"),
        two().named("two") + 1.0,
        two().offset(0.5).named("x").named("").named("a b\"\\\n\t\r\u{1F600}").named("_x").named("pi"),
        Tree::x().named("a") + Tree::y().named("a"),
        Tree::x().named("bounds").translate(1.0, 2.0, 3.0),
        two().union(Tree::constant(3.0)),
        Tree::foreign("two words", Arc::new(Ramp), false),
        Tree::foreign("ramp(\"a\\\\b\", height: -2, top: 1e-9)", Arc::new(Ramp), false),
        Tree::foreign("ramp(\"a\",  height: 2)", Arc::new(Ramp), false),
        Tree::foreign("sphere(\"a\")", Arc::new(Ramp), false),
        Tree::foreign("foreign(\"a\")", Arc::new(Ramp), false),
        Tree::foreign("", Arc::new(Ramp), false),
    ];
    for value in [0.0, -0.0, 1e300, -5e-324, f64::MAX, 0.1 + 0.2, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e16] {
        let number = || Tree::constant(value);
        trees.extend([
            number(),
            -number(),
            Tree::x() / number(),
            number() - number(),
            number().power(2),
            number().displace(number()),
            number().binary(Binary::Minimum, number()),
        ]);
        if value.is_finite() {
            trees.push(number().offset(value));
        }
    }
    for tree in trees {
        assert_comes_back(&tree);
    }
    let sign = read("-0").operation().clone();
    assert!(matches!(sign, Operation::Constant(value) if value.to_bits() == (-0.0_f64).to_bits()));
}

/// A tree of random nodes over a pool, so that parts are shared.
fn random(numbers: &mut Numbers, size: usize) -> Tree {
    let solids = samples();
    let mut pool = vec![Tree::x(), Tree::y(), Tree::z(), Tree::sphere(1.0)];
    for _ in 0..size {
        let mut pick = |from: &[Tree]| from[numbers.within(0.0, from.len() as f64) as usize].clone();
        // The last ones most often, so that trees get deep.
        let recent = pool.len().saturating_sub(3);
        let (a, b, c, solid) = (pick(&pool[recent..]), pick(&pool), pick(&pool), pick(&solids));
        let value = numbers.within(-2.0, 2.0);
        let value = if value > 1.0 { value.round() } else { value };
        let operator = Binary::ALL[numbers.within(0.0, 12.0) as usize];
        let set = SetOperation::ALL[numbers.within(0.0, 3.0) as usize];
        let tree = match numbers.within(0.0, 20.0) as u32 {
            0 | 1 => a.binary(operator, b),
            2 => b.binary(operator, value),
            3 => Tree::constant(value).binary(operator, a),
            4 => a.unary(Unary::ALL[numbers.within(0.0, 17.0) as usize]),
            5 => a.power((value * 5.0) as i32),
            6 => Tree::new(Operation::Set(set, vec![a, b])),
            7 => Tree::new(Operation::Set(set, vec![b, a, c])),
            8 => Tree::new(Operation::Set(set, vec![a])),
            9 => a.complement(),
            10 => a.offset(value),
            11 => a.shell(value.abs() + 0.1),
            12 => a.displace(b),
            13 => a.translate(value, 0.0, 1.0),
            14 => a.rotate(AxisAngle::new(DVec3::new(1.0, value, 0.5), value).unwrap()),
            15 => a.substitute(b, c, value),
            16 => {
                let names = ["left", "right", "x", "wheel 2", "_hidden", "part_7"];
                a.named(names[numbers.within(0.0, 6.0) as usize])
            }
            17 => a.blend(b, set, BlendForm::Smooth { radius: value.abs() + 0.1 }),
            18 => a.scale(value.abs() + 0.5),
            _ => a.union(solid),
        };
        pool.push(tree);
    }
    pool.pop().unwrap()
}

#[test]
fn random_trees_come_back() {
    let mut numbers = Numbers::new(11);
    let mut shared = 0;
    for round in 0..500 {
        let tree = random(&mut numbers, 1 + round / 8);
        shared += usize::from(to_text(&tree, None).contains("_1 = "));
        assert_comes_back(&tree);
    }
    assert!(shared > 100, "{shared}");
}

#[test]
fn sharing_stays_and_lines_stay_short() {
    let mut tree = Tree::sphere(1.0);
    for i in 0..60 {
        tree = tree.clone().union(tree.translate(f64::from(i), 0.0, 0.0));
    }
    let text = to_text(&tree, None);
    assert!(text.lines().count() == 61 && read(&text) == tree, "{text}");
    assert_eq!(read(&text).node_count(), tree.node_count());
    let mut sum = Tree::x();
    for i in 0..10_000 {
        sum = if i % 2 == 0 { sum + Tree::y() } else { 3.0 / sum };
    }
    let text = to_text(&sum, None);
    assert!(text.lines().all(|line| line.len() < 250) && read(&text) == sum);
}

#[test]
fn maps_are_written_as_what_they_are() {
    let turn = AxisAngle::new(DVec3::Z, 0.3).unwrap();
    let ball = || Tree::sphere(1.0);
    for (map, expected) in [
        (Affine::from_translation(DVec3::new(1.0, -2.0, 0.0)), "sphere(1).move(1, -2, 0)\n"),
        (Affine::from_scale(DVec3::splat(2.0)), "sphere(1).scale(2)\n"),
        (Affine::from_scale(DVec3::new(2.0, 1.0, -1.0)), "sphere(1).scale(2, 1, -1)\n"),
        (Affine::IDENTITY, "sphere(1).move(0, 0, 0)\n"),
    ] {
        assert_eq!(to_text(&ball().transform(map), None), expected);
    }
    let shear = DMat3::from_cols_array(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0]);
    let map = Affine { linear: shear, translation: DVec3::new(11.0, 12.0, 13.0) };
    assert_eq!(to_text(&ball().transform(map), None), "sphere(1).matrix(1, 4, 7, 11, 2, 5, 8, 12, 3, 6, 10, 13)\n");
    assert_comes_back(&ball().transform(map));
    assert_comes_back(&ball().rotate(turn));
}

#[test]
fn bounds_come_back() {
    let bounds = Aabb::from_corners(DVec3::new(-1.0, -2.5, 0.0), DVec3::new(1.0, 1e20, 0.0));
    let text = to_text(&Tree::sphere(1.0).named("ball"), Some(&bounds));
    assert_eq!(text, "bounds(-1, -2.5, 0, 1, 1e20, 0);\nball = sphere(1);\nball\n");
    let parsed = parse(text.as_bytes(), None).unwrap();
    assert!(parsed.bounds == Some(bounds) && parsed.tree == Tree::sphere(1.0).named("ball"));
}
