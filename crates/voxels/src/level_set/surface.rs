//! The straight pieces of a surface, by the cells that they are in.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Exec, Reservation, parallel};
use shapeloom_isosurface::{Lattice, Level, Slabs};

use super::{pieces, place};
use crate::{VoxelError, VoxelGrid};

/// A triangle, and what the squared distance of its nearest corner may be too large.
///
/// Of a point q = Σ λᵢ vᵢ of the triangle, Σ λᵢ |p − vᵢ|² = |p − q|² + Σ λᵢ |q − vᵢ|². The last sum is at most the
/// squared radius of the smallest circle around the triangle, a third of its longest side squared (Jung 1901).
#[derive(Clone, Copy)]
struct Piece {
    corners: [DVec3; 3],
    slack: f64,
}

impl Piece {
    fn new(corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners;
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        Self { corners, slack: longest * (1.0 / 3.0 + 1e-9) }
    }
}

/// A cell with surface.
#[derive(Clone, Copy)]
struct Cell {
    base: [u32; 3],
    /// Its first piece.
    first: u32,
    /// The middle of its pieces' corners.
    middle: DVec3,
}

/// The nearest piece so far, its cell, and its squared distance.
#[derive(Clone, Copy)]
pub(super) struct Nearest {
    pub squared: f64,
    pub piece: u32,
    pub cell: u32,
}

/// The surface between samples, cut into triangles by marching tetrahedra. Positions are those of the lattice but for
/// the translation.
#[derive(Default)]
pub(super) struct Surface {
    pieces: Vec<Piece>,
    /// In the order of slabs, rows and columns.
    cells: Vec<Cell>,
    /// For each cell the cells with surface of the 27 around it, itself first: from `starts` on.
    around: Vec<u32>,
    starts: Vec<u32>,
    memory: Vec<Reservation>,
}

/// A cell's base and its samples.
pub(super) type Sampled = ([u32; 3], [f32; 8]);

/// How many triangles the tetrahedra of a cell give.
fn count_pieces(samples: &[f32; 8], level: Level) -> u64 {
    pieces::count(samples.map(|sample| level.holds(sample))) as u64
}

impl Surface {
    /// The surface of a grid, and how many samples are not finite.
    ///
    /// # Errors
    /// Too many pieces for their numbers, a slab that cannot be had, too little memory, or the reason to stop.
    pub fn of(source: &VoxelGrid, level: Level, exec: &Exec) -> Result<(Self, u64), ConvertError> {
        let lattice = source.lattice();
        let [columns, rows, slabs] = lattice.dimensions().map(|count| count as usize);
        let found = parallel::map_chunks(&exec.part(0.0, 0.5), slabs, 1, |range| {
            let k = range.start;
            let _memory = exec.reserve_elements(lattice.slab_len() as u64, 2 * (size_of::<f32>() + 1))?;
            let (mut lower, mut upper) = (Vec::new(), Vec::new());
            let lower = source.slab(k as u32, &mut lower)?;
            let not_finite = lower.iter().filter(|sample| !sample.is_finite()).count() as u64;
            let mut part = Self::default();
            if k + 1 == slabs {
                return Ok::<_, ConvertError>((part, not_finite));
            }
            let upper = source.slab(k as u32 + 1, &mut upper)?;
            let holds = |sample: &f32| u8::from(level.holds(*sample));
            let inside: [Vec<u8>; 2] = [lower, upper].map(|slab| slab.iter().map(holds).collect());
            let mut cut: Vec<Sampled> = Vec::new();
            let mut room = Vec::new();
            let mut inside_of = vec![0u8; columns];
            for j in 0..rows - 1 {
                exec.check()?;
                inside_of.fill(0);
                for side in &inside {
                    for row in [j, j + 1] {
                        let row = &side[row * columns..(row + 1) * columns];
                        inside_of.iter_mut().zip(row).for_each(|(sum, inside)| *sum += inside);
                    }
                }
                for (i, pair) in inside_of.windows(2).enumerate() {
                    if (pair[0] + pair[1]).is_multiple_of(8) {
                        continue;
                    }
                    let sample = |c: usize| {
                        let slab = if c >> 2 == 0 { lower } else { upper };
                        slab[(j + (c >> 1 & 1)) * columns + i + (c & 1)]
                    };
                    if cut.len() == cut.capacity() {
                        let more = cut.len().max(1 << 8);
                        room.push(exec.reserve_elements(more as u64, size_of::<Sampled>())?);
                        cut.reserve_exact(more);
                    }
                    cut.push(([i as u32, j as u32, k as u32], std::array::from_fn(sample)));
                }
            }
            part.add(&cut, lattice, level, exec)?;
            Ok((part, not_finite))
        })?;
        let not_finite = found.iter().map(|(_, count)| count).sum();
        let mut whole = Self::default();
        let sums = found.iter().map(|(part, _)| [part.cells.len(), part.pieces.len()]);
        let [cells, pieces] = sums.fold([0; 2], |[a, b], [x, y]| [a + x, b + y]);
        whole.reserve(cells, pieces, exec)?;
        for (part, _) in found {
            let first = whole.pieces.len() as u32;
            whole.cells.extend(part.cells.iter().map(|cell| Cell { first: cell.first + first, ..*cell }));
            whole.pieces.extend_from_slice(&part.pieces);
        }
        whole.link(&exec.part(0.5, 1.0))?;
        Ok((whole, not_finite))
    }

