//! Solid angles of near triangles, around eight samples at once.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use multiversion::multiversion;
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};

use super::near_triangle::LANES;

/// Eight places by axis.
pub(super) type Places = [[f64; LANES]; 3];

/// How many factors are multiplied before the product is brought back to a size of about 1: each is between 1e-40 and 1e50.
const FACTORS: usize = 4;

/// What one triangle's share is wrong by at most where it was not looked at alone, in turns: rounding is below 91 u of the product of
/// lengths (see [`turns`]), the tangent's terms are above 2⁻²⁰ of it.
const ROUNDING: f64 = 1.0 / (1u64 << 28) as f64;

/// How often some triangles wind around places, solid angles over 4π, and what that may be wrong by: infinity where a place is on
/// the border of a triangle.
///
/// A triangle's angle is twice that of the number den + i det (Van Oosterom and Strackee 1983), so all angles together are twice that
/// of the product of these numbers, whole turns being counted on the way: no arctangent is needed for each. Places in a triangle
/// itself are seen as [`Rows`](super::rows::Rows) sees them: moved by something infinitely small.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn turns_around(all: &[[DVec3; 3]], some: &[u32], places: &Places) -> ([f64; LANES], [f64; LANES]) {
    let (mut re, mut im, mut whole) = ([1.0; LANES], [0.0; LANES], [0.0; LANES]);
    let (mut alone, mut errors) = ([0.0; LANES], [0.0; LANES]);
    for part in some.chunks(FACTORS) {
        for &triangle in part {
            let Some(corners) = all.get(triangle as usize) else { continue };
            let [a, b, c] = corners;
            let mut factors = [[0.0; LANES]; 2];
            let mut doubtful = [false; LANES];
            for lane in 0..LANES {
                let [x, y, z] = [places[0][lane], places[1][lane], places[2][lane]];
                let [ax, ay, az] = [a.x - x, a.y - y, a.z - z];
                let [bx, by, bz] = [b.x - x, b.y - y, b.z - z];
                let [cx, cy, cz] = [c.x - x, c.y - y, c.z - z];
                let la = (ax * ax + ay * ay + az * az).sqrt();
                let lb = (bx * bx + by * by + bz * bz).sqrt();
                let lc = (cx * cx + cy * cy + cz * cz).sqrt();
                let ab = ax * bx + ay * by + az * bz;
                let bc = bx * cx + by * cy + bz * cz;
                let ca = cx * ax + cy * ay + cz * az;
                let product = la * lb * lc;
                let det = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
                let den = product + ab * lc + bc * la + ca * lb;
                let is_clear = (den > BORDER * product)
                    | ((det.abs() > PLANE * product) & ((den < -BORDER * product) | (det.abs() > BORDER * product)));
                doubtful[lane] = !is_clear;
                factors[0][lane] = if is_clear { den } else { 1.0 };
                factors[1][lane] = if is_clear { det } else { 0.0 };
            }
            if doubtful != [false; LANES] {
                for lane in (0..LANES).filter(|&lane| doubtful[lane]) {
                    let place = DVec3::new(places[0][lane], places[1][lane], places[2][lane]);
                    let (turns, error) = turns(corners, place);
                    alone[lane] += turns;
                    errors[lane] += error;
                }
            }
            for lane in 0..LANES {
                let (x, y) = (factors[0][lane], factors[1][lane]);
                let (u, v) = (re[lane], im[lane]);
                let (p, q) = (u * x - v * y, u * y + v * x);
                // Both angles are between -π and π; where the sum leaves that, the product's angle is back on the other side.
                let above = (v >= 0.0) & (y >= 0.0) & (q < 0.0);
                let below = (v < 0.0) & (y < 0.0) & (q >= 0.0);
                whole[lane] += if above { 1.0 } else { 0.0 } - if below { 1.0 } else { 0.0 };
                re[lane] = p;
                im[lane] = q;
            }
        }
        for lane in 0..LANES {
            let scale = 1.0 / (re[lane].abs() + im[lane].abs());
            re[lane] *= scale;
            im[lane] *= scale;
        }
    }
    let rounding = some.len() as f64 * ROUNDING;
    for lane in 0..LANES {
        alone[lane] += whole[lane] + im[lane].atan2(re[lane]) * (1.0 / TAU);
        errors[lane] += rounding;
    }
    (alone, errors)
}

/// Where the denominator is below this part of the product of lengths the place is near the border of a triangle or in it.
const BORDER: f64 = 1.0 / (1u64 << 20) as f64;

/// Where the determinant is below this part of the product of lengths rounding may decide on which side of a triangle a place is.
const PLANE: f64 = 1.0 / (1u64 << 45) as f64;

/// The same for one triangle and one place, more exactly.
///
/// With u = 2⁻⁵³ the determinant is wrong by at most 14 u, the denominator by 56 u of the product of lengths, so the angle of both by
/// 91 u of it over their length. In whole turns 2⁻⁴⁸ and 2⁻⁵¹ for the arctangent hold that. The side is decided exactly.
pub(super) fn turns(corners: &[DVec3; 3], place: DVec3) -> (f64, f64) {
    let [a, b, c] = corners.map(|corner| corner - place);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let product = la * lb * lc;
    let det = a.dot(b.cross(c));
    let den = product + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    // NaN, where the place is a corner, becomes 1/2 by `min`.
    let error = (2f64.powi(-48) * product / det.hypot(den) + 2f64.powi(-51)).min(0.5);
    if det.abs() > PLANE * product || den > BORDER * product {
        return (det.atan2(den) / TAU, error);
    }
    let size = det.abs().atan2(den) / TAU;
    match orient3d(corners[0], corners[1], corners[2], place) {
        Ordering::Less => (size, error),
        Ordering::Greater => (-size, error),
        Ordering::Equal => in_plane(corners, place),
    }
}

/// The same for a place in the triangle's plane: moved against x, then along y, then along z by something ever smaller, as rows of
/// samples along x are. Then it is on one side wholly, if it is in the triangle.
fn in_plane(corners: &[DVec3; 3], place: DVec3) -> (f64, f64) {
    let turn = |axis: usize, [a, b, c]: [DVec3; 3]| {
        let flat = |p: DVec3| DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]);
        orient2d(flat(a), flat(b), flat(c))
    };
    let [a, b, c] = *corners;
    for (axis, moved_up) in [(0, false), (1, true), (2, true)] {
        let front = turn(axis, *corners);
        if front == Ordering::Equal {
            continue;
        }
        let sides = [[a, b, place], [b, c, place], [c, a, place]].map(|side| turn(axis, side));
        if sides.contains(&front.reverse()) {
            return (0.0, 0.0);
        }
        if sides.contains(&Ordering::Equal) {
            return (0.0, f64::INFINITY);
        }
        // In front of a triangle the winding number is smaller by 1/2, behind it larger.
        let in_front = (front == Ordering::Greater) == moved_up;
        return (if in_front { -0.5 } else { 0.5 }, 0.0);
    }
    // A triangle without area is not seen.
    (0.0, 0.0)
}
