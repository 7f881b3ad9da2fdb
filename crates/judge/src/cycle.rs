//! Cycles of vertices, wherever they start and whichever way they run.

/// A number that is the same for all rotations and reflections of a cycle.
pub(crate) fn key(cycle: &[u32]) -> u64 {
    let sides = cycle.iter().zip(cycle.iter().cycle().skip(1));
    sides.fold(cycle.len() as u64, |sum, (&a, &b)| {
        let mixed = (u64::from(a.min(b)) << 32 | u64::from(a.max(b))).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        sum.wrapping_add((mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9))
    })
}

/// Whether one cycle is the other but for where it starts.
pub(crate) fn same_rotation(one: &[u32], other: &[u32]) -> bool {
    least_rotation(one) == least_rotation(other)
}

/// The smallest of all rotations of a cycle and of its reverse.
pub(crate) fn canonical(cycle: &[u32]) -> Vec<u32> {
    let reversed: Vec<u32> = cycle.iter().rev().copied().collect();
    least_rotation(cycle).min(least_rotation(&reversed))
}

/// The smallest rotation in linear time (Shiloach 1981): two starts race, and each mismatch rules out all starts that the
/// larger one has passed.
fn least_rotation(cycle: &[u32]) -> Vec<u32> {
    let count = cycle.len();
    let (mut one, mut other, mut matched) = (0, 1, 0);
    while one < count && other < count && matched < count {
        let (a, b) = (cycle[(one + matched) % count], cycle[(other + matched) % count]);
        if a == b {
            matched += 1;
            continue;
        }
        if a > b {
            one += matched + 1;
        } else {
            other += matched + 1;
        }
        other += usize::from(one == other);
        matched = 0;
    }
    let start = one.min(other);
    cycle[start..].iter().chain(&cycle[..start]).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_rotation_is_the_smallest_of_all() {
        // Every cycle of up to seven numbers below three.
        for count in 1..=7u32 {
            for code in 0..3u32.pow(count) {
                let cycle: Vec<u32> = (0..count).map(|place| code / 3u32.pow(place) % 3).collect();
                let rotations = (0..cycle.len()).map(|start| [&cycle[start..], &cycle[..start]].concat());
                assert_eq!(least_rotation(&cycle), rotations.min().unwrap(), "{cycle:?}");
                let mut turned = cycle.clone();
                turned.reverse();
                turned.rotate_left(1);
                assert_eq!((key(&turned), canonical(&turned)), (key(&cycle), canonical(&cycle)));
            }
        }
    }
}
