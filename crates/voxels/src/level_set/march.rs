//! Distances from pieces of a surface in bricks, sample after sample outward.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use shapeloom_core::{Affine, ConvertError, Exec, Reservation};
use shapeloom_isosurface::Lattice;

use super::place;
use super::surface::{Nearest, Surface};
use crate::sparse_bricks::{BRICK, key_of, offset};

/// No piece yet.
const NONE: u32 = u32::MAX;
/// The sample itself among the 27 around it.
const MIDDLE: u32 = 13;
/// Samples between two polls.
const POLL: u32 = 1 << 10;
/// The bytes of a sample: its distance, its piece, and its entries in the queue.
const SAMPLE_BYTES: usize = 8 + 4 + 2 * 24;

/// Samples of bricks, which are added as they are asked for.
#[derive(Default)]
pub(super) struct Bricks {
    pub places: BTreeMap<u64, usize>,
    memory: Vec<Reservation>,
}

impl Bricks {
    /// The place of a sample's numbers, made if need be.
    fn slot(&mut self, at: [u32; 3], exec: &Exec) -> Result<usize, ConvertError> {
        let key = key_of(at);
        let place = match self.places.get(&key) {
            Some(&place) => place,
            None => {
                self.memory.push(exec.reserve_elements(BRICK as u64, 2 * SAMPLE_BYTES)?);
                let place = self.places.len();
                self.places.insert(key, place);
                place
            }
        };
        Ok(place * BRICK + offset(at))
    }

    /// The place of a sample's numbers, if there is one.
    fn find(&self, at: [u32; 3]) -> Option<usize> {
        self.places.get(&key_of(at)).map(|place| place * BRICK + offset(at))
    }

    /// How many places there are.
    fn len(&self) -> usize {
        self.places.len() * BRICK
    }
}

/// The march: every sample takes the nearest of the pieces that its neighbours have, in the order of distance (Sethian
/// 1996, with the pieces in place of the quadratic equation), and looks around that. A sample that a later neighbour
/// brings nearer is taken up again.
pub(super) struct March<'a> {
    pub bricks: Bricks,
    dimensions: [u32; 3],
    placement: &'a Affine,
    surface: &'a Surface,
    distance: Vec<f64>,
    nearest: Vec<u32>,
    queue: BinaryHeap<Reverse<(u64, [u32; 3])>>,
    exec: &'a Exec,
}

impl<'a> March<'a> {
    /// The corners of the surface's cells with their distances.
    pub fn new(surface: &'a Surface, lattice: &'a Lattice, exec: &'a Exec) -> Result<Self, ConvertError> {
        let mut march = Self {
            bricks: Bricks::default(),
            dimensions: lattice.dimensions(),
            placement: lattice.placement(),
            surface,
            distance: Vec::new(),
            nearest: Vec::new(),
            queue: BinaryHeap::new(),
            exec,
        };
        for cell in 0..surface.cells() as u32 {
            if cell.is_multiple_of(POLL) {
                exec.check()?;
            }
            let base = surface.base(cell);
            for corner in 0..8 {
                let at = std::array::from_fn(|axis| base[axis] + (corner >> axis & 1));
                for piece in surface.pieces_of(cell) {
                    march.offer(at, piece, f64::INFINITY)?;
                }
            }
        }
        Ok(march)
    }

    fn slot(&mut self, at: [u32; 3]) -> Result<usize, ConvertError> {
        let slot = self.bricks.slot(at, self.exec)?;
        if slot >= self.distance.len() {
            self.distance.resize(self.bricks.len(), f64::INFINITY);
            self.nearest.resize(self.bricks.len(), NONE);
        }
        Ok(slot)
    }

    /// Lets a sample take a piece that is nearer than its own and within the limit.
    fn offer(&mut self, at: [u32; 3], piece: u32, limit: f64) -> Result<(), ConvertError> {
        let position = place(self.placement, at);
        let found = self.surface.distance_squared(position, piece);
        if found > limit {
            return Ok(());
        }
        let slot = self.slot(at)?;
        if found < self.distance[slot] {
            self.distance[slot] = found;
            self.nearest[slot] = piece;
            // Numbers that are not negative are ordered as their bits.
            self.queue.push(Reverse((found.to_bits(), at)));
        }
        Ok(())
    }

    /// One of the 27 samples around one, if it is in the lattice.
    fn beside(&self, at: [u32; 3], step: u32) -> Option<[u32; 3]> {
        let to = [step % 3, step / 3 % 3, step / 9];
        // Before the first comes a number beyond every lattice.
        let near = std::array::from_fn(|axis| at[axis].wrapping_add(to[axis]).wrapping_sub(1));
        (0..3).all(|axis| near[axis] < self.dimensions[axis]).then_some(near)
    }

    /// Lets a sample look at all pieces in the cells around that of its own. Few pieces are the nearest of some sample
    /// beside the surface, so without that far samples would not hear of most.
    fn refine(&mut self, at: [u32; 3], slot: usize) {
        let (squared, piece) = (self.distance[slot], self.nearest[slot]);
        let mut best = Nearest { squared, piece, cell: self.surface.cell_of(piece) };
        self.surface.climb(place(self.placement, at), &mut best);
        (self.distance[slot], self.nearest[slot]) = (best.squared, best.piece);
    }

    /// Goes outward up to a distance, and some more: what a neighbour has is farther than what is found around it.
    pub fn run(&mut self, limit: f64, cell_diagonal: f64) -> Result<(), ConvertError> {
        let limit = (limit + 0.25 * cell_diagonal).powi(2);
        let (mut polled, mut done) = (0u32, 0usize);
        while let Some(Reverse((bits, at))) = self.queue.pop() {
            if polled.is_multiple_of(POLL) {
                self.exec.check()?;
                self.exec.progress(done as f64 / self.bricks.len().max(1) as f64);
            }
            polled = polled.wrapping_add(1);
            let slot = self.slot(at)?;
            // An entry that a nearer one overtook.
            if self.distance[slot].to_bits() != bits {
                continue;
            }
            done += 1;
            self.refine(at, slot);
            let piece = self.nearest[slot];
            for step in (0..27).filter(|&step| step != MIDDLE) {
                let Some(near) = self.beside(at, step) else { continue };
                let slot = self.bricks.find(near);
                // A settled one may be corrected: then it tells its neighbours again.
                if slot.is_some_and(|slot| self.nearest[slot] == piece) {
                    continue;
                }
                self.offer(near, piece, limit)?;
            }
        }
        Ok(())
    }

    /// The distance at a place; infinite where the march did not come.
    pub fn distance(&self, slot: usize) -> f64 {
        self.distance[slot].sqrt()
    }
}
