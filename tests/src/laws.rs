//! The laws of core's capability traits, run on everything that implements them; those of queries are in `query_laws`.

use shapeloom::core::glam::{DMat3, DVec2, DVec3};
use shapeloom::core::{Affine, Curve, Interval, Surface, VectorSpace, Warp};
use shapeloom::parametric::{BezierCurve, BezierPatch};

use crate::shapes;
use crate::support::Dice;

/// `derivatives` agrees with `point` and with difference quotients, `points` with `point` to the bit.
fn curve_laws<P: VectorSpace>(curve: &impl Curve<P>, size: f64) {
    let domain = curve.domain();
    let parameters: Vec<f64> = (0..=16).map(|k| domain.at(f64::from(k) / 16.0)).collect();
    let mut batch = vec![P::ZERO; parameters.len()];
    curve.points(&parameters, &mut batch);
    for (&t, &together) in parameters.iter().zip(&batch) {
        assert_eq!(curve.point(t), together);
        let mut out = [P::ZERO; 4];
        curve.derivatives(t, &mut out);
        assert!((out[0] - curve.point(t)).length() <= 1e-13 * size);
        let h = 1e-4 * domain.length();
        let quotient = (curve.point(t + h) - curve.point(t - h)) * (0.5 / h);
        assert!((quotient - out[1]).length() <= 1e-5 * size, "{t}");
        let second = (curve.point(t + h) + curve.point(t - h) - curve.point(t) * 2.0) * (1.0 / (h * h));
        assert!((second - out[2]).length() <= 1e-4 * size, "{t}");
    }
}

/// `jet` agrees with `point` and with difference quotients, normals are unit and perpendicular, batches are the same.
fn surface_laws(surface: &impl Surface, size: f64) {
    let [us, vs] = surface.domain();
    let mut parameters = Vec::new();
    for k in 0..49 {
        parameters.push(DVec2::new(us.at(f64::from(k % 7) / 6.0), vs.at(f64::from(k / 7) / 6.0)));
    }
    let mut batch = vec![DVec3::ZERO; parameters.len()];
    surface.points(&parameters, &mut batch);
    for (uv, together) in parameters.iter().zip(batch) {
        let (u, v) = (uv.x, uv.y);
        assert_eq!(surface.point(u, v), together);
        let jet = surface.jet(u, v);
        let close = |a: DVec3, b: DVec3, tolerance: f64| assert!((a - b).length() <= tolerance * size, "{uv}: {a} {b}");
        close(jet.point, together, 1e-13);
        let h = 1e-4;
        let at = |i: f64, j: f64| surface.point(u + i * h, v + j * h);
        close((at(1.0, 0.0) - at(-1.0, 0.0)) / (2.0 * h), jet.du, 1e-5);
        close((at(0.0, 1.0) - at(0.0, -1.0)) / (2.0 * h), jet.dv, 1e-5);
        close((at(1.0, 0.0) + at(-1.0, 0.0) - 2.0 * together) / (h * h), jet.duu, 1e-4);
        close((at(0.0, 1.0) + at(0.0, -1.0) - 2.0 * together) / (h * h), jet.dvv, 1e-4);
        let mixed = (at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0)) / (4.0 * h * h);
        close(mixed, jet.duv, 1e-4);
        if let Some(normal) = surface.normal(u, v) {
            assert!((normal.length() - 1.0).abs() < 1e-12);
            assert!(normal.dot(jet.du).abs() <= 1e-4 * size && normal.dot(jet.dv).abs() <= 1e-4 * size);
        }
    }
}

/// `jacobian` agrees with difference quotients of `position`, `positions` with `position` to the bit.
fn warp_laws(warp: &impl Warp) {
    let mut dice = Dice(3);
    let points: Vec<DVec3> = (0..32).map(|_| DVec3::new(dice.unit(), dice.unit(), dice.unit()) * 4.0).collect();
    let mut moved = points.clone();
    warp.positions(&mut moved);
    for (&p, image) in points.iter().zip(moved) {
        assert_eq!(warp.position(p), image);
        let h = 1e-5;
        let column = |e: DVec3| (warp.position(p + e * h) - warp.position(p - e * h)) / (2.0 * h);
        let quotients = DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
        assert!(quotients.abs_diff_eq(warp.jacobian(p), 1e-6));
    }
}

#[test]
fn bezier_curves_are_curves() {
    curve_laws(&shapes::curve(), 10.0);
    let mut dice = Dice(5);
    for degree in 0..9 {
        let flat = (0..=degree).map(|_| DVec2::new(dice.unit(), dice.unit())).collect();
        curve_laws(&BezierCurve::try_new(flat).expect("finite"), 10.0 * (1.0 + f64::from(degree)));
        let space = (0..=degree).map(|_| DVec3::new(dice.unit(), dice.unit(), dice.unit())).collect();
        curve_laws(&BezierCurve::try_new(space).expect("finite"), 10.0 * (1.0 + f64::from(degree)));
    }
    let domain: Interval = Curve::<DVec3>::domain(&shapes::curve());
    assert_eq!(domain, Interval::UNIT);
}

#[test]
fn bezier_patches_are_surfaces() {
    surface_laws(&shapes::bent_patch(), 20.0);
    let mut dice = Dice(9);
    for (m, n) in [(0, 0), (1, 1), (2, 1), (0, 3), (5, 4)] {
        let net = (0..(m + 1) * (n + 1)).map(|_| DVec3::new(dice.unit(), dice.unit(), dice.unit())).collect();
        surface_laws(&BezierPatch::try_new(m, n, net).expect("finite"), 10.0);
    }
    let shapeloom::shape::Geometry::BezierSurface(teapot) = shapes::teapot() else { panic!("the teapot is patches") };
    teapot.patches.iter().for_each(|patch| surface_laws(patch, 10.0));
}

#[test]
fn affine_maps_are_warps() {
    let linear = DMat3::from_cols(DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 0.3, 2.0), DVec3::new(0.0, 1.0, -2.0));
    warp_laws(&Affine { linear, translation: DVec3::new(3.0, -4.0, 5.0) });
    warp_laws(&Affine::IDENTITY);
}
