//! Whole powers by repeated squaring.

/// `base` to the power of `exponent`, by repeated squaring: the same bits on every platform. Anything to the power of 0 is 1.
pub(crate) fn power(base: f64, exponent: i32) -> f64 {
    let up = power_up(base, exponent.unsigned_abs());
    if exponent < 0 { 1.0 / up } else { up }
}

fn power_up(base: f64, mut exponent: u32) -> f64 {
    let mut square = base;
    let mut product = 1.0;
    while exponent > 0 {
        if exponent & 1 == 1 {
            product *= square;
        }
        exponent >>= 1;
        if exponent > 0 {
            square *= square;
        }
    }
    product
}

/// [`power`] in single precision.
#[inline(always)]
pub(crate) fn power_f32(base: f32, exponent: i32) -> f32 {
    let mut left = exponent.unsigned_abs();
    let mut square = base;
    let mut product = 1.0;
    while left > 0 {
        if left & 1 == 1 {
            product *= square;
        }
        left >>= 1;
        if left > 0 {
            square *= square;
        }
    }
    if exponent < 0 { 1.0 / product } else { product }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_products() {
        assert_eq!(power(3.0, 5), 243.0);
        assert_eq!(power(-2.0, 3), -8.0);
        assert_eq!(power(2.0, -2), 0.25);
        assert_eq!(power(0.0, 0), 1.0);
        assert_eq!(power_f32(-2.0, 3), -8.0);
        assert!((power(1.1, i32::MAX)).is_infinite());
        assert_eq!(power(1.1, i32::MIN), 0.0);
    }
}
