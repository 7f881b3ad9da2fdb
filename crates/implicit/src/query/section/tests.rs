//! Curves held against closed forms.

use std::f64::consts::PI;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{CancelFlag, Category, Convert, Converted, Deviation, Exec, Field, Frame, OverBudget, Stop};

use super::*;
use crate::{Primitive, Program, Tree, Unary};

fn squared(x: f64, y: f64) -> Tree {
    (Tree::x() - x).square() + (Tree::y() - y).square()
}

fn curves(tree: &Tree, reach: f64, squares: &AdaptiveMarchingSquares) -> Converted<PlaneCurves> {
    let program = tree.compile().unwrap();
    // No lattice line through the middle.
    let (lo, hi) = (DVec2::new(-reach, -reach * 1.01), DVec2::new(reach * 1.02, reach));
    let found = squares.convert(&PlaneWindow::in_xy(&program, lo, hi).unwrap()).unwrap();
    has_inside_on_the_left(&program, &found.value, squares.chord_tolerance);
    found
}

/// At the middle of each segment longer than the tolerance, a little to the left is inside and a little to the right outside.
fn has_inside_on_the_left(program: &Program, found: &PlaneCurves, tolerance: f64) {
    let mut wrong = 0;
    let mut count = 0;
    for [a, b] in found.curves.iter().flat_map(|curve| curve.segments()).filter(|[a, b]| a.distance(*b) > tolerance) {
        let left = (b - a).normalize().truncate().perp() * (2.0 * tolerance);
        let value = |side: DVec2| program.value(found.frame.position((a + b) * 0.5 + side.extend(0.0)));
        count += 1;
        // A sheet or gap thinner than that is passed.
        let right = value(-left);
        wrong += usize::from(value(left) >= 0.0 || right < 0.0);
    }
    assert!(wrong * 20 <= count, "{wrong} of {count}");
}

fn closed(found: &PlaneCurves) -> Vec<bool> {
    found.curves.iter().map(shapeloom_mesh::Polyline::is_closed).collect()
}

fn length(found: &PlaneCurves) -> f64 {
    found.curves.iter().map(shapeloom_mesh::Polyline::length).sum()
}

#[test]
fn a_circle_has_its_length_and_area() {
    for tree in [Tree::sphere(1.0), squared(0.0, 0.0) - 1.0, (squared(0.0, 0.0) - 1.0).power(3)] {
        for tolerance in [1e-2, 1e-4, 1e-6] {
            let found = curves(&tree, 1.7, &AdaptiveMarchingSquares::new(tolerance));
            assert_eq!(closed(&found.value), [true], "{tree:?}");
            let line = &found.value.curves[0];
            // Two-sided: points are on the circle, and chords are so long that they stay this near.
            assert!(line.points().iter().all(|p| (p.length() - 1.0).abs() < 1e-9 && p.z == 0.0));
            let sagitta = line.segments().map(|[a, b]| 1.0 - ((a + b) * 0.5).length()).fold(0.0, f64::max);
            assert!(sagitta <= 1.05 * tolerance, "{tree:?} {tolerance} {sagitta}");
            let least = PI / (2.0 * tolerance).sqrt() * 0.5;
            assert!((line.points().len() as f64) < least.max(400.0) * 12.0);
            assert!((length(&found.value) - 2.0 * PI).abs() < 4.0 * tolerance);
            let area = found.value.closed_area();
            assert!(area < PI && PI - area < 2.0 * PI * tolerance, "{area}");
            assert!(matches!(found.report.deviation, Deviation::Estimated(_)));
        }
    }
}

#[test]
fn proven_deviations_hold() {
    let squares = AdaptiveMarchingSquares { proven: true, ..AdaptiveMarchingSquares::new(0.01) };
    let found = curves(&(squared(0.0, 0.0) - 1.0), 1.7, &squares);
    let Deviation::AtMost(bound) = found.report.deviation else { panic!("{:?}", found.report) };
    assert!(bound <= 0.01);
    for i in 0..2000 {
        let p = DVec2::from_angle(f64::from(i) * PI / 1000.0).extend(0.0);
        let near = found.value.curves[0].points().iter().map(|q| q.distance(p)).fold(f64::INFINITY, f64::min);
        assert!(near <= bound);
    }
}

