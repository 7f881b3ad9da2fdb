//! The sides of faces, grouped by the edge that they lie on.

use std::ops::Range;

use shapeloom_core::{Exec, OverBudget, Stop, parallel};

use super::face_list::{FaceList, ordered, sides_of};

/// Faces that one task distributes at once; fixed, so that results do not depend on the number of threads.
const FACES: usize = 1 << 15;
/// Vertices whose edges are sorted together: few enough for their sides to stay in the second-level cache (four sides a vertex at
/// 12 bytes are 200 kB), as many as possible because every bucket of a chunk is a write stream of its own.
const BUCKET: u32 = 1 << 12;
/// More streams than this cost more than they save.
const BUCKETS: u32 = 1 << 11;

/// Sides that lie on edges whose smaller vertex is in one range, ready to be taken apart by edge.
pub(crate) struct Bucket<'a> {
    vertices: Range<u32>,
    sides: &'a [[u32; 3]],
}

/// An edge and the sides on it.
pub(crate) struct EdgeSides<'a> {
    /// The vertices, the smaller first.
    pub(crate) vertices: [u32; 2],
    keys: &'a [u64],
}

impl EdgeSides<'_> {
    /// How many sides lie on the edge.
    pub(crate) fn len(&self) -> usize {
        self.keys.len()
    }

    /// The corner at which the `i`th side starts; they rise.
    pub(crate) fn corner(&self, i: usize) -> u32 {
        self.keys[i] as u32
    }

    /// The corners at which the sides start, rising.
    pub(crate) fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.keys.iter().map(|&key| key as u32)
    }
}

impl Bucket<'_> {
    /// Calls with every edge, in the order of its smaller and then its larger vertex.
    pub(crate) fn for_each_edge(&self, mut f: impl FnMut(EdgeSides<'_>)) {
        let first = self.vertices.start;
        let mut ends = vec![0u32; self.vertices.len() + 1];
        for &[low, ..] in self.sides {
            ends[(low - first) as usize + 1] += 1;
        }
        for i in 1..ends.len() {
            ends[i] += ends[i - 1];
        }
        // `ends[i]` is where the sides of vertex i start; after they are laid out it is where they end.
        let mut keys = vec![0u64; self.sides.len()];
        for &[low, high, corner] in self.sides {
            let end = &mut ends[(low - first) as usize];
            keys[*end as usize] = u64::from(high) << 32 | u64::from(corner);
            *end += 1;
        }
        let mut start = 0;
        for (low, &end) in self.vertices.clone().zip(&ends) {
            let own = &mut keys[start..end as usize];
            start = end as usize;
            sort_few(own);
            for keys in own.chunk_by(|a, b| a >> 32 == b >> 32) {
                f(EdgeSides { vertices: [low, (keys[0] >> 32) as u32], keys });
            }
        }
    }
}

/// Sorts by insertion where there are so few that calling the library costs more.
fn sort_few(keys: &mut [u64]) {
    if keys.len() > 24 {
        keys.sort_unstable();
        return;
    }
    for i in 1..keys.len() {
        let key = keys[i];
        let mut j = i;
        while j > 0 && keys[j - 1] > key {
            keys[j] = keys[j - 1];
            j -= 1;
        }
        keys[j] = key;
    }
}

