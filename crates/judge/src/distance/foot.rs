//! Distances from a point to one triangle, and what rounding can do to them.
//!
//! Everything here is in scaled units, in which no coordinate exceeds 1 in magnitude.

use shapeloom_core::glam::DVec3;

/// What rounding adds at most to a distance to a point of a triangle: the point itself is off by less than eight
/// roundings of numbers below 2, each at most 2^-53, in each of three coordinates.
pub(super) const PAD: f64 = 1.0 / (1u64 << 48) as f64;

/// The relative rounding of a length: three products, two sums and a root, with room to spare.
const LENGTH: f64 = 1.0 + 1.0 / (1u64 << 50) as f64;

/// A computed distance to a computed point of a triangle, rounded up so that the true distance is no larger.
pub(super) fn up(distance: f64) -> f64 {
    distance * LENGTH + PAD
}

/// No less than the length of a vector: squares of coordinates below about 1e-154 vanish, those of zero alone are nothing.
pub(super) fn length_up(v: DVec3) -> f64 {
    if v == DVec3::ZERO { 0.0 } else { v.length() * LENGTH + VANISHING }
}

/// More than a length whose square vanishes or is rounded with it, and far below all other rounding.
const VANISHING: f64 = 1e-150;

/// No less than the distance from a point to a triangle; 0 where the point is one of the corners.
///
/// The foot on the plane where it falls inside, else the nearest of the sides: each is a point of the triangle, so that
/// thin triangles and those without area give true bounds, if not the best ones.
pub(super) fn distance_to_triangle(corners: &[DVec3; 3], query: DVec3) -> f64 {
    if corners.contains(&query) {
        return 0.0;
    }
    let [a, b, c] = *corners;
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let (area, from) = (normal.length_squared(), query - a);
    let (v, w) = (from.cross(ac).dot(normal), ab.cross(from).dot(normal));
    let u = area - v - w;
    if u > 0.0 && v > 0.0 && w > 0.0 {
        let (v, w) = (v / area, w / area);
        return up((query - (a + ab * v + ac * w)).length());
    }
    // The nearest point lies on a side beyond which the query is; of a triangle without area, on any.
    let all = area <= 0.0;
    let mut squared = f64::INFINITY;
    if u <= 0.0 || all {
        squared = to_segment(b, c - b, query);
    }
    if v <= 0.0 || all {
        squared = squared.min(to_segment(a, ac, query));
    }
    if w <= 0.0 || all {
        squared = squared.min(to_segment(a, ab, query));
    }
    up(squared.sqrt())
}

/// The squared distance to a point of a segment that is all but the nearest.
fn to_segment(start: DVec3, along: DVec3, query: DVec3) -> f64 {
    let from = query - start;
    let t = from.dot(along) / along.length_squared();
    let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
    (query - (start + along * t)).length_squared()
}

/// How far in the plane of a triangle the computed closest point may be from the true one: by the rounding of the
/// barycentric weights, which grows with the square of the triangle's aspect, and never by more than its smallest
/// altitude, because the closest points of its sides are candidates too.
///
/// A table over the distance, in steps of 16.
#[derive(Clone, Debug)]
pub(super) struct FootError([f64; Self::STEPS]);

impl FootError {
    const STEPS: usize = 16;
    /// Errors of two cross products and two scalar products, counted generously.
    const ROUNDING: f64 = 64.0 / (1u64 << 53) as f64;

    pub(super) fn none() -> Self {
        Self([0.0; Self::STEPS])
    }

    /// The distance up to which a step of the table holds: 4 for the first, which no distance exceeds.
    fn reach(step: usize) -> f64 {
        4.0 / (1u64 << (4 * step)) as f64
    }

    pub(super) fn include(&mut self, [a, b, c]: &[DVec3; 3]) {
        let (ab, ac, bc) = (*b - *a, *c - *a, *c - *b);
        let longest = ab.length().max(ac.length()).max(bc.length());
        if longest == 0.0 {
            return;
        }
        let altitude = ab.cross(ac).length() / longest + Self::ROUNDING * longest;
        let aspect = longest / altitude;
        for (step, error) in self.0.iter_mut().enumerate() {
            let rounding = Self::ROUNDING * aspect * aspect * (Self::reach(step) + longest);
            *error = error.max(rounding.min(altitude));
        }
    }

    pub(super) fn union(mut self, other: &Self) -> Self {
        for (error, other) in self.0.iter_mut().zip(&other.0) {
            *error = error.max(*other);
        }
        self
    }

    /// No more than the distance of which the computed one is `distance`.
    pub(super) fn down(&self, distance: f64) -> f64 {
        if !distance.is_finite() {
            return 0.0;
        }
        let step = (1..Self::STEPS).rev().find(|&step| distance <= Self::reach(step)).unwrap_or(0);
        let error = self.0[step];
        let squared = distance * distance * (2.0 - LENGTH) - error * error;
        if squared > 0.0 { (squared.sqrt() * (2.0 - LENGTH) - PAD).max(0.0) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_region_has_its_known_distance() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (query, distance) in [
            (DVec3::new(0.25, 0.25, -0.5), 0.5),
            (DVec3::new(-0.3, -0.4, 0.0), 0.5),
            (DVec3::new(0.5, -0.25, 0.0), 0.25),
            (DVec3::new(1.0, 1.0, 0.0), 0.5f64.sqrt()),
            (DVec3::new(1.0, -0.5, 0.0), 0.5),
        ] {
            let found = distance_to_triangle(&corners, query);
            assert!(found >= distance && found <= distance + 1e-14, "{query}: {found}");
        }
        assert_eq!(distance_to_triangle(&corners, DVec3::X), 0.0);
        let segment = [DVec3::ZERO, DVec3::X, DVec3::X];
        assert!((distance_to_triangle(&segment, DVec3::new(0.5, 0.5, 0.0)) - 0.5).abs() < 1e-14);
        assert!((distance_to_triangle(&[DVec3::ZERO; 3], DVec3::Z) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn well_shaped_triangles_lose_little_and_slivers_no_more_than_their_width() {
        let mut good = FootError::none();
        good.include(&[DVec3::ZERO, DVec3::X, DVec3::Y]);
        assert!(good.down(0.1) < 0.1 && good.down(0.1) > 0.1 - 1e-13);
        assert!(good.down(1e-6) > 1e-6 - 1e-13 && good.down(0.0) == 0.0);
        let mut sliver = FootError::none();
        sliver.include(&[DVec3::ZERO, DVec3::X, DVec3::new(0.5, 1e-6, 0.0)]);
        assert!(sliver.down(0.1) > 0.1 - 1e-11 && sliver.down(1e-7) == 0.0);
        let both = good.clone().union(&sliver);
        assert_eq!(both.down(0.1), sliver.down(0.1).min(good.down(0.1)));
    }
}
