//! Which vertices lie in one place.

use shapeloom_core::glam::DVec3;

/// For each position the first that equals it (-0 equals 0). O(n log n).
pub(crate) fn equal_positions(positions: &[DVec3]) -> Vec<u32> {
    // Adding 0 turns -0 into 0 and keeps every other bit.
    let bits = |index: u32| positions[index as usize].to_array().map(|coordinate| (coordinate + 0.0).to_bits());
    let mut keyed: Vec<(u64, u32)> = (0..positions.len() as u32).map(|index| (hash(bits(index)), index)).collect();
    keyed.sort_unstable();
    let mut first: Vec<u32> = (0..positions.len() as u32).collect();
    for run in keyed.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        run.sort_unstable_by_key(|&(_, index)| (bits(index), index));
        for equal in run.chunk_by(|a, b| bits(a.1) == bits(b.1)) {
            equal.iter().for_each(|&(_, index)| first[index as usize] = equal[0].1);
        }
    }
    first
}

fn hash(words: [u64; 3]) -> u64 {
    words.into_iter().fold(0, |hash, word| {
        let mixed = (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_positions_are_the_first_of_them() {
        let points = [DVec3::X, DVec3::Y, DVec3::X, DVec3::new(0.0, 1.0, -0.0), DVec3::ZERO];
        assert_eq!(equal_positions(&points), [0, 1, 0, 1, 4]);
        assert!(equal_positions(&[]).is_empty());
    }
}
