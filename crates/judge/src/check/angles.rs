//! Angles so small that solvers suffer.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Stop};
use shapeloom_mesh::TriMesh;

/// The smallest angle that is no sliver's, in degrees.
pub(super) const SMALLEST: f64 = 1.0;

/// The triangles with an area and an angle below [`SMALLEST`], rising. In floating point: angles within about 1e-15 of it
/// may fall on either side.
pub(super) fn slivers(mesh: &TriMesh, exec: &Exec) -> Result<Vec<u32>, Stop> {
    let sine = SMALLEST.to_radians().sin();
    let mut found = Vec::new();
    for triangle in 0..mesh.triangles().len() {
        if triangle.is_multiple_of(1 << 14) {
            exec.check()?;
        }
        if is_sliver(mesh.corners(triangle), sine) {
            found.push(triangle as u32);
        }
    }
    Ok(found)
}

fn is_sliver([a, b, c]: [DVec3; 3], sine: f64) -> bool {
    // On a scale of its own, whatever the shape's.
    let longest = [b - a, c - b, a - c].map(|side| side.abs().max_element()).into_iter().fold(0.0, f64::max);
    let [u, v, w] = [b - a, c - b, a - c].map(|side| (side / longest).length());
    let doubled = ((b - a) / longest).cross((c - a) / longest).length();
    // The smallest angle is between the two longer sides; its sine is the doubled area over their product.
    let product = u * v * w / u.min(v).min(w);
    doubled > 0.0 && doubled < sine * product
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_is_one_degree_at_every_size_and_shape() {
        for size in [1e-200, 1e-9, 1.0, 1e200] {
            for (degrees, sliver) in [(0.99f64, true), (1.01, false), (60.0, false), (0.01, true)] {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                for along in [0.01, 1.0, 3.0] {
                    let [a, b, c] = [DVec3::ZERO, DVec3::X * along, DVec3::new(cosine, sine, 0.0)];
                    // Between sides of 1 and 0.01 the third corner's angle is the smallest, and smaller.
                    let other = (b - c).angle_between(a - c).min((c - b).angle_between(a - b)).to_degrees();
                    let corners = [a, b, c].map(|corner| corner * size);
                    let wanted = sliver || other < SMALLEST;
                    assert_eq!(is_sliver(corners, SMALLEST.to_radians().sin()), wanted, "{size} {degrees} {along}");
                }
            }
        }
        assert!(!is_sliver([DVec3::ZERO, DVec3::X, DVec3::X], 0.5) && !is_sliver([DVec3::ONE; 3], 0.5));
    }
}