/// Groups the sides of faces by edge, and calls `f` with each bucket of edges: in parallel, results in order of the
/// buckets, whose edges follow one another by smaller and then larger vertex. Sides between equal corners lie on no edge.
///
/// Takes 12 bytes a corner while it runs, and 8 for the buckets at work; linear but for the sorting of edges at one vertex.
///
/// # Errors
/// The first that `f` gives, the budget, or the reason to stop.
pub(crate) fn by_edge<T: Send, E: Send + From<Stop> + From<OverBudget>>(
    faces: &impl FaceList,
    exec: &Exec,
    f: impl Fn(Bucket<'_>) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let vertices = faces.vertex_total() as u32;
    let _memory = exec.reserve_elements(faces.all_corners().len() as u64, 12 + 8)?;
    let mut width = BUCKET;
    while vertices.div_ceil(width) > BUCKETS {
        width *= 2;
    }
    let shift = width.trailing_zeros();
    let buckets = vertices.div_ceil(width) as usize;

    // How many sides each chunk of faces gives to each bucket.
    let counts = parallel::map_chunks(exec, faces.face_total(), FACES, |chunk| {
        let mut counts = vec![0u32; buckets];
        for_sides(faces, chunk, |low, _, _| counts[(low >> shift) as usize] += 1);
        Ok::<_, E>(counts)
    })?;
    let mut starts = Vec::with_capacity(buckets + 1);
    let mut total = 0usize;
    for bucket in 0..buckets {
        starts.push(total);
        total += counts.iter().map(|chunk| chunk[bucket] as usize).sum::<usize>();
    }
    starts.push(total);

    // Each chunk writes its own part of every bucket, one chunk after another.
    let mut sides = vec![[0u32; 3]; total];
    let mut parts: Vec<Vec<&mut [[u32; 3]]>> = counts.iter().map(|_| Vec::with_capacity(buckets)).collect();
    let mut rest = sides.as_mut_slice();
    for bucket in 0..buckets {
        for (chunk, counts) in counts.iter().enumerate() {
            let (own, after) = rest.split_at_mut(counts[bucket] as usize);
            parts[chunk].push(own);
            rest = after;
        }
    }
    parallel::fill_chunks(exec, &mut parts, 1, |chunk, parts| {
        let faces_of_chunk = chunk * FACES..((chunk + 1) * FACES).min(faces.face_total());
        let streams = &mut parts[0];
        let mut filled = vec![0u32; buckets];
        for_sides(faces, faces_of_chunk, |low, high, corner| {
            let bucket = (low >> shift) as usize;
            streams[bucket][filled[bucket] as usize] = [low, high, corner];
            filled[bucket] += 1;
        });
        Ok::<_, E>(())
    })?;

    parallel::map_chunks(exec, buckets, 1, |bucket| {
        let first = bucket.start as u32 * width;
        let vertices = first..vertices.min(first.saturating_add(width));
        f(Bucket { vertices, sides: &sides[starts[bucket.start]..starts[bucket.start + 1]] })
    })
}

fn for_sides(faces: &impl FaceList, chunk: Range<usize>, mut f: impl FnMut(u32, u32, u32)) {
    for face in chunk {
        for (corner, side) in sides_of(faces, face as u32) {
            let [low, high] = ordered(side);
            if low != high {
                f(low, high, corner);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::structures::{IndexedPolygons, IndexedTriangles, StructureError};

    /// What it does in a dozen slow lines.
    fn plainly(faces: &impl FaceList) -> Vec<([u32; 2], Vec<u32>)> {
        let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for corner in 0..faces.all_corners().len() as u32 {
            let [a, b] = faces.side(corner);
            if a != b {
                edges.entry([a.min(b), a.max(b)]).or_default().push(corner);
            }
        }
        edges.into_iter().collect()
    }

    fn grouped(faces: &impl FaceList, exec: &Exec) -> Vec<([u32; 2], Vec<u32>)> {
        let parts = by_edge(faces, exec, |bucket| {
            let mut edges = Vec::new();
            bucket.for_each_edge(|edge| edges.push((edge.vertices, edge.corners().collect())));
            Ok::<_, StructureError>(edges)
        });
        parts.unwrap().concat()
    }

    #[test]
    fn every_side_lies_on_its_edge() {
        let mut state = 7u32;
        let mut random = |below: u32| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) % below
        };
        // Few vertices and many, degenerate faces, one vertex with very many edges, more faces than a chunk.
        for (vertices, count) in [(1, 3), (3, 50), (9000, 40_000), (100_000, 70_000), (9000, 0)] {
            let mut triangles: Vec<[u32; 3]> = (0..count).map(|_| [(); 3].map(|()| random(vertices))).collect();
            for i in 0..count / 3 {
                triangles[i as usize][0] = vertices / 2;
            }
            let faces = IndexedTriangles::try_new(vertices, triangles).unwrap();
            let wanted = plainly(&faces);
            let alone = Exec::default().with_threads(shapeloom_core::Threads::Sequential);
            assert!(grouped(&faces, &alone) == wanted, "{vertices}");
            assert!(grouped(&faces, &Exec::default()) == wanted, "{vertices}");
            let polygons = IndexedPolygons::from(&faces);
            assert!(grouped(&polygons, &Exec::default()) == wanted, "{vertices}");
        }
    }
}
