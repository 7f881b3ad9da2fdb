//! Triangles by where they stand across the x axis.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Reservation};

use crate::JudgeError;

/// A grid over y and z with the triangles whose boxes meet each cell, so that a ray along x asks one cell.
///
/// It has about as many cells as triangles, fewer where that would list triangles more than eight times each.
#[derive(Debug)]
pub(crate) struct Columns {
    low: [f64; 2],
    per_cell: [f64; 2],
    cells: usize,
    starts: Vec<u32>,
    triangles: Vec<u32>,
    _memory: Reservation,
}

impl Columns {
    /// Gathers the triangles over positions of magnitude at most 1.
    pub fn new(triangles: &[[u32; 3]], positions: &[DVec3], exec: &Exec) -> Result<Self, JudgeError> {
        let boxed = |triangle: &[u32; 3]| {
            let corners = triangle.map(|vertex| positions[vertex as usize]);
            [1, 2].map(|axis| {
                let [a, b, c] = corners.map(|corner| corner[axis]);
                [a.min(b).min(c), a.max(b).max(c)]
            })
        };
        let mut bounds = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
        for triangle in triangles {
            for (whole, [low, high]) in bounds.iter_mut().zip(boxed(triangle)) {
                *whole = [whole[0].min(low), whole[1].max(high)];
            }
        }
        let low = bounds.map(|[low, _]| low);
        let mut cells = ((triangles.len() as f64).sqrt() as usize).clamp(1, 1024);
        loop {
            let per_cell = bounds.map(|[low, high]| if high > low { cells as f64 / (high - low) } else { 0.0 });
            let mut grid =
                Self { low, per_cell, cells, starts: Vec::new(), triangles: Vec::new(), _memory: exec.reserve(0)? };
            let span = |triangle: &[u32; 3]| {
                let [y, z] = boxed(triangle);
                [grid.cell(0, y[0])..=grid.cell(0, y[1]), grid.cell(1, z[0])..=grid.cell(1, z[1])]
            };
            let listed: usize = triangles
                .iter()
                .map(|triangle| {
                    let [y, z] = span(triangle);
                    (y.end() - y.start() + 1) * (z.end() - z.start() + 1)
                })
                .fold(0, usize::saturating_add);
            if listed > 8 * triangles.len() && cells > 1 {
                exec.check()?;
                cells /= 2;
                continue;
            }
            let memory = exec.reserve(4 * (listed + 2 * cells * cells + 2) as u64)?;
            let mut starts = vec![0u32; cells * cells + 1];
            let each = |triangle: &[u32; 3], visit: &mut dyn FnMut(usize)| {
                let [y, z] = span(triangle);
                z.for_each(|z| y.clone().for_each(|y| visit(z * cells + y)));
            };
            triangles.iter().for_each(|triangle| each(triangle, &mut |cell| starts[cell + 1] += 1));
            (1..starts.len()).for_each(|cell| starts[cell] += starts[cell - 1]);
            let mut next = starts.clone();
            let mut found = vec![0u32; listed];
            for (index, triangle) in triangles.iter().enumerate() {
                each(triangle, &mut |cell| {
                    found[next[cell] as usize] = index as u32;
                    next[cell] += 1;
                });
            }
            grid.starts = starts;
            grid.triangles = found;
            grid._memory = memory;
            return Ok(grid);
        }
    }

    fn cell(&self, axis: usize, at: f64) -> usize {
        // Rounding is the same for equal numbers and keeps their order, so nothing falls between cells.
        (((at - self.low[axis]) * self.per_cell[axis]) as usize).min(self.cells - 1)
    }

    /// The triangles whose boxes may hold the point's y and z, rising.
    pub fn around(&self, point: DVec3) -> &[u32] {
        let cell = self.cell(1, point.z) * self.cells + self.cell(0, point.y);
        &self.triangles[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}