    /// The surface in cells, which are in the order of slabs, rows and columns, and each there once.
    ///
    /// # Errors
    /// As [`Surface::of`].
    pub fn in_cells(cells: &[Sampled], lattice: &Lattice, level: Level, exec: &Exec) -> Result<Self, ConvertError> {
        let mut surface = Self::default();
        surface.add(cells, lattice, level, exec)?;
        surface.link(exec)?;
        Ok(surface)
    }

    fn reserve(&mut self, cells: usize, pieces: usize, exec: &Exec) -> Result<(), ConvertError> {
        if u32::try_from(pieces).is_err() {
            return Err(VoxelError::Overflow { what: "a number of triangles", found: pieces as f64 }.into());
        }
        self.memory.push(exec.reserve_elements(pieces as u64, size_of::<Piece>())?);
        self.memory.push(exec.reserve_elements(cells as u64, size_of::<Cell>())?);
        self.cells.reserve_exact(cells);
        self.pieces.reserve_exact(pieces);
        Ok(())
    }

    fn add(&mut self, cells: &[Sampled], lattice: &Lattice, level: Level, exec: &Exec) -> Result<(), ConvertError> {
        let pieces = cells.iter().map(|(_, samples)| count_pieces(samples, level)).sum::<u64>();
        self.reserve(cells.len(), pieces as usize, exec)?;
        for (polled, (base, samples)) in cells.iter().enumerate() {
            if polled.is_multiple_of(1024) {
                exec.check()?;
            }
            let corner = |c: usize| std::array::from_fn(|axis| base[axis] + (c >> axis & 1) as u32);
            let corners = std::array::from_fn(|c| place(lattice.placement(), corner(c)));
            let first = self.pieces.len();
            let list = &mut self.pieces;
            pieces::for_each_piece(samples, &corners, level, |piece| list.push(Piece::new(piece)));
            let own = self.pieces[first..].iter().flat_map(|piece| piece.corners);
            let middle = own.sum::<DVec3>() / (3 * (self.pieces.len() - first).max(1)) as f64;
            self.cells.push(Cell { base: *base, first: first as u32, middle });
        }
        Ok(())
    }

