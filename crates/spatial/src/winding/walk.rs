//! Fast winding numbers: a walk that takes far clusters whole.

use std::f64::consts::PI;

use multiversion::multiversion;

use super::far::Node;
use super::near::{Block, WIDTH, total};
use super::sum::Sum;
use super::tree::WindingTree;

/// Levels of nodes that four billion triangles can have, and nodes that wait: seven siblings on each.
const WAITING: usize = 12 * WIDTH;

/// Nodes of a tree that are still to be looked at, the latest first.
pub(super) struct Waiting<'a> {
    tree: &'a WindingTree,
    /// Levels and indices.
    places: [(u32, u32); WAITING],
    count: usize,
}

impl<'a> Waiting<'a> {
    /// The root, if there is one.
    #[inline(always)]
    pub fn at_root(tree: &'a WindingTree) -> Self {
        let mut places = [(0, 0); WAITING];
        places[0].0 = tree.levels.len().saturating_sub(1) as u32;
        Self { tree, places, count: usize::from(!tree.levels.is_empty()) }
    }

    /// A node, and its level and index.
    #[inline(always)]
    pub fn next(&mut self) -> Option<(&'a Node, (u32, u32))> {
        self.count = self.count.checked_sub(1)?;
        let (level, index) = self.places[self.count];
        Some((&self.tree.levels[level as usize][index as usize], (level, index)))
    }

    /// Lets those children of a node wait whose bits are set, or gives them where they are blocks.
    #[inline(always)]
    pub fn open(&mut self, (level, index): (u32, u32), mut lanes: u32) -> impl Iterator<Item = &'a Block> + use<'a> {
        let first = index * WIDTH as u32;
        while level > 0 && lanes != 0 {
            self.places[self.count] = (level - 1, first + lanes.trailing_zeros());
            self.count += 1;
            lanes &= lanes - 1;
        }
        let blocks = &self.tree.blocks;
        std::iter::from_fn(move || {
            let lane = (lanes != 0).then(|| lanes.trailing_zeros())?;
            lanes &= lanes - 1;
            // Lanes without a cluster are far.
            blocks.get((first + lane) as usize)
        })
    }
}

/// The winding number of a query given in scaled and in local units.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn winding_number(tree: &WindingTree, scaled: [f64; 3], local: [f64; 3]) -> f64 {
    let high = local.map(|x| x as f32);
    let low = [0, 1, 2].map(|axis| (local[axis] - f64::from(high[axis])) as f32);
    let accuracy_squared = tree.accuracy * tree.accuracy;
    let mut far = [0.0f64; WIDTH];
    let mut near = 0.0;
    let mut waiting = Waiting::at_root(tree);
    while let Some((node, place)) = waiting.next() {
        let (angles, open) = node.far(high, low, accuracy_squared);
        for lane in 0..WIDTH {
            far[lane] += f64::from(angles[lane]);
        }
        for block in waiting.open(place, open) {
            near += block.turns(scaled);
        }
    }
    near + total(&far) * (1.0 / (4.0 * PI))
}

/// Adds every triangle.
#[multiversion(targets("x86_64+avx2"))]
pub(super) fn visit_all(blocks: &[Block], scaled: [f64; 3], sum: &mut Sum, bound: &mut f64) {
    for block in blocks {
        let (turns, error) = block.turns_within(scaled);
        sum.add(turns);
        *bound += error;
    }
}
