//! Which triangles have the same corners in the same order.

use glam::DVec3;

/// Triangles in groups of equal corners: groups by their smallest element, elements rising within a group.
#[derive(Debug)]
pub(crate) struct Groups {
    starts: Vec<u32>,
    elements: Vec<u32>,
}

impl Groups {
    /// Groups `0..count` by the bits of their corners. O(n log n).
    pub fn of_equal(count: u32, corners: impl Fn(u32) -> [DVec3; 3]) -> Self {
        let mut keyed: Vec<(u64, u32)> = (0..count).map(|element| (hash(&bits(corners(element))), element)).collect();
        keyed.sort_unstable();
        // Each element's smallest equal, itself where it has none.
        let mut leader: Vec<u32> = (0..count).collect();
        for run in keyed.chunk_by_mut(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
            run.sort_by_cached_key(|&(_, element)| (bits(corners(element)), element));
            for equal in run.chunk_by(|a, b| bits(corners(a.1)) == bits(corners(b.1))) {
                for &(_, element) in equal {
                    leader[element as usize] = equal[0].1;
                }
            }
        }
        let mut elements: Vec<u32> = (0..count).collect();
        elements.sort_by_key(|&element| leader[element as usize]);
        let first = |&place: &u32| leader[elements[place as usize] as usize] == elements[place as usize];
        let starts = (0..count).filter(first).chain([count]).collect();
        Self { starts, elements }
    }

    /// How many groups there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The elements of a group.
    pub fn get(&self, group: usize) -> &[u32] {
        &self.elements[self.starts[group] as usize..self.starts[group + 1] as usize]
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
        let groups = Groups::of_equal(6, |element| [DVec3::splat(kinds[element as usize]); 3]);
        let found: Vec<&[u32]> = (0..groups.len()).map(|group| groups.get(group)).collect();
        assert_eq!(found, [&[0, 2, 5][..], &[1, 4], &[3]]);
        assert_eq!(Groups::of_equal(0, |_| [DVec3::ZERO; 3]).len(), 0);
    }
}
