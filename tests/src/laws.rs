//! The laws of core's capability traits, run on everything that implements them.

use shapeloom::core::glam::{DMat3, DVec2, DVec3};
use shapeloom::core::{
    Affine, Closest, ClosestPoint, Curve, Exec, Hit, Interval, Ray, Rays, Surface, VectorSpace, Warp,
};
use shapeloom::parametric::{BezierCurve, BezierPatch};
use shapeloom::spatial::TriangleBvh;

use crate::oracles::{to_triangle, triangles};
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

/// The first hit is the nearest of all, `any_hit` tells whether there is one, hits lie within reach, batches agree.
fn ray_laws(shape: &impl Rays, rays: &[Ray]) -> usize {
    let mut batch = vec![None; rays.len()];
    shape.first_hits(rays, &mut batch, &Exec::default()).expect("nothing stops it");
    let (mut hits, mut count) = (Vec::new(), 0);
    for (ray, together) in rays.iter().zip(batch) {
        shape.all_hits(ray, &mut hits);
        let first: Option<Hit> = shape.first_hit(ray);
        assert_eq!(first, together);
        assert_eq!(first, hits.first().copied());
        assert_eq!(shape.any_hit(ray), first.is_some());
        assert!(hits.windows(2).all(|pair| (pair[0].distance, pair[0].element) < (pair[1].distance, pair[1].element)));
        assert!(hits.iter().all(|hit| ray.reach.contains(hit.distance)));
        count += hits.len();
    }
    count
}

/// No point of the shape is closer than the answer, the answer is that far away, batches agree.
fn closest_laws(shape: &impl ClosestPoint, brute: impl Fn(DVec3) -> f64, queries: &[DVec3]) {
    let mut batch: Vec<Option<Closest>> = vec![None; queries.len()];
    shape.closest_points(queries, &mut batch, &Exec::default()).expect("nothing stops it");
    for (&query, together) in queries.iter().zip(batch) {
        let found = shape.closest(query);
        assert_eq!(found, together);
        let found = found.expect("the shape is not empty");
        let distance = found.distance_squared.sqrt();
        assert!((distance - brute(query)).abs() <= 1e-12 * (1.0 + distance), "{query}");
        assert!((found.point.distance(query) - distance).abs() <= 1e-12 * (1.0 + distance));
        assert_eq!(shape.closest_within(query, distance * 0.99 - 1e-12), None);
    }
    assert_eq!(shape.closest(DVec3::NAN), None);
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

#[test]
fn triangle_hierarchies_answer_rays_and_closest_points() {
    let mesh = shapes::tagged_triangles();
    let bvh = TriangleBvh::build(mesh.positions(), mesh.triangles(), &Exec::default()).expect("a sound mesh");
    let mut dice = Dice(21);
    let mut point = |size: f64| DVec3::new(dice.unit() - 0.5, dice.unit() - 0.5, dice.unit() - 0.5) * size;
    let rays: Vec<Ray> = (0..2000)
        .map(|k| {
            let (origin, target) = (point(5.0), point(2.0));
            let ray = Ray::new(origin, target - origin).expect("different points");
            if k % 3 == 0 { ray.within(Interval::new(0.5, 3.0)) } else { ray }
        })
        .collect();
    assert!(ray_laws(&bvh, &rays) > 1000);
    let all = triangles(&mesh);
    let brute = |p: DVec3| all.iter().map(|&t| to_triangle(p, t)).fold(f64::INFINITY, f64::min);
    let queries: Vec<DVec3> = (0..500).map(|_| point(4.0)).collect();
    closest_laws(&bvh, brute, &queries);
}
