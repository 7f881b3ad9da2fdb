//! Inside and outside of meshes that are not closed.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec, parallel};
use shapeloom_isosurface::Lattice;
use shapeloom_spatial::WindingTree;

use super::steepness::Steepness;

/// The side of the largest cubes of samples that are looked at as one.
const BRICK: usize = 8;

/// Samples farther than this from all triangles have balls that together hold the cells between them.
const FREE: f32 = 0.8661;

/// Tolerances to try: most places are far from the threshold, and a coarse one costs a few microseconds.
const TOLERANCES: [f64; 4] = [0.45, 0.1, 0.01, 0.001];

/// How far from 1/2 winding numbers mostly are at most: at whole numbers beside it.
const USUAL: f64 = 0.5;

/// Tells inside from outside by winding numbers above 1/2.
pub(super) struct OpenSigns<'a> {
    pub tree: &'a WindingTree,
    pub steepness: &'a Steepness,
    pub lattice: &'a Lattice,
}

/// A box of samples: where it begins in its block, and how many it has each way.
#[derive(Clone, Copy)]
struct Cube {
    start: [usize; 3],
    size: [usize; 3],
}

impl OpenSigns<'_> {
    /// Gives each distance, in cells, its sign: negative where the winding number is above 1/2.
    ///
    /// A cube of samples that no triangle passes is settled as a whole where the winding number in its middle is farther from 1/2
    /// than it can change on the way to the corners; else its eighths are, at last single samples.
    pub fn give(&self, values: &mut [f32], exec: &Exec) -> Result<(), ConvertError> {
        let [columns, rows, slabs] = self.lattice.dimensions().map(|count| count as usize);
        let block = BRICK * columns * rows;
        parallel::fill_chunks(exec, values, block, |first, part| {
            let first_slab = first / (columns * rows);
            let depth = part.len() / (columns * rows);
            for j in (0..rows).step_by(BRICK) {
                for i in (0..columns).step_by(BRICK) {
                    exec.check()?;
                    let size = [BRICK.min(columns - i), BRICK.min(rows - j), depth];
                    self.settle(Cube { start: [i, j, 0], size }, first_slab, part, exec)?;
                }
            }
            exec.progress((first_slab + depth) as f64 / slabs as f64);
            Ok::<_, ConvertError>(())
        })
    }

    fn settle(&self, cube: Cube, first_slab: usize, values: &mut [f32], exec: &Exec) -> Result<(), ConvertError> {
        let Cube { start, size } = cube;
        if size == [1; 3] {
            exec.check()?;
            if self.is_inside(self.place(start, first_slab)) {
                let value = &mut values[self.index(start)];
                *value = -*value;
            }
            return Ok(());
        }
        if self.is_free(cube, values) {
            exec.check()?;
            let middle = [0, 1, 2].map(|axis| start[axis] + size[axis] / 2);
            let radius = [0, 1, 2].map(|axis| (size[axis] / 2).max(size[axis] - 1 - size[axis] / 2) as f64);
            let radius = DVec3::from_array(radius).length() * (1.0 + 1e-9);
            let center = DVec3::from_array(middle.map(|x| x as f64)) + DVec3::Z * first_slab as f64;
            // The winding number costs more than the bound of its change, and is not asked where it would hardly tell.
            if self.steepness.is_at_most(center, radius, USUAL / radius) {
                let found = self.tree.winding_number_within(self.place(middle, first_slab), 0.2);
                let clear = (found.value - 0.5).abs() - found.bound;
                if clear > 0.0 && (clear >= USUAL || self.steepness.is_at_most(center, radius, clear / radius)) {
                    if found.value > 0.5 {
                        self.visit(cube, |at| values[at] = -values[at]);
                    }
                    return Ok(());
                }
            }
        }
        // Halves each way; a side of one sample stays whole.
        let halves = size
            .map(|count| if count > 1 { vec![(0, count / 2), (count / 2, count - count / 2)] } else { vec![(0, 1)] });
        for &(z, depth) in &halves[2] {
            for &(y, height) in &halves[1] {
                for &(x, width) in &halves[0] {
                    let start = [start[0] + x, start[1] + y, start[2] + z];
                    self.settle(Cube { start, size: [width, height, depth] }, first_slab, values, exec)?;
                }
            }
        }
        Ok(())
    }

    /// Whether no triangle passes between the samples of a cube.
    fn is_free(&self, cube: Cube, values: &[f32]) -> bool {
        let mut free = true;
        self.visit(cube, |at| free &= values[at].abs() > FREE);
        free
    }

    fn visit(&self, Cube { start, size }: Cube, mut each: impl FnMut(usize)) {
        for k in 0..size[2] {
            for j in 0..size[1] {
                let row = self.index([start[0], start[1] + j, start[2] + k]);
                (row..row + size[0]).for_each(&mut each);
            }
        }
    }

    fn index(&self, [i, j, k]: [usize; 3]) -> usize {
        let [columns, rows, _] = self.lattice.dimensions().map(|count| count as usize);
        (k * rows + j) * columns + i
    }

    fn place(&self, [i, j, k]: [usize; 3], first_slab: usize) -> DVec3 {
        self.lattice.position([i as u32, j as u32, (first_slab + k) as u32])
    }

    /// Whether the winding number around a place is above 1/2: refined until its bound tells, at last exactly.
    fn is_inside(&self, place: DVec3) -> bool {
        for tolerance in TOLERANCES {
            let found = self.tree.winding_number_within(place, tolerance);
            let above = found.value - 0.5;
            if above.abs() > found.bound {
                return above > 0.0;
            }
        }
        self.tree.winding_number_exact(place).value > 0.5
    }
}
