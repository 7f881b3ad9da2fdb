//! A cell, looked at on its own.

use shapeloom_core::glam::DVec3;

use super::cell_tables::edge_corners;
use super::sign_slice::Frame;
use super::slab_ring::KEPT;
use crate::{Inside, Level};

/// The samples around a layer of cells: the slabs of the slices from the one below the layer to the second above it; none for slices
/// around the lattice and beyond.
pub(super) struct Surroundings<'a> {
    pub(super) slabs: [Option<&'a [f32]>; KEPT],
    pub(super) frame: Frame,
    pub(super) level: Level,
    /// The layer of the cells.
    pub(super) layer: usize,
}

/// A cell with its corners and the samples next to them.
pub(crate) struct Cell<'a> {
    surroundings: &'a Surroundings<'a>,
    column: usize,
    row: usize,
    /// The inside corners, a bit each.
    pub(crate) corners: u8,
}

/// Where the surface crosses an edge of a cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// The axis of the edge.
    pub(crate) axis: usize,
    /// The place in the cell, from 0 to 1 in each direction.
    pub(crate) place: DVec3,
    /// Whether the upper end of the edge is outside.
    pub(crate) rises: bool,
    /// The corners at the ends, the lower first.
    pub(crate) ends: [usize; 2],
}

/// A corner's place in its cell.
fn corner_place(corner: usize) -> DVec3 {
    DVec3::new((corner & 1) as f64, (corner >> 1 & 1) as f64, (corner >> 2) as f64)
}

impl<'a> Cell<'a> {
    pub(super) fn new(surroundings: &'a Surroundings<'a>, column: usize, row: usize, corners: u8) -> Self {
        Self { surroundings, column, row, corners }
    }

    /// What is inside.
    pub(crate) fn level(&self) -> Level {
        self.surroundings.level
    }

    /// The lattice coordinates of corner 0; -1 for a sample before the lattice.
    pub(crate) fn lattice_place(&self) -> DVec3 {
        let pad = self.surroundings.frame.pad as f64;
        DVec3::new(self.column as f64 - pad, self.row as f64 - pad, self.surroundings.layer as f64 - pad)
    }

    /// The sample this far from corner 0, from -1 to 2 in each direction; none outside of the lattice.
    pub(crate) fn sample(&self, offset: [isize; 3]) -> Option<f32> {
        let frame = &self.surroundings.frame;
        let slab = (*self.surroundings.slabs.get(usize::try_from(offset[2] + 1).ok()?)?)?;
        let place = |at: usize, offset: isize, axis: usize| {
            (at + 1).checked_add_signed(offset)?.checked_sub(frame.pad + 1).filter(|&i| i < frame.samples[axis])
        };
        let (i, j) = (place(self.column, offset[0], 0)?, place(self.row, offset[1], 1)?);
        slab.get(j * frame.samples[0] + i).copied()
    }

    /// The sample at a corner; none outside of the lattice.
    pub(crate) fn corner(&self, corner: usize) -> Option<f32> {
        self.sample([corner & 1, corner >> 1 & 1, corner >> 2].map(|bit| bit as isize))
    }

    /// The crossings on edges, given a bit each.
    pub(crate) fn crossings(&self, edges: u16) -> impl Iterator<Item = Crossing> {
        (0..12).filter(move |edge| edges >> edge & 1 == 1).map(|edge| {
            let [p, q] = edge_corners(edge);
            let rises = self.corners >> p & 1 == 1;
            let part = match (self.corner(p), self.corner(q)) {
                (Some(a), Some(b)) => self.level().crossing(a, b),
                // On the border of the lattice, where it is closed.
                (Some(_), None) => 0.0,
                (None, Some(_)) => 1.0,
                (None, None) => 0.5,
            };
            let (axis, from) = (edge / 4, corner_place(p));
            Crossing { axis, place: from + DVec3::AXES[axis] * part, rises, ends: [p, q] }
        })
    }

    pub(crate) fn mean_of_crossings(&self, edges: u16) -> DVec3 {
        let sum: DVec3 = self.crossings(edges).map(|crossing| crossing.place).sum();
        sum / f64::from(edges.count_ones().max(1))
    }

    /// The direction, in lattice coordinates as a normal's, in which the samples rise outward at a place: the gradient of the
    /// trilinear interpolant, or the sum of the crossed edges' directions where a corner has no finite sample or the gradient is zero.
    pub(crate) fn outward(&self, edges: u16, place: DVec3) -> DVec3 {
        let sign = if self.level().inside == Inside::Below { 1.0 } else { -1.0 };
        let value = |corner: usize| self.corner(corner).filter(|sample| sample.is_finite()).map(f64::from);
        let values: [Option<f64>; 8] = std::array::from_fn(value);
        if values.iter().all(Option::is_some) {
            let mut gradient = DVec3::ZERO;
            for (corner, value) in values.into_iter().flatten().enumerate() {
                let far = corner_place(corner);
                let weight = DVec3::ONE - far + (far * 2.0 - DVec3::ONE) * place;
                let slope = far * 2.0 - DVec3::ONE;
                gradient += sign
                    * value
                    * DVec3::new(
                        slope.x * weight.y * weight.z,
                        weight.x * slope.y * weight.z,
                        weight.x * weight.y * slope.z,
                    );
            }
            if gradient.is_finite() && gradient != DVec3::ZERO {
                return gradient;
            }
        }
        let direction = |crossing: Crossing| DVec3::AXES[crossing.axis] * if crossing.rises { 1.0 } else { -1.0 };
        let sum: DVec3 = self.crossings(edges).map(direction).sum();
        if sum == DVec3::ZERO { self.crossings(edges).map(direction).next().unwrap_or(DVec3::Z) } else { sum }
    }
}