    /// Finds the cells around each.
    fn link(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let cells = &self.cells;
        let row_of = |base: [u32; 3]| [base[2], base[1]];
        self.memory.push(exec.reserve_elements(cells.len() as u64, size_of::<([u32; 2], u32)>() + 2 * 4)?);
        let mut rows: Vec<([u32; 2], u32)> = Vec::new();
        for (number, cell) in (0u32..).zip(cells) {
            if rows.last().is_none_or(|&(row, _)| row != row_of(cell.base)) {
                rows.push((row_of(cell.base), number));
            }
        }
        let parts = parallel::map_chunks(exec, cells.len(), 1 << 10, |range| {
            let room = exec.reserve_elements(range.len() as u64, 27 * size_of::<u32>())?;
            let (mut around, mut counts) = (Vec::with_capacity(range.len() * 12), Vec::with_capacity(range.len()));
            for number in range {
                let before = around.len();
                around.push(number as u32);
                let [i, j, k] = cells[number].base;
                for k in k.saturating_sub(1)..=k + 1 {
                    for j in j.saturating_sub(1)..=j + 1 {
                        let at = rows.partition_point(|&(row, _)| row < [k, j]);
                        let Some(&(row, start)) = rows.get(at).filter(|(row, _)| *row == [k, j]) else { continue };
                        debug_assert_eq!(row, [k, j]);
                        let end = rows.get(at + 1).map_or(cells.len(), |&(_, next)| next as usize);
                        let row = &cells[start as usize..end];
                        let from = row.partition_point(|cell| cell.base[0] + 1 < i);
                        let beside = row[from..].iter().take_while(|cell| cell.base[0] <= i + 1);
                        let numbers = (start + from as u32..).zip(beside).map(|(number, _)| number);
                        around.extend(numbers.filter(|&other| other != number as u32));
                    }
                }
                counts.push((around.len() - before) as u32);
            }
            Ok::<_, ConvertError>((around, counts, room))
        })?;
        let total = parts.iter().map(|(around, ..)| around.len()).sum::<usize>();
        if u32::try_from(total).is_err() {
            return Err(VoxelError::Overflow { what: "a number of cells side by side", found: total as f64 }.into());
        }
        self.memory.push(exec.reserve_elements(total as u64, size_of::<u32>())?);
        self.around.reserve_exact(total);
        self.starts.reserve_exact(cells.len() + 1);
        for (around, counts, _) in parts {
            for count in counts {
                let start = self.starts.last().copied().unwrap_or(0);
                if self.starts.is_empty() {
                    self.starts.push(0);
                }
                self.starts.push(start + count);
            }
            self.around.extend(around);
        }
        Ok(())
    }

    /// How many cells have surface.
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// How many triangles there are.
    pub fn pieces(&self) -> usize {
        self.pieces.len()
    }

    /// The smallest corner of a cell.
    pub fn base(&self, cell: u32) -> [u32; 3] {
        self.cells[cell as usize].base
    }

    /// Whether one of two cells is among the 27 around the other.
    pub fn are_beside(&self, one: u32, other: u32) -> bool {
        let (one, other) = (self.base(one), self.base(other));
        (0..3).all(|axis| one[axis].abs_diff(other[axis]) <= 1)
    }

    /// The middles of the cells' pieces.
    pub fn middles(&self) -> impl ExactSizeIterator<Item = DVec3> + '_ {
        self.cells.iter().map(|cell| cell.middle)
    }

    /// The numbers of a cell's pieces.
    pub fn pieces_of(&self, cell: u32) -> std::ops::Range<u32> {
        let next = self.cells.get(cell as usize + 1);
        self.cells[cell as usize].first..next.map_or(self.pieces.len() as u32, |next| next.first)
    }

    /// The cell of a piece.
    pub fn cell_of(&self, piece: u32) -> u32 {
        self.cells.partition_point(|cell| cell.first <= piece) as u32 - 1
    }

    /// The squared distance from a piece.
    pub fn distance_squared(&self, position: DVec3, piece: u32) -> f64 {
        pieces::distance_squared(position, &self.pieces[piece as usize].corners)
    }

    /// No piece yet, but a cell to look in.
    pub fn start(cell: u32) -> Nearest {
        Nearest { squared: f64::INFINITY, piece: 0, cell }
    }

    /// Lets a point look at the pieces in a cell.
    pub fn look(&self, position: DVec3, cell: u32, best: &mut Nearest) {
        for number in self.pieces_of(cell) {
            let piece = &self.pieces[number as usize];
            let [a, b, c] = piece.corners.map(|corner| position.distance_squared(corner));
            if a.min(b).min(c) - piece.slack >= best.squared {
                continue;
            }
            let squared = pieces::distance_squared(position, &piece.corners);
            if squared < best.squared {
                *best = Nearest { squared, piece: number, cell };
            }
        }
    }

    /// Lets a point look at all pieces in the cells around the nearest so far, until none is nearer.
    pub fn climb(&self, position: DVec3, best: &mut Nearest) {
        loop {
            let from = best.cell as usize;
            for &cell in &self.around[self.starts[from] as usize..self.starts[from + 1] as usize] {
                self.look(position, cell, best);
            }
            if best.cell as usize == from {
                return;
            }
        }
    }
}
