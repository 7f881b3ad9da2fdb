//! Text means the tree that methods build.

use shapeloom_core::glam::{DMat3, DVec2, DVec3};
use shapeloom_core::{Aabb, Affine, AxisAngle};

use super::*;
use crate::laws::Numbers;

fn assert_means(text: &str, expected: impl Into<Tree>) {
    let expected = expected.into();
    let found = read(text);
    assert!(found == expected, "{text}\n{}{}", to_text(&found, None), to_text(&expected, None));
}

#[test]
fn primitives_are_those_of_the_methods() {
    let v = DVec3::new;
    assert_means("plane(1, -2, 0.5, 0.3)", Tree::plane(v(1.0, -2.0, 0.5), 0.3));
    assert_means("plane(0, 0, 1)", Tree::plane(v(0.0, 0.0, 1.0), 0.0));
    assert_means("sphere(1.5)", Tree::sphere(1.5));
    assert_means("sphere(1, 2, 3, 4)", Primitive::Sphere { center: v(2.0, 3.0, 4.0), radius: 1.0 });
    assert_means("sphere(1, y: 3)", Primitive::Sphere { center: v(0.0, 3.0, 0.0), radius: 1.0 });
    assert_means("box(1, 2, 3)", Tree::cuboid(1.0, 2.0, 3.0));
    assert_means("box(z: 3, x: 1, y: 2)", Tree::cuboid(1.0, 2.0, 3.0));
    assert_means("rounded_box(60, 40, 6, radius: 2)", Tree::rounded_box(v(60.0, 40.0, 6.0), 2.0));
    assert_means("cylinder(radius: 4, height: 10)", Tree::cylinder(4.0, 10.0));
    assert_means("cone(3, 1, 2)", Tree::cone(3.0, 1.0, 2.0));
    assert_means("capsule(1, 2, 3, 4, 5, 6, 7)", Tree::capsule(v(1.0, 2.0, 3.0), v(4.0, 5.0, 6.0), 7.0));
    assert_means("torus(3, 1)", Tree::torus(3.0, 1.0));
    assert_means("quartic_torus(3, 1)", Primitive::QuarticTorus { major: 3.0, minor: 1.0 });
    assert_means("prism(6, 2, 1)", Tree::prism(6, 2.0, 1.0));
    assert_means("circle(2)", Tree::circle(2.0));
    assert_means("rectangle(2, 3)", Primitive::Rectangle { size: DVec2::new(2.0, 3.0) });
    assert_means("ellipsoid(1, 2, 3)", Quadric::Ellipsoid(v(1.0, 2.0, 3.0)));
    assert_means("elliptic_cylinder(1, 2)", Quadric::EllipticCylinder([1.0, 2.0]));
    assert_means("elliptic_cone(1, 2, 3)", Quadric::Cone(v(1.0, 2.0, 3.0)));
    assert_means("hyperboloid(1, 2, 3)", Quadric::OneSheetHyperboloid(v(1.0, 2.0, 3.0)));
    assert_means("two_sheet_hyperboloid(1, 2, 3)", Quadric::TwoSheetHyperboloid(v(1.0, 2.0, 3.0)));
    assert_means("paraboloid(1, 2)", Quadric::EllipticParaboloid([1.0, 2.0]));
    assert_means("hyperbolic_paraboloid(1, 2)", Quadric::HyperbolicParaboloid([1.0, 2.0]));
    let ten = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0];
    assert_means("quadric(1, 2, 3, 4, 5, 6, 7, 8, 9, 10)", Quadric::General(ten));
    let mut some = [0.0; 10];
    (some[0], some[5], some[9]) = (1.0, -2.0, -1.0);
    assert_means("quadric(xx: 1, zx: -2, one: -1)", Quadric::General(some));
}

