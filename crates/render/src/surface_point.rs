//! The place on a surface that a picture shows: where it is, how it is turned.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Hit, Ray};

/// A visible place of a surface, turned toward the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfacePoint {
    /// Where it is.
    pub position: DVec3,
    /// The triangle's unit normal, on the viewer's side.
    pub facet: DVec3,
    /// The unit normal to shade with, on the viewer's side.
    pub normal: DVec3,
    /// Where rays to lights start: on the smooth surface that the normals stand for, at or above the triangle.
    pub smooth_position: DVec3,
    /// The unit vector to the viewer.
    pub to_viewer: DVec3,
}

impl SurfacePoint {
    /// The place of a hit on a triangle, with the normals of its corners if there are any.
    pub fn new(corners: &[DVec3; 3], normals: Option<[DVec3; 3]>, ray: &Ray, hit: &Hit) -> Self {
        let to_viewer = -ray.direction();
        let weights = [1.0 - hit.parameters.x - hit.parameters.y, hit.parameters.x, hit.parameters.y];
        let [a, b, c] = *corners;
        let position = a * weights[0] + b * weights[1] + c * weights[2];
        let facet = unit_normal(b - a, c - a).unwrap_or(to_viewer);
        // The side is the hit's, which is exact; the sign of a product may not be at grazing view.
        let side = if hit.back { -1.0 } else { 1.0 };
        let facet = facet * side;
        let Some(normals) = normals else {
            return Self { position, facet, normal: facet, smooth_position: position, to_viewer };
        };
        let turned = normals.map(|normal| {
            let normal = normal.try_normalize().map_or(facet, |normal| normal * side);
            // A normal given the wrong way round.
            if normal.dot(facet) < -0.5 { -normal } else { normal }
        });
        let blended = turned[0] * weights[0] + turned[1] * weights[1] + turned[2] * weights[2];
        let normal = toward(blended.try_normalize().unwrap_or(facet), to_viewer).unwrap_or(facet);
        // Hanika: Hacking the Shadow Terminator, Ray Tracing Gems II, 2021: the place lifted to the corners' tangent
        // planes, so that a coarse convex mesh casts no facets' shadows on itself.
        let lifted = (0..3).fold(position, |lifted, i| {
            let below = (position - corners[i]).dot(turned[i]).min(0.0);
            lifted - turned[i] * (below * weights[i])
        });
        Self { position, facet, normal, smooth_position: lifted, to_viewer }
    }
}

/// The unit normal of the triangle with these two sides from one corner; none without area. Safe for tiny and huge sides.
fn unit_normal(u: DVec3, v: DVec3) -> Option<DVec3> {
    let scale = u.abs().max(v.abs()).max_element();
    (u / scale).cross(v / scale).try_normalize()
}

/// The normal, bent where it looks away from the viewer until it is seen from its edge.
fn toward(normal: DVec3, to_viewer: DVec3) -> Option<DVec3> {
    let facing = normal.dot(to_viewer);
    if facing >= 0.01 { Some(normal) } else { (normal + to_viewer * (0.01 - facing)).try_normalize() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    const CORNERS: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    fn hit(back: bool) -> Hit {
        Hit { distance: 2.0, element: 0, parameters: DVec2::new(0.25, 0.25), back }
    }

    #[test]
    fn normals_face_the_viewer_on_both_sides() {
        let tilted = [DVec3::new(0.1, 0.0, 1.0), DVec3::new(0.4, 0.0, 2.0), DVec3::new(0.0, 0.3, 0.5)];
        for (z, back) in [(2.0, false), (-2.0, true)] {
            let ray = Ray::new(DVec3::new(0.25, 0.25, z), DVec3::Z * -z).unwrap();
            for normals in [None, Some(tilted), Some(tilted.map(|n| -n)), Some([DVec3::ZERO; 3]), Some([DVec3::NAN; 3])]
            {
                let point = SurfacePoint::new(&CORNERS, normals, &ray, &hit(back));
                assert_eq!(point.facet, DVec3::Z * z.signum());
                assert!(point.normal.dot(point.to_viewer) > 0.8, "{normals:?}");
                assert!((point.position - DVec3::new(0.25, 0.25, 0.0)).length() < 1e-15);
            }
        }
    }

    #[test]
    fn normals_that_look_away_are_bent_to_the_outline() {
        let ray = Ray::new(DVec3::new(-3.0, 0.25, 0.2), DVec3::new(3.25, 0.0, -0.2)).unwrap();
        let point = SurfacePoint::new(&CORNERS, Some([DVec3::new(1.0, 0.0, 0.3); 3]), &ray, &hit(false));
        assert!(point.normal.dot(point.to_viewer) > 0.0);
    }

    #[test]
    fn a_triangle_of_a_sphere_is_lifted_outward() {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        let ray = Ray::new(DVec3::splat(3.0), DVec3::NEG_ONE).unwrap();
        let hit = Hit { parameters: DVec2::splat(1.0 / 3.0), ..hit(false) };
        let point = SurfacePoint::new(&corners, Some(corners), &ray, &hit);
        assert!((point.position.length() - (1.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!(point.smooth_position.length() > 0.9 && point.smooth_position.length() <= 1.0 + 1e-12);
        let flat = SurfacePoint::new(&CORNERS, Some([DVec3::Z; 3]), &ray, &hit);
        assert_eq!(flat.position, flat.smooth_position);
    }
}
