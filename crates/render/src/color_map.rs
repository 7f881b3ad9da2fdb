//! Colours for numbers.

use shapeloom_core::glam::DVec3;

/// The colour of a number from 0 to 1, in linear sRGB: from a dark violet over blue and green to a pale yellow.
///
/// Lightness rises evenly as the eye sees it, so that more always looks like more, also in grey and to most colour-blind
/// eyes; the hue turns along the way. A line in the cylinder coordinates of Oklab (Ottosson 2020), with the chroma that
/// sRGB has room for. What is not from 0 to 1 is clamped; NaN is grey.
pub fn sequential_color(value: f64) -> [f32; 3] {
    if value.is_nan() {
        return [0.2; 3];
    }
    let t = value.clamp(0.0, 1.0);
    let lightness = 0.27 + 0.65 * t;
    let hue = (310.0 - 205.0 * t).to_radians();
    // Less room for colour at the ends, and in the blue-greens of the middle.
    let chroma = 0.115 + 0.05 * t;
    let in_gamut = |color: &DVec3| color.min_element() >= 0.0 && color.max_element() <= 1.0;
    let color = (0..40).map(|step| oklab(lightness, chroma * (1.0 - f64::from(step) / 40.0), hue)).find(in_gamut);
    color.unwrap_or(DVec3::splat(lightness.powi(3))).to_array().map(|channel| channel as f32)
}

/// Lightness, chroma and hue in Oklab as linear sRGB, which may be out of its range.
fn oklab(lightness: f64, chroma: f64, hue: f64) -> DVec3 {
    let (a, b) = (chroma * hue.cos(), chroma * hue.sin());
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    DVec3::new(
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_is_lighter_all_the_way() {
        let light = |t: f64| {
            let [r, g, b] = sequential_color(t).map(f64::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let steps: Vec<f64> = (0..=100).map(|k| light(f64::from(k) / 100.0)).collect();
        assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        // Lightness is about the cube root of the light: its steps are even.
        let roots: Vec<f64> = steps.iter().map(|light| light.cbrt()).collect();
        assert!(roots.windows(2).all(|pair| (pair[1] - pair[0] - 0.0065).abs() < 0.004), "{roots:?}");
        assert!(steps[0] < 0.03 && steps[100] > 0.6);
    }

    #[test]
    fn colours_are_colours_whatever_the_number() {
        for value in [-1.0, 0.0, 0.3, 1.0, 2.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
            assert!(sequential_color(value).iter().all(|channel| (0.0..=1.0).contains(channel)), "{value}");
        }
        assert_eq!((sequential_color(-3.0), sequential_color(7.0)), (sequential_color(0.0), sequential_color(1.0)));
        // White and a primary, as published with the matrices.
        assert!((oklab(1.0, 0.0, 0.0) - DVec3::ONE).length() < 1e-4);
        let red = oklab(0.627_955, 0.257_683, 29.234_f64.to_radians());
        assert!((red - DVec3::X).length() < 1e-3, "{red}");
    }
}