#[test]
fn operations_are_those_of_the_methods() {
    let a = || Tree::sphere(1.0);
    let b = || Tree::torus(3.0, 1.0);
    let means = |text: &str, tree: Tree| assert_means(&format!("_a = sphere(1); _b = torus(3, 1); {text}"), tree);
    means("union(_a, _b, x)", Tree::union_of([a(), b(), Tree::x()]));
    means("intersection(_a, _b)", a().intersection(b()));
    means("difference(_a, _b)", a().difference(b()));
    means("union(_a)", Tree::union_of([a()]));
    means("complement(_a)", a().complement());
    for set in SetOperation::ALL {
        let name = set.name();
        means(&format!("r_{name}(_a, _b, 0.5)"), a().blend(b(), set, BlendForm::RFunction { alpha: 0.5 }));
        let form = BlendForm::Displaced { alpha: 0.5, amount: 1.0, first: 2.0, second: 3.0 };
        means(&format!("_a.blend_{name}(_b, 0.5, amount: 1, first: 2, second: 3)"), a().blend(b(), set, form));
        means(&format!("smooth_{name}(_a, _b, radius: 0.5)"), a().blend(b(), set, BlendForm::Smooth { radius: 0.5 }));
    }
    means("_a.offset(-0.5)", a().offset(-0.5));
    means("shell(_a, 0.1)", a().shell(0.1));
    means("_a.displace(sin(x))", a().displace(Tree::x().unary(Unary::Sine)));
    means("_a.move(1, 2, 3)", a().translate(1.0, 2.0, 3.0));
    means("move(_a, 1, 2, z: 3)", a().translate(1.0, 2.0, 3.0));
    let turn = |axis: DVec3, angle: f64| AxisAngle::new(axis, angle).unwrap();
    means("_b.rotate_x(30 deg)", b().rotate(turn(DVec3::X, 30_f64.to_radians())));
    means("_b.rotate_y(-pi / 4)", b().rotate(turn(DVec3::Y, -std::f64::consts::FRAC_PI_4)));
    means("_b.rotate_z(1)", b().rotate(turn(DVec3::Z, 1.0)));
    means("rotate(_b, 1, 2, 3, angle: 0.5)", b().rotate(turn(DVec3::new(1.0, 2.0, 3.0), 0.5)));
    means("_a.scale(2)", a().scale(2.0));
    means("_a.scale(1, 2, 3)", a().transform(Affine::from_scale(DVec3::new(1.0, 2.0, 3.0))));
    // Rows are what is written, columns what is stored.
    let linear = DMat3 {
        x_axis: DVec3::new(1.0, 5.0, 9.0),
        y_axis: DVec3::new(2.0, 0.0, 10.0),
        z_axis: DVec3::new(3.0, 7.0, 11.0),
    };
    let map = Affine { linear, translation: DVec3::new(4.0, 8.0, 12.0) };
    assert_eq!(map.point(DVec3::X), DVec3::new(5.0, 13.0, 21.0));
    means("_a.matrix(1, 2, 3, 4, 5, 0, 7, 8, 9, 10, 11, 12)", a().transform(map));
    means("_a.twist(0.5)", a().in_domain(Domain::Twist { rate: 0.5 }));
    means("_a.bend(0.5)", a().in_domain(Domain::Bend { rate: 0.5 }));
    means("_a.taper(height: 2, factor: 0.5)", a().in_domain(Domain::Taper { height: 2.0, factor: 0.5 }));
    let spacing = DVec3::new(3.0, 0.0, 4.0);
    means("_a.repeat(3, 0, 4)", a().in_domain(Domain::Repeat { spacing, copies: None }));
    means("_a.repeat(x: 3, z: 4)", a().in_domain(Domain::Repeat { spacing, copies: None }));
    means("_a.repeat(3, 0, 4, copies_z: 2)", a().in_domain(Domain::Repeat { spacing, copies: Some([0, 0, 2]) }));
    means("_a.repeat(3, 0, 4, 5, 6, 2)", a().in_domain(Domain::Repeat { spacing, copies: Some([5, 6, 2]) }));
    for (axis, name) in Axis::ALL.into_iter().zip(["x", "y", "z"]) {
        means(&format!("_a.mirror_{name}()"), a().in_domain(Domain::Mirror { axis }));
    }
    means("_a.elongate(y: 2)", a().in_domain(Domain::Elongate { size: DVec3::new(0.0, 2.0, 0.0) }));
    means("circle(1).extrude(2)", Tree::circle(1.0).extrude(2.0));
    means("circle(1).revolve(2)", Tree::circle(1.0).revolve(2.0));
    means("circle(1).revolve()", Tree::circle(1.0).revolve(0.0));
    means("_a.substitute(y, z * 2, 5)", a().substitute(Tree::y(), Tree::z() * 2.0, 5.0));
    means("_a.named(\"a b\")", a().named("a b"));
    means("constant(2)", Tree::constant(2.0));
    for operator in Unary::ALL {
        means(&format!("{}(x)", operator.name()), Tree::x().unary(operator));
        means(&format!("_a.{}()", operator.name()), a().unary(operator));
    }
    for operator in Binary::ALL {
        means(&format!("{}(x, 2)", operator.name()), Tree::x().binary(operator, 2.0));
        means(&format!("y.{}(_a)", operator.name()), Tree::y().binary(operator, a()));
    }
}