#[test]
fn an_ellipse_and_its_mirror_image() {
    let ellipse = (Tree::x() / 2.0).square() + (Tree::y() / 0.7).square() - 1.0;
    let found = curves(&ellipse, 2.5, &AdaptiveMarchingSquares::new(1e-4)).value;
    assert!((found.closed_area() - PI * 1.4).abs() < 1e-3);
    // The outside of it: the same curve, turned round.
    let outside = curves(&-ellipse, 2.5, &AdaptiveMarchingSquares::new(1e-4)).value;
    assert!((outside.closed_area() + PI * 1.4).abs() < 1e-3);
}

#[test]
fn a_hyperbola_has_two_branches_that_the_window_cuts() {
    let found =
        curves(&(1.0 - Tree::x().square() + Tree::y().square()), 3.0, &AdaptiveMarchingSquares::new(1e-3)).value;
    assert_eq!(closed(&found), [false, false]);
    for curve in &found.curves {
        let points = curve.points();
        for end in [points[0], points[points.len() - 1]] {
            let on_border = [-3.0, 3.06].contains(&end.x) || [-3.03, 3.0].contains(&end.y);
            assert!(on_border, "{end}");
        }
        assert!(points.iter().all(|p| (p.x * p.x - p.y * p.y - 1.0).abs() < 1e-12));
        assert!(points.iter().all(|p| p.x.signum() == points[0].x.signum()));
    }
}

#[test]
fn nodes_are_resolved_to_the_tolerance() {
    // The lemniscate of Bernoulli: two lobes of area a² each... together 2a² with a² = 1/2·2.
    let sum = squared(0.0, 0.0);
    let lemniscate = sum.square() - (Tree::x().square() - Tree::y().square()) * 2.0;
    let found = curves(&lemniscate, 1.8, &AdaptiveMarchingSquares::new(1e-4));
    assert!((found.value.closed_area() - 2.0).abs() < 1e-3, "{}", found.value.closed_area());
    assert!(found.value.curves.iter().all(shapeloom_mesh::Polyline::is_closed));
    assert!(found.value.curves.len() <= 2);
    // Its length is that of the lemniscate constant: 2√2 · 2.62205755 for a = √2... with half width √2.
    assert!((length(&found.value) - 2.0 * 2.622_057_554_292_119 * 2.0_f64.sqrt()).abs() < 2e-3);

    // The folium of Descartes: a loop of area 3a²/2, here with a = 1.
    let folium = Tree::x().power(3) + Tree::y().power(3) - Tree::x() * Tree::y() * 3.0;
    let found = curves(&folium, 2.4, &AdaptiveMarchingSquares::new(1e-4)).value;
    for point in found.curves.iter().flat_map(|curve| curve.points()) {
        let (x, y) = (point.x, point.y);
        assert!((x * x * x + y * y * y - 3.0 * x * y).abs() < 1e-12);
    }
    assert!(found.curves.len() <= 3);

    // Two lines that cross: each corner keeps its own curve, or pairs are joined, but all within the tolerance.
    let cross = Tree::x() * Tree::y();
    let found = curves(&cross, 1.0, &AdaptiveMarchingSquares::new(1e-4)).value;
    assert_eq!(closed(&found), [false, false]);
    assert!((length(&found) - 2.02 - 2.01).abs() < 1e-3, "{}", length(&found));
    assert!(found.curves.iter().flat_map(|c| c.points()).all(|p| p.x.abs().min(p.y.abs()) < 1e-4));
}

#[test]
fn circles_that_touch_and_circles_that_nearly_do() {
    for (gap, expected) in [(0.0, 1..=2), (1e-2, 2..=2), (-1e-2, 1..=1)] {
        let pair = (squared(-1.0 - gap / 2.0, 0.0) - 1.0).minimum(squared(1.0 + gap / 2.0, 0.0) - 1.0);
        let found = curves(&pair, 2.6, &AdaptiveMarchingSquares::new(1e-3)).value;
        assert!(expected.contains(&found.curves.len()), "{gap} {}", found.curves.len());
        assert!((found.closed_area() - 2.0 * PI).abs() < 0.02, "{gap} {}", found.closed_area());
    }
    // Many small circles, far smaller than the cells: bounds show where to look.
    let dots = (0..12).map(|i| {
        let at = DVec2::from_angle(f64::from(i)) * (0.1 * f64::from(i));
        Tree::sphere(0.01).translate(at.x, at.y, 0.0)
    });
    let found = curves(&Tree::union_of(dots), 1.5, &AdaptiveMarchingSquares::new(1e-4)).value;
    assert_eq!(found.curves.len(), 12);
    assert!((found.closed_area() - 12.0 * PI * 1e-4).abs() < 6e-5);
}

