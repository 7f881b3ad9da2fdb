//! A hierarchy of boxes over segments.

use shapeloom_core::Aabb;
use shapeloom_core::glam::DVec3;

/// A chord of a piece over a range of its parameter.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) start: DVec3,
    pub(super) end: DVec3,
    pub(super) piece: u32,
    pub(super) from: f64,
    pub(super) to: f64,
}

impl Segment {
    fn bounds(&self) -> Aabb {
        Aabb::from_corners(self.start, self.end)
    }

    /// The squared distance and the place of the nearest point, from 0 at the start to 1.
    fn closest(&self, point: DVec3) -> (f64, f64) {
        let along = self.end - self.start;
        let square = along.length_squared();
        let place = if square > 0.0 { ((point - self.start).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        ((self.start + along * place).distance_squared(point), place)
    }
}

/// Segments in an order in which each node's are neighbours; the nodes of a binary tree, the first child behind its parent.
#[derive(Clone, Debug)]
pub(super) struct SegmentTree {
    segments: Vec<Segment>,
    nodes: Vec<Node>,
}

#[derive(Clone, Debug)]
struct Node {
    bounds: Aabb,
    first: u32,
    /// How many segments; 0 in a node with children.
    count: u32,
    /// The second child.
    second: u32,
}

const LEAF: usize = 4;

impl SegmentTree {
    /// At least one segment. Split in the middle of the longest side, by the middle segment.
    pub(super) fn new(mut segments: Vec<Segment>) -> Self {
        let mut nodes: Vec<Node> = Vec::new();
        // Ranges to be made nodes, with the parent whose second child each is.
        let mut tasks = vec![(0, segments.len(), None::<usize>)];
        while let Some((start, end, parent)) = tasks.pop() {
            let here = nodes.len();
            if let Some(parent) = parent {
                nodes[parent].second = here as u32;
            }
            let range = &mut segments[start..end];
            let bounds = range.iter().fold(Aabb::EMPTY, |all, segment| all.union(segment.bounds()));
            let leaf = range.len() <= LEAF;
            nodes.push(Node {
                bounds,
                first: start as u32,
                count: if leaf { range.len() as u32 } else { 0 },
                second: 0,
            });
            if !leaf {
                let size = bounds.size();
                let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
                let middle = range.len() / 2;
                let center = |segment: &Segment| segment.start[axis] + segment.end[axis];
                range.select_nth_unstable_by(middle, |a, b| {
                    center(a).total_cmp(&center(b)).then(a.piece.cmp(&b.piece)).then(a.from.total_cmp(&b.from))
                });
                tasks.push((start + middle, end, Some(here)));
                tasks.push((start, start + middle, None));
            }
        }
        Self { segments, nodes }
    }

    /// The nearest segment and the place on it. One is known to lie within `limit`.
    pub(super) fn closest(&self, point: DVec3, limit: f64) -> (Segment, f64) {
        let mut best = (self.segments[0], 0.0);
        // Room for the rounding of a limit that another point's answer gave; else nothing might be found.
        let mut distance = limit * limit * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        let mut found = false;
        loop {
            let mut stack = vec![0_usize];
            while let Some(at) = stack.pop() {
                let node = &self.nodes[at];
                if node.bounds.distance_squared(point) > distance {
                    continue;
                }
                if node.count == 0 {
                    let children = [at + 1, node.second as usize];
                    let [a, b] = children.map(|child| self.nodes[child].bounds.distance_squared(point));
                    stack.extend(if a < b { [children[1], children[0]] } else { children });
                    continue;
                }
                for segment in &self.segments[node.first as usize..(node.first + node.count) as usize] {
                    let (square, place) = segment.closest(point);
                    // Of equally near ones the first of the curve, whatever the order of the search.
                    let earlier = || (segment.piece, segment.from) < (best.0.piece, best.0.from);
                    if square < distance || (square == distance && (!found || earlier())) {
                        (best, distance, found) = ((*segment, place), square, true);
                    }
                }
            }
            if found || distance == f64::INFINITY || point.is_nan() {
                return best;
            }
            distance = f64::INFINITY;
        }
    }
}
