//! Triangles, segments and points as samples of cells.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Reservation};
use shapeloom_spatial::BvhError;

use super::mean::Measure;
use super::side::Scale;
use super::{Sample, Samples, Simplices};
use crate::JudgeError;

/// The cells of [`Simplices`]: equal parts of their triangles, of their segments where no triangle has an area, their
/// points where nothing has a length. Each has its middle as its sample.
///
/// Elements of a smaller dimension than the largest have no weight and no cells.
#[derive(Debug)]
pub struct SimplexCells<'a> {
    shape: &'a Simplices<'a>,
    measure: Measure,
    scale: Scale,
    /// The measure of one cell, about.
    cell: f64,
    /// The number of the first cell of each element, and of all.
    starts: Vec<usize>,
    _memory: Reservation,
}

/// What rounding can do to the middle of a cell, in scaled units.
const PAD: f64 = 1.0 / (1u64 << 49) as f64;

impl<'a> SimplexCells<'a> {
    /// Cuts a shape into about `count` cells, at least one for each element that has the largest dimension.
    ///
    /// Weights are in units of a power of two near the size of the shape. Memory: 8 bytes an element.
    ///
    /// # Errors
    /// An index out of range, a corner that is not finite, too little memory in the budget, or the reason to stop.
    pub fn new(shape: &'a Simplices<'a>, count: u32, exec: &Exec) -> Result<Self, JudgeError> {
        let elements = shape.triangles.len();
        if u32::try_from(elements).is_err() {
            return Err(BvhError::TooMany { found: elements }.into());
        }
        let memory = exec.reserve_elements(elements as u64 + 1, size_of::<usize>())?;
        let positions = &shape.positions;
        for (triangle, corners) in (0u32..).zip(shape.triangles.iter()) {
            for (corner, &found) in (0u8..).zip(corners) {
                match positions.get(found as usize) {
                    None => return Err(BvhError::Index { triangle, corner, found, positions: positions.len() }.into()),
                    Some(&at) if !at.is_finite() => {
                        return Err(BvhError::NotFinite { triangle, position: found, found: at }.into());
                    }
                    Some(_) => {}
                }
            }
            if triangle % (1 << 14) == 0 {
                exec.check()?;
            }
        }
        let scale = Scale::of([shape, shape]);
        let corners = |element: u32| corners(shape, scale, element as usize);
        let (measure, total) = Measure::of_shape(elements, corners, exec)?;
        let cell = total / f64::from(count.max(1));
        let (mut starts, mut all) = (Vec::with_capacity(elements + 1), 0usize);
        starts.push(0);
        for element in 0..elements as u32 {
            let size = measure.of(&corners(element));
            let parts = if size > 0.0 { measure.parts(size, cell) as usize } else { 0 };
            all = all.saturating_add(if measure == Measure::Area { parts * parts } else { parts });
            starts.push(all);
            if element % (1 << 14) == 0 {
                exec.check()?;
            }
        }
        Ok(Self { shape, measure, scale, cell, starts, _memory: memory })
    }

    /// The sample of one of an element's cells.
    fn sample(&self, element: usize, cell: u32) -> Sample {
        let [a, b, c] = corners(self.shape, self.scale, element);
        let size = self.measure.of(&[a, b, c]);
        let parts = self.measure.parts(size, self.cell);
        let (position, weight, radius) = match self.measure {
            Measure::Area => {
                let (u, v) = ((b - a) / f64::from(parts), (c - a) / f64::from(parts));
                // Rows of 2 q - 1 cells, q from `parts` down to 1; from a row on, there are q² cells to come.
                let q = (parts * parts - cell - 1).isqrt() + 1;
                let place = cell - (parts * parts - q * q);
                // Cells that stand as the triangle does and such that are turned take turns.
                let third = if place.is_multiple_of(2) { 1.0 / 3.0 } else { 2.0 / 3.0 };
                let middle = a + u * (f64::from(place / 2) + third) + v * (f64::from(parts - q) + third);
                let reach = (u + v).length().max((u * 2.0 - v).length()).max((v * 2.0 - u).length()) / 3.0;
                (middle, size / f64::from(parts * parts), reach + PAD)
            }
            Measure::Length => {
                let sides = [(a, b), (b, c), (c, a)];
                let (start, end) = sides.into_iter().find(|(a, b)| a.distance(*b) == size).unwrap_or((a, b));
                let middle = start + (end - start) * ((f64::from(cell) + 0.5) / f64::from(parts));
                (middle, size / f64::from(parts), size / f64::from(2 * parts) + PAD)
            }
            Measure::Count => (a, 1.0, 0.0),
        };
        Sample { position: self.scale.point(position), weight, radius: self.scale.length_up(radius) }
    }
}

/// The corners of an element, in scaled units. Indices are in range.
fn corners(shape: &Simplices<'_>, scale: Scale, element: usize) -> [DVec3; 3] {
    shape.triangles[element].map(|corner| scale.scaled(shape.positions[corner as usize]))
}

impl Samples for SimplexCells<'_> {
    fn count(&self) -> usize {
        self.starts.last().copied().unwrap_or(0)
    }

    fn fill(&self, first: usize, out: &mut [Sample]) {
        // Elements without cells start where the next one does.
        let mut element = self.starts.partition_point(|&start| start <= first).saturating_sub(1);
        for (cell, sample) in (first..).zip(out) {
            while self.starts[element + 1] <= cell {
                element += 1;
            }
            *sample = self.sample(element, (cell - self.starts[element]) as u32);
        }
    }
}
