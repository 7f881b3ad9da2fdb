//! Octrees of full and empty octants.

mod build;
mod code;
mod sets;
#[cfg(test)]
mod tests;

use shapeloom_core::{ConvertError, Exec, Reservation};
use shapeloom_isosurface::Lattice;

use crate::{Quantity, Samples, VoxelError, VoxelGrid, morton};

/// A node: [`EMPTY`], [`FULL`], or the place of its eight children.
type Node = u32;
const EMPTY: Node = u32::MAX - 1;
const FULL: Node = u32::MAX;

/// Octants at or above this level are polled for: 4096 cells.
const POLL_LEVEL: u32 = 4;

/// A set of cells as an octree (Meagher 1982): a cube of 2^depth cells a side that is full, empty, or cut into eight
/// octants.
///
/// The cube holds the cells of a [`Lattice`], from its first sample on; cells of the cube beyond the lattice are empty
/// at first, and full after [`complement`](Self::complement). No octant has eight full or eight empty children, and
/// nodes lie in depth-first order, so equal sets are equal trees. Lattices have at most 2^21 samples in a direction, so
/// depth is at most 21.
///
/// Memory: 32 bytes for each octant that is cut, whose eight children are in it. Looking up a cell costs the depth; set
/// operations cost the nodes of both trees at most. [`encode`](Self::encode) gives the form for keeping: less than two
/// bits a node.
#[derive(Clone, Debug, PartialEq)]
pub struct Octree {
    lattice: Lattice,
    depth: u32,
    root: Node,
    /// The children of each octant that is cut, child `x + 2 y + 4 z`.
    children: Vec<[Node; 8]>,
}

/// How many nodes an octree has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OctreeCounts {
    /// Octants that are cut.
    pub mixed: u64,
    /// Full octants.
    pub full: u64,
    /// Empty octants.
    pub empty: u64,
}

impl OctreeCounts {
    /// All nodes.
    pub fn nodes(&self) -> u64 {
        self.mixed + self.full + self.empty
    }
}

fn depth_of(lattice: &Lattice) -> Result<u32, VoxelError> {
    let dimensions = lattice.dimensions();
    let widest = dimensions.into_iter().max().unwrap_or(1);
    if widest > 1 << morton::BITS {
        return Err(VoxelError::TooLarge { structure: "octree", dimensions, most: 1 << morton::BITS });
    }
    Ok(widest.next_power_of_two().trailing_zeros())
}

/// The base of a child of an octant whose children have `half` cells a side.
fn child_base(base: [u32; 3], half: u32, child: usize) -> [u32; 3] {
    std::array::from_fn(|axis| base[axis] + half * (child >> axis & 1) as u32)
}

/// The children of a tree that grows, with their memory.
struct Growing<'a> {
    children: Vec<[Node; 8]>,
    memory: Vec<Reservation>,
    exec: &'a Exec,
}

impl<'a> Growing<'a> {
    fn new(exec: &'a Exec) -> Self {
        Self { children: Vec::new(), memory: Vec::new(), exec }
    }

    /// A node with these children: one leaf where all are equal ones.
    fn node(&mut self, children: [Node; 8]) -> Result<Node, ConvertError> {
        if children[0] >= EMPTY && children.iter().all(|&child| child == children[0]) {
            return Ok(children[0]);
        }
        if self.children.len() == self.children.capacity() {
            // As many again, which twice as long vectors take while they grow.
            let more = self.children.len().max(64);
            self.memory.push(self.exec.reserve_elements(more as u64, size_of::<[Node; 8]>())?);
            self.children.reserve_exact(more);
        }
        let place = u32::try_from(self.children.len()).ok().filter(|&place| place < EMPTY);
        let most = Self::MOST;
        let place = place.ok_or_else(|| {
            ConvertError::from(VoxelError::Overflow { what: "a number of octants", found: f64::from(most) })
        })?;
        self.children.push(children);
        Ok(place)
    }

    const MOST: u32 = EMPTY;
}

impl Octree {
    /// Whether a cell is full; empty outside of the cube.
    pub fn is_full(&self, cell: [u32; 3]) -> bool {
        if cell.iter().any(|&at| u64::from(at) >> self.depth != 0) {
            return false;
        }
        let (mut node, mut level) = (self.root, self.depth);
        while let Some(children) = self.children.get(node as usize).filter(|_| node < EMPTY && level > 0) {
            level -= 1;
            node = children[(0..3).fold(0, |child, axis| child | (cell[axis] as usize >> level & 1) << axis)];
        }
        node == FULL
    }

