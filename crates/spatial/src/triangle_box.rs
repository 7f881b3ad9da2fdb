//! Whether a triangle meets a box, exactly.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use shapeloom_core::Aabb;
use shapeloom_core::predicates::{orient2d, orient3d};

/// Whether a closed triangle and a closed box have a point in common, decided exactly; touching counts. Triangles may
/// be segments or points.
///
/// Separating axes (Akenine-Möller 2001): if the two are apart, they are so along a side of the box, along the
/// triangle's normal, or along the normal of one of its sides seen along an axis. Each is a comparison, or a sign of
/// the exact predicates on the coordinates as given.
pub(crate) fn triangle_meets_box(corners: &[DVec3; 3], region: &Aabb) -> bool {
    let [a, b, c] = *corners;
    if region.is_empty() || a.min(b).min(c).cmpgt(region.max).any() || a.max(b).max(c).cmplt(region.min).any() {
        return false;
    }
    if corners.iter().any(|&corner| region.contains(corner)) {
        return true;
    }
    for axis in 0..3 {
        let flat = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
        let triangle = corners.map(flat);
        let (low, high) = (flat(region.min), flat(region.max));
        let rectangle = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        for side in 0..3 {
            let (p, q, other) = (triangle[side], triangle[(side + 1) % 3], triangle[(side + 2) % 3]);
            let beyond = rectangle.map(|corner| orient2d(p, q, corner));
            // All on one side of the line, and the triangle is not there.
            let inner = orient2d(p, q, other);
            let apart = |outer: Ordering| beyond.iter().all(|&on| on == outer) && inner != outer;
            if apart(Ordering::Greater) || apart(Ordering::Less) {
                return false;
            }
        }
    }
    let sides = region.corners().map(|corner| orient3d(a, b, c, corner));
    !(sides.iter().all(|&on| on == Ordering::Greater) || sides.iter().all(|&on| on == Ordering::Less))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    /// What is left of a triangle within a box, by clipping at its six planes in exact integers scaled by their
    /// denominators: none if apart.
    fn clipped(corners: &[DVec3; 3], region: &Aabb) -> bool {
        // Rational coordinates with a common denominator; few bits each, so that i128 holds all.
        let mut polygon: Vec<([i128; 3], i128)> =
            corners.iter().map(|c| (c.to_array().map(|x| x as i128), 1)).collect();
        for axis in 0..3 {
            for (sign, limit) in [(1, region.max[axis] as i128), (-1, -region.min[axis] as i128)] {
                let depth = |(p, w): &([i128; 3], i128)| limit * w - sign * p[axis];
                let mut next = Vec::new();
                for n in 0..polygon.len() {
                    let (p, q) = (&polygon[n], &polygon[(n + 1) % polygon.len()]);
                    let (dp, dq) = (depth(p), depth(q));
                    if dp >= 0 {
                        next.push(*p);
                    }
                    if (dp > 0 && dq < 0) || (dp < 0 && dq > 0) {
                        // dp and dq are scaled by their own denominators.
                        let (s, t) = (dp * q.1, dq * p.1);
                        let mix = |a: i128, b: i128| a * q.1 * t - b * p.1 * s;
                        let point: [i128; 3] = std::array::from_fn(|i| mix(p.0[i], q.0[i]));
                        let w = p.1 * q.1 * (t - s);
                        let g = [point[0], point[1], point[2], w].into_iter().fold(0i128, gcd).max(1);
                        let g = if w < 0 { -g } else { g };
                        next.push((point.map(|x| x / g), w / g));
                    }
                }
                polygon = next;
            }
        }
        !polygon.is_empty()
    }

    fn gcd(a: i128, b: i128) -> i128 {
        let (mut a, mut b) = (a.abs(), b.abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        a
    }

    #[test]
    fn agrees_with_clipping_in_integers() {
        let mut draws = Draws::new(3);
        let mut met = 0;
        for round in 0..20_000 {
            let size = if round % 3 == 0 { 3.0 } else { 8.0 };
            let mut point = || (draws.point() * size).round();
            let corners = [point(), point(), point()];
            let region = Aabb::from_corners(point(), point());
            let wanted = clipped(&corners, &region);
            assert_eq!(triangle_meets_box(&corners, &region), wanted, "{corners:?} {region:?}");
            met += usize::from(wanted);
        }
        assert!((2000..18_000).contains(&met), "{met}");
    }
}
