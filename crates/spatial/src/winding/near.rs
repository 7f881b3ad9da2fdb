//! Triangles close to a query: their solid angles, eight at once.

use std::f64::consts::TAU;

use glam::DVec3;

use super::arctangent::angle;
use super::reference::turns_of;

/// How many triangles are evaluated together, and children of a node.
pub(crate) const WIDTH: usize = 8;

/// Eight triangles by corner, axis and lane, in scaled units about the origin. Lanes without a triangle hold a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub corners: [[[f64; WIDTH]; 3]; 3],
}

impl Block {
    pub fn triangle(&self, lane: usize) -> [DVec3; 3] {
        self.corners.map(|corner| DVec3::new(corner[0][lane], corner[1][lane], corner[2][lane]))
    }

    /// Determinants, denominators and products of lengths (see [`turns_of`](super::reference::turns_of)).
    #[inline(always)]
    fn tangents(&self, query: [f64; 3]) -> [[f64; WIDTH]; 3] {
        let mut out = [[0.0; WIDTH]; 3];
        let [a, b, c] = &self.corners;
        for lane in 0..WIDTH {
            let [ax, ay, az] = [a[0][lane] - query[0], a[1][lane] - query[1], a[2][lane] - query[2]];
            let [bx, by, bz] = [b[0][lane] - query[0], b[1][lane] - query[1], b[2][lane] - query[2]];
            let [cx, cy, cz] = [c[0][lane] - query[0], c[1][lane] - query[1], c[2][lane] - query[2]];
            let la = (ax * ax + ay * ay + az * az).sqrt();
            let lb = (bx * bx + by * by + bz * bz).sqrt();
            let lc = (cx * cx + cy * cy + cz * cz).sqrt();
            let ab = ax * bx + ay * by + az * bz;
            let bc = bx * cx + by * cy + bz * cz;
            let ca = cx * ax + cy * ay + cz * az;
            let product = la * lb * lc;
            out[0][lane] = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
            out[1][lane] = product + ab * lc + bc * la + ca * lb;
            out[2][lane] = product;
        }
        out
    }

    /// The sum of the lanes' solid angles over 4π.
    #[inline(always)]
    pub fn turns(&self, query: [f64; 3]) -> f64 {
        let [det, den, product] = self.tangents(query);
        let mut turns = [0.0; WIDTH];
        let mut doubtful = [false; WIDTH];
        for lane in 0..WIDTH {
            turns[lane] = angle(det[lane], den[lane]) * (1.0 / TAU);
            doubtful[lane] = is_doubtful(det[lane], den[lane], product[lane]);
        }
        if doubtful != [false; WIDTH] {
            for lane in (0..WIDTH).filter(|&lane| doubtful[lane]) {
                turns[lane] = turns_of(&self.triangle(lane), query.into()).0;
            }
        }
        total(&turns)
    }

    /// The same with a bound of its rounding error.
    #[inline(always)]
    pub fn turns_within(&self, query: [f64; 3]) -> (f64, f64) {
        let [det, den, product] = self.tangents(query);
        let mut turns = [0.0; WIDTH];
        let mut errors = [0.0; WIDTH];
        let mut doubtful = [false; WIDTH];
        for lane in 0..WIDTH {
            turns[lane] = angle(det[lane], den[lane]) * (1.0 / TAU);
            let length = (det[lane] * det[lane] + den[lane] * den[lane]).sqrt();
            let error = product[lane] * 2f64.powi(-48) / length + 2f64.powi(-50);
            // Also where 0/0 is not a number.
            errors[lane] = if error < 0.5 { error } else { 0.5 };
            doubtful[lane] = is_doubtful(det[lane], den[lane], product[lane]);
        }
        if doubtful != [false; WIDTH] {
            for lane in (0..WIDTH).filter(|&lane| doubtful[lane]) {
                (turns[lane], errors[lane]) = turns_of(&self.triangle(lane), query.into());
            }
        }
        (total(&turns), total(&errors) * (1.0 + 1e-9))
    }
}

/// Below this a product of lengths, each at most 2⁴² or so, may have lost digits to underflow.
const LEAST_PRODUCT: f64 = 1.0 / (1u128 << 100) as f64 / (1u128 << 100) as f64 / (1u128 << 100) as f64;

/// Whether the query may lie on either side of the triangle's plane, inside its border, or is so close to corners that
/// numbers may underflow: then the triangle is looked at alone.
#[inline(always)]
fn is_doubtful(det: f64, den: f64, product: f64) -> bool {
    ((det.abs() <= 2f64.powi(-45) * product) & (den <= 2f64.powi(-20) * product)) | (product < LEAST_PRODUCT)
}

#[inline(always)]
pub(crate) fn total(lanes: &[f64; WIDTH]) -> f64 {
    let [a, b, c, d, e, f, g, h] = *lanes;
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}
