//! Signs of determinants, decided exactly (Shewchuk 1997, through the `robust` crate).
//!
//! Exact as long as no intermediate product overflows or underflows: coordinates between about 1e-70 and 1e70 in
//! magnitude, or zero, are safe for every predicate here.

use std::cmp::Ordering;

use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D};

fn flat(p: DVec2) -> Coord<f64> {
    Coord { x: p.x, y: p.y }
}

fn solid(p: DVec3) -> Coord3D<f64> {
    Coord3D { x: p.x, y: p.y, z: p.z }
}

fn sign(value: f64) -> Ordering {
    value.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// `Greater` when `a`, `b`, `c` turn counter-clockwise, `Less` when clockwise, `Equal` when collinear.
pub fn orient2d(a: DVec2, b: DVec2, c: DVec2) -> Ordering {
    sign(robust::orient2d(flat(a), flat(b), flat(c)))
}

/// Twice the signed area of the triangle `a`, `b`, `c`, rounded: its sign is that of [`orient2d`], exactly, and where the
/// terms nearly cancel more of its bits are right than of a plain difference of products.
pub fn doubled_area(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    robust::orient2d(flat(a), flat(b), flat(c))
}

/// On which side of the plane through `a`, `b`, `c` the point `d` lies: `Greater` on the side of the normal
/// `(b - a) × (c - a)`, `Less` on the other, `Equal` in the plane.
pub fn orient3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> Ordering {
    // Shewchuk's sign is positive below the plane.
    sign(robust::orient3d(solid(a), solid(b), solid(c), solid(d))).reverse()
}

/// `Greater` when `d` lies inside the circle through the counter-clockwise `a`, `b`, `c`.
pub fn in_circle(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Ordering {
    sign(robust::incircle(flat(a), flat(b), flat(c), flat(d)))
}

/// `Greater` when `e` lies inside the sphere through `a`, `b`, `c`, `d`, where `d` is on the side of the normal of
/// `a`, `b`, `c` ([`orient3d`] `Greater`).
pub fn in_sphere(a: DVec3, b: DVec3, c: DVec3, d: DVec3, e: DVec3) -> Ordering {
    sign(robust::insphere(solid(a), solid(b), solid(c), solid(d), solid(e))).reverse()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_follow_the_documentation() {
        let (a, b, c) = (DVec3::ZERO, DVec3::X, DVec3::Y);
        assert_eq!(orient3d(a, b, c, DVec3::Z), Ordering::Greater);
        assert_eq!(orient3d(a, b, c, -DVec3::Z), Ordering::Less);
        assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y), Ordering::Greater);
        assert_eq!(in_circle(DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::splat(0.4)), Ordering::Greater);
        assert_eq!(in_circle(DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE), Ordering::Equal);
        assert_eq!(in_sphere(a, b, c, DVec3::Z, DVec3::splat(0.2)), Ordering::Greater);
        assert_eq!(in_sphere(a, b, c, DVec3::Z, DVec3::splat(2.0)), Ordering::Less);
    }

    /// The 2D sign in exact integer arithmetic on a fine grid around a line, where rounding would fail.
    #[test]
    fn agrees_with_integers_near_a_line() {
        let unit = 2f64.powi(-53);
        for i in 0..64i128 {
            for j in 0..64i128 {
                let a = DVec2::new(0.5 + i as f64 * unit, 0.5 + j as f64 * unit);
                let (b, c) = (DVec2::splat(12.0), DVec2::splat(24.0));
                let half = 1i128 << 52;
                let (ax, ay) = (half + i, half + j);
                let (bx, cx) = (12i128 << 53, 24i128 << 53);
                let exact = (ax - cx) * (bx - cx) - (ay - cx) * (bx - cx);
                assert_eq!(orient2d(a, b, c), exact.cmp(&0), "{i} {j}");
                // In units of 2^-106, and to the last bits where a plain difference has none.
                let found = doubled_area(a, b, c) * 2f64.powi(106);
                assert!((found - exact as f64).abs() <= 1e-9 * exact.unsigned_abs() as f64, "{i} {j}");
            }
        }
    }

    #[test]
    fn nan_decides_nothing_and_does_not_panic() {
        assert_eq!(orient2d(DVec2::NAN, DVec2::X, DVec2::Y), Ordering::Equal);
    }
}
