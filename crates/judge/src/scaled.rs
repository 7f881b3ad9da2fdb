//! Positions on a scale where exact arithmetic neither overflows nor underflows.

use shapeloom_core::glam::DVec3;

use crate::JudgeError;

/// Positions multiplied by a power of two, so that the largest coordinate is between 1/2 and 1 in magnitude.
///
/// That changes no sign of a determinant and no bit of a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Scaled {
    /// The scaled positions.
    pub positions: Vec<DVec3>,
    /// The exponent of the power of two, from -1024 to 1073.
    pub exponent: i32,
}

impl Scaled {
    /// The exponent of the smallest bit that a coordinate may have after scaling: products of three differences, and
    /// their rounding errors, stay above the smallest number, 2^-1074.
    const LOWEST_BIT: i32 = -340;

    /// Scales the positions of a shape.
    ///
    /// # Errors
    /// A coordinate that is not finite, or one with bits that exact products of three would lose: about 1e-86 of the
    /// largest and smaller.
    pub fn new(positions: &[DVec3]) -> Result<Self, JudgeError> {
        if let Some(vertex) = positions.iter().position(|position| !position.is_finite()) {
            return Err(JudgeError::NotFinite { vertex: vertex as u32, found: positions[vertex] });
        }
        let largest = positions.iter().map(|position| position.abs().max_element()).fold(0.0, f64::max);
        if largest == 0.0 {
            return Ok(Self { positions: positions.to_vec(), exponent: 0 });
        }
        let exponent = -(exponent_of(largest) + 1);
        if let Some(vertex) = positions.iter().position(|&position| is_too_fine(position, exponent)) {
            return Err(JudgeError::Underflow { vertex: vertex as u32, found: positions[vertex], largest });
        }
        Ok(Self { positions: positions.iter().map(|&position| times_power(position, exponent)).collect(), exponent })
    }

    /// A point on the scale of a shape; none if it is not finite, larger than the shape's largest coordinate could be, or
    /// has bits that exact products would lose.
    pub(crate) fn point(point: DVec3, exponent: i32) -> Option<DVec3> {
        let moved = times_power(point, exponent);
        (moved.is_finite() && moved.abs().max_element() <= 1.0 && !is_too_fine(point, exponent)).then_some(moved)
    }
}

/// The middle of two points of a [`Scaled`] shape, if it is a number exactly.
pub(crate) fn exact_middle(a: DVec3, b: DVec3) -> Option<DVec3> {
    let sum = a + b;
    // The rounding error of each sum (Knuth's two-sum); coordinates are at most 1 and halving is exact.
    let rest = sum - a;
    let error = (a - (sum - rest)) + (b - rest);
    (error == DVec3::ZERO).then_some(sum * 0.5)
}

/// Whether a position, scaled, has bits that exact products of three would lose.
fn is_too_fine(position: DVec3, exponent: i32) -> bool {
    let bits = position.to_array().map(lowest_bit);
    bits.into_iter().flatten().any(|bit| bit + exponent < Scaled::LOWEST_BIT)
}

/// A vector times a power of two up to 2^1073: in two steps, each of them a number.
pub(crate) fn times_power(vector: DVec3, exponent: i32) -> DVec3 {
    let [first, second] = [exponent / 2, exponent - exponent / 2].map(|half| 2f64.powi(half));
    vector * first * second
}

/// The exponent `e` of a positive number in `[2^e, 2^(e+1))`.
pub(crate) fn exponent_of(value: f64) -> i32 {
    let bits = value.to_bits();
    let stored = (bits >> 52 & 0x7ff) as i32;
    if stored == 0 { -1011 - (bits << 12).leading_zeros() as i32 - 12 } else { stored - 1023 }
}

/// The exponent of the lowest bit that is set; none for zero.
fn lowest_bit(value: f64) -> Option<i32> {
    let bits = value.to_bits();
    let (stored, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    match (stored, fraction) {
        (0, 0) => None,
        (0, fraction) => Some(fraction.trailing_zeros() as i32 - 1074),
        (stored, 0) => Some(stored - 1023),
        (stored, fraction) => Some(stored - 1075 + fraction.trailing_zeros() as i32),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scaling_keeps_every_bit_at_both_ends_of_the_numbers() {
        for size in [5e-324, 1e-320, 1e-300, 1e-9, 0.7, 1.0, 5e6, 1e150, f64::MAX] {
            let positions = [DVec3::new(size, -size, 0.0), DVec3::new(-0.0, size / 2.0, size)];
            let scaled = Scaled::new(&positions).unwrap();
            let largest = scaled.positions[0].x;
            assert!((0.5..1.0).contains(&largest), "{size}: {largest}");
            let [first, second] = [scaled.exponent / 2, scaled.exponent - scaled.exponent / 2];
            let back = scaled.positions[0] / 2f64.powi(first) / 2f64.powi(second);
            assert_eq!(back, positions[0], "{size}");
        }
        assert_eq!(Scaled::new(&[]).unwrap().exponent, 0);
        assert_eq!(Scaled::new(&[DVec3::ZERO; 2]).unwrap().positions.len(), 2);
    }

    #[test]
    fn what_exact_products_would_lose_is_refused_and_named() {
        let found = DVec3::new(0.0, 1e-90, 0.0);
        let wanted = JudgeError::Underflow { vertex: 1, found, largest: 1.0 };
        assert_eq!(Scaled::new(&[DVec3::ONE, found]), Err(wanted));
        assert!(Scaled::new(&[DVec3::ONE, DVec3::splat(1e-80)]).is_ok());
        // Scaled down, it would vanish.
        assert!(Scaled::new(&[DVec3::splat(1e308), DVec3::splat(1e-10)]).is_err());
        assert!(matches!(
            Scaled::new(&[DVec3::ZERO, DVec3::new(0.0, f64::NAN, 0.0)]),
            Err(JudgeError::NotFinite { vertex: 1, .. })
        ));
    }
}
