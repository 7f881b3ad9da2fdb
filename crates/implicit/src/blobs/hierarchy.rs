//! Which terms reach a point or a box.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Exec, Stop};

use super::term::Term;

/// How many terms a leaf holds. Fewer make more boxes to test, more test terms that are far away; 2 and 8 are slower by a
/// tenth to a third on molecules.
const LEAF: usize = 4;

/// A binary tree of boxes over terms that lie in the order of its leaves, stored parents first.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// The node after the last one below this.
    skip: u32,
    /// The terms of a leaf.
    first: u32,
    count: u32,
}

/// How many of `count` terms go to the left: the largest power of two of leaves that leaves the right side some. The shape of the tree so
/// depends on the count alone.
fn left_of(count: usize) -> usize {
    let leaves = count.div_ceil(LEAF);
    LEAF * (leaves.next_power_of_two() / 2)
}

/// Puts terms that are near each other beside each other, by halving along the longest side again and again. Terms with
/// equal centres keep an order that depends on their numbers alone.
pub(super) fn sort_by_place(terms: &mut [(u32, Term)], exec: &Exec) -> Result<(), Stop> {
    let mut left = vec![(0, terms.len())];
    while let Some((start, end)) = left.pop() {
        let part = &mut terms[start..end];
        if part.len() <= LEAF {
            part.sort_unstable_by_key(|(index, _)| *index);
            continue;
        }
        if part.len() > 256 {
            exec.check()?;
        }
        let size = Aabb::from_points(part.iter().map(|(_, term)| term.center)).size();
        let axis = (0..3).fold(0, |most, axis| if size[axis] > size[most] { axis } else { most });
        let cut = left_of(part.len());
        part.select_nth_unstable_by(cut, |(i, a), (j, b)| a.center[axis].total_cmp(&b.center[axis]).then(i.cmp(j)));
        left.push((start, start + cut));
        left.push((start + cut, end));
    }
    Ok(())
}

impl Hierarchy {
    /// The tree over terms in the order in which they lie.
    pub(super) fn new(terms: &[Term]) -> Self {
        let mut nodes: Vec<Node> = Vec::with_capacity(2 * terms.len().div_ceil(LEAF));
        let mut left = vec![(0, terms.len())];
        while let Some((start, end)) = left.pop() {
            let count = end - start;
            let leaf = count <= LEAF;
            // The nodes of a subtree: two for each leaf but one.
            let below = 2 * count.div_ceil(LEAF).max(1) - 1;
            nodes.push(Node {
                bounds: Aabb::EMPTY,
                skip: (nodes.len() + below) as u32,
                first: start as u32,
                count: if leaf { count as u32 } else { 0 },
            });
            if !leaf {
                let cut = start + left_of(count);
                left.push((cut, end));
                left.push((start, cut));
            }
        }
        // Children lie behind their parents.
        for at in (0..nodes.len()).rev() {
            let node = nodes[at];
            nodes[at].bounds = if node.count > 0 || terms.is_empty() {
                let own = &terms[node.first as usize..(node.first + node.count) as usize];
                own.iter().fold(Aabb::EMPTY, |sum, term| sum.union(term.bounds()))
            } else {
                let second = nodes[at + 1].skip as usize;
                nodes[at + 1].bounds.union(nodes[second].bounds)
            };
        }
        Self { nodes }
    }

    /// The box around all terms.
    pub(super) fn bounds(&self) -> Aabb {
        self.nodes.first().map_or(Aabb::EMPTY, |root| root.bounds)
    }

    /// Bytes for so many terms.
    pub(super) fn bytes_for(terms: usize) -> u64 {
        2 * terms.div_ceil(LEAF) as u64 * size_of::<Node>() as u64
    }

    /// Visits the leaves whose boxes hold the point, in order.
    pub(super) fn around(&self, point: DVec3, mut visit: impl FnMut(std::ops::Range<usize>)) {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !node.bounds.contains(point) {
                at = node.skip as usize;
                continue;
            }
            if node.count > 0 {
                visit(node.first as usize..(node.first + node.count) as usize);
            }
            at += 1;
        }
    }

    /// Visits the leaves whose boxes meet the region, in order, until told to stop. Whether all were visited.
    pub(super) fn meeting(&self, region: &Aabb, mut visit: impl FnMut(std::ops::Range<usize>) -> bool) -> bool {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if node.bounds.min.cmpgt(region.max).any() || node.bounds.max.cmplt(region.min).any() {
                at = node.skip as usize;
                continue;
            }
            if node.count > 0 && !visit(node.first as usize..(node.first + node.count) as usize) {
                return false;
            }
            at += 1;
        }
        true
    }
}
