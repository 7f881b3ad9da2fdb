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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Dice, soup, torus};
    use shapeloom_core::Exec;
    use shapeloom_spatial::generalized_winding_number;

    /// Products of many factors against sums of angles: whole turns included.
    #[test]
    fn products_wind_as_often_as_sums_of_angles() {
        let mut dice = Dice(12);
        // Triangles on triangles and turned ones: many turns, both ways.
        let many = |count: usize, flip: bool| {
            let [a, b, c] = [DVec3::X, DVec3::Y, DVec3::Z];
            vec![if flip { [a, c, b] } else { [a, b, c] }; count]
        };
        let of = |mesh: shapeloom_mesh::TriMesh| (0..mesh.triangles().len()).map(|i| mesh.corners(i)).collect();
        let sets: Vec<Vec<[DVec3; 3]>> =
            vec![of(soup(90, 0.9, 5)), of(torus(20, 9)), many(50, false), many(51, true), vec![]];
        let mut most = 0f64;
        for set in sets {
            let some: Vec<u32> = (0..set.len() as u32).collect();
            for _ in 0..60 {
                let lanes: [DVec3; LANES] =
                    std::array::from_fn(
                        |lane| {
                            if lane < 4 { dice.point() } else { DVec3::splat(0.33) + dice.point() * 0.01 }
                        },
                    );
                let places = [0, 1, 2].map(|axis| lanes.map(|place| place[axis]));
                let (found, errors) = turns_around(&set, &some, &places);
                for (lane, place) in lanes.into_iter().enumerate() {
                    let positions = set.as_flattened();
                    let indices: Vec<[u32; 3]> = some.iter().map(|&i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                    let exact = generalized_winding_number(positions, &indices, place, &Exec::default()).unwrap();
                    assert!(
                        (found[lane] - exact.value).abs() <= errors[lane] + exact.bound,
                        "{} {exact:?}",
                        found[lane]
                    );
                    assert!(errors[lane] < 1e-5);
                    most = most.max(exact.value.abs());
                }
            }
        }
        assert!(most > 20.0, "{most}");
    }

    /// Places in a triangle are on the side where moving them a little puts them; beside it they see nothing of it, on its border they
    /// are told.
    #[test]
    fn places_in_a_triangle_are_moved_a_little() {
        let moved = DVec3::new(-1e-3, 1e-5, 1e-7);
        for axis in 0..4 {
            // Planes across an axis and one aslant.
            let turned = |p: DVec3| match axis {
                3 => DVec3::new(p.x, p.y, p.x + p.y),
                axis => DVec3::from_array([0, 1, 2].map(|i| p[(i + axis) % 3])),
            };
            for flip in [false, true] {
                let mut corners = [DVec3::ZERO, DVec3::new(8.0, 0.0, 0.0), DVec3::new(0.0, 8.0, 0.0)].map(turned);
                if flip {
                    corners.swap(0, 1);
                }
                for (at, inside) in [([2.0, 3.0], true), ([1.0, 1.0], true), ([9.0, 2.0], false), ([-1.0, 0.0], false)]
                {
                    let place = turned(DVec3::new(at[0], at[1], 0.0));
                    let (found, error) = turns(&corners, place);
                    let (wanted, _) = turns(&corners, place + moved);
                    assert_eq!(found.abs(), if inside { 0.5 } else { 0.0 }, "{axis}");
                    assert!(error < 1e-14, "{axis}: {error}");
                    assert!((found - wanted).abs() < 0.01, "{axis}: {found} {wanted}");
                }
                for at in [[4.0, 0.0], [0.0, 0.0], [4.0, 4.0]] {
                    assert_eq!(turns(&corners, turned(DVec3::new(at[0], at[1], 0.0))).1, f64::INFINITY);
                }
            }
        }
        let line = [DVec3::ZERO, DVec3::ONE, DVec3::splat(3.0)];
        assert_eq!(turns(&line, DVec3::splat(2.0)), (0.0, 0.0));
    }
}
