//! How far triangles are from a surface, by measurement.

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::{CHUNK, map_chunks};
use shapeloom_core::{Aabb, Exec, Field, Stop};
use shapeloom_mesh::TriMesh;

/// How many points of a mesh are looked at a chunk.
const POINTS: usize = CHUNK / 8;

/// The largest distance of vertices and of the middles of triangles to the surface, to first order: |f| / |∇f|. None where a value or
/// gradient does not tell. Points on the sides of `region` are left out: there the solid is cut off.
pub(super) fn distance<F: Field + ?Sized>(
    mesh: &TriMesh,
    field: &F,
    region: &Aabb,
    exec: &Exec,
) -> Result<Option<f64>, Stop> {
    let rounding = 1e-9 * region.size().max_element();
    let of = |point: DVec3| {
        if on_side(region, point, rounding) {
            return 0.0;
        }
        let value = field.value(point);
        if value == 0.0 { 0.0 } else { value.abs() / field.gradient(point).length() }
    };
    // Not a number stays, so that it is seen.
    let worse = |most: f64, found: f64| if found <= most { most } else { found };
    let vertices = mesh.positions();
    let of_vertices = map_chunks(exec, vertices.len(), POINTS, |part| {
        Ok::<f64, Stop>(vertices[part].iter().fold(0.0, |most, &point| worse(most, of(point))))
    })?;
    let of_triangles = map_chunks(exec, mesh.triangles().len(), POINTS, |part| {
        let middle = |triangle: usize| mesh.corners(triangle).into_iter().sum::<DVec3>() / 3.0;
        Ok::<f64, Stop>(part.fold(0.0, |most, triangle| worse(most, of(middle(triangle)))))
    })?;
    let most = of_vertices.into_iter().chain(of_triangles).fold(0.0, worse);
    Ok(most.is_finite().then_some(most))
}

/// Whether a point lies on a side of a box, within rounding.
pub(super) fn on_side(region: &Aabb, point: DVec3, rounding: f64) -> bool {
    (point - region.min).abs().min_element() <= rounding || (region.max - point).abs().min_element() <= rounding
}
