//! How fast the winding number of an open mesh can change away from it.

use std::f64::consts::PI;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, ConvertError, Exec, Reservation};

use super::in_cells::InCells;

/// The sides of triangles that are not passed as often one way as the other: the boundary of the mesh as a chain, as a tree.
///
/// Off the triangles the winding number is the flux of a field like that of a current along the boundary (Biot and Savart), so its
/// gradient at a place is no longer than Σ length / (4π distance²) over these sides, each as often as it is passed too often.
pub(super) struct Boundary {
    sides: Vec<Side>,
    /// A complete binary tree over the sides: node `i` has the children `2 i + 1` and `2 i + 2`, the last level being groups.
    nodes: Vec<Node>,
    levels: u32,
    _memory: Reservation,
}

struct Side {
    ends: [DVec3; 2],
    weight: f64,
}

#[derive(Clone, Copy)]
struct Node {
    bounds: Aabb,
    weight: f64,
}

/// How many sides are in a group.
const GROUP: usize = 8;

impl Boundary {
    /// Finds the sides. Corners at equal places count as one.
    pub fn new(mesh: &InCells<'_>, exec: &Exec) -> Result<Self, ConvertError> {
        let count = mesh.triangles.len() as u64 * 3;
        let memory = exec.reserve_elements(count, 2 * size_of::<(u32, u32, i32)>() + 2 * size_of::<Side>())?;
        let _order = exec.reserve_elements(mesh.positions.len() as u64, 2 * size_of::<u32>())?;
        let key = |index: u32| mesh.positions[index as usize].to_array().map(|x| (x + 0.0).to_bits());
        let mut order: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        order.sort_unstable_by_key(|&index| (key(index), index));
        exec.check()?;
        let mut first = vec![0u32; order.len()];
        for equal in order.chunk_by(|&a, &b| key(a) == key(b)) {
            equal.iter().for_each(|&index| first[index as usize] = equal[0]);
        }
        let mut passed: Vec<(u32, u32, i32)> = Vec::with_capacity(count as usize);
        for triangle in mesh.triangles {
            let [a, b, c] = triangle.map(|corner| first[corner as usize]);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                if from != to {
                    passed.push((from.min(to), from.max(to), if from < to { 1 } else { -1 }));
                }
            }
        }
        exec.check()?;
        passed.sort_unstable();
        exec.check()?;
        let mut sides = Vec::new();
        for same in passed.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
            let net: i64 = same.iter().map(|side| i64::from(side.2)).sum();
            if net != 0 {
                let ends = [same[0].0, same[0].1].map(|corner| mesh.positions[corner as usize]);
                sides.push(Side { ends, weight: net.unsigned_abs() as f64 * ends[0].distance(ends[1]) / (4.0 * PI) });
            }
        }
        let groups = sides.len().div_ceil(GROUP).max(1).next_power_of_two();
        let levels = groups.trailing_zeros();
        let mut boundary = Self { sides, nodes: Vec::new(), levels, _memory: memory };
        exec.check()?;
        boundary.arrange(exec)?;
        Ok(boundary)
    }

    /// Puts near sides together by halving along the longest axis, and makes the nodes.
    fn arrange(&mut self, exec: &Exec) -> Result<(), ConvertError> {
        let len = self.sides.len();
        for level in 0..self.levels {
            exec.check()?;
            for part in 0..1usize << level {
                let range = span(len, self.levels, level, part);
                let middle = span(len, self.levels, level + 1, 2 * part).end;
                let sides = &mut self.sides[range.clone()];
                let center = |side: &Side| (side.ends[0] + side.ends[1]) * 0.5;
                let bounds = Aabb::from_points(sides.iter().map(center));
                let size = bounds.max - bounds.min;
                let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
                if middle > range.start && middle < range.end {
                    sides.select_nth_unstable_by(middle - range.start, |a, b| {
                        let tie = |side: &Side| side.ends.map(|end| end.to_array());
                        let order = center(a)[axis].total_cmp(&center(b)[axis]);
                        order.then_with(|| tie(a).partial_cmp(&tie(b)).unwrap_or(std::cmp::Ordering::Equal))
                    });
                }
            }
        }
        for level in 0..=self.levels {
            for part in 0..1usize << level {
                let sides = &self.sides[span(len, self.levels, level, part)];
                let bounds = Aabb::from_points(sides.iter().flat_map(|side| side.ends));
                self.nodes.push(Node { bounds, weight: sides.iter().map(|side| side.weight).sum() });
            }
        }
        Ok(())
    }

    /// Whether the gradient of the winding number is nowhere longer than `slope`, a turn a cell, within `radius` of a place that no
    /// triangle comes as near to. May say no where it is.
    pub fn is_flatter(&self, center: DVec3, radius: f64, slope: f64) -> bool {
        let total = self.nodes.first().map_or(0.0, |root| root.weight);
        let mut left = slope;
        let mut stack = vec![(0u32, 0usize)];
        while let Some((level, part)) = stack.pop() {
            let node = &self.nodes[(1usize << level) - 1 + part];
            if node.weight == 0.0 {
                continue;
            }
            let share = at_most(node.weight, node.bounds.distance_squared(center).sqrt() - radius);
            // What is accepted whole takes half of the allowance in all at most.
            if share <= 0.5 * slope * node.weight / total {
                left -= share;
            } else if level < self.levels {
                stack.extend([(level + 1, 2 * part), (level + 1, 2 * part + 1)]);
            } else {
                for side in &self.sides[span(self.sides.len(), self.levels, level, part)] {
                    left -= at_most(side.weight, to_segment(center, side.ends) - radius);
                }
            }
            if left < 0.0 {
                return false;
            }
        }
        true
    }
}

/// What a side adds to the gradient at most, from a distance.
fn at_most(weight: f64, distance: f64) -> f64 {
    if distance > 0.0 { weight / (distance * distance) } else { f64::INFINITY }
}

/// The sides of a node: all are cut into as many groups as the last level has, of sizes that differ by one at most.
fn span(len: usize, levels: u32, level: u32, part: usize) -> std::ops::Range<usize> {
    let groups = 1usize << levels;
    let width = 1usize << (levels - level);
    let at = |group: usize| (group as u128 * len as u128 / groups as u128) as usize;
    at(part * width)..at((part + 1) * width)
}

fn to_segment(place: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let squared = along.length_squared();
    let t = if squared > 0.0 { ((place - a).dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    place.distance(a + along * t)
}