    /// Where the cells are: each around its sample.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// How often the cube is cut in two in each direction: it has 2^depth cells a side.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// How many nodes there are of each kind.
    pub fn counts(&self) -> OctreeCounts {
        let mut counts = OctreeCounts { mixed: self.children.len() as u64, ..OctreeCounts::default() };
        for &node in self.children.as_flattened().iter().chain([&self.root]) {
            counts.full += u64::from(node == FULL);
            counts.empty += u64::from(node == EMPTY);
        }
        counts
    }

    /// How many cells of the cube are full.
    pub fn full_cells(&self) -> u64 {
        // Children come before their parent, so one pass finds the level of every octant from the root down.
        let mut levels = vec![0u32; self.children.len()];
        let mut cells = if self.root == FULL { 1u64 << (3 * self.depth) } else { 0 };
        if let Some(level) = levels.last_mut() {
            *level = self.depth;
        }
        for place in (0..self.children.len()).rev() {
            let below = levels[place] - 1;
            for &child in &self.children[place] {
                match child {
                    FULL => cells += 1 << (3 * below),
                    EMPTY => {}
                    child => levels[child as usize] = below,
                }
            }
        }
        cells
    }

    /// The full octants, depth first: the smallest cell of each, and how many cells it has along a side. Those beyond
    /// the lattice are among them after [`complement`](Self::complement).
    pub fn full_octants(&self) -> Vec<([u32; 3], u32)> {
        let mut found = Vec::new();
        // Seven siblings wait on each level at most.
        let mut open = vec![(self.root, [0; 3], self.depth)];
        while let Some((node, base, level)) = open.pop() {
            match node {
                FULL => found.push((base, 1 << level)),
                EMPTY => {}
                mixed => {
                    for (child, &node) in self.children[mixed as usize].iter().enumerate().rev() {
                        open.push((node, child_base(base, 1 << (level - 1), child), level - 1));
                    }
                }
            }
        }
        found
    }

    /// The memory that the tree takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.children.as_slice())
    }

    /// The cells of the lattice as a grid of bits.
    ///
    /// # Errors
    /// Too little memory, or the reason to stop.
    pub fn to_grid(&self, exec: &Exec) -> Result<VoxelGrid, ConvertError> {
        exec.check()?;
        let count = self.lattice.samples();
        let _memory = exec.reserve_elements(count.div_ceil(64), size_of::<u64>())?;
        let mut words = vec![0u64; count.div_ceil(64) as usize];
        self.fill(self.root, [0; 3], self.depth, &mut words, exec)?;
        Ok(VoxelGrid::try_new(self.lattice, Samples::Bits(words), Quantity::Occupancy)?)
    }

    /// Sets the bits of the full cells of an octant, where they are in the lattice.
    fn fill(&self, node: Node, base: [u32; 3], level: u32, words: &mut [u64], exec: &Exec) -> Result<(), ConvertError> {
        let dimensions = self.lattice.dimensions();
        if node == EMPTY || (0..3).any(|axis| base[axis] >= dimensions[axis]) {
            return Ok(());
        }
        if level >= POLL_LEVEL {
            exec.check()?;
        }
        if node == FULL {
            let end: [u32; 3] = std::array::from_fn(|axis| dimensions[axis].min(base[axis] + (1 << level)));
            for k in base[2]..end[2] {
                exec.check()?;
                for j in base[1]..end[1] {
                    let start = self.lattice.index([base[0], j, k]) as usize;
                    set_bits(words, start, start + (end[0] - base[0]) as usize);
                }
            }
            return Ok(());
        }
        for (child, &node) in self.children[node as usize].iter().enumerate() {
            self.fill(node, child_base(base, 1 << (level - 1), child), level - 1, words, exec)?;
        }
        Ok(())
    }
}

/// Sets the bits from `start` up to `end`.
fn set_bits(words: &mut [u64], start: usize, end: usize) {
    let mut at = start;
    while at < end {
        let (bit, count) = (at % 64, (end - at).min(64 - at % 64));
        words[at / 64] |= (u64::MAX >> (64 - count)) << bit;
        at += count;
    }
}
