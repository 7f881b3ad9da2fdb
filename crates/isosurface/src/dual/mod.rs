//! Dual surfaces: a vertex for each piece of the surface in a cell, a quad for each edge of the lattice that the surface crosses.

mod batch;
mod block;
mod cell;
mod cell_layer;
mod cell_tables;
mod extract;
mod quads;
mod sign_slice;
mod slab_ring;

pub(crate) use cell::{Cell, Crossing};
pub(crate) use extract::{DualSurface, extract};

use shapeloom_core::glam::DVec3;

/// Where the vertex of a piece of the surface in a cell lies.
pub(crate) trait VertexRule: Sync {
    /// Whether the mean of the crossings will do for cells without anything special, so that they need not be asked about.
    const MEAN_WILL_DO: bool;

    /// The place of the vertex in the cell, from 0 to 1 in each direction, for the piece that crosses these edges, a bit each.
    fn vertex(&self, cell: &Cell<'_>, edges: u16) -> Placed;

    /// The direction outward there, in lattice coordinates as a normal's.
    fn outward(&self, cell: &Cell<'_>, edges: u16, place: DVec3) -> DVec3 {
        cell.outward(edges, place)
    }
}

/// Where a vertex lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    /// The place in the cell, from 0 to 1 in each direction.
    pub(crate) place: DVec3,
    /// Whether it would have left the cell.
    pub(crate) held: bool,
}

/// The mean of the crossings (Gibson 1998).
pub(crate) struct MeanOfCrossings;

impl VertexRule for MeanOfCrossings {
    const MEAN_WILL_DO: bool = true;

    fn vertex(&self, cell: &Cell<'_>, edges: u16) -> Placed {
        Placed { place: cell.mean_of_crossings(edges), held: false }
    }
}
