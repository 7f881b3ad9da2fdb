//! Distances from pieces of a surface, sample after sample outward.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, ConvertError, Exec, Reservation};
use shapeloom_isosurface::{Lattice, Level};

use super::{pieces, place};
use crate::sparse_bricks::{BRICK, key_of, offset};

/// No piece yet.
const NONE: u32 = u32::MAX;
/// The sample itself among the 27 around it.
const MIDDLE: u32 = 13;
/// Samples between two polls.
const POLL: u32 = 1 << 10;
/// The bytes of a sample: its distance, its piece, its cell, and its entries in the queue.
pub(super) const SAMPLE_BYTES: usize = 8 + 4 + 4 + 2 * 24;
/// The bytes of a piece, with its cell and its part of the list of cells.
const PIECE_BYTES: usize = size_of::<[DVec3; 3]>() + 4 + 16;

/// Where the numbers of samples lie.
pub(super) trait Table {
    /// The place of a sample's numbers, made if need be.
    fn slot(&mut self, at: [u32; 3], exec: &Exec) -> Result<usize, ConvertError>;
    /// The place of a sample's numbers, if there is one.
    fn find(&self, at: [u32; 3]) -> Option<usize>;
    /// How many places there are.
    fn len(&self) -> usize;
}

/// Every sample of a lattice.
pub(super) struct Dense(pub [u32; 3]);

impl Dense {
    fn index(&self, [i, j, k]: [u32; 3]) -> usize {
        let [x, y, _] = self.0.map(|count| count as usize);
        (k as usize * y + j as usize) * x + i as usize
    }
}

impl Table for Dense {
    fn slot(&mut self, at: [u32; 3], _: &Exec) -> Result<usize, ConvertError> {
        Ok(self.index(at))
    }

    fn find(&self, at: [u32; 3]) -> Option<usize> {
        Some(self.index(at))
    }

    fn len(&self) -> usize {
        self.0.iter().map(|&count| count as usize).product()
    }
}

/// Samples of bricks, which are added as they are asked for.
#[derive(Default)]
pub(super) struct Bricks {
    pub places: BTreeMap<u64, usize>,
    memory: Vec<Reservation>,
}

impl Table for Bricks {
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

    fn find(&self, at: [u32; 3]) -> Option<usize> {
        self.places.get(&key_of(at)).map(|place| place * BRICK + offset(at))
    }

    fn len(&self) -> usize {
        self.places.len() * BRICK
    }
}

/// The march: every sample takes the nearest of the pieces that its neighbours have, in the order of distance (Sethian
/// 1996, with the pieces in place of the quadratic equation). A sample that a later neighbour brings nearer is taken up
/// again.
pub(super) struct March<'a, T> {
    pub table: T,
    dimensions: [u32; 3],
    placement: &'a Affine,
    pieces: Vec<[DVec3; 3]>,
    /// The cell of each piece, by its number among cells with surface.
    cell_of: Vec<u32>,
    /// The smallest corner of each such cell, and its first piece.
    cells: Vec<([u32; 3], u32)>,
    /// The number of the cell whose smallest corner a sample is.
    cell_at: Vec<u32>,
    /// Half the diagonal of a cell.
    half_diagonal: f64,
    memory: Vec<Reservation>,
    distance: Vec<f64>,
    nearest: Vec<u32>,
    queue: BinaryHeap<Reverse<(u64, [u32; 3])>>,
    exec: &'a Exec,
}

impl<'a, T: Table> March<'a, T> {
    pub fn new(table: T, lattice: &'a Lattice, exec: &'a Exec) -> Self {
        let (dimensions, placement) = (lattice.dimensions(), lattice.placement());
        let half_diagonal = lattice.cell_diagonal() * 0.5;
        let mut march = Self {
            table,
            dimensions,
            placement,
            pieces: Vec::new(),
            cell_of: Vec::new(),
            cells: Vec::new(),
            cell_at: Vec::new(),
            half_diagonal,
            memory: Vec::new(),
            distance: Vec::new(),
            nearest: Vec::new(),
            queue: BinaryHeap::new(),
            exec,
        };
        march.grow();
        march
    }

