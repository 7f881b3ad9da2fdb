//! Sample places that depend on pixel, sample and seed alone.

use shapeloom_core::Frame;
use shapeloom_core::glam::{DVec2, DVec3};

/// A well-mixed number of three (one step of a splitmix64 each).
pub(crate) fn hash(x: u32, y: u32, seed: u32) -> u64 {
    let mut state = u64::from(x) << 32 | u64::from(y);
    for word in [0x9e37_79b9_7f4a_7c15, u64::from(seed)] {
        state = state.wrapping_add(word);
        state = (state ^ state >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        state = (state ^ state >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        state ^= state >> 31;
    }
    state
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

/// The direction around `normal` with cosine density for a point of the unit square.
pub(crate) fn cosine_direction(normal: DVec3, square: DVec2) -> DVec3 {
    let radius = square.x.sqrt();
    let turn = std::f64::consts::TAU * square.y;
    let [x, y, z] = Frame::with_normal(DVec3::ZERO, normal).axes();
    x * (radius * turn.cos()) + y * (radius * turn.sin()) + z * (1.0 - square.x).max(0.0).sqrt()
}

/// A direction in the cone of half angle `atan(spread)` around a unit vector.
pub(crate) fn cone_direction(axis: DVec3, slope: f64, square: DVec2) -> DVec3 {
    let radius = slope * square.x.sqrt();
    let turn = std::f64::consts::TAU * square.y;
    let [x, y, z] = Frame::with_normal(DVec3::ZERO, axis).axes();
    (x * (radius * turn.cos()) + y * (radius * turn.sin()) + z).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_directions_have_their_moments() {
        let normal = DVec3::new(0.48, -0.6, 0.64);
        let count = 4096;
        let sum: DVec3 = (0..count).map(|i| cosine_direction(normal, spread(i, DVec2::new(0.3, 0.8)))).sum();
        // The mean of a cosine-weighted direction is 2/3 of the normal.
        assert!((sum / f64::from(count) - normal * (2.0 / 3.0)).length() < 1e-2);
        for i in 0..100 {
            let direction = cosine_direction(normal, shift(hash(i, 7, 1)));
            assert!((direction.length() - 1.0).abs() < 1e-12 && direction.dot(normal) >= -1e-12);
            assert!(cone_direction(normal, 0.1, shift(hash(i, 3, 1))).dot(normal) >= 0.995);
        }
    }

    #[test]
    fn sixteen_samples_fall_into_sixteen_strips() {
        let mut strips: Vec<u32> = (0..16).map(|i| (spread(i, DVec2::ZERO).x * 16.0) as u32).collect();
        strips.sort_unstable();
        strips.dedup();
        assert!(strips.len() >= 12, "{strips:?}");
    }
}
