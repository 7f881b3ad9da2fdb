//! Whether triangles leave no boundary.

use glam::DVec3;
use shapeloom_core::Exec;

use crate::BvhError;

/// Whether every edge is passed as often one way as the other, corners at equal positions counting as one (-0 equals
/// 0): whether the boundary of the triangles, as a chain, is zero.
///
/// Exactly then the winding number is a whole number everywhere off the surface, and the enclosed volume does not depend
/// on where it is measured from. It says nothing on being manifold: a face counted twice each way is closed, and so are
/// two cubes that share an edge. A mesh that no orientation of its faces makes consistent, such as a Klein bottle, is
/// not closed in this sense.
///
/// ```
/// use shapeloom_core::{Exec, glam::DVec3};
/// use shapeloom_spatial::is_closed;
///
/// let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
/// assert!(is_closed(&positions, &faces, &Exec::default())?);
/// assert!(!is_closed(&positions, &faces[1..], &Exec::default())?);
/// # Ok::<(), shapeloom_spatial::BvhError>(())
/// ```
///
/// Cost: O(n log n), for a million triangles a tenth of a second; where indices alone do not say it, as in a soup,
/// several times that. 48 bytes a triangle and 8 a position are reserved meanwhile. It asks whether to stop between the
/// steps, of which the longest sorts a key for each edge: some 50 ms for a million triangles.
///
/// # Errors
/// An index out of range, too little memory in the budget, or the reason to stop.
pub fn is_closed(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<bool, BvhError> {
    for (part, triangles) in triangles.chunks(STEP).enumerate() {
        exec.check()?;
        let corners = triangles.as_flattened().iter().enumerate();
        if let Some((place, &found)) = corners.clone().find(|&(_, &corner)| corner as usize >= positions.len()) {
            let (triangle, corner) = ((part * STEP + place / 3) as u32, (place % 3) as u8);
            return Err(BvhError::Index { triangle, corner, found, positions: positions.len() });
        }
    }
    let _memory = exec.reserve_elements(triangles.len() as u64, 6 * size_of::<u64>())?;
    if edges_cancel(triangles, |corner| corner, exec)? {
        return Ok(true);
    }
    let _merged = exec.reserve_elements(positions.len() as u64, 2 * size_of::<u32>())?;
    let first = first_of_equal(positions, exec)?;
    edges_cancel(triangles, |corner| first[corner as usize], exec)
}

/// How many elements are looked at before asking whether to stop.
const STEP: usize = 1 << 16;

/// For each position the first one that is equal to it.
fn first_of_equal(positions: &[DVec3], exec: &Exec) -> Result<Vec<u32>, BvhError> {
    // Adding zero turns -0 into 0.
    let key = |index: u32| positions[index as usize].to_array().map(|x| (x + 0.0).to_bits());
    // Equal positions are in one of so many buckets, each sorted alone: no step is long.
    let bucket = |index: u32| {
        let [x, y, z] = key(index);
        let mixed = (x ^ y.rotate_left(21) ^ z.rotate_left(42)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        (mixed >> 56) as usize
    };
    // Indices are 32 bits wide: no triangle names positions beyond.
    let count = positions.len().min(1 << 32);
    let steps = || (0..count).step_by(STEP).map(|first| (first, STEP.min(count - first)));
    let mut ends = [0usize; 257];
    for (first, len) in steps() {
        exec.check()?;
        (first..first + len).for_each(|index| ends[bucket(index as u32) + 1] += 1);
    }
    for bucket in 0..256 {
        ends[bucket + 1] += ends[bucket];
    }
    let (mut order, mut next) = (vec![0u32; count], ends);
    for (start, len) in steps() {
        exec.check()?;
        for index in start..start + len {
            let place = &mut next[bucket(index as u32)];
            order[*place] = index as u32;
            *place += 1;
        }
    }
    let mut first = vec![0; count];
    for bounds in ends.windows(2) {
        exec.check()?;
        let bucket = &mut order[bounds[0]..bounds[1]];
        bucket.sort_unstable_by_key(|&index| (key(index), index));
        for equal in bucket.chunk_by(|&a, &b| key(a) == key(b)) {
            for &index in equal {
                first[index as usize] = equal[0];
            }
        }
    }
    Ok(first)
}

/// Whether the edges that rise (from a smaller to a larger corner) are those that fall, counted each.
fn edges_cancel(triangles: &[[u32; 3]], corner: impl Fn(u32) -> u32, exec: &Exec) -> Result<bool, BvhError> {
    let (mut rising, mut falling) = (Vec::new(), Vec::new());
    rising.reserve_exact(triangles.len() * 3 / 2);
    falling.reserve_exact(triangles.len() * 3 / 2);
    for part in triangles.chunks(STEP) {
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
    use crate::fixtures::{Draws, bumpy_ball};

    #[test]
    fn equal_positions_have_their_first() {
        let mut draws = Draws::new(23);
        let few: Vec<DVec3> = (0..3000).map(|_| (draws.point() * 4.0).round()).collect();
        let wanted: Vec<u32> =
            few.iter().map(|place| few.iter().position(|other| other == place).unwrap() as u32).collect();
        assert_eq!(first_of_equal(&few, &Exec::default()).unwrap(), wanted);
        let one = vec![DVec3::ZERO, -DVec3::ZERO];
        assert_eq!(first_of_equal(&one, &Exec::default()).unwrap(), [0, 0]);
    }

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
        let found = is_closed(&positions, &[[0, 1, 2], [2, 1, 5000]], &exec).unwrap_err();
        assert_eq!(found, BvhError::Index { triangle: 1, corner: 2, found: 5000, positions: positions.len() });
        // As many edges rise as fall, but not the same.
        assert!(!closed(&positions, &[[0, 1, 2], [3, 5, 4]]));
    }
}