    fn grow(&mut self) {
        let len = self.table.len();
        self.distance.resize(len, f64::INFINITY);
        self.nearest.resize(len, NONE);
        self.cell_at.resize(len, NONE);
    }

    fn slot(&mut self, at: [u32; 3]) -> Result<usize, ConvertError> {
        let slot = self.table.slot(at, self.exec)?;
        if slot >= self.distance.len() {
            self.grow();
        }
        Ok(slot)
    }

    /// The surface in a cell, from its eight samples; its corners get their distances.
    pub fn add_cell(&mut self, base: [u32; 3], samples: &[f32; 8], level: Level) -> Result<(), ConvertError> {
        let placement = self.placement;
        let corner = |c: usize| std::array::from_fn(|axis| base[axis] + (c >> axis & 1) as u32);
        let corners = std::array::from_fn(|c| place(placement, corner(c)));
        let first = self.pieces.len();
        if first + 12 > self.pieces.capacity() {
            let more = first.max(1 << 10);
            self.memory.push(self.exec.reserve_elements(more as u64, PIECE_BYTES)?);
            self.pieces.reserve_exact(more);
        }
        let list = &mut self.pieces;
        pieces::for_each_piece(samples, &corners, level, |piece| list.push(piece));
        let number = self.cells.len() as u32;
        self.cells.push((base, first as u32));
        self.cell_of.resize(self.pieces.len(), number);
        let slot = self.slot(base)?;
        self.cell_at[slot] = number;
        for piece in first..self.pieces.len() {
            for c in 0..8 {
                self.offer(corner(c), piece as u32, f64::INFINITY)?;
            }
        }
        Ok(())
    }

    /// Lets a sample take a piece that is nearer than its own and within the limit.
    fn offer(&mut self, at: [u32; 3], piece: u32, limit: f64) -> Result<(), ConvertError> {
        let position = place(self.placement, at);
        let found = pieces::distance_squared(position, &self.pieces[piece as usize]);
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

    /// Lets a sample look at all pieces in the cells around that of its own, until none is nearer. Few pieces are the
    /// nearest of some sample beside the surface, so without that far samples would not hear of most.
    fn refine(&mut self, at: [u32; 3], slot: usize) {
        let position = place(self.placement, at);
        loop {
            let before = self.nearest[slot];
            let (base, _) = self.cells[self.cell_of[before as usize] as usize];
            for step in 0..27 {
                let cell = self.beside(base, step).and_then(|cell| self.table.find(cell));
                let Some(number) = cell.map(|cell| self.cell_at[cell]).filter(|&number| number != NONE) else {
                    continue;
                };
                let (corner, first) = self.cells[number as usize];
                let middle = self.placement.linear * (DVec3::from(corner.map(f64::from)) + 0.5);
                let reach = self.distance[slot].sqrt() + self.half_diagonal;
                if position.distance_squared(middle) >= reach * reach {
                    continue;
                }
                let end = self.cells.get(number as usize + 1).map_or(self.pieces.len(), |&(_, next)| next as usize);
                for piece in first as usize..end {
                    let found = pieces::distance_squared(position, &self.pieces[piece]);
                    if found < self.distance[slot] {
                        self.distance[slot] = found;
                        self.nearest[slot] = piece as u32;
                    }
                }
            }
            if self.nearest[slot] == before {
                return;
            }
        }
    }

    /// Goes outward up to a distance.
    pub fn run(&mut self, limit: f64) -> Result<(), ConvertError> {
        let limit = limit * limit;
        let (mut polled, mut done) = (0u32, 0usize);
        while let Some(Reverse((bits, at))) = self.queue.pop() {
            if polled.is_multiple_of(POLL) {
                self.exec.check()?;
                self.exec.progress(done as f64 / self.table.len().max(1) as f64);
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
                let slot = self.table.find(near);
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
