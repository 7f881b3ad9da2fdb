//! Which faces stay together where four meet at an edge.

use shapeloom_core::{ConvertError, Exec, Reservation};

use super::corner::{EDGES, Fans, around, crossed_edges};
use super::{for_each_cell, touching_edges};
use crate::full_cells::FullCells;

/// How the faces at edges of four are paired.
///
/// Faces of one cell stay together, unless the fans at both ends of the edge hold all four faces: then two pairs would
/// share an edge between the same two vertices, and faces of one gap stay together instead. The change parts the fan at
/// each end into two and joins none, so an edge once decided stays right, and one pass over the edges does.
pub(super) struct Pairings {
    separate: bool,
    places: [u32; 3],
    /// The edges whose faces are paired by gap: `3 * place + axis`, rising.
    by_gap: Vec<u64>,
    /// The fans by full cells alone.
    table: Vec<Fans>,
    /// How many edges have four faces.
    pub touching: u64,
    _memory: Vec<Reservation>,
}

impl Pairings {
    /// Decides for every edge.
    ///
    /// # Errors
    /// The reason to stop, or too little memory.
    pub fn settle(cells: &FullCells, places: [u32; 3], separate: bool, exec: &Exec) -> Result<Self, ConvertError> {
        let fans = |mask| if separate { Fans::new(mask, 0) } else { Fans::together(mask) };
        let table = (0..=u8::MAX).map(fans).collect();
        let mut pairings = Self { separate, places, by_gap: Vec::new(), table, touching: 0, _memory: Vec::new() };
        if !separate {
            pairings.touching = touching_edges(cells, places, exec)?;
            return Ok(pairings);
        }
        for_each_cell(places, exec, |place| {
            let crossed = crossed_edges(around(cells, place));
            for axis in 0..3 {
                let edge = 2 * axis + 1;
                if crossed >> edge & 1 == 0 {
                    continue;
                }
                pairings.touching += 1;
                let mut end = place;
                end[axis] += 1;
                if pairings.fans(cells, place).same_at(edge) && pairings.fans(cells, end).same_at(edge - 1) {
                    if pairings.by_gap.len() == pairings.by_gap.capacity() {
                        let more = pairings.by_gap.len().max(1 << 10);
                        pairings._memory.push(exec.reserve_elements(more as u64, size_of::<u64>())?);
                        pairings.by_gap.reserve_exact(more);
                    }
                    pairings.by_gap.push(pairings.number(place, axis));
                }
            }
            Ok(())
        })?;
        Ok(pairings)
    }

    fn number(&self, [i, j, k]: [u32; 3], axis: usize) -> u64 {
        let [x, y, _] = self.places.map(u64::from);
        3 * ((u64::from(k) * y + u64::from(j)) * x + u64::from(i)) + axis as u64
    }

    /// The fans of faces at a place.
    pub fn fans(&self, cells: &FullCells, place: [u32; 3]) -> Fans {
        let mask = around(cells, place);
        let plain = self.table[usize::from(mask)];
        let crossed = crossed_edges(mask);
        if !self.separate || crossed == 0 || self.by_gap.is_empty() {
            return plain;
        }
        let mut by_gap = 0u8;
        for edge in (0..EDGES).filter(|edge| crossed >> edge & 1 == 1) {
            let (axis, mut start) = (edge / 2, place);
            // Four faces at an edge that comes from below: there is a place below.
            start[axis] = start[axis].saturating_sub(u32::from(edge % 2 == 0));
            by_gap |= u8::from(self.by_gap.binary_search(&self.number(start, axis)).is_ok()) << edge;
        }
        if by_gap == 0 { plain } else { Fans::new(mask, by_gap) }
    }
}
