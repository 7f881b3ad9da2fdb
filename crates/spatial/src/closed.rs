//! Whether triangles leave no boundary.

use glam::DVec3;
use shapeloom_core::Exec;

use crate::BvhError;

/// Whether every edge is passed as often one way as the other, corners at equal positions counting as one: whether the
/// boundary of the triangles, as a chain, is zero. Exactly then the winding number is a whole number everywhere off the
/// surface. Indices must be in range. O(n log n); 48 bytes a triangle and 8 a position are reserved meanwhile.
pub(crate) fn is_closed(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<bool, BvhError> {
    let _memory = exec.reserve_elements(triangles.len() as u64, 6 * size_of::<u64>())?;
    if edges_cancel(triangles, |corner| corner, exec)? {
        return Ok(true);
    }
    let _merged = exec.reserve_elements(positions.len() as u64, 2 * size_of::<u32>())?;
    // Adding zero turns -0 into 0.
    let key = |index: &u32| positions[*index as usize].to_array().map(|x| (x + 0.0).to_bits());
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_unstable_by_key(key);
    exec.check()?;
    let mut first = vec![0; positions.len()];
    for equal in order.chunk_by(|a, b| key(a) == key(b)) {
        for &index in equal {
            first[index as usize] = equal[0];
        }
    }
    edges_cancel(triangles, |corner| first[corner as usize], exec)
}

/// Whether the edges that rise (from a smaller to a larger corner) are those that fall, counted each.
fn edges_cancel(triangles: &[[u32; 3]], corner: impl Fn(u32) -> u32, exec: &Exec) -> Result<bool, BvhError> {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    rising.reserve_exact(triangles.len() * 3 / 2);
    falling.reserve_exact(triangles.len() * 3 / 2);
    for part in triangles.chunks(1 << 16) {
        exec.check()?;
        for &triangle in part {
            let [a, b, c] = triangle.map(&corner);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let key = u64::from(from.min(to)) << 32 | u64::from(from.max(to));
                if from < to {
                    rising.push(key);
                } else if from > to {
                    falling.push(key);
                }
            }
        }
    }
    if rising.len() != falling.len() {
        return Ok(false);
    }
    rising.sort_unstable();
    exec.check()?;
    falling.sort_unstable();
    Ok(rising == falling)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::bumpy_ball;

    #[test]
    fn boundaries_are_seen() {
        let exec = Exec::default();
        let (positions, mut triangles) = bumpy_ball(8, DVec3::ZERO, 1.0, 0.1);
        let closed = |positions: &[DVec3], triangles: &[[u32; 3]]| is_closed(positions, triangles, &exec).unwrap();
        assert!(closed(&positions, &triangles));
        let soup: Vec<DVec3> = triangles.iter().flatten().map(|&corner| positions[corner as usize]).collect();
        let triples: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        assert!(closed(&soup, &triples));
        assert!(!closed(&soup, &triples[1..]));
        // A triangle and its reverse cancel; a flipped face alone does not.
        triangles.extend([[1, 5, 9], [1, 9, 5], [3, 3, 4]]);
        assert!(closed(&positions, &triangles));
        triangles[0].reverse();
        assert!(!closed(&positions, &triangles));
        triangles.remove(0);
        assert!(!closed(&positions, &triangles));
        assert!(closed(&[], &[]));
        // As many edges rise as fall, but not the same.
        assert!(!closed(&positions, &[[0, 1, 2], [3, 5, 4]]));
    }
}