#[test]
fn operators_bind_as_documented() {
    let (x, y, z) = (Tree::x, Tree::y, Tree::z);
    assert_means("x + y * z", x() + y() * z());
    assert_means("(x + y) * z", (x() + y()) * z());
    assert_means("x - y - z", x() - y() - z());
    assert_means("x - (y - z)", x() - (y() - z()));
    assert_means("x / y / z", x() / y() / z());
    assert_means("-x ^ 2", -x().power(2));
    assert_means("x ^ 2 ^ 3", x().power(8));
    assert_means("x ^ y ^ z", x().binary(Binary::Power, y().binary(Binary::Power, z())));
    assert_means("x ^ -2 * y", x().power(-2) * y());
    assert_means("x ^ -y * z", x().binary(Binary::Power, -y()) * z());
    assert_means("x ^ 2.5", x().binary(Binary::Power, 2.5));
    assert_means("x ^ constant(2)", x().binary(Binary::Power, 2.0));
    assert_means("2 ^ x", Tree::constant(2.0).binary(Binary::Power, x()));
    assert_means("x ^ 3000000000", x().binary(Binary::Power, 3e9));
    assert_means("x * -y", x() * -y());
    assert_means("--x", -(-x()));
    assert_means("~x & y", x().complement().intersection(y()));
    assert_means("~x + y", x().complement() + y());
    assert_means("x | y & z", x().union(y().intersection(z())));
    assert_means("x | y \\ z", x().union(y()).difference(z()));
    assert_means("x \\ y | z", x().difference(y()).union(z()));
    assert_means("x & y + z", x().intersection(y() + z()));
    assert_means("x | y | z", Tree::union_of([x(), y(), z()]));
    assert_means("(x | y) | z", x().union(y()).union(z()));
    assert_means("x | (y | z)", x().union(y().union(z())));
    assert_means("x \\ y \\ z", Tree::new(Operation::Set(SetOperation::Difference, vec![x(), y(), z()])));
    assert_means("x & y & z | x & y", Tree::intersection_of([x(), y(), z()]).union(x().intersection(y())));
    assert_means("(x | y).offset(1) | z", x().union(y()).offset(1.0).union(z()));
    assert_means("_u = x | y; _u | z", x().union(y()).union(z()));
    assert_means("x + y.move(1, 2, 3)", x() + y().translate(1.0, 2.0, 3.0));
}

