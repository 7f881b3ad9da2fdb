//! Which faces have equal corners.

use crate::cycle::canonical;

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
            keys.extend(canonical(outline(face)));
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
