//! The angle of a point in the plane, on several lanes at once.
//!
//! Only the four operations, so a loop over lanes becomes vector instructions and every machine gives the same bits.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// tan(π/8): beyond it the angle is taken from π/4.
const TAN_PI_8: f64 = 0.414_213_562_373_095_03;

/// `(atan(√s)/√s - 1)/s` on `0 ≤ s ≤ tan²(π/8)`, interpolated at Chebyshev's points with 60 digits: the error of the
/// arctangent is below 8e-18 of it, before rounding.
const SERIES: [f64; 11] = [
    -0.3333333333333333,
    0.19999999999995516,
    -0.14285714284665682,
    0.11111111015187018,
    -0.0909090457530649,
    0.07692183125376892,
    -0.06664510525508936,
    0.05858140904866328,
    -0.050854078345894844,
    0.03923044778479309,
    -0.019175404711104935,
];

/// `atan2(y, x)` within 4e-16 of its value; 0 at the origin. Below 1e-290 in both, anything.
#[inline(always)]
pub(crate) fn angle(y: f64, x: f64) -> f64 {
    let (wide, high) = (x.abs(), y.abs());
    let (long, short) = if wide > high { (wide, high) } else { (high, wide) };
    let turned = short > TAN_PI_8 * long;
    let above = if turned { short - long } else { short };
    let below = if turned { short + long } else { long };
    let z = above / (below + f64::MIN_POSITIVE);
    let s = z * z;
    // Even and odd coefficients apart: half the latency.
    let t = s * s;
    let even = ((((SERIES[10] * t + SERIES[8]) * t + SERIES[6]) * t + SERIES[4]) * t + SERIES[2]) * t + SERIES[0];
    let odd = (((SERIES[9] * t + SERIES[7]) * t + SERIES[5]) * t + SERIES[3]) * t + SERIES[1];
    let small = z + z * (s * (even + s * odd));
    let acute = small + if turned { FRAC_PI_4 } else { 0.0 };
    let upper = if wide > high { acute } else { FRAC_PI_2 - acute };
    let upper = if x < 0.0 { PI - upper } else { upper };
    // At the origin the quotient is 0 and the point counts as upward.
    let upper = if long > 0.0 { upper } else { 0.0 };
    if y < 0.0 { -upper } else { upper }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    #[test]
    fn agrees_with_the_standard_library() {
        let mut draws = Draws::new(3);
        for i in 0..200_000 {
            let scale = 2f64.powi(i % 80 - 40);
            let (y, x) = (draws.signed() * scale, draws.signed());
            let found = angle(y, x);
            let wanted = y.atan2(x);
            assert!((found - wanted).abs() <= 4.5e-16 * wanted.abs().max(1e-3), "{y} {x}: {found} {wanted}");
        }
        for (y, x) in [(0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (1.0, -1.0), (1.0, 1.0), (0.0, -1.0), (-1e-300, -1.0)] {
            assert!((angle(y, x) - f64::atan2(y, x)).abs() <= 4.5e-16, "{y} {x}");
        }
        assert_eq!(angle(0.0, 0.0), 0.0);
    }
}
