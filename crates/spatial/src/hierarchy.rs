//! The tree of boxes: built two-wide by obvhs, kept eight-wide.
//!
//! Boxes are `f32` in local units,
//! where the shape's size is about 1, and always hold what they bound.

use obvhs::aabb::Aabb as Box2;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::wide_node::{Node, WIDTH};

/// A box of a primitive in local units.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bounds {
    pub min: [f32; 3],
    pub max: [f32; 3],
}

impl Bounds {
    /// The smallest `f32` box around `f64` corners.
    pub fn outward(min: [f64; 3], max: [f64; 3]) -> Self {
        Self { min: min.map(below), max: max.map(above) }
    }
}

/// The largest `f32` that is not above `value`.
pub(crate) fn below(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

/// The smallest `f32` that is not below `value`.
pub(crate) fn above(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}

/// A tree over primitives, and the order in which its leaves name them.
#[derive(Debug)]
pub(crate) struct Hierarchy {
    /// The root first; empty without primitives.
    pub nodes: Vec<Node>,
    /// The leaves: where each one's primitives start in the order.
    pub leaves: Vec<u32>,
    /// The primitive at each place of the leaves.
    pub order: Vec<u32>,
}

impl Hierarchy {
    /// Memory that [`Hierarchy::build`] needs for a primitive while it runs: the builder's nodes (48 bytes, five
    /// times), its sort keys and parents, and ours.
    pub const BUILD_BYTES: usize = 400;

    /// A tree over boxes in local units (coordinates of magnitude about 1).
    ///
    /// Parallel locally-ordered clustering (Meister, Bittner 2018) with reinsertion, on one thread: obvhs' parallel
    /// build depends on the number of threads.
    pub fn build(bounds: &[Bounds]) -> Self {
        let padded: Vec<Box2> = bounds.iter().enumerate().map(|(i, &bounds)| jittered(bounds, i as u32)).collect();
        let indices = (0..bounds.len() as u32).collect();
        let mut tree = PlocBuilder::with_capacity(bounds.len()).build(
            PlocSearchDistance::Low,
            &padded,
            indices,
            SortPrecision::U64,
            2,
        );
        collapse(&mut tree);
        // More gains nothing that a million rays show.
        ReinsertionOptimizer::default().run(&mut tree, 0.02, None);
        let mut hierarchy = Self { nodes: Vec::new(), leaves: Vec::new(), order: Vec::with_capacity(bounds.len()) };
        hierarchy.widen(&tree);
        hierarchy
    }

    fn widen(&mut self, tree: &Bvh2) {
        if tree.nodes.is_empty() {
            return;
        }
        self.nodes.push(Node::UNUSED);
        let mut open = vec![(0u32, 0usize)];
        let mut lanes: Vec<u32> = Vec::with_capacity(WIDTH);
        while let Some((from, to)) = open.pop() {
            let root = &tree.nodes[from as usize];
            lanes.clear();
            if root.is_leaf() {
                lanes.push(from);
            } else {
                lanes.extend([root.first_index, root.first_index + 1]);
            }
            while lanes.len() < WIDTH {
                let area = |&lane: &usize| tree.nodes[lanes[lane] as usize].aabb().half_area();
                let inner = (0..lanes.len()).filter(|&lane| !tree.nodes[lanes[lane] as usize].is_leaf());
                let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
                let first = tree.nodes[lanes[largest] as usize].first_index;
                lanes[largest] = first;
                lanes.push(first + 1);
            }
            for (lane, &child) in lanes.iter().enumerate() {
                let child_node = &tree.nodes[child as usize];
                let (min, max) = (child_node.aabb().min.to_array(), child_node.aabb().max.to_array());
                for axis in 0..3 {
                    self.nodes[to].sides[0][axis][lane] = min[axis];
                    self.nodes[to].sides[1][axis][lane] = max[axis];
                }
                if child_node.is_leaf() {
                    let place = self.order.len() as u32;
                    self.nodes[to].first[lane] = self.leaves.len() as u32;
                    self.nodes[to].place[lane] = place;
                    self.leaves.push(place);
                    let primitives = child_node.first_index as usize..;
                    self.order.extend_from_slice(&tree.primitive_indices[primitives][..child_node.prim_count as usize]);
                } else {
                    self.nodes[to].first[lane] = self.nodes.len() as u32;
                    open.push((child, self.nodes.len()));
                    self.nodes.push(Node::UNUSED);
                }
            }
        }
    }
}

/// The box, moved outward a little, by another amount for each primitive.
///
/// Clustering merges one pair in a pass where all neighbours cost the same, as in a straight strip of equal boxes or a
/// row of points on an axis: quadratic time. Amounts up to eight steps of `f32` break the ties and cost nothing later.
fn jittered(bounds: Bounds, index: u32) -> Box2 {
    let hash = index.wrapping_add(1).wrapping_mul(0x9e37_79b1);
    let hash = (hash ^ hash >> 15).wrapping_mul(0x85eb_ca77);
    let amount = |shift: u32| (hash >> shift & 0xff) as f32 * (f32::EPSILON / 32.0);
    let [min, max] = [0, 1].map(|side| {
        let from = if side == 0 { bounds.min } else { bounds.max };
        let sign = if side == 0 { -1.0 } else { 1.0 };
        glam::Vec3A::from_array(std::array::from_fn(|axis| from[axis] + sign * amount(8 * axis as u32)))
    });
    // Adding a non-negative amount rounds to no less than the start.
    Box2::new(min, max)
}

/// Makes leaves of up to [`WIDTH`] primitives where the surface area heuristic says that this is cheaper. Children must
/// stand after their parents, as the builder leaves them.
fn collapse(tree: &mut Bvh2) {
    /// What a node costs, in primitives. A block of triangles costs about the same however full it is, so leaves should
    /// be full: at 5 rays take longer for the blocks, at 12 for the boxes that grow too large.
    const NODE_COST: f32 = 7.0;
    let count = tree.nodes.len();
    if count == 0 {
        return;
    }
    // How many primitives are below each node, and whether it becomes or is a leaf.
    let mut below = vec![(0u32, false); count];
    for index in (0..count).rev() {
        let node = &tree.nodes[index];
        below[index] = if node.is_leaf() {
            (node.prim_count, true)
        } else {
            let children = [node.first_index as usize, node.first_index as usize + 1];
            let primitives = below[children[0]].0 + below[children[1]].0;
            let apart: f32 =
                children.iter().map(|&child| tree.nodes[child].aabb().half_area() * below[child].0 as f32).sum();
            let together = node.aabb().half_area() * (primitives as f32 - NODE_COST);
            let leaves = children.iter().all(|&child| below[child].1);
            (primitives, leaves && primitives <= WIDTH as u32 && together <= apart)
        };
    }
    let mut order = vec![0; tree.primitive_indices.len()];
    // Where each node's primitives start in the new order, and the node that it becomes.
    let mut starts = vec![(0u32, 0u32); count];
    let mut inside = vec![false; count];
    let mut nodes: Vec<Bvh2Node> = Vec::with_capacity(count / 3);
    nodes.push(Bvh2Node::default());
    for index in 0..count {
        let node = tree.nodes[index];
        let (start, to) = starts[index];
        let leaf = below[index].1;
        if leaf && !inside[index] {
            nodes[to as usize] = Bvh2Node::new(*node.aabb(), below[index].0, start);
        }
        if node.is_leaf() {
            let primitives = &tree.primitive_indices[node.first_index as usize..][..node.prim_count as usize];
            order[start as usize..][..primitives.len()].copy_from_slice(primitives);
            continue;
        }
        let [left, right] = [node.first_index as usize, node.first_index as usize + 1];
        let first = nodes.len() as u32;
        starts[left] = (start, first);
        starts[right] = (start + below[left].0, first + 1);
        (inside[left], inside[right]) = (leaf, leaf);
        if !leaf {
            nodes[to as usize] = Bvh2Node::new(*node.aabb(), 0, first);
            nodes.extend([Bvh2Node::default(); 2]);
        }
    }
    tree.nodes = nodes;
    tree.primitive_indices = order;
    tree.parents = Vec::new();
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each primitive stands in one leaf, and every box around it, up to the root, holds it.
    fn assert_sound(hierarchy: &Hierarchy, bounds: &[Bounds]) {
        let mut seen = vec![0; bounds.len()];
        let mut open = vec![(0usize, [f32::MIN; 3], [f32::MAX; 3], 0)];
        while let Some((index, low, high, depth)) = open.pop() {
            // A tree that merges one pair in a pass is a chain.
            assert!(depth < 40, "a deep tree");
            let node = &hierarchy.nodes[index];
            for lane in 0..WIDTH {
                let (min, max) = ([0, 1, 2].map(|a| node.sides[0][a][lane]), [0, 1, 2].map(|a| node.sides[1][a][lane]));
                if !node.is_used(lane) {
                    continue;
                }
                assert!((0..3).all(|a| min[a] >= low[a] && max[a] <= high[a]));
                if node.place[lane] == Node::INNER {
                    open.push((node.first[lane] as usize, min, max, depth + 1));
                    continue;
                }
                let leaf = node.first[lane] as usize;
                assert_eq!(hierarchy.leaves[leaf], node.place[lane]);
                let end = hierarchy.leaves.get(leaf + 1).map_or(bounds.len(), |&end| end as usize);
                for &primitive in &hierarchy.order[node.place[lane] as usize..end] {
                    let primitive = primitive as usize;
                    seen[primitive] += 1;
                    let held = &bounds[primitive];
                    assert!((0..3).all(|a| held.min[a] >= min[a] && held.max[a] <= max[a]));
                }
            }
        }
        assert!(seen.iter().all(|&count| count == 1));
    }

    fn boxes(count: u32, at: impl Fn(u32) -> [f64; 3], size: f64) -> Vec<Bounds> {
        (0..count).map(|i| Bounds::outward(at(i), at(i).map(|x| x + size))).collect()
    }

    /// A quadratic build would make chains of these.
    #[test]
    fn rows_grids_and_heaps_of_equal_boxes_make_sound_trees() {
        for bounds in [
            boxes(50_000, |i| [f64::from(i) / 5e4, 0.0, 0.0], 0.0),
            boxes(50_000, |i| [f64::from(i) / 5e4, 0.0, 0.0], 2e-5),
            boxes(50_000, |_| [0.5; 3], 0.1),
            boxes(40_000, |i| [f64::from(i % 200) / 200.0, f64::from(i / 200) / 200.0, 0.0], 5e-3),
            boxes(3, |_| [0.0; 3], 0.0),
            boxes(1, |_| [0.0; 3], 0.0),
        ] {
            assert_sound(&Hierarchy::build(&bounds), &bounds);
        }
        assert!(Hierarchy::build(&[]).nodes.is_empty());
    }

    #[test]
    fn rounding_goes_outward() {
        for value in [0.1, -0.1, 1.0 / 3.0, 1e-300, -1e-300, 0.0, 1.0] {
            assert!(f64::from(below(value)) <= value && f64::from(above(value)) >= value);
            assert!(above(value) <= below(value).next_up());
        }
    }
}
