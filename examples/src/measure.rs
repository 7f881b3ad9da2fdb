//! How far patches are from their triangles, found by sampling: a check that knows nothing of how bounds are proven.

use std::error::Error;

use shapeloom::core::glam::{DMat2, DVec2, DVec3};
use shapeloom::core::{ClosestPoint, Exec, Surface};
use shapeloom::mesh::{Domain, PATCH, TEXCOORD, TriMesh};
use shapeloom::parametric::BezierPatch;
use shapeloom::spatial::TriangleBvh;

/// The triangles of a patch: each carries its patch's number as a label.
pub fn triangles_of_patch(mesh: &TriMesh, patch: usize) -> impl Iterator<Item = usize> {
    let labels = mesh.attribute(Domain::Face, PATCH);
    (0..mesh.triangles().len()).filter(move |&triangle| labels.is_some_and(|l| l.number(triangle, 0) == patch as f64))
}

/// The distance between a patch and its triangles, the larger of both directions, by dense samples; and the bound that
/// would follow if only the part of the second derivatives along the normal counted.
///
/// # Errors
/// A mesh that has lost the parameters of its wedges.
pub fn measure_patch(patch: &BezierPatch, mesh: &TriMesh, index: usize) -> Result<(f64, f64), Box<dyn Error>> {
    let own: Vec<usize> = triangles_of_patch(mesh, index).collect();
    let triangles: Vec<[u32; 3]> = own.iter().map(|&triangle| mesh.triangles()[triangle]).collect();
    let bvh = TriangleBvh::build(mesh.positions(), &triangles, &Exec::default())?;
    let away = |p: DVec3| bvh.closest(p).map_or(f64::INFINITY, |closest| closest.distance_squared.sqrt());
    let samples = (0..97 * 97).map(|k| patch.point(f64::from(k % 97) / 96.0, f64::from(k / 97) / 96.0));
    let (mut measured, mut curved) = (samples.map(away).fold(0.0, f64::max), 0.0f64);
    let parameters = mesh.attribute(Domain::Wedge, TEXCOORD).ok_or("no parameters")?;
    for triangle in own {
        let [p, q, r] = mesh.corners(triangle);
        let [a, b, c] = [0, 1, 2].map(|k| DVec2::from([0, 1].map(|axis| parameters.number(3 * triangle + k, axis))));
        let size = a.max(b).max(c) - a.min(b).min(c);
        for (i, j) in (0..=4).flat_map(|i| (0..=4 - i).map(move |j| (f64::from(i) / 4.0, f64::from(j) / 4.0))) {
            let uv = a + (b - a) * i + (c - a) * j;
            let jet = patch.jet(uv.x, uv.y);
            let normal = jet.du.cross(jet.dv).normalize_or_zero();
            let [uu, twist, vv] = [jet.duu, jet.duv, jet.dvv].map(|second| second.dot(normal).abs());
            curved = curved.max((uu * size.x * size.x + 2.0 * twist * size.x * size.y + vv * size.y * size.y) / 8.0);
            measured = measured.max(nearest(patch, p + (q - p) * i + (r - p) * j, uv));
        }
    }
    Ok((measured, curved))
}

/// How far a patch is from a point: the nearest of a few Gauss-Newton steps from near parameters.
fn nearest(patch: &BezierPatch, point: DVec3, mut uv: DVec2) -> f64 {
    let mut nearest = f64::INFINITY;
    for _ in 0..3 {
        let jet = patch.jet(uv.x, uv.y);
        let offset = point - jet.point;
        nearest = nearest.min(offset.length());
        let tangents =
            DMat2::from_cols_array(&[jet.du.dot(jet.du), jet.du.dot(jet.dv), jet.dv.dot(jet.du), jet.dv.dot(jet.dv)]);
        if tangents.determinant() > 1e-12 {
            uv = (uv + tangents.inverse() * DVec2::new(jet.du.dot(offset), jet.dv.dot(offset)))
                .clamp(DVec2::ZERO, DVec2::ONE);
        }
    }
    nearest
}
