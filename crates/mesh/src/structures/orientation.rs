//! Which faces to turn over so that neighbours agree on an outside.

use shapeloom_core::{Exec, OverBudget, Stop};

use super::face_list::FaceList;
use super::sides::by_edge;

/// How many steps may pass between two looks at whether to stop.
const POLL: usize = 1 << 16;
/// Of an orientation of a face that was not met.
const UNSEEN: u64 = u64::MAX;

/// An edge of two faces: the faces, and whether one of them must be turned over for them to agree.
#[derive(Clone, Copy)]
struct Link {
    faces: [u32; 2],
    differ: bool,
}

/// How the faces of a mesh lie to each other across the edges that have two.
///
/// Edges with more than two faces bind nothing, so a mesh falls apart there.
#[derive(Debug, Default)]
pub(crate) struct Orientation {
    /// The component of each face, numbered by their smallest faces.
    pub(crate) components: Vec<u32>,
    /// Whether each face lies the other way around than the smallest face of its component.
    pub(crate) against: Vec<bool>,
    /// For each component whether it has no orientation, with a ring of faces that shows it: each shares an edge with the next,
    /// the last with the first; orienting one after the other alike turns the first over.
    pub(crate) one_sided: Vec<(u32, Vec<u32>)>,
    /// The components that have a border, or an edge of more than two faces.
    pub(crate) open: Vec<bool>,
    /// How many edges have more than two faces.
    pub(crate) crowded_edges: usize,
}

impl Orientation {
    /// Looks at all faces. Linear but for the sorting of sides; 20 bytes a corner and 8 a face while it runs.
    pub(crate) fn of<E>(faces: &impl FaceList, exec: &Exec) -> Result<Self, E>
    where
        E: Send + From<Stop> + From<OverBudget>,
    {
        let count = faces.face_total();
        // A link takes 12 bytes and binds two corners; of a face the sets keep 8 bytes, the result 5, and a little in between.
        let _memory = exec.reserve_elements(faces.all_corners().len() as u64 + 2 * count as u64, 12)?;
        let found = by_edge(faces, exec, |bucket| {
            let (mut links, mut odd, mut crowded) = (Vec::new(), Vec::new(), 0);
            bucket.for_each_edge(|edge| {
                if edge.len() == 2 {
                    let forward = [0, 1].map(|i| faces.all_corners()[edge.corner(i) as usize] == edge.vertices[0]);
                    let faces = [0, 1].map(|i| faces.face_of(edge.corner(i)));
                    links.push(Link { faces, differ: forward[0] == forward[1] });
                } else {
                    odd.extend(edge.corners().map(|corner| faces.face_of(corner)));
                    crowded += usize::from(edge.len() > 2);
                }
            });
            Ok::<_, E>((links, odd, crowded))
        })?;
        let mut sets = Sets::new(count);
        let mut torn = Vec::new();
        for (number, link) in found.iter().flat_map(|(links, ..)| links).enumerate() {
            if number % POLL == 0 {
                exec.check()?;
            }
            let [a, b] = link.faces;
            if !sets.unite(a, b, link.differ) {
                torn.push(a);
            }
        }
        exec.check()?;
        let mut result = Self { crowded_edges: found.iter().map(|part| part.2).sum(), ..Self::default() };
        let mut numbers = vec![u32::MAX; count];
        let mut first_against = Vec::new();
        for face in 0..count as u32 {
            if (face as usize).is_multiple_of(POLL) {
                exec.check()?;
            }
            let (root, against) = sets.find(face);
            if numbers[root as usize] == u32::MAX {
                numbers[root as usize] = first_against.len() as u32;
                first_against.push(against);
            }
            let component = numbers[root as usize];
            result.components.push(component);
            result.against.push(against != first_against[component as usize]);
        }
        result.open = vec![false; first_against.len()];
        for &face in found.iter().flat_map(|(_, odd, _)| odd) {
            result.open[result.components[face as usize] as usize] = true;
        }
        torn.sort_unstable_by_key(|&face| result.components[face as usize]);
        torn.dedup_by_key(|face| result.components[*face as usize]);
        if !torn.is_empty() {
            // The links once more, both ways, and two words for each orientation of a face.
            let _more = exec.reserve_elements(faces.all_corners().len() as u64 + count as u64, 20)?;
            let links: Vec<Link> = found.into_iter().flat_map(|(links, ..)| links).collect();
            let neighbours = Neighbours::new(count, &links);
            let mut before = vec![UNSEEN; 2 * count];
            for face in torn {
                let ring = neighbours.ring(face, &mut before, exec)?;
                result.one_sided.push((result.components[face as usize], ring));
            }
        }
        Ok(result)
    }
}

/// Sets of faces with the orientation of each against its set's root.
struct Sets {
    /// The parent, and whether the face lies the other way around than it.
    parents: Vec<(u32, bool)>,
}

