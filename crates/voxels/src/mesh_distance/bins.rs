//! Which triangles come near which block of slabs.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec, Reservation};

use super::in_cells::InCells;

/// Triangles by blocks of slabs: each is listed in every block that it comes near.
pub(crate) struct Bins {
    /// How many slabs a block has; the last one may have fewer.
    pub slabs: u32,
    starts: Vec<usize>,
    members: Vec<u32>,
    _memory: Reservation,
}

/// How many samples a block has, about: enough that few triangles are near two blocks, few enough for the caches.
const BLOCK: usize = 1 << 20;

/// How many triangles are looked at before asking whether to stop.
const STEP: usize = 1 << 14;

impl Bins {
    /// Sorts triangles into blocks: those within `reach` cells of a slab. The blocks depend on the lattice alone, never on threads.
    pub fn new(mesh: &InCells<'_>, reach: f64, exec: &Exec) -> Result<Self, ConvertError> {
        let corners = |triangle: &[u32; 3]| triangle.map(|vertex| mesh.positions[vertex as usize]);
        Self::sorted(mesh.triangles, corners, mesh.dimensions, reach, exec)
    }

    /// The same for triangles by their corners, in lattice coordinates: the blocks are the same.
    pub fn of_corners(
        triangles: &[[DVec3; 3]],
        dimensions: [u32; 3],
        reach: f64,
        exec: &Exec,
    ) -> Result<Self, ConvertError> {
        Self::sorted(triangles, |corners| *corners, dimensions, reach, exec)
    }

    fn sorted<T>(
        triangles: &[T],
        corners: impl Fn(&T) -> [DVec3; 3],
        [columns, rows, count]: [u32; 3],
        reach: f64,
        exec: &Exec,
    ) -> Result<Self, ConvertError> {
        let slabs = (BLOCK / (columns as usize * rows as usize).max(1)).clamp(4, 16) as u32;
        let blocks = count.div_ceil(slabs) as usize;
        let top = f64::from(count - 1);
        let span = |triangle: &T| {
            let [a, b, c] = corners(triangle).map(|corner| corner.z);
            let (low, high) = (a.min(b).min(c) - reach, a.max(b).max(c) + reach);
            // In a range without end blocks are none.
            if low > top || high < 0.0 {
                return 0..0;
            }
            let block = |z: f64| (z.clamp(0.0, top) as u32 / slabs) as usize;
            block(low)..block(high) + 1
        };
        let mut starts = vec![0usize; blocks + 1];
        for part in triangles.chunks(STEP) {
            exec.check()?;
            for triangle in part {
                span(triangle).for_each(|block| starts[block + 1] += 1);
            }
        }
        for block in 0..blocks {
            starts[block + 1] += starts[block];
        }
        let memory = exec.reserve_elements(starts[blocks] as u64, size_of::<u32>())?;
        let mut members = vec![0u32; starts[blocks]];
        let mut next = starts.clone();
        for (part, triangles) in triangles.chunks(STEP).enumerate() {
            exec.check()?;
            for (index, triangle) in (part * STEP..).zip(triangles) {
                for block in span(triangle) {
                    members[next[block]] = index as u32;
                    next[block] += 1;
                }
            }
        }
        Ok(Self { slabs, starts, members, _memory: memory })
    }

    /// The triangles near a block, in order.
    pub fn of(&self, block: usize) -> &[u32] {
        &self.members[self.starts[block]..self.starts[block + 1]]
    }
}