#[test]
fn numbers_are_computed() {
    for (text, expected) in [
        ("2 + 3 * 4", 14.0),
        ("2 ^ 3 ^ 2", 512.0),
        ("-2 ^ 2", -4.0),
        ("7 - 2 - 1", 4.0),
        ("12 / 3 / 2", 2.0),
        ("2 ^ -1", 0.5),
        ("2 ^ 0.5", 2_f64.sqrt()),
        ("180 deg", std::f64::consts::PI),
        ("2 * 90 deg", std::f64::consts::PI),
        ("(10 + 20) deg", 30_f64.to_radians()),
        ("sqrt(16) + min(2, 3) + atan2(0, 1)", 6.0),
        ("16.sqrt().max(5)", 5.0),
        ("1.5e3 + .5 + 1E-1", 1500.6),
        ("a = 2; b = a * 3; a + b", 8.0),
    ] {
        assert_means(text, expected);
    }
    // What stands for a field is not computed.
    assert_means("sqrt(constant(2))", Tree::constant(2.0).square_root());
    assert_means(
        "prism(2 * 3, radius: 4 / cos(30 deg), height: 1)",
        Tree::prism(6, 4.0 / 30_f64.to_radians().cos(), 1.0),
    );
}

#[test]
fn names_become_parts() {
    let part = Tree::sphere(1.0).named("ball");
    assert_means("ball = sphere(1); ball", part.clone());
    assert_means(
        "ball = sphere(1); ball | ball.move(1, 0, 0)",
        part.clone().union(part.clone().translate(1.0, 0.0, 0.0)),
    );
    assert_means("_ball = sphere(1); _ball", Tree::sphere(1.0));
    assert_means("r = 2; sphere(r)", Tree::sphere(2.0));
    assert_means("ball = sphere(1); other = ball; other", part.clone().named("other"));
    assert_means("u = x; u + 1", Tree::x().named("u") + 1.0);
    assert_means("cone = cone(1, 0, 2); cone.scale(2)", Tree::cone(1.0, 0.0, 2.0).named("cone").scale(2.0));
    assert_means("# first\nball = sphere(1); # then\n\r\n\tball;", part);
    assert_means("\u{FEFF}x", Tree::x());
    // Used twice, it is one node.
    assert_eq!(read("ball = sphere(1); ball | ball").node_count(), 3);
}

#[test]
fn the_example_of_the_documentation_means_what_it_says() {
    let text = "
        plate = rounded_box(60, 40, 6, radius: 2);
        hole = cylinder(radius: 4, height: 10);
        holes = union(hole.move(-20, 0, 0), hole.move(20, 0, 0));
        bounds(-32, -22, -5, 32, 22, 5);          # where to mesh
        plate \\ holes";
    let hole = Tree::cylinder(4.0, 10.0).named("hole");
    let holes = hole.clone().translate(-20.0, 0.0, 0.0).union(hole.translate(20.0, 0.0, 0.0)).named("holes");
    let expected = Tree::rounded_box(DVec3::new(60.0, 40.0, 6.0), 2.0).named("plate").difference(holes);
    let parsed = parse(text.as_bytes(), None).unwrap();
    assert!(parsed.tree == expected);
    let corner = DVec3::new(32.0, 22.0, 5.0);
    assert_eq!(parsed.bounds, Some(Aabb::from_corners(-corner, corner)));
}

#[test]
fn fields_from_elsewhere_are_asked_for_once() {
    let tree = read("ramp(\"a.stl\", height: -2 * 3) | ramp( \"a.stl\" ,height:-6)");
    let Operation::Set(_, parts) = tree.operation() else { panic!() };
    assert_eq!(parts[0].address(), parts[1].address());
    let Operation::Foreign(foreign) = parts[0].operation() else { panic!() };
    assert_eq!(foreign.source(), "ramp(\"a.stl\", height: -6)");
    assert_means("file = \"a.stl\"; ramp(file, height: -6)", parts[0].clone());
    assert_means("foreign(\"any words\")", Tree::foreign("any words", Arc::new(Ramp), false));
}

