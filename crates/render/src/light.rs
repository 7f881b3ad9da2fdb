//! The lights of the studio: a soft key from the upper left, a fill from the right, a bright ceiling over a warm floor.

use shapeloom_core::Camera;
use shapeloom_core::glam::DVec3;

use crate::surface_point::SurfacePoint;

/// Light of the key on a surface that faces it.
const KEY: DVec3 = DVec3::new(1.16, 1.09, 1.00);
/// Light of the fill.
const FILL: DVec3 = DVec3::new(0.13, 0.15, 0.18);
/// Light from above, on a surface that faces up.
const CEILING: DVec3 = DVec3::new(0.36, 0.40, 0.46);
/// Light from below.
const FLOOR: DVec3 = DVec3::new(0.17, 0.155, 0.14);
/// The slope of the cone in which the key's surface is seen: soft shadows.
pub(crate) const KEY_SLOPE: f64 = 0.16;

/// Lights that stand with the camera, upright.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lights {
    /// The unit vector to the key light.
    pub key: DVec3,
    fill: DVec3,
    up: DVec3,
}

/// Light from a place, in the parts that are shadowed apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parts {
    /// From everywhere around.
    pub ambient: DVec3,
    /// From the key light.
    pub key: DVec3,
}

impl Lights {
    /// The lights for a camera; `up` is a unit vector.
    pub fn new(camera: &Camera, up: DVec3) -> Self {
        let [right, above, backward] = camera.axes();
        // Seen from straight above or below, the picture's up is what lies level.
        let level = |direction: DVec3| direction.reject_from_normalized(up).try_normalize();
        let front = level(backward).or(level(-above)).unwrap_or(backward);
        Self {
            key: (right * -0.62 + up * 0.95 + front * 0.60).normalize(),
            fill: (right * 0.85 + up * 0.25 + front * 0.45).normalize(),
            up,
        }
    }

    /// Light from a place of this colour, unshadowed; `gloss` adds the shine of a glaze.
    pub fn shade(&self, point: &SurfacePoint, color: DVec3, gloss: bool) -> Parts {
        let normal = point.normal;
        let sky = 0.5 + 0.5 * normal.dot(self.up);
        let around = FLOOR + (CEILING - FLOOR) * sky + FILL * normal.dot(self.fill).max(0.0);
        let facing_key = normal.dot(self.key).max(0.0);
        let mut parts = Parts { ambient: color * around, key: color * KEY * facing_key };
        if gloss {
            let facing = normal.dot(point.to_viewer).clamp(0.0, 1.0);
            // Schlick 1994, for glass.
            let fresnel = 0.04 + 0.96 * (1.0 - facing).powi(5);
            let mirrored = normal * (2.0 * facing) - point.to_viewer;
            let height = (0.5 + 0.6 * mirrored.dot(self.up)).clamp(0.0, 1.0);
            let seen = FLOOR + (CEILING * 2.2 - FLOOR) * (height * height * (3.0 - 2.0 * height));
            // The room's mirror image fades toward the outline, where a real one would show what stands behind.
            parts.ambient += seen * (fresnel.min(0.35) * 0.9);
            let half = (self.key + point.to_viewer).normalize_or_zero();
            let along = normal.dot(half).max(0.0);
            // Blinn 1977 with two widths: a sharp highlight in a soft bloom.
            let highlight = 0.75 * along.powi(260) + 0.10 * along.powi(24);
            parts.key += KEY * (highlight * (facing_key * 6.0).min(1.0));
        }
        parts
    }
}

/// The colour of back faces: far from the front's.
pub(crate) fn back_color(front: DVec3) -> DVec3 {
    const RED: DVec3 = DVec3::new(0.62, 0.085, 0.10);
    const TEAL: DVec3 = DVec3::new(0.03, 0.36, 0.42);
    if front.distance_squared(RED) >= front.distance_squared(TEAL) { RED } else { TEAL }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Projection;

    #[test]
    fn lights_stand_above_and_before_the_shape() {
        for eye in [DVec3::new(3.0, -4.0, 2.0), DVec3::new(0.0, -1e-9, 5.0), DVec3::new(1.0, 1.0, -3.0)] {
            let camera = Camera::look_at(eye, DVec3::ZERO, DVec3::Y, Projection::Perspective { fov_y: 0.5 }).unwrap();
            let lights = Lights::new(&camera, DVec3::Z);
            assert!(lights.key.z > 0.5 && lights.key.dot(camera.axes()[0]) < -0.3);
            assert!((lights.key.length() - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn back_faces_differ_from_any_front() {
        for front in [DVec3::ONE, DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.6, 0.1, 0.1)] {
            assert!(back_color(front).distance(front) > 0.3);
        }
    }
}
