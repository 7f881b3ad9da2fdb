//! The order in which points are inserted.

use shapeloom_core::glam::DVec2;
use shapeloom_core::parallel::{CHUNK, fill_chunks};
use shapeloom_core::{Exec, Stop};

/// The indices of the points in a biased randomized insertion order (Amenta, Choi and Rote 2003): rounds that double in
/// size, each a sample that does not depend on where points lie, and within a round along a Hilbert curve.
///
/// The rounds keep the expected number of changes linear for any arrangement of the points; the curve makes each point a
/// neighbour of the one before, so it is found in a few steps. Points must be finite, with differences that do not
/// overflow. Cost: a sort.
pub(crate) fn insertion_order(points: &[DVec2], exec: &Exec) -> Result<Vec<u32>, Stop> {
    let low = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
    let high = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
    let extent = (high - low).max_element();
    // One scale for both axes: the curve's squares are squares.
    let per = if extent > 0.0 { f64::from(1 << HILBERT_BITS) / extent } else { 0.0 };
    let mut keys = vec![(0u64, 0u32); points.len()];
    fill_chunks(exec, &mut keys, CHUNK, |first, part| {
        for (offset, key) in part.iter_mut().enumerate() {
            let index = first + offset;
            let cell = (points[index] - low) * per;
            // A cast of a number that is too large gives the largest.
            let clamped = [cell.x, cell.y].map(|c| (c as u32).min((1 << HILBERT_BITS) - 1));
            *key = ((LAST_ROUND - round(index as u64)) << (2 * HILBERT_BITS) | hilbert(clamped), index as u32);
        }
        Ok::<(), Stop>(())
    })?;
    keys.sort_unstable();
    exec.check()?;
    Ok(keys.into_iter().map(|(_, index)| index).collect())
}

const HILBERT_BITS: u32 = 30;
const LAST_ROUND: u64 = 15;

/// Half of the points are in round 0, a quarter in round 1, and so on.
fn round(index: u64) -> u64 {
    // The finaliser of SplitMix64 (Steele, Lea and Flood 2014): neighbouring numbers fall into unrelated rounds.
    let mut mixed = index.wrapping_add(0x9e37_79b9_7f4a_7c15);
    mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    u64::from((mixed ^ mixed >> 31).leading_zeros()).min(LAST_ROUND)
}

/// The place of a cell along Hilbert's curve.
fn hilbert([x, y]: [u32; 2]) -> u64 {
    let (mut place, mut turned) = (0u64, 0usize);
    for bit in (0..HILBERT_BITS).rev() {
        let quadrant = ((x >> bit & 1) << 1 | y >> bit & 1) as usize;
        let [step, next] = HILBERT[turned][quadrant];
        place = place << 2 | u64::from(step);
        turned = next as usize;
    }
    place
}

/// For each way in which the curve may lie in a square, and each quadrant of it (2 for the right half, and 1 for the upper
/// half): the quadrant's place along the curve, and how the curve lies in it. The ways are: from the lower left to the lower
/// right corner, to the upper left one, and each of these from the opposite end of the diagonal.
const HILBERT: [[[u8; 2]; 4]; 4] = [
    [[0, 1], [1, 0], [3, 3], [2, 0]],
    [[0, 0], [3, 2], [1, 1], [2, 1]],
    [[2, 2], [3, 1], [1, 2], [0, 3]],
    [[2, 3], [1, 3], [3, 0], [0, 2]],
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_on_the_curve_are_neighbours_in_the_plane() {
        let shift = HILBERT_BITS - 4;
        let mut cells: Vec<[u32; 2]> = (0..256).map(|k| [k % 16, k / 16]).collect();
        cells.sort_by_key(|cell| hilbert(cell.map(|c| c << shift)));
        for pair in cells.windows(2) {
            assert_eq!(pair[0][0].abs_diff(pair[1][0]) + pair[0][1].abs_diff(pair[1][1]), 1, "{pair:?}");
        }
    }

    #[test]
    fn every_point_comes_once_and_rounds_double() {
        let points: Vec<DVec2> = (0..5000).map(|k| DVec2::new(f64::from(k * 37 % 101), f64::from(k))).collect();
        let mut order = insertion_order(&points, &Exec::default()).unwrap();
        let last: Vec<u64> = order.iter().rev().take(2000).map(|&index| round(u64::from(index))).collect();
        assert!(last.iter().all(|&round| round == 0));
        order.sort_unstable();
        assert_eq!(order, (0..5000).collect::<Vec<u32>>());
        let share = (0..100_000).filter(|&index| round(index) == 1).count();
        assert!((24_000..26_000).contains(&share), "{share}");
        assert_eq!(insertion_order(&[DVec2::ONE; 3], &Exec::default()).unwrap().len(), 3);
        assert!(insertion_order(&[], &Exec::default()).unwrap().is_empty());
    }
}
