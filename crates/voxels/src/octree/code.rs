//! Octrees as bits.

use shapeloom_core::{ConvertError, Exec};
use shapeloom_isosurface::Lattice;

use super::{EMPTY, FULL, Growing, Node, Octree, POLL_LEVEL, depth_of};
use crate::VoxelError;

impl Octree {
    /// The tree as bits, depth first: 1 for an octant that is cut, followed by its eight children; 0 and a bit for a
    /// leaf, 1 if it is full. Single cells are leaves always and have that one bit alone. The lowest bit of a byte is
    /// its first; the last byte is filled with zeros.
    ///
    /// The bits say nothing of the lattice, which is kept beside them. Worst case: 8/7 bits a cell and one more.
    ///
    /// # Errors
    /// Too little memory, or the reason to stop.
    pub fn encode(&self, exec: &Exec) -> Result<Vec<u8>, ConvertError> {
        exec.check()?;
        let _memory = exec.reserve(self.counts().nodes() / 4 + 1)?;
        let mut bits = Writer::default();
        self.write(self.root, self.depth, &mut bits, exec)?;
        Ok(bits.bytes)
    }

    fn write(&self, node: Node, level: u32, bits: &mut Writer, exec: &Exec) -> Result<(), ConvertError> {
        if node >= EMPTY {
            if level > 0 {
                bits.push(false);
            }
            bits.push(node == FULL);
            return Ok(());
        }
        if level >= POLL_LEVEL {
            exec.check()?;
        }
        bits.push(true);
        let children = &self.children[node as usize];
        children.iter().try_for_each(|&child| self.write(child, level.saturating_sub(1), bits, exec))
    }

    /// The tree that [`encode`](Self::encode) made bits of.
    ///
    /// # Errors
    /// A lattice of more than 2^21 samples in a direction, bits that end too early, that have eight equal leaves or go
    /// on after the tree, too little memory, or the reason to stop.
    pub fn decode(bytes: &[u8], lattice: Lattice, exec: &Exec) -> Result<Self, ConvertError> {
        exec.check()?;
        let depth = depth_of(&lattice)?;
        let mut growing = Growing::new(exec);
        let mut bits = Reader { bytes, at: 0 };
        let root = read(&mut bits, depth, &mut growing)?;
        let end = bits.at;
        // At most seven bits are left in the last byte, and they are zeros.
        let whole = end.div_ceil(8) == bytes.len() as u64;
        if !whole || (end..bytes.len() as u64 * 8).any(|_| bits.next() != Some(false)) {
            return Err(VoxelError::OctreeTrails { bit: end }.into());
        }
        Ok(Self { lattice, depth, root, children: growing.children })
    }
}

fn read(bits: &mut Reader<'_>, level: u32, growing: &mut Growing<'_>) -> Result<Node, ConvertError> {
    let ends = VoxelError::OctreeEnds { bits: bits.bytes.len() as u64 * 8 };
    let mut next = || bits.next().ok_or_else(|| ends.clone());
    if level == 0 || !next()? {
        return Ok(if next()? { FULL } else { EMPTY });
    }
    if level >= POLL_LEVEL {
        growing.exec.check()?;
    }
    let mut children = [EMPTY; 8];
    for node in &mut children {
        *node = read(bits, level - 1, growing)?;
    }
    match growing.node(children)? {
        EMPTY | FULL => Err(VoxelError::OctreeEqual { bit: bits.at }.into()),
        node => Ok(node),
    }
}

#[derive(Default)]
struct Writer {
    bytes: Vec<u8>,
    used: u8,
}

impl Writer {
    fn push(&mut self, bit: bool) {
        match self.bytes.last_mut().filter(|_| self.used < 8) {
            Some(last) => *last |= u8::from(bit) << self.used,
            None => {
                self.bytes.push(u8::from(bit));
                self.used = 0;
            }
        }
        self.used += 1;
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    at: u64,
}

impl Reader<'_> {
    fn next(&mut self) -> Option<bool> {
        let byte = self.bytes.get((self.at / 8) as usize)?;
        let bit = byte >> (self.at % 8) & 1 == 1;
        self.at += 1;
        Some(bit)
    }
}
