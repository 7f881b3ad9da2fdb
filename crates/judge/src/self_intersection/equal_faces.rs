//! Which vertices have equal positions, and which faces equal corners.

use shapeloom_core::glam::DVec3;

/// For each position the first that equals it (-0 equals 0). O(n log n).
pub(super) fn equal_positions(positions: &[DVec3]) -> Vec<u32> {
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

/// Faces in groups of those with equal corners, rising within a group.
#[derive(Debug)]
pub(super) struct Groups {
    starts: Vec<u32>,
    faces: Vec<u32>,
}

impl Groups {
    /// Cuts a row of faces, sorted so that equal ones are neighbours and rise, into groups.
    fn of_sorted(faces: Vec<u32>, equal: impl Fn(u32, u32) -> bool) -> Self {
        let mut starts = vec![0];
        for run in faces.chunk_by(|&a, &b| equal(a, b)) {
            starts.push(starts[starts.len() - 1] + run.len() as u32);
        }
        Self { starts, faces }
    }

    /// Groups of triangles with the same corners in any order; of triangles without area those with the same distinct
    /// corners. `vertices` bounds the corners' numbers. Linear, and n log n in large groups.
    pub fn of_triangles(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let key = |face: u32| {
            let mut corners = triangles[face as usize];
            corners.sort_unstable();
            let [a, b, c] = corners;
            if a == b { [a, c, c] } else { [a, b, c] }
        };
        let mut places = vec![0u32; vertices + 1];
        (0..triangles.len() as u32).for_each(|face| places[key(face)[0] as usize + 1] += 1);
        (1..places.len()).for_each(|vertex| places[vertex] += places[vertex - 1]);
        let mut faces = vec![0; triangles.len()];
        for face in 0..triangles.len() as u32 {
            let place = &mut places[key(face)[0] as usize];
            faces[*place as usize] = face;
            *place += 1;
        }
        // Each vertex' place has moved to where the next one starts.
        let mut start = 0;
        for &end in &places[..vertices] {
            let around = &mut faces[start..end as usize];
            if around.len() > 1 {
                around.sort_unstable_by_key(|&face| (key(face), face));
            }
            start = end as usize;
        }
        Self::of_sorted(faces, |a, b| key(a) == key(b))
    }

    /// Groups of polygons with the same corners in the same order, wherever it starts and whichever way it runs.
    pub fn of_polygons<'a>(faces: u32, outline: impl Fn(u32) -> &'a [u32]) -> Self {
        let (mut keys, mut starts): (Vec<u32>, Vec<usize>) = (Vec::new(), vec![0]);
        for face in 0..faces {
            let forward = outline(face);
            let backward: Vec<u32> = forward.iter().rev().copied().collect();
            let (from, back) = (least_rotation(forward), least_rotation(&backward));
            let turned = |ring: &'a [u32], from: usize| ring[from..].iter().chain(&ring[..from]);
            let reversed = || backward[back..].iter().chain(&backward[..back]);
            if turned(forward, from).le(reversed()) {
                keys.extend(turned(forward, from));
            } else {
                keys.extend(reversed());
            }
            starts.push(keys.len());
        }
        let key = |face: u32| &keys[starts[face as usize]..starts[face as usize + 1]];
        let mut sorted: Vec<u32> = (0..faces).collect();
        sorted.sort_unstable_by(|&a, &b| key(a).cmp(key(b)).then(a.cmp(&b)));
        Self::of_sorted(sorted, |a, b| key(a) == key(b))
    }

    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The faces of a group, rising.
    pub fn get(&self, group: u32) -> &[u32] {
        let group = group as usize;
        &self.faces[self.starts[group] as usize..self.starts[group + 1] as usize]
    }
}

/// Where the smallest rotation of a ring starts, in linear time (Booth 1980, in the two-pointer form).
fn least_rotation(ring: &[u32]) -> usize {
    let at = |place: usize| ring[place % ring.len()];
    let (mut i, mut j, mut same) = (0, 1, 0);
    while i < ring.len() && j < ring.len() && same < ring.len() {
        let (a, b) = (at(i + same), at(j + same));
        if a == b {
            same += 1;
            continue;
        }
        // No rotation from the larger one's start to where they differ can be the smallest.
        if a > b {
            i += same + 1;
        } else {
            j += same + 1;
        }
        if i == j {
            j += 1;
        }
        same = 0;
    }
    i.min(j)
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

    #[test]
    fn triangles_group_by_their_corners_alone() {
        let triangles = [[3, 1, 2], [0, 1, 2], [2, 1, 3], [1, 2, 3], [0, 0, 1], [1, 0, 1], [4, 4, 4]];
        let groups = Groups::of_triangles(&triangles, 5);
        let mut found: Vec<&[u32]> = (0..groups.len() as u32).map(|group| groups.get(group)).collect();
        found.sort_unstable();
        assert_eq!(found, [&[0, 2, 3][..], &[1], &[4, 5], &[6]]);
        assert_eq!(Groups::of_triangles(&[], 0).len(), 0);
    }

    #[test]
    fn polygons_group_by_their_ring() {
        let faces: [&[u32]; 6] =
            [&[0, 1, 2, 3], &[2, 3, 0, 1], &[0, 3, 2, 1], &[0, 2, 1, 3], &[5, 5, 5], &[1, 2, 1, 3]];
        let groups = Groups::of_polygons(6, |face| faces[face as usize]);
        let mut found: Vec<&[u32]> = (0..groups.len() as u32).map(|group| groups.get(group)).collect();
        found.sort_unstable();
        assert_eq!(found, [&[0, 1, 2][..], &[3], &[4], &[5]]);
    }

    #[test]
    fn the_least_rotation_is_the_least() {
        for length in 1..7u32 {
            for code in 0..3u32.pow(length) {
                let ring: Vec<u32> = (0..length).map(|i| code / 3u32.pow(i) % 3).collect();
                let turned = |from: usize| ring[from..].iter().chain(&ring[..from]).copied().collect::<Vec<u32>>();
                let least = (0..ring.len()).map(turned).min().unwrap();
                assert_eq!(turned(least_rotation(&ring)), least);
            }
        }
    }
}
