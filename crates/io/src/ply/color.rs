//! Colours: linear in shapes where they are fractions, sRGB in files (IEC 61966-2-1).

use super::types::Type;
use crate::color::{self, srgb};

/// The linear intensity of an sRGB value; negative ones mirror positive ones.
pub(super) fn linear(srgb: f64) -> f64 {
    color::linear(srgb.abs()).copysign(srgb)
}

/// Values of both pieces of the curve: the published ones overlap a little where they meet.
fn both_pieces(intensity: f64) -> [f64; 2] {
    let size = intensity.abs();
    [srgb(size).copysign(intensity), intensity * 12.92]
}

/// The float that [`linear`] takes to this intensity to the last bit, if there is one.
fn exact_float(intensity: f64) -> Option<f32> {
    let near = both_pieces(intensity).map(|value| value as f32);
    let candidates = near.into_iter().flat_map(|near| [near, near.next_up(), near.next_down()]);
    candidates.into_iter().find(|&float| linear(f64::from(float)).to_bits() == intensity.to_bits())
}

/// The float that [`linear`] takes to an intensity that rounds to this one, if there is one.
fn single(intensity: f32) -> Option<f32> {
    let near = both_pieces(f64::from(intensity)).map(|value| value as f32);
    let candidates = near.into_iter().flat_map(|near| [near, near.next_up(), near.next_down()]);
    candidates.into_iter().find(|&float| (linear(f64::from(float)) as f32).to_bits() == intensity.to_bits())
}

/// A linear intensity in single precision as a fraction in sRGB in that precision.
pub(super) fn single_fraction(intensity: f32) -> f32 {
    single(intensity).unwrap_or_else(|| srgb(f64::from(intensity).abs()).copysign(f64::from(intensity)) as f32)
}

/// The type of fractions in sRGB that are read as intensities which round to these.
pub(super) fn single_type(intensities: impl IntoIterator<Item = f32>) -> Type {
    let exact = |intensity: f32| intensity.is_nan() || single(intensity).is_some();
    if intensities.into_iter().all(exact) { Type::Float } else { Type::Double }
}

/// Whether a fraction in sRGB is that of a byte, by as much as single precision and the digits of texts may blur it.
pub(super) fn is_byte(fraction: f64) -> bool {
    let byte = 255.0 * fraction;
    (-1e-3..=255.001).contains(&byte) && (byte - byte.round()).abs() <= 1e-3
}

/// The double that [`linear`] takes to this intensity to the last bit, or the nearest to it that is found.
fn nearest_double(intensity: f64) -> f64 {
    let [near, straight] = both_pieces(intensity);
    let (mut up, mut down) = (near, near);
    for _ in 0..16 {
        let found = [up, down, straight].into_iter().find(|&double| linear(double).to_bits() == intensity.to_bits());
        if let Some(exact) = found {
            return exact;
        }
        (up, down) = (up.next_up(), down.next_down());
    }
    near
}

/// A linear intensity as a fraction in sRGB, so that reading it gives the same intensity.
pub(super) fn fraction(intensity: f64) -> f64 {
    if intensity.is_nan() {
        return intensity;
    }
    exact_float(intensity).map_or_else(|| nearest_double(intensity), f64::from)
}

/// The type in which linear intensities are fractions in sRGB: floats if floats were read, else doubles.
pub(super) fn fraction_type(intensities: impl IntoIterator<Item = f64>) -> Type {
    let exact = |intensity: f64| intensity.is_nan() || exact_float(intensity).is_some();
    if intensities.into_iter().all(exact) { Type::Float } else { Type::Double }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_has_its_published_values() {
        for (srgb_value, linear_value) in [(0.0, 0.0), (1.0, 1.0), (0.5, 0.214_041_14), (0.04, 0.003_095_975)] {
            assert!((linear(srgb_value) - linear_value).abs() < 1e-8);
            assert!((srgb(linear_value) - srgb_value).abs() < 1e-7);
        }
        assert_eq!(linear(-0.5), -linear(0.5));
    }

    #[test]
    fn fractions_survive_to_the_bit() {
        // Where the pieces of the curve meet.
        let meeting = (0.0404f32.to_bits()..0.0405f32.to_bits()).map(f32::from_bits);
        assert!(meeting.map(|float| linear(f64::from(float))).all(|intensity| exact_float(intensity).is_some()));
        let mut state = 1u32;
        for i in 0..200_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let float = if i % 2 == 0 { state as f32 / u32::MAX as f32 } else { f32::from_bits(state >> 2) };
            let intensity = linear(f64::from(float));
            assert_eq!(linear(fraction(intensity)).to_bits(), intensity.to_bits(), "{float}");
            assert!(exact_float(intensity).is_some(), "{float}");
            let double = f64::from(state) / f64::from(u32::MAX) + 1e-12;
            let intensity = linear(double);
            assert_eq!(linear(fraction(intensity)).to_bits(), intensity.to_bits(), "{double}");
        }
        assert_eq!(fraction_type([0.5, linear(0.25)]), Type::Double);
        assert_eq!(fraction_type([linear(0.5), 1.0, 0.0, -0.0, f64::NAN]), Type::Float);
    }
}
