//! Set operations.

use shapeloom_core::{ConvertError, Exec};

use super::{EMPTY, FULL, Growing, Node, Octree, POLL_LEVEL};
use crate::VoxelError;

impl Octree {
    /// The cells of either.
    ///
    /// # Errors
    /// Trees over different lattices, too little memory, or the reason to stop.
    pub fn union(&self, other: &Self, exec: &Exec) -> Result<Self, ConvertError> {
        self.combined(other, |a, b| a || b, exec)
    }

    /// The cells of both.
    ///
    /// # Errors
    /// As [`Octree::union`].
    pub fn intersection(&self, other: &Self, exec: &Exec) -> Result<Self, ConvertError> {
        self.combined(other, |a, b| a && b, exec)
    }

    /// The cells of this one that are not the other's.
    ///
    /// # Errors
    /// As [`Octree::union`].
    pub fn difference(&self, other: &Self, exec: &Exec) -> Result<Self, ConvertError> {
        self.combined(other, |a, b| a && !b, exec)
    }

    /// The cells of exactly one of the two.
    ///
    /// # Errors
    /// As [`Octree::union`].
    pub fn symmetric_difference(&self, other: &Self, exec: &Exec) -> Result<Self, ConvertError> {
        self.combined(other, |a, b| a != b, exec)
    }

    /// The other cells of the cube, also those beyond the lattice. No node changes but in kind.
    #[must_use]
    pub fn complement(&self) -> Self {
        let other = |node: Node| match node {
            EMPTY => FULL,
            FULL => EMPTY,
            mixed => mixed,
        };
        let children = self.children.iter().map(|children| children.map(other)).collect();
        Self { root: other(self.root), children, ..self.clone() }
    }

    fn combined(&self, other: &Self, full: fn(bool, bool) -> bool, exec: &Exec) -> Result<Self, ConvertError> {
        exec.check()?;
        if self.lattice != other.lattice {
            return Err(VoxelError::Lattices(Box::new([self.lattice, other.lattice])).into());
        }
        let mut growing = Growing::new(exec);
        let walk = Walk { trees: [self, other], full };
        let root = walk.combine(self.root, other.root, self.depth, &mut growing)?;
        Ok(Self { root, children: growing.children, ..*self })
    }
}

/// Two trees that are walked side by side.
struct Walk<'a> {
    trees: [&'a Octree; 2],
    full: fn(bool, bool) -> bool,
}

impl Walk<'_> {
    fn combine(&self, a: Node, b: Node, level: u32, growing: &mut Growing<'_>) -> Result<Node, ConvertError> {
        let leaf = |node: Node| (node >= EMPTY).then_some(node == FULL);
        let of = |full: bool| if full { FULL } else { EMPTY };
        match (leaf(a), leaf(b)) {
            (Some(a), Some(b)) => return Ok(of((self.full)(a, b))),
            // One leaf decides alone where the other's kind makes no difference.
            (Some(a), None) if (self.full)(a, false) == (self.full)(a, true) => return Ok(of((self.full)(a, true))),
            (None, Some(b)) if (self.full)(false, b) == (self.full)(true, b) => return Ok(of((self.full)(true, b))),
            _ => {}
        }
        if level >= POLL_LEVEL {
            growing.exec.check()?;
        }
        let child = |tree: &Octree, node: Node, child: usize| {
            if node >= EMPTY { node } else { tree.children[node as usize][child] }
        };
        let mut children = [EMPTY; 8];
        for (at, node) in children.iter_mut().enumerate() {
            let (a, b) = (child(self.trees[0], a, at), child(self.trees[1], b, at));
            *node = self.combine(a, b, level.saturating_sub(1), growing)?;
        }
        growing.node(children)
    }
}
