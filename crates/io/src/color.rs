//! Colours between files and shapes.

/// The sRGB value of a linear intensity from 0 to 1 (IEC 61966-2-1).
pub(crate) fn srgb(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { linear * 12.92 } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The linear intensity of an sRGB value from 0 to 1.
pub(crate) fn linear(srgb: f64) -> f64 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_meets_its_ends_and_comes_back() {
        assert_eq!((srgb(0.0), linear(0.0)), (0.0, 0.0));
        assert!((srgb(1.0) - 1.0).abs() < 1e-12 && (linear(1.0) - 1.0).abs() < 1e-12);
        for k in 0..=255 {
            let value = f64::from(k) / 255.0;
            assert!((srgb(linear(value)) - value).abs() < 1e-7, "{k}");
        }
    }
}
