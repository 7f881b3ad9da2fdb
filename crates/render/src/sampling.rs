//! Evenly spread directions that depend on their number and a seed alone.

use shapeloom_core::glam::{DVec2, DVec3};

/// A well-mixed number of two (splitmix64).
pub(crate) fn hash(x: u32, y: u32) -> u64 {
    let mut state = (u64::from(x) << 32 | u64::from(y)).wrapping_add(0x9e37_79b9_7f4a_7c15);
    state = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    state = (state ^ state >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    state ^ state >> 31
}

/// A shift of the unit square from a hash.
pub(crate) fn shift(hash: u64) -> DVec2 {
    let scale = 1.0 / f64::from(1u32 << 31) / 2.0;
    DVec2::new((hash >> 32) as f64, (hash & 0xffff_ffff) as f64) * scale
}

/// The point `index` of an evenly spread sequence in the unit square, shifted with wrap-around: the additive recurrence
/// with the plastic number (Roberts 2018), well spread at every length.
pub(crate) fn spread(index: u32, shift: DVec2) -> DVec2 {
    const STEP: DVec2 = DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_2);
    let point = shift + STEP * f64::from(index);
    point - point.floor()
}

/// The direction around the third axis with cosine density for a point of the unit square.
pub(crate) fn cosine_direction(square: DVec2) -> DVec3 {
    let (sine, cosine) = (std::f64::consts::TAU * square.y).sin_cos();
    let radius = square.x.sqrt();
    DVec3::new(radius * cosine, radius * sine, (1.0 - square.x).max(0.0).sqrt())
}

/// The direction around the third axis, evenly in a cone of this slope, for a point of the unit square.
pub(crate) fn cone_direction(slope: f64, square: DVec2) -> DVec3 {
    let (sine, cosine) = (std::f64::consts::TAU * square.y).sin_cos();
    let radius = slope * square.x.sqrt();
    DVec3::new(radius * cosine, radius * sine, 1.0).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_directions_have_their_moments() {
        let count = 4096;
        let sum: DVec3 = (0..count).map(|i| cosine_direction(spread(i, DVec2::new(0.3, 0.8)))).sum();
        // The mean of a cosine-weighted direction is 2/3 of the normal.
        assert!((sum / f64::from(count) - DVec3::Z * (2.0 / 3.0)).length() < 1e-2);
        for i in 0..100 {
            let direction = cosine_direction(shift(hash(i, 7)));
            assert!((direction.length() - 1.0).abs() < 1e-12 && direction.z >= 0.0);
            assert!(cone_direction(0.1, shift(hash(i, 3))).z >= 0.995);
        }
    }

    #[test]
    fn places_keep_apart() {
        for count in [16, 49 * 16] {
            let places: Vec<DVec2> = (0..count).map(|i| spread(i, DVec2::new(0.3, 0.8))).collect();
            let apart = |a: &DVec2, b: &DVec2| {
                let d = (*a - *b).abs();
                d.min(DVec2::ONE - d).length()
            };
            let pairs = places.iter().enumerate().flat_map(|(i, a)| places[..i].iter().map(move |b| apart(a, b)));
            // A square lattice has 1 / sqrt(count); random places have almost 0.
            assert!(pairs.fold(1.0, f64::min) > 0.5 / f64::from(count).sqrt());
        }
    }
}
