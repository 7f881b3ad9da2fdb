//! On which side of a triangle's plane a point lies, for every finite number.

use std::cmp::Ordering;

use glam::DVec3;
use shapeloom_core::predicates::orient3d;

/// Beyond these magnitudes products of three coordinates or their error terms could leave the range of numbers.
const SAFE: std::ops::RangeInclusive<f64> = 1e-69..=1e69;

/// On which side of the plane through `a`, `b`, `c` the point lies, as [`orient3d`] says it, exactly however small the
/// coordinates are.
pub(crate) fn side([a, b, c]: &[DVec3; 3], point: DVec3) -> Ordering {
    let is_safe = |p: &DVec3| p.abs().to_array().iter().all(|x| *x == 0.0 || SAFE.contains(x));
    if [a, b, c, &point].into_iter().all(is_safe) {
        return orient3d(*a, *b, *c, point);
    }
    side_by_integers([*a, *b, *c], point)
}

/// The same by the whole determinant in integers: a microsecond or two.
///
/// `det(a − p, b − p, c − p)` is a sum of 24 products of three coordinates. Each is an integer of at most 159 bits times
/// a power of two; those to add and those to subtract are summed apart and compared.
fn side_by_integers([a, b, c]: [DVec3; 3], point: DVec3) -> Ordering {
    let (mut above, mut below) = (Integer::ZERO, Integer::ZERO);
    let mut add_determinant = |[a, b, c]: [DVec3; 3], is_negative: bool| {
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (1, 0, 2), (2, 1, 0)] {
            let factors = [a[i], b[j], c[k]];
            // The last three permutations are odd.
            let is_odd = (i + 1) % 3 != j;
            let signs = factors.iter().filter(|x| x.is_sign_negative()).count();
            let sum = if is_negative ^ is_odd ^ (signs % 2 == 1) { &mut below } else { &mut above };
            sum.add_product(factors);
        }
    };
    add_determinant([a, b, c], false);
    add_determinant([point, b, c], true);
    add_determinant([a, point, c], true);
    add_determinant([a, b, point], true);
    // The determinant is negative on the normal's side.
    below.limbs.iter().rev().cmp(above.limbs.iter().rev())
}

/// Products of three numbers reach from 2⁻³²²² to 2³⁰⁷²; a few bits more hold their sums.
const LIMBS: usize = (3222 + 3072 + 64) / 64 + 1;

/// A positive integer times 2⁻³²²², the lowest limb first.
struct Integer {
    limbs: [u64; LIMBS],
}

impl Integer {
    const ZERO: Self = Self { limbs: [0; LIMBS] };

    /// Adds the product of magnitudes.
    fn add_product(&mut self, factors: [f64; 3]) {
        let [a, b, c] = factors.map(parts);
        let (low, high) = wide(a.0, b.0);
        let (first, carry) = wide(low, c.0);
        let (second, third) = wide(high, c.0);
        let (second, over) = second.overflowing_add(carry);
        let third = third + u64::from(over);
        // Exponents count from the least there is.
        let (limb, shift) = ((a.1 + b.1 + c.1) / 64, (a.1 + b.1 + c.1) % 64);
        let spill = |x: u64| if shift == 0 { 0 } else { x >> (64 - shift) };
        let mut carry = 0u64;
        let terms = [first << shift, second << shift | spill(first), third << shift | spill(second), spill(third)];
        for (place, limb) in self.limbs.iter_mut().skip(limb).enumerate() {
            let term = terms.get(place).copied().unwrap_or(0);
            if place >= terms.len() && carry == 0 {
                break;
            }
            let (sum, over) = limb.overflowing_add(term);
            let (sum, again) = sum.overflowing_add(carry);
            *limb = sum;
            carry = u64::from(over) + u64::from(again);
        }
    }
}

/// The magnitude of a number as an integer times 2^(exponent − 1074).
fn parts(x: f64) -> (u64, usize) {
    let bits = x.to_bits();
    let (fraction, exponent) = (bits & ((1 << 52) - 1), (bits >> 52 & 0x7ff) as usize);
    if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 52, exponent - 1) }
}

/// A product's low and high half.
fn wide(a: u64, b: u64) -> (u64, u64) {
    let product = u128::from(a) * u128::from(b);
    (product as u64, (product >> 64) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    /// Small whole numbers, each axis at a scale of its own, which changes no side; each sign against `i128`.
    #[test]
    fn sides_are_those_of_whole_numbers() {
        let mut draws = Draws::new(21);
        let mut counts = [0; 3];
        for [x, y, z] in
            [[0, 0, 0], [-1000, 5, 40], [-1074, -1074, -1074], [900, -900, 0], [1010, 1010, 1010], [-300; 3]]
        {
            let scale = DVec3::new(power(x), power(y), power(z));
            for i in 0..400 {
                // Three in four are nearly or wholly in one plane.
                let mut draw = || [0; 3].map(|_: i32| (draws.signed() * 5.0) as i128);
                let [a, b, c] = [draw(), draw(), draw()];
                let mut p = draw();
                if i % 4 != 0 {
                    p = [0, 1, 2].map(|k| a[k] + b[k] - c[k]);
                    p[0] += (i % 4 - 2) as i128;
                }
                let [u, v, w] = [a, b, c].map(|q| [0, 1, 2].map(|k| q[k] - p[k]));
                let det = u[0] * (v[1] * w[2] - v[2] * w[1])
                    + u[1] * (v[2] * w[0] - v[0] * w[2])
                    + u[2] * (v[0] * w[1] - v[1] * w[0]);
                let place = |q: [i128; 3]| DVec3::from_array(q.map(|x| x as f64)) * scale;
                let corners = [a, b, c].map(place);
                let wanted = 0.cmp(&det);
                assert_eq!(side_by_integers(corners, place(p)), wanted, "{corners:?} {p:?}");
                assert_eq!(side(&corners, place(p)), wanted, "{corners:?} {p:?}");
                counts[(wanted as i32 + 1) as usize] += 1;
            }
        }
        assert!(counts.into_iter().all(|count| count > 300), "{counts:?}");
    }

    fn power(exponent: i32) -> f64 {
        if exponent < -1000 { 2f64.powi(-1000) * 2f64.powi(exponent + 1000) } else { 2f64.powi(exponent) }
    }

    /// All bits of ordinary numbers, near planes.
    #[test]
    fn integers_agree_with_the_predicate() {
        let mut draws = Draws::new(22);
        for i in 0..3000 {
            let [a, b, c] = [draws.point(), draws.point() * 1e-5, draws.point() * 1e7];
            let point = a * 0.3 + b * 0.5 + c * 0.2 + if i % 2 == 0 { DVec3::ZERO } else { draws.point() };
            assert_eq!(side_by_integers([a, b, c], point), orient3d(a, b, c, point));
        }
    }
}
