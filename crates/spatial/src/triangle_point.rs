//! The point of a triangle closest to a place.

use glam::{DVec2, DVec3};

/// The closest point of a triangle: the point, its squared distance, the weights of the second and third corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foot {
    pub point: DVec3,
    pub distance_squared: f64,
    pub weights: DVec2,
}

/// The point of the closed triangle closest to `query`.
///
/// The minimum over the three sides and, where the plane's foot falls inside, that foot. Each candidate is a point of
/// the triangle whatever rounding does, so thin triangles and those without area get a true distance to a true point.
#[inline(always)]
pub(crate) fn closest_on_triangle(corners: &[DVec3; 3], query: DVec3) -> Foot {
    let [a, b, c] = *corners;
    let (ab, ac, bc) = (b - a, c - a, c - b);
    let (aq, bq) = (query - a, query - b);
    let on_ab = fraction(ab, aq);
    let on_ac = fraction(ac, aq);
    let on_bc = fraction(bc, bq);
    let foot = |point: DVec3, v: f64, w: f64| Foot {
        point,
        distance_squared: (query - point).length_squared(),
        weights: DVec2::new(v, w),
    };
    let mut best = foot(between(a, b, on_ab), on_ab, 0.0);
    for other in [foot(between(a, c, on_ac), 0.0, on_ac), foot(between(b, c, on_bc), 1.0 - on_bc, on_bc)] {
        if other.distance_squared < best.distance_squared {
            best = other;
        }
    }
    let normal = ab.cross(ac);
    let area = normal.length_squared();
    if area > 0.0 {
        let v = aq.cross(ac).dot(normal) / area;
        let w = ab.cross(aq).dot(normal) / area;
        if v > 0.0 && w > 0.0 && v + w < 1.0 {
            let inside = foot(a + ab * v + ac * w, v, w);
            if inside.distance_squared < best.distance_squared {
                best = inside;
            }
        }
    }
    best
}

/// Where along a side the foot of a point falls, in `[0, 1]`; 0 on a side of no length.
#[inline(always)]
fn fraction(side: DVec3, from_start: DVec3) -> f64 {
    let t = from_start.dot(side) / side.length_squared();
    if t > 0.0 { t.min(1.0) } else { 0.0 }
}

/// The point at a fraction, exactly an end at 0 and 1.
#[inline(always)]
fn between(start: DVec3, end: DVec3, fraction: f64) -> DVec3 {
    if fraction == 1.0 { end } else { start + (end - start) * fraction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    #[test]
    fn each_region_has_its_known_answer() {
        let corners = [DVec3::ZERO, DVec3::X * 4.0, DVec3::Y * 4.0];
        for (query, point) in [
            (DVec3::new(1.0, 1.0, 5.0), DVec3::new(1.0, 1.0, 0.0)),
            (DVec3::new(-1.0, -2.0, 1.0), DVec3::ZERO),
            (DVec3::new(2.0, -3.0, 0.0), DVec3::new(2.0, 0.0, 0.0)),
            (DVec3::new(-3.0, 2.0, 0.0), DVec3::new(0.0, 2.0, 0.0)),
            (DVec3::new(4.0, 4.0, 0.0), DVec3::new(2.0, 2.0, 0.0)),
            (DVec3::new(9.0, 0.0, 0.0), DVec3::X * 4.0),
            (DVec3::new(0.0, 9.0, 0.0), DVec3::Y * 4.0),
        ] {
            let found = closest_on_triangle(&corners, query);
            assert!((found.point - point).length() < 1e-15, "{query}");
            let again = corners[1] * found.weights.x + corners[2] * found.weights.y;
            assert!((again - point).length() < 1e-14, "{query}");
        }
    }

    #[test]
    fn no_sampled_point_is_closer() {
        let mut draws = Draws::new(3);
        for _ in 0..300 {
            let corners: [DVec3; 3] = std::array::from_fn(|_| draws.point());
            let query = draws.point() * 2.0;
            let found = closest_on_triangle(&corners, query);
            for i in 0..=20 {
                for j in 0..=20 - i {
                    let (v, w) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                    let sample = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
                    assert!((query - sample).length_squared() >= found.distance_squared - 1e-14);
                }
            }
        }
    }

    #[test]
    fn triangles_without_area_are_segments_and_points() {
        let segment = [DVec3::ZERO, DVec3::X, DVec3::X * 3.0];
        assert_eq!(closest_on_triangle(&segment, DVec3::new(2.5, 2.0, 0.0)).distance_squared, 4.0);
        assert_eq!(closest_on_triangle(&[DVec3::ONE; 3], DVec3::ZERO).distance_squared, 3.0);
    }
}