impl Sets {
    fn new(count: usize) -> Self {
        Self { parents: (0..count as u32).map(|face| (face, false)).collect() }
    }

    /// The root, and whether the face lies the other way around. Halves the way to it for the next time.
    fn find(&mut self, mut face: u32) -> (u32, bool) {
        let mut against = false;
        loop {
            let (parent, turned) = self.parents[face as usize];
            if parent == face {
                return (face, against);
            }
            let (grandparent, also) = self.parents[parent as usize];
            if grandparent != parent {
                self.parents[face as usize] = (grandparent, turned != also);
            }
            against ^= turned;
            face = parent;
        }
    }

    /// Joins two faces; false if they are in one set already and the other way around.
    fn unite(&mut self, a: u32, b: u32, differ: bool) -> bool {
        let ((a, a_against), (b, b_against)) = (self.find(a), self.find(b));
        let differ = differ != (a_against != b_against);
        if a == b {
            return !differ;
        }
        // The smaller face leads; halving alone keeps ways short.
        self.parents[a.max(b) as usize] = (a.min(b), differ);
        true
    }
}

/// The faces across the edges of each face.
struct Neighbours {
    starts: Vec<u32>,
    across: Vec<(u32, bool)>,
}

impl Neighbours {
    fn new(count: usize, links: &[Link]) -> Self {
        let mut starts = vec![0u32; count + 1];
        for face in links.iter().flat_map(|link| link.faces) {
            starts[face as usize + 1] += 1;
        }
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut filled = starts.clone();
        let mut across = vec![(0, false); links.len() * 2];
        for &Link { faces: [a, b], differ } in links {
            for (from, to) in [(a, b), (b, a)] {
                across[filled[from as usize] as usize] = (to, differ);
                filled[from as usize] += 1;
            }
        }
        Self { starts, across }
    }

    /// A ring of faces that turns over, without a face twice: from a face of a component that has no orientation. Breadth
    /// first over faces with an orientation each, from the face to the face turned over. `before` is for each of these states
    /// the one from which it was met, `2 * face`, and one more if turned over; components share it, as they share no face.
    fn ring(&self, face: u32, before: &mut [u64], exec: &Exec) -> Result<Vec<u32>, Stop> {
        let start = 2 * u64::from(face);
        before[start as usize] = start;
        let mut queue = std::collections::VecDeque::from([start]);
        let mut steps = 0usize;
        while let Some(at) = queue.pop_front() {
            if steps.is_multiple_of(POLL) {
                exec.check()?;
            }
            steps += 1;
            let own = at as usize / 2;
            for &(next, differ) in &self.across[self.starts[own] as usize..self.starts[own + 1] as usize] {
                let next = 2 * u64::from(next) + ((at & 1) ^ u64::from(differ));
                if before[next as usize] != UNSEEN {
                    continue;
                }
                before[next as usize] = at;
                if next != start + 1 {
                    queue.push_back(next);
                    continue;
                }
                let mut way = vec![];
                let mut step = at;
                while step != start {
                    way.push((step / 2) as u32);
                    step = before[step as usize];
                }
                way.push(face);
                way.reverse();
                return Ok(innermost(&way));
            }
        }
        Ok(vec![face])
    }
}

/// The part of a closed way between the first face that comes twice and its first coming: the way to the ring is left out.
fn innermost(way: &[u32]) -> Vec<u32> {
    let mut seen = std::collections::HashMap::new();
    for (i, &face) in way.iter().enumerate() {
        if let Some(&from) = seen.get(&face) {
            return way[from..i].to_vec();
        }
        seen.insert(face, i);
    }
    way.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_to_a_ring_is_left_out() {
        assert_eq!(innermost(&[7, 1, 2, 3, 1]), [1, 2, 3]);
        assert_eq!(innermost(&[1, 2, 3]), [1, 2, 3]);
    }

    /// A fan of triangles each of which lies the other way around than the one before: against the smallest, whichever way
    /// that one was linked.
    #[test]
    fn faces_are_compared_with_the_smallest_of_their_component() {
        for turned in 0..32u32 {
            let triangles: Vec<[u32; 3]> =
                (0..5u32).map(|k| if turned >> k & 1 == 1 { [0, k + 2, k + 1] } else { [0, k + 1, k + 2] }).collect();
            let mesh = crate::TriMesh::try_new(vec![Default::default(); 7], triangles).unwrap();
            let found = Orientation::of::<shapeloom_core::ConvertError>(&mesh, &Exec::default()).unwrap();
            let expected: Vec<bool> = (0..5).map(|k| (turned >> k ^ turned) & 1 == 1).collect();
            assert_eq!(found.against, expected, "{turned:b}");
        }
    }
}
