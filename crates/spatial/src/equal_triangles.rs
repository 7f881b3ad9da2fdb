//! Which triangles have the same corners in the same order.

use glam::DVec3;
use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{Exec, Stop};

/// Triangles in groups of equal corners, each named by its smallest element.
#[derive(Debug)]
pub(crate) struct Groups {
    count: u32,
    /// The smallest element of each group, rising; none where no triangle equals another.
    leaders: Option<Vec<u32>>,
    /// Smallest elements with each other element of their group, rising.
    twins: Vec<(u32, u32)>,
}

impl Groups {
    /// Groups `0..count` by the bits of their corners. O(n), and O(k log k) in those that equal others.
    ///
    /// # Errors
    /// The reason to stop.
    pub fn of_equal(count: u32, corners: impl Fn(u32) -> [DVec3; 3] + Sync, exec: &Exec) -> Result<Self, Stop> {
        let mut hashes = vec![0u32; count as usize];
        fill_chunks(exec, &mut hashes, 1 << 14, |first, part| {
            for (element, hash_of) in (first as u32..).zip(part) {
                *hash_of = (hash(&bits(corners(element))) >> 32) as u32;
            }
            Ok::<(), Stop>(())
        })?;
        // One bit for each of some times as many values as there are triangles tells most of them apart.
        let values = (16 * count as usize).next_power_of_two().clamp(64, 1 << 32);
        let shift = 32 - values.trailing_zeros();
        let (mut seen, mut again) = (vec![0u64; values / 64], vec![0u64; values / 64]);
        let place = |hash: u32| {
            let value = (u64::from(hash) >> shift) as usize;
            (value / 64, 1u64 << (value % 64))
        };
        for &hash in &hashes {
            let (word, bit) = place(hash);
            again[word] |= seen[word] & bit;
            seen[word] |= bit;
        }
        let doubtful = (0..count).zip(&hashes).filter(|&(_, &hash)| again[place(hash).0] & place(hash).1 != 0);
        let mut keyed: Vec<(u32, u32)> = doubtful.map(|(element, &hash)| (hash, element)).collect();
        keyed.sort_unstable();
        let mut twins = Vec::new();
        for run in keyed.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
            run.sort_by_cached_key(|&(_, element)| (bits(corners(element)), element));
            for equal in run.chunk_by(|a, b| bits(corners(a.1)) == bits(corners(b.1))) {
                twins.extend(equal[1..].iter().map(|&(_, element)| (equal[0].1, element)));
            }
        }
        twins.sort_unstable();
        let leaders = (!twins.is_empty()).then(|| {
            let mut leads = vec![true; count as usize];
            twins.iter().for_each(|&(_, twin)| leads[twin as usize] = false);
            (0..count).filter(|&element| leads[element as usize]).collect()
        });
        Ok(Self { count, leaders, twins })
    }

    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.leaders.as_ref().map_or(self.count as usize, Vec::len)
    }

    /// Memory that is held.
    pub fn bytes(&self) -> usize {
        self.leaders.as_ref().map_or(0, Vec::len) * size_of::<u32>() + self.twins.capacity() * size_of::<(u32, u32)>()
    }

    /// The smallest element of a group.
    pub fn leader(&self, group: usize) -> u32 {
        self.leaders.as_ref().map_or(group as u32, |leaders| leaders[group])
    }

    /// The other elements of a group, rising, given its smallest.
    pub fn twins_of(&self, leader: u32) -> impl Iterator<Item = u32> {
        let start = self.twins.partition_point(|&(first, _)| first < leader);
        self.twins[start..].iter().take_while(move |&&(first, _)| first == leader).map(|&(_, twin)| twin)
    }
}

fn bits(corners: [DVec3; 3]) -> [[u64; 3]; 3] {
    corners.map(|corner| corner.to_array().map(f64::to_bits))
}

fn hash(words: &[[u64; 3]; 3]) -> u64 {
    words.as_flattened().iter().fold(0, |hash, &word| {
        let mixed = (hash ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ mixed >> 29
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_ordered_by_their_smallest_element() {
        let kinds = [7.0, 3.0, 7.0, 5.0, 3.0, 7.0];
        let of = |count: u32| {
            Groups::of_equal(count, |element| [DVec3::splat(kinds[element as usize]); 3], &Exec::default()).unwrap()
        };
        let groups = of(6);
        let found: Vec<Vec<u32>> = (0..groups.len())
            .map(|group| std::iter::once(groups.leader(group)).chain(groups.twins_of(groups.leader(group))).collect())
            .collect();
        assert_eq!(found, [&[0, 2, 5][..], &[1, 4], &[3]]);
        assert_eq!((of(0).len(), of(2).len(), of(2).leader(1), of(2).twins_of(1).count()), (0, 2, 1, 0));
    }

    /// Many more values than the table of bits tells apart, half of them twice.
    #[test]
    fn only_equal_triangles_are_grouped() {
        let kind = |element: u32| f64::from(if element < 30_000 { element } else { (element - 30_000) * 2 });
        let corners = |element| [DVec3::ZERO, DVec3::X, DVec3::Y * kind(element)];
        let groups = Groups::of_equal(45_000, corners, &Exec::default()).unwrap();
        assert_eq!(groups.len(), 30_000);
        for element in 0..30_000 {
            let twin = (element % 2 == 0).then_some(30_000 + element / 2);
            assert!(groups.twins_of(element).eq(twin));
        }
    }
}