/// Barth's sextic, 4 (φ²x² - y²)(φ²y² - z²)(φ²z² - x²) - (1 + 2φ)(x² + y² + z² - w²)²w² (Barth, 1996), with w = 1.
#[test]
fn barths_sextic_is_its_formula() {
    let text = include_bytes!("../../../../../data/implicit/barth_sextic.shape");
    let parsed = parse(text, None).unwrap();
    let program = parsed.tree.compile().unwrap();
    let phi = (1.0 + 5_f64.sqrt()) / 2.0;
    let mut numbers = Numbers::new(5);
    for _ in 0..1000 {
        let p = numbers.point(2.0);
        let s = phi * phi;
        let planes = (s * p.x * p.x - p.y * p.y) * (s * p.y * p.y - p.z * p.z) * (s * p.z * p.z - p.x * p.x);
        let sphere = p.length_squared() - 1.0;
        let sextic = 4.0 * planes - (1.0 + 2.0 * phi) * sphere * sphere;
        // Cut off by a ball; a sum of a few dozen terms of size 300.
        let expected = (-sextic).max(p.length() - 1.9);
        assert!((program.value(p) - expected).abs() < 1e-9, "{p} {} {expected}", program.value(p));
    }
    assert!(parsed.bounds.is_some_and(|bounds| bounds.contains(DVec3::splat(1.9 / 3.0_f64.sqrt()))));
    // Twenty of its double points are the corners of a dodecahedron of edge 2/φ: value and gradient vanish there.
    let mut nodes: Vec<DVec3> = Vec::new();
    for (a, b) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        nodes.extend([DVec3::new(1.0, a, b), DVec3::new(-1.0, a, b)]);
        let (long, short) = (a * phi, b / phi);
        nodes.extend([DVec3::new(0.0, short, long), DVec3::new(long, 0.0, short), DVec3::new(short, long, 0.0)]);
    }
    let flat =
        nodes.iter().filter(|&&node| program.value(node).abs() < 1e-12 && program.gradient(node).length() < 1e-12);
    assert_eq!((nodes.len(), flat.count()), (20, 20));
}

/// Text costs nothing once it is read: its program has the steps of one made by methods, in the same order.
#[test]
fn programs_of_text_are_those_of_code() {
    for tree in crate::laws::samples() {
        let again = read(&to_text(&tree, None));
        let (written, parsed) = (tree.compile().unwrap(), again.compile().unwrap());
        let (steps, result) = written.steps();
        assert_eq!((format!("{steps:?}"), result), (format!("{:?}", parsed.steps().0), parsed.steps().1));
    }
}

/// Every function stands on the page with its parameters, and the page's examples can be read.
#[test]
fn the_page_describes_every_function() {
    let page = include_str!("../../../../../docs/formats/shape_language.md");
    for callee in super::super::functions::Callee::all() {
        let signature = callee.signature().described();
        assert!(page.contains(&format!("`{signature}`")), "{signature}");
    }
    let examples: Vec<&str> = page.split("```shape\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert!(examples.len() >= 5);
    for example in examples {
        read(example);
    }
}

#[test]
fn the_files_of_the_repository_are_shapes() {
    for text in [
        include_str!("../../../../../data/implicit/bracket.shape"),
        include_str!("../../../../../data/implicit/blended_cylinders.shape"),
        include_str!("../../../../../data/implicit/barth_sextic.shape"),
    ] {
        let parsed = parse(text.as_bytes(), None).unwrap();
        let again = parse(to_text(&parsed.tree, parsed.bounds.as_ref()).as_bytes(), None).unwrap();
        assert!(again.tree == parsed.tree && again.bounds == parsed.bounds);
        // The bounds hold the shape: its surface does not reach their faces.
        let (program, bounds) = (parsed.tree.compile().unwrap(), parsed.bounds.unwrap());
        let mut numbers = Numbers::new(1);
        let mut inside = 0;
        for _ in 0..3000 {
            let part = (numbers.point(0.5) + 0.5).clamp(DVec3::ZERO, DVec3::ONE);
            let point = bounds.min + part * bounds.size();
            inside += usize::from(program.value(point) < 0.0);
            for axis in 0..3 {
                for side in [bounds.min, bounds.max] {
                    let mut on_face = point;
                    on_face[axis] = side[axis];
                    assert!(program.value(on_face) > 0.0, "{on_face}");
                }
            }
        }
        assert!(inside > 30, "{inside}");
    }
}
