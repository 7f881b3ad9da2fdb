//! The tree of boxes: built two-wide by obvhs, kept four-wide.
//!
//! Four boxes side by side in arrays let the compiler test them against a ray at once. Boxes are `f32` in local units,
//! where the shape's size is about 1, and always hold what they bound.

use obvhs::aabb::Aabb as Box2;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// Children of a node.
pub(crate) const WIDTH: usize = 4;

/// Four boxes with what they hold. Unused places have a box that nothing meets.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    /// `sides[0]` are the smaller and `sides[1]` the larger coordinates, by axis, then by child.
    pub sides: [[[f32; WIDTH]; 3]; 2],
    /// The index of a node, or of a leaf's first primitive.
    pub first: [u32; WIDTH],
    /// How many primitives a leaf holds; 0 for a node.
    pub count: [u32; WIDTH],
}

impl Node {
    // Finite, so that differences with finite numbers are never NaN.
    const UNUSED: Self =
        Self { sides: [[[f32::MAX; WIDTH]; 3], [[f32::MIN; WIDTH]; 3]], first: [0; WIDTH], count: [0; WIDTH] };
}

/// A box of a primitive in local units.
#[derive(Clone, Copy, Debug)]
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
    /// The primitive at each place of the leaves.
    pub order: Vec<u32>,
}

impl Hierarchy {
    /// Memory that [`Hierarchy::build`] needs for a primitive while it runs: the builder's nodes (48 bytes, five
    /// times), its sort keys and parents, and ours.
    pub const BUILD_BYTES: usize = 400;
    /// Memory that stays, in bytes a primitive: at worst one node for each three leaves of one primitive.
    pub const BYTES: usize = 48;

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
        ReinsertionOptimizer::default().run(&mut tree, 0.02, None);
        // Triangle tests in f64 cost about as much as a node of four boxes, so leaves stay small.
        collapse(&mut tree, 4, 1.0);
        Self { nodes: widened(&tree), order: tree.primitive_indices }
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

fn widened(tree: &Bvh2) -> Vec<Node> {
    let mut nodes = Vec::new();
    if tree.nodes.is_empty() {
        return nodes;
    }
    nodes.push(Node::UNUSED);
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
                nodes[to].sides[0][axis][lane] = min[axis];
                nodes[to].sides[1][axis][lane] = max[axis];
            }
            if child_node.is_leaf() {
                nodes[to].first[lane] = child_node.first_index;
                nodes[to].count[lane] = child_node.prim_count;
            } else {
                nodes[to].first[lane] = nodes.len() as u32;
                open.push((child, nodes.len()));
                nodes.push(Node::UNUSED);
            }
        }
    }
    nodes
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
                if min[0] > max[0] {
                    continue;
                }
                assert!((0..3).all(|a| min[a] >= low[a] && max[a] <= high[a]));
                if node.count[lane] == 0 {
                    open.push((node.first[lane] as usize, min, max, depth + 1));
                }
                for place in node.first[lane]..node.first[lane] + node.count[lane] {
                    let primitive = hierarchy.order[place as usize] as usize;
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
