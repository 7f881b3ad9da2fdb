//! Where a ray meets a triangle, without gaps between neighbours.
//!
//! Woop, Benthin, Wald: Watertight Ray/Triangle Intersection, JCGT 2013. The corners are sheared so that the ray runs
//! along the third axis through the origin; what remains is a point-in-triangle test in the plane. A corner's image
//! depends on the ray and the corner alone, and the signs of the three edge functions are those of exact arithmetic on
//! the images, so that triangles which share corners tile the plane without a gap, at edges and at corners alike.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use shapeloom_core::predicates::orient2d;

/// A ray prepared for many triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shear {
    origin: DVec3,
    pub axes: [usize; 3],
    pub slope: DVec2,
    stretch: f64,
}

/// Where the line of a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// The distance along the ray, negative behind its origin.
    pub distance: f64,
    /// The weights of the second and third corner.
    pub weights: DVec2,
    /// Whether the ray runs along the triangle's normal.
    pub back: bool,
}

impl Shear {
    /// Prepares the line through `origin` along the unit vector `direction`.
    #[inline(always)]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let z = if size.z >= size.x && size.z >= size.y {
            2
        } else if size.y >= size.x {
            1
        } else {
            0
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // Keeps the orientation of the plane for both senses of the direction.
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        let stretch = 1.0 / direction[z];
        Self { origin, axes: [x, y, z], slope: DVec2::new(direction[x], direction[y]) * stretch, stretch }
    }

    #[inline(always)]
    fn image(&self, corner: DVec3) -> (DVec2, f64) {
        let local = corner - self.origin;
        let [x, y, z] = self.axes;
        let depth = local[z];
        (DVec2::new(local[x] - self.slope.x * depth, local[y] - self.slope.y * depth), depth)
    }

    /// Where the line meets the closed triangle; none beside it and where it is seen from its edge.
    #[inline(always)]
    pub fn cross(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let (a, depth_a) = self.image(corners[0]);
        let (b, depth_b) = self.image(corners[1]);
        let (c, depth_c) = self.image(corners[2]);
        let u = edge(b, c);
        let v = edge(c, a);
        if (u < 0.0 && v > 0.0) || (u > 0.0 && v < 0.0) {
            return None;
        }
        let w = edge(a, b);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let area = u + v + w;
        if area == 0.0 {
            return None;
        }
        let (u, v, w) = (u / area, v / area, w / area);
        let distance = (u * depth_a + v * depth_b + w * depth_c) * self.stretch;
        // Also refuses overflow and NaN from the far ends of the number range.
        distance.is_finite().then_some(Crossing { distance, weights: DVec2::new(v, w), back: area > 0.0 })
    }
}

/// The cross product `p × q` with the sign of exact arithmetic.
#[inline(always)]
fn edge(p: DVec2, q: DVec2) -> f64 {
    let (left, right) = (p.x * q.y, p.y * q.x);
    let value = left - right;
    // Each product and the difference round by at most 2^-53 relatively; four times that is safe.
    if value.abs() > 4.5e-16 * (left.abs() + right.abs()) { value } else { exact_edge(p, q, value) }
}

#[cold]
fn exact_edge(p: DVec2, q: DVec2, value: f64) -> f64 {
    // Where rounding lost the sign, the size is noise: a number so small gives its corner no weight beside others.
    const NOISE: f64 = 1e-200;
    match orient2d(DVec2::ZERO, p, q) {
        Ordering::Equal => 0.0,
        Ordering::Greater if value > 0.0 => value,
        Ordering::Less if value < 0.0 => value,
        Ordering::Greater => NOISE,
        Ordering::Less => -NOISE,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [DVec3; 3] = [DVec3::ZERO, DVec3::X, DVec3::Y];

    #[test]
    fn a_known_crossing_has_its_distance_weights_and_side() {
        let down = Shear::new(DVec3::new(0.25, 0.5, 3.0), DVec3::NEG_Z).cross(&UNIT).unwrap();
        assert_eq!(down, Crossing { distance: 3.0, weights: DVec2::new(0.25, 0.5), back: false });
        let up = Shear::new(DVec3::new(0.25, 0.5, 3.0), DVec3::Z).cross(&UNIT).unwrap();
        assert_eq!(up, Crossing { distance: -3.0, weights: DVec2::new(0.25, 0.5), back: true });
        for axis in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y] {
            assert_eq!(Shear::new(DVec3::new(0.2, 0.2, 0.0), axis).cross(&UNIT), None);
        }
    }

    #[test]
    fn the_crossing_lies_on_the_triangle_for_all_directions() {
        let corners = [DVec3::new(1.0, 0.1, 0.0), DVec3::new(-0.3, 1.2, 0.1), DVec3::new(0.2, -0.1, 1.5)];
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        for i in 0..64 {
            let angle = f64::from(i);
            let inside = corners[0] * 0.5 + corners[1] * 0.2 + corners[2] * 0.3;
            let direction = DVec3::new(angle.cos(), (angle * 1.7).sin(), (angle * 0.3).sin()).normalize();
            let found = Shear::new(inside - direction * 2.0, direction).cross(&corners).unwrap();
            assert!((found.distance - 2.0).abs() < 1e-13 && (found.weights - DVec2::new(0.2, 0.3)).length() < 1e-12);
            assert_eq!(found.back, normal.dot(direction) > 0.0);
        }
    }

    #[test]
    fn points_of_edges_and_corners_belong_to_the_triangle() {
        for point in [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.0, 0.3, 0.0)] {
            assert!(Shear::new(point + DVec3::Z, DVec3::NEG_Z).cross(&UNIT).is_some(), "{point}");
        }
    }

    #[test]
    fn triangles_without_area_and_wild_numbers_are_missed() {
        let line = [DVec3::ZERO, DVec3::X, DVec3::X * 2.0];
        assert_eq!(Shear::new(DVec3::new(0.5, 0.0, 1.0), DVec3::NEG_Z).cross(&line), None);
        assert_eq!(Shear::new(DVec3::splat(1e308), DVec3::NEG_Z).cross(&[DVec3::splat(-1e308); 3]), None);
    }
}
