//! Which sides of faces lie on which edge.

use shapeloom_core::{Exec, OverBudget, Reservation, Stop};

use crate::Faces;

/// The edges of a mesh, by their vertices, each with the wedges at which its sides begin. A side between a vertex and
/// itself is no edge.
#[derive(Debug)]
pub(crate) struct Edges {
    starts: Vec<u32>,
    wedges: Vec<u32>,
    _memory: Reservation,
}

/// Why edges could not be gathered.
#[derive(Debug)]
pub(crate) enum EdgesError {
    OverBudget(OverBudget),
    Stop(Stop),
}

impl Edges {
    /// Gathers the edges: a bucket for each smaller vertex, sorted by the larger one and the wedge. O(n log d) for n
    /// sides and d sides in the fullest bucket.
    pub fn new(faces: &Faces<'_>, exec: &Exec) -> Result<Self, EdgesError> {
        let sides = faces.corners().len();
        // The edges' starts are at most one a side; the buckets and their starts are gone at the end.
        let memory = exec.reserve_elements(2 * sides as u64 + 1, size_of::<u32>()).map_err(EdgesError::OverBudget)?;
        let _scratch = exec.reserve_elements(sides as u64, size_of::<u64>()).map_err(EdgesError::OverBudget)?;
        let _counts =
            exec.reserve_elements(faces.vertex_count() as u64 + 1, size_of::<u32>()).map_err(EdgesError::OverBudget)?;
        let check = |at: usize| if at.is_multiple_of(1 << 16) { exec.check() } else { Ok(()) };
        let rising = |wedge: u32| {
            let [a, b] = faces.side(wedge);
            [a.min(b), a.max(b)]
        };
        let mut ends = vec![0u32; faces.vertex_count()];
        for wedge in 0..sides as u32 {
            check(wedge as usize).map_err(EdgesError::Stop)?;
            let [low, high] = rising(wedge);
            ends[low as usize] += u32::from(low != high);
        }
        let mut total = 0;
        for end in &mut ends {
            // The starts for now; filling turns them into ends.
            (*end, total) = (total, total + *end);
        }
        let mut filled = vec![0u64; total as usize];
        for wedge in 0..sides as u32 {
            check(wedge as usize).map_err(EdgesError::Stop)?;
            let [low, high] = rising(wedge);
            if low != high {
                let place = &mut ends[low as usize];
                filled[*place as usize] = u64::from(high) << 32 | u64::from(wedge);
                *place += 1;
            }
        }
        let mut starts = Vec::with_capacity(total as usize / 2 + 1);
        let mut first = 0;
        for (low, &end) in ends.iter().enumerate() {
            check(low).map_err(EdgesError::Stop)?;
            let bucket = &mut filled[first as usize..end as usize];
            bucket.sort_unstable();
            for place in 0..bucket.len() {
                if place == 0 || bucket[place - 1] >> 32 != bucket[place] >> 32 {
                    starts.push(first + place as u32);
                }
            }
            first = end;
        }
        starts.push(total);
        let wedges = filled.into_iter().map(|packed| packed as u32).collect();
        Ok(Self { starts, wedges, _memory: memory })
    }

    /// How many edges there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// The wedges at which the sides on an edge begin, rising.
    pub fn uses(&self, edge: usize) -> &[u32] {
        &self.wedges[self.starts[edge] as usize..self.starts[edge + 1] as usize]
    }

    /// The uses of each edge, by their vertices.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &[u32]> {
        (0..self.len()).map(|edge| self.uses(edge))
    }
}
