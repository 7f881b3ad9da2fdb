//! Which cells of a height field are whole, and the outline of its holes.

use shapeloom_core::{ConvertError, Exec, Reservation};

use crate::HeightField;

/// A bit for each cell: whether all of its corners have heights.
pub(super) struct WholeCells {
    bits: Vec<u64>,
    size: [u32; 2],
    count: u64,
    _memory: Reservation,
}

impl WholeCells {
    pub(super) fn of(field: &HeightField, exec: &Exec) -> Result<Self, ConvertError> {
        let size = [field.columns() - 1, field.rows() - 1];
        let words = (u64::from(size[0]) * u64::from(size[1])).div_ceil(64);
        let memory = exec.reserve_elements(words, 8)?;
        let mut cells = Self { bits: vec![0; words as usize], size, count: 0, _memory: memory };
        let width = field.columns() as usize;
        for (y, rows) in field.heights().windows(2 * width).step_by(width).enumerate() {
            exec.check()?;
            let (low, high) = rows.split_at(width);
            let missing = |x: usize| low[x].is_nan() || high[x].is_nan();
            let mut left = missing(0);
            for x in 1..width {
                let right = missing(x);
                if !left && !right {
                    let cell = y * size[0] as usize + x - 1;
                    cells.bits[cell / 64] |= 1 << (cell % 64);
                    cells.count += 1;
                }
                left = right;
            }
        }
        Ok(cells)
    }

    /// How many cells are whole.
    pub(super) fn count(&self) -> u64 {
        self.count
    }

    /// Whether a cell is whole; none beyond the grid is.
    pub(super) fn has(&self, x: u32, y: u32) -> bool {
        let cell = y as usize * self.size[0] as usize + x as usize;
        x < self.size[0] && y < self.size[1] && self.bits[cell / 64] >> (cell % 64) & 1 == 1
    }

    fn are_all(&self) -> bool {
        self.count == u64::from(self.size[0]) * u64::from(self.size[1])
    }

    /// The straight runs of the outline between holes and whole cells, from corner to corner.
    pub(super) fn runs(&self, exec: &Exec) -> Result<Vec<[[u32; 2]; 2]>, ConvertError> {
        let mut runs = Vec::new();
        if self.are_all() || self.count == 0 {
            return Ok(runs);
        }
        for (along, across, upright) in [(self.size[0], self.size[1], false), (self.size[1], self.size[0], true)] {
            let turned = |i: u32, j: u32| if upright { [j, i] } else { [i, j] };
            let whole = |i: u32, j: u32| {
                let [x, y] = turned(i, j);
                self.has(x, y)
            };
            for line in 1..across {
                exec.check()?;
                let mut open: Option<(u32, bool)> = None;
                for i in 0..=along {
                    let (below, above) = (i < along && whole(i, line - 1), i < along && whole(i, line));
                    let side = (below != above).then_some(above);
                    if let Some((start, was)) = open
                        && side != Some(was)
                    {
                        runs.push([turned(start, line), turned(i, line)]);
                        open = None;
                    }
                    if let (None, Some(side)) = (open, side) {
                        open = Some((i, side));
                    }
                }
            }
        }
        Ok(runs)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    #[test]
    fn runs_end_where_the_outline_turns_or_crosses() {
        // Two whole cells that touch in a corner, in a field of holes.
        let mut heights = vec![f64::NAN; 25];
        for (x, y) in [(1, 1), (2, 1), (1, 2), (2, 2), (3, 2), (2, 3), (3, 3)] {
            heights[y * 5 + x] = 0.0;
        }
        let field = HeightField::try_new(5, 5, DVec2::ONE, heights).unwrap();
        let cells = WholeCells::of(&field, &Exec::default()).unwrap();
        assert_eq!((cells.count(), cells.has(1, 1), cells.has(2, 2), cells.has(1, 2)), (2, true, true, false));
        let runs = cells.runs(&Exec::default()).unwrap();
        assert_eq!(runs.len(), 8);
        assert!(runs.iter().all(|[p, q]| p[0].abs_diff(q[0]) + p[1].abs_diff(q[1]) == 1));
    }
}
