//! From light to bytes.

use shapeloom_core::glam::DVec3;

/// Where highlights begin to be compressed.
const SHOULDER: f64 = 0.70;

/// Compresses light above the shoulder smoothly below 1, and leaves what is darker as it is.
pub(crate) fn tone(light: DVec3) -> DVec3 {
    let curve = |x: f64| {
        let over = x - SHOULDER;
        if over <= 0.0 { x } else { SHOULDER + over / (1.0 + over / (1.0 - SHOULDER)) }
    };
    DVec3::new(curve(light.x), curve(light.y), curve(light.z))
}

/// The sRGB byte of a linear value; NaN is 0.
pub(crate) fn srgb(linear: f64) -> u8 {
    let x = linear.clamp(0.0, 1.0);
    let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
    (encoded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_bytes() {
        // IEC 61966-2-1: code 128 stands for 21.6% of the light.
        assert_eq!([0.0, 0.215_860_5, 1.0, 7.0, -1.0, f64::NAN].map(srgb), [0, 128, 255, 255, 0, 0]);
    }

    #[test]
    fn the_curve_rises_below_one_and_keeps_the_dark() {
        assert_eq!(tone(DVec3::new(0.1, 0.5, 0.7)), DVec3::new(0.1, 0.5, 0.7));
        let values: Vec<f64> = (0..100).map(|i| tone(DVec3::splat(f64::from(i) * 0.1)).x).collect();
        assert!(values.windows(2).all(|pair| pair[0] < pair[1] && pair[1] < 1.0));
    }
}
