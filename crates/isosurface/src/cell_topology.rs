//! Cells whose topology the samples decide.

use std::sync::LazyLock;

use crate::cube_cycles::{CUBE_EDGES, INNER, Outlines, ambiguous_faces};
use crate::pattern::cube_pattern;
use crate::trilinear_cell::{CellSurface, Corners, joined_faces};

/// The outlines for every choice of inside corners and of joined faces among the ambiguous ones.
struct AllOutlines {
    outlines: Vec<Outlines>,
    /// Where those of a choice of corners start.
    starts: [u16; 256],
    /// Whether the samples have a say in a cell.
    open: [bool; 256],
    /// The place of each edge in the pattern of cubes.
    places: [u8; 12],
}

static ALL: LazyLock<AllOutlines> = LazyLock::new(|| {
    let pattern = cube_pattern(false);
    let mut all = AllOutlines {
        outlines: Vec::new(),
        starts: [0; 256],
        open: [false; 256],
        places: CUBE_EDGES.map(|edge| pattern.place(edge)),
    };
    for mask in 0..=255u8 {
        let ambiguous = ambiguous_faces(mask);
        all.starts[mask as usize] = all.outlines.len() as u16;
        // Bits of `choice` go to the ambiguous faces in order.
        for choice in 0..1u8 << ambiguous.count_ones() {
            all.outlines.push(Outlines::new(mask, spread(choice, ambiguous)));
        }
        // A tunnel joins two cycles.
        let cycles = &all.outlines[all.starts[mask as usize] as usize].cycles;
        all.open[mask as usize] = ambiguous != 0 || cycles.len() > 1;
    }
    all
});

/// The bits of `choice`, one for each bit that is set in `at`.
fn spread(choice: u8, at: u8) -> u8 {
    let places = (0..8).filter(|place| at >> place & 1 == 1).enumerate();
    places.fold(0, |bits, (number, place)| bits | (choice >> number & 1) << place)
}

/// The bits of `choice` where `at` has bits, put together: the inverse of [`spread`].
fn gather(choice: u8, at: u8) -> u8 {
    let places = (0..8).filter(|place| at >> place & 1 == 1).enumerate();
    places.fold(0, |bits, (number, place)| bits | (choice >> place & 1) << number)
}

/// What decides the topology of cells of cubes by their samples.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellTopology;

impl CellTopology {
    /// How many triangles and inner vertices a cell has.
    pub(crate) fn count(&self, mask: u8, corners: impl FnOnce() -> Corners) -> [u32; 2] {
        match self.surface(mask, corners) {
            None => [cube_pattern(false).count(mask), 0],
            Some(surface) => [surface.triangles.len() as u32, surface.inner.len() as u32],
        }
    }

    /// The surface in a cell; none where the pattern of cubes tells it.
    pub(crate) fn surface(&self, mask: u8, corners: impl FnOnce() -> Corners) -> Option<CellSurface> {
        if !ALL.open[mask as usize] {
            return None;
        }
        let corners = corners();
        let joined = joined_faces(mask, &corners);
        let at = ALL.starts[mask as usize] + u16::from(gather(joined, ambiguous_faces(mask)));
        let outlines = &ALL.outlines[at as usize];
        Some(CellSurface::new(mask, joined, outlines, &corners))
    }

    /// The place of an edge's vertex in the pattern of cubes, or which inner vertex it is.
    pub(crate) fn place(&self, corner: u8) -> Result<u8, u8> {
        ALL.places.get(corner as usize).copied().ok_or(corner.wrapping_sub(INNER))
    }
}
