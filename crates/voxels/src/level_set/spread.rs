//! Distances at every sample of a lattice, from the surface that is near another sample.

use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{ConvertError, Exec};
use shapeloom_isosurface::Lattice;

use super::place;
use super::surface::{Nearest, Surface};
use crate::waves::{Beside, Sweep};

/// No cell yet.
const NONE: u32 = u32::MAX;
/// The bytes of a sample: the cell that it is nearest to, and its distance.
pub(super) const SAMPLE_BYTES: usize = 8;
/// Samples between two polls.
const POLL: usize = 1 << 10;
/// Samples of the rows that are visited in one go.
const CHUNK: usize = 1 << 12;

/// The samples of a row: the squared distances from the middles of their cells, in diagonals of a cell.
struct Row<'a> {
    squared: &'a mut [f32],
    cells: &'a mut [u32],
}

/// Distances that have no sign, up to `limit`, in model units. The surface has a cell at least.
///
/// First every sample gets a cell with surface: sweeps in all orders hand cells on to the next sample, which takes the
/// one whose middle is nearest (Danielsson 1980; Tsai 2002). Then every sample looks for the nearest triangle in that
/// cell and around it, and at last in the cells that its neighbours found.
pub(super) fn distances(
    surface: &Surface,
    lattice: &Lattice,
    limit: f64,
    exec: &Exec,
) -> Result<Vec<f32>, ConvertError> {
    let samples = lattice.samples() as usize;
    let columns = lattice.dimensions()[0] as usize;
    let diagonal = lattice.cell_diagonal();
    let _middles = exec.reserve_elements(surface.cells() as u64, size_of::<[f32; 3]>())?;
    let middles: Vec<[f32; 3]> = surface.middles().map(|middle| (middle / diagonal).as_vec3().to_array()).collect();
    let mut squared = vec![f32::INFINITY; samples];
    let mut cells = vec![NONE; samples];
    let scaled = |at: [u32; 3]| (place(lattice.placement(), at) / diagonal).as_vec3().to_array();
    let from = |[x, y, z]: [f32; 3], cell: u32| {
        let [a, b, c] = middles[cell as usize];
        (x - a) * (x - a) + (y - b) * (y - b) + (z - c) * (z - c)
    };
    for cell in 0..surface.cells() as u32 {
        if (cell as usize).is_multiple_of(POLL) {
            exec.check()?;
        }
        let base = surface.base(cell);
        for corner in 0..8 {
            let at = std::array::from_fn(|axis| base[axis] + (corner >> axis & 1));
            let (index, found) = (lattice.index(at) as usize, from(scaled(at), cell));
            if found < squared[index] {
                (squared[index], cells[index]) = (found, cell);
            }
        }
    }
    let [_, rows, slabs] = lattice.dimensions().map(|count| count as usize);
    let step = (lattice.placement().linear.x_axis / diagonal).as_vec3().to_array();
    let visit = |[j, k]: [usize; 2], row: &mut Row<'_>, beside: Beside<'_, Row<'_>>| {
        let start = scaled([0, j as u32, k as u32]);
        let position = |i: usize| std::array::from_fn(|axis| start[axis] + step[axis] * i as f32);
        let mut offer = |i: usize, cell: u32| {
            if cell != NONE && cell != row.cells[i] {
                let found = from(position(i), cell);
                if found < row.squared[i] {
                    (row.squared[i], row.cells[i]) = (found, cell);
                }
            }
            row.cells[i]
        };
        for other in beside.before.into_iter().flatten() {
            for (i, &cell) in other.cells.iter().enumerate() {
                offer(i, cell);
            }
        }
        let mut last = NONE;
        for i in 0..columns {
            last = offer(i, last);
        }
        for i in (0..columns).rev() {
            last = offer(i, last);
        }
        Ok(())
    };
    for (number, sweep) in (0u8..).zip(Sweep::all([rows, slabs])) {
        let exec = exec.part(f64::from(number) * 0.075, f64::from(number + 1) * 0.075);
        sweep.run(rows_of(&mut squared, &mut cells, columns), (CHUNK / columns).max(1), &exec, visit)?;
    }
    // No cell reaches farther from its middle than a diagonal, and another is for what sweeps miss.
    let far = (limit / diagonal + 2.0).powi(2) as f32;
    let (first, second) = (exec.part(0.3, 0.8), exec.part(0.8, 1.0));
    let mut each: Vec<Row<'_>> = rows_of(&mut squared, &mut cells, columns).collect();
    fill_chunks(&first, &mut each, 1, |number, row| {
        first.progress(number as f64 / (rows * slabs) as f64);
        let start = [0, (number % rows) as u32, (number / rows) as u32];
        for Row { squared, cells } in row {
            let mut last: Option<Nearest> = None;
            for (i, (value, cell)) in squared.iter_mut().zip(cells.iter_mut()).enumerate() {
                if i.is_multiple_of(POLL) {
                    exec.check()?;
                }
                if *value > far {
                    (*value, *cell, last) = (f32::INFINITY, NONE, None);
                    continue;
                }
                let position = place(lattice.placement(), [i as u32, start[1], start[2]]);
                // The nearest piece of the sample before is a good start, and leaves few to be looked at.
                let mut found = match last {
                    Some(last) => Nearest { squared: surface.distance_squared(position, last.piece), ..last },
                    None => Surface::start(*cell),
                };
                surface.look(position, *cell, &mut found);
                surface.climb(position, &mut found);
                last = Some(found);
                (*value, *cell) = (found.squared.sqrt() as f32, found.cell);
            }
        }
        Ok::<_, ConvertError>(())
    })?;
    drop(each);
    // Where a sample's cell is not beside those of its neighbours, one of theirs may be nearer after all.
    fill_chunks(&second, &mut squared, columns, |start, part| {
        second.progress(start as f64 / samples as f64);
        let [_, j, k] = lattice.coordinates(start as u64).map(|at| at as usize);
        for (i, value) in part.iter_mut().enumerate() {
            if i.is_multiple_of(POLL) {
                exec.check()?;
            }
            let own = cells[start + i];
            if own == NONE {
                *value = limit as f32;
                continue;
            }
            let position = place(lattice.placement(), [i, j, k].map(|at| at as u32));
            let mut best = Nearest { squared: f64::from(*value).powi(2), piece: 0, cell: own };
            for k in k.saturating_sub(1)..(k + 2).min(slabs) {
                for j in j.saturating_sub(1)..(j + 2).min(rows) {
                    let row = (k * rows + j) * columns;
                    for &cell in &cells[row + i.saturating_sub(1)..row + (i + 2).min(columns)] {
                        if cell != own && cell != NONE && !surface.are_beside(cell, own) {
                            surface.look(position, cell, &mut best);
                        }
                    }
                }
            }
            if best.cell != own {
                surface.climb(position, &mut best);
                *value = best.squared.sqrt() as f32;
            }
            *value = value.min(limit as f32);
        }
        Ok::<_, ConvertError>(())
    })?;
    Ok(squared)
}

/// The rows of a lattice, in its order.
fn rows_of<'a>(squared: &'a mut [f32], cells: &'a mut [u32], columns: usize) -> impl ExactSizeIterator<Item = Row<'a>> {
    let rows = squared.chunks_mut(columns).zip(cells.chunks_mut(columns));
    rows.map(|(squared, cells)| Row { squared, cells })
}
