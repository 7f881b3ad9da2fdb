//! An order of points in which neighbours in the row are near in space.

use std::ops::Range;

use glam::DVec3;
use shapeloom_core::parallel::{CHUNK, fill_chunks};
use shapeloom_core::{Exec, Stop};

/// Bits of a coordinate in a key: three fit in 64.
const BITS: u32 = 21;

/// The numbers `0..count` sorted along a space-filling curve through their points (Morton 1966).
///
/// Runs of more than `run` points in one cell of the curve are sorted again on a scale of their own, until they are
/// told apart or equal; ties are kept in rising order. O(n log n), and once more for each scale that the points have.
pub(crate) fn space_order(
    count: u32,
    run: usize,
    point: impl Fn(u32) -> DVec3 + Sync,
    exec: &Exec,
) -> Result<Vec<u32>, Stop> {
    let mut keyed: Vec<(u64, u32)> = (0..count).map(|item| (0, item)).collect();
    let mut open: Vec<Range<usize>> = std::iter::once(0..keyed.len()).collect();
    while let Some(range) = open.pop() {
        exec.check()?;
        let part = &mut keyed[range.clone()];
        let (min, max) = part.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(min, max), &(_, item)| {
            // NaN is passed over by min and max in this order of arguments.
            let point = point(item);
            let pass =
                |from: DVec3, pick: fn(f64, f64) -> f64| DVec3::from_array([0, 1, 2].map(|i| pick(point[i], from[i])));
            (pass(min, f64::min), pass(max, f64::max))
        });
        let extent = (max * 0.5 - min * 0.5).max_element();
        if extent.is_nan() || extent <= 0.0 {
            // All equal, or none a number.
            part.sort_unstable_by_key(|&(_, item)| item);
            continue;
        }
        let key = |item: u32| {
            let cell = (point(item) * 0.5 - min * 0.5) / extent * f64::from((1u32 << BITS) - 1);
            // Casts saturate, and NaN becomes 0.
            cell.to_array()
                .map(|coordinate| spread(coordinate as u64 & ((1 << BITS) - 1)))
                .into_iter()
                .enumerate()
                .fold(0, |key, (axis, bits)| key | bits << axis)
        };
        fill_chunks(exec, part, CHUNK, |_, part| {
            part.iter_mut().for_each(|(code, item)| *code = key(*item));
            Ok::<_, Stop>(())
        })?;
        part.sort_unstable();
        let mut start = range.start;
        for equal in part.chunk_by(|a, b| a.0 == b.0) {
            // A cell that holds everything would be tried for ever.
            if equal.len() > run && equal.len() < range.len() {
                open.push(start..start + equal.len());
            }
            start += equal.len();
        }
    }
    Ok(keyed.into_iter().map(|(_, item)| item).collect())
}

/// Bits moved apart so that two others fit between.
fn spread(bits: u64) -> u64 {
    let steps = [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ];
    steps.into_iter().fold(bits, |bits, (shift, mask)| (bits | bits << shift) & mask)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_move_apart_in_order() {
        for bits in [0, 1, 2, 0x155555, 0x1f_ffff, 0x10_0001] {
            let wanted = (0..BITS).fold(0, |sum, bit| sum | (bits >> bit & 1) << (3 * bit));
            assert_eq!(spread(bits), wanted);
        }
    }

    #[test]
    fn every_number_stands_once_and_scales_are_told_apart() {
        // Rows of points at three scales far apart, mixed.
        let point = |item: u32| DVec3::splat(f64::from(item / 3) * [1e-20, 1.0, 1e20][item as usize % 3]);
        let order = space_order(3000, 8, point, &Exec::default()).unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..3000));
        let places: Vec<f64> = order.iter().map(|&item| point(item).x).collect();
        let falls = places.windows(2).filter(|pair| pair[0] > pair[1]).count();
        assert!(falls < 200, "{falls} falls along a line");
        assert_eq!(space_order(20, 8, |_| DVec3::ONE, &Exec::default()).unwrap(), (0..20).collect::<Vec<_>>());
        assert_eq!(space_order(3, 1, |_| DVec3::NAN, &Exec::default()).unwrap(), [0, 1, 2]);
    }
}