#[test]
fn sharp_corners_are_kept_to_the_tolerance() {
    let square = Tree::cuboid(1.0, 1.0, 1.0);
    let found = curves(&square, 0.83, &AdaptiveMarchingSquares::new(1e-5)).value;
    assert!((found.closed_area() - 1.0).abs() < 1e-4 && (length(&found) - 4.0).abs() < 1e-4);
    for corner in [DVec3::new(0.5, 0.5, 0.0), DVec3::new(-0.5, 0.5, 0.0)] {
        let to = |[a, b]: [DVec3; 2]| {
            let part = ((corner - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            corner.distance(a.lerp(b, part))
        };
        let near = found.curves[0].segments().map(to).fold(f64::INFINITY, f64::min);
        assert!(near <= 1e-5, "{near}");
    }
}

#[test]
fn nothing_everything_and_what_is_not_a_number() {
    let squares = AdaptiveMarchingSquares::new(1e-3);
    assert!(curves(&Tree::constant(1.0), 1.0, &squares).value.curves.is_empty());
    assert!(curves(&Tree::constant(-1.0), 1.0, &squares).value.curves.is_empty());
    let double = curves(&(squared(0.0, 0.0) - 0.5).square(), 1.0, &squares);
    assert!(double.report.findings.iter().any(|finding| finding.code == "W-section-uncertain"));
    // The square root ends at x = 0: inside is 0 < x < 0.25.
    let half = Tree::x().unary(Unary::SquareRoot) - 0.5;
    let found = curves(&half, 1.0, &squares);
    assert_eq!(found.value.curves.len(), 2);
    assert!(found.report.findings.iter().any(|finding| finding.code == "W-section-undefined"));
    let mut at: Vec<f64> = found.value.curves.iter().map(|curve| curve.points()[0].x).collect();
    at.sort_by(f64::total_cmp);
    assert!(at[0].abs() < 1e-9 && (at[1] - 0.25).abs() < 1e-12, "{at:?}");
    let nowhere = Tree::constant(f64::NAN) * Tree::x();
    if let Ok(program) = nowhere.compile() {
        let window = PlaneWindow::in_xy(&program, DVec2::ZERO, DVec2::ONE).unwrap();
        assert!(squares.convert(&window).unwrap().value.curves.is_empty());
    }
}

struct Mute;

impl Field for Mute {
    fn value(&self, point: DVec3) -> f64 {
        point.length_squared() - 1.0
    }

    fn gradient(&self, point: DVec3) -> DVec3 {
        point * 2.0
    }
}

#[test]
fn absurd_sizes_are_refused_before_memory_runs_out() {
    let window = PlaneWindow::in_xy(&Mute, DVec2::splat(-1.5), DVec2::splat(1.5)).unwrap();
    let attempt = |squares: AdaptiveMarchingSquares, exec: &Exec| squares.convert_with(&window, exec).unwrap_err();
    let exec = Exec::default();
    for squares in [
        AdaptiveMarchingSquares::new(1e-300),
        AdaptiveMarchingSquares { cell_size: 1e-30, ..AdaptiveMarchingSquares::new(0.1) },
    ] {
        let error = attempt(squares, &exec);
        assert!(matches!(error.narrow(), Some(SectionError::Fine { .. })), "{error}");
    }
    let fine = AdaptiveMarchingSquares { cell_size: 1e-6, max_cells: 100_000, ..AdaptiveMarchingSquares::new(0.1) };
    let error = attempt(fine.clone(), &exec);
    assert_eq!(error.narrow(), Some(&SectionError::Cells { most: 100_000 }));
    let small = AdaptiveMarchingSquares { cell_size: 0.01, ..fine.clone() };
    let error = attempt(small, &Exec::default().with_memory(1 << 20));
    assert!(error.narrow::<OverBudget>().is_some() && error.category() == Category::OverLimit);
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        assert_eq!(attempt(AdaptiveMarchingSquares::new(bad), &exec).category(), Category::Usage);
    }
    let flag = CancelFlag::default();
    flag.cancel();
    let error = attempt(AdaptiveMarchingSquares::new(0.1), &Exec::default().with_cancel(&flag));
    assert_eq!(error.narrow(), Some(&Stop::Cancelled));
    for (lo, hi) in [(DVec2::ZERO, DVec2::ZERO), (DVec2::NAN, DVec2::ONE), (DVec2::ONE, DVec2::ZERO)] {
        assert!(matches!(PlaneWindow::in_xy(&Mute, lo, hi), Err(SectionError::Window { .. })));
    }
    assert!(PlaneWindow::in_xy(&Mute, DVec2::splat(-1e308), DVec2::splat(1e308)).is_err());
    // A field that knows no bounds still gives its curve, with a warning.
    let found =
        AdaptiveMarchingSquares { search_depth: 0, ..AdaptiveMarchingSquares::new(1e-3) }.convert(&window).unwrap();
    assert_eq!(found.value.curves.len(), 1);
    assert!(!found.report.findings.is_empty());
}

#[test]
fn scales_and_narrow_windows() {
    for scale in [1e-9, 1e9, 1e100] {
        let program = Tree::sphere(scale).compile().unwrap();
        let (lo, hi) = (DVec2::new(-1.1, -1.3) * scale, DVec2::new(1.5, 1.2) * scale);
        let found = section(&program, Frame::WORLD, [lo, hi], 1e-4 * scale, &Exec::default()).unwrap().value;
        assert!((found.closed_area() / scale / scale - PI).abs() < 1e-3);
    }
    let program = Tree::sphere(1.0).compile().unwrap();
    let window = [DVec2::new(-2.0, -0.001), DVec2::new(2.0, 0.001)];
    let found = section(&program, Frame::WORLD, window, 1e-4, &Exec::default()).unwrap().value;
    assert_eq!(closed(&found), [false, false]);
}

#[test]
fn sections_of_a_torus_are_circles() {
    let (major, minor): (f64, f64) = (2.0, 0.7);
    // The plane that touches the torus twice meets it in two circles of radius R (Villarceau, 1848), which cross.
    let tilt = (minor / major).asin();
    let villarceau = Frame::new(DVec3::ZERO, DVec3::Y, DVec3::new(tilt.cos(), 0.0, tilt.sin())).unwrap();
    let flat = Frame::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap();
    let upright = Frame::new(DVec3::ZERO, DVec3::X, DVec3::Z).unwrap();
    for tree in [Tree::torus(major, minor), Primitive::QuarticTorus { major, minor }.into()] {
        let program = tree.compile().unwrap();
        let cut = |frame: Frame| {
            let window = [DVec2::new(-3.1, -2.9), DVec2::new(3.0, 3.05)];
            section(&program, frame, window, 1e-3, &Exec::default()).unwrap().value
        };
        let rings = cut(flat);
        assert_eq!(closed(&rings), [true, true]);
        assert!((rings.closed_area() - PI * (2.7 * 2.7 - 1.3 * 1.3)).abs() < 0.03);
        assert!((length(&rings) - 2.0 * PI * 4.0).abs() < 0.02);
        let discs = cut(upright);
        assert!((discs.closed_area() - 2.0 * PI * 0.49).abs() < 0.01 && discs.curves.len() == 2);
        let crossing = cut(villarceau);
        assert!((length(&crossing) - 2.0 * 2.0 * PI * major).abs() < 0.03, "{}", length(&crossing));
        for point in crossing.in_space().iter().flat_map(|curve| curve.points().to_vec()) {
            assert!(program.value(point).abs() < 1e-9);
        }
        for point in crossing.curves.iter().flat_map(|curve| curve.points()) {
            // Circles of radius R about (±r, 0): the frame's first axis is y.
            let off = [minor, -minor].map(|x| (point.truncate().distance(DVec2::new(x, 0.0)) - major).abs());
            assert!(off[0].min(off[1]) < 2e-3, "{point} {off:?}");
        }
    }
}
