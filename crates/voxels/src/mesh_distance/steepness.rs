//! How fast the winding number of an open mesh can change away from it.

use std::f64::consts::PI;
use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, ConvertError, Exec, Reservation};

use super::in_cells::InCells;

/// Two bounds of the gradient of the winding number off the triangles; either may be the better one.
///
/// It is the flux of a field like that of a current along the boundary of the mesh as a chain (Biot and Savart), so it changes no
/// faster than Σ length / (4π distance²) over the sides that are not passed as often one way as the other. And it is that of
/// dipoles on the triangles, so it changes no faster than Σ 2 area / (4π distance³) over all triangles. The first is small for few
/// holes, the second for many small ones and for soups.
pub(super) struct Steepness {
    boundary: Tree,
    triangles: Tree,
}

impl Steepness {
    /// Finds the boundary and arranges it and the triangles. Corners at equal places count as one.
    pub fn new(mesh: &InCells<'_>, exec: &Exec) -> Result<Self, ConvertError> {
        let boundary = Tree::new(boundary(mesh, exec)?, 2, exec)?;
        let count = mesh.triangles.len();
        let _memory = exec.reserve_elements(count as u64, size_of::<Part>())?;
        let mut parts = Vec::with_capacity(count);
        for triangle in 0..count as u32 {
            if triangle % 4096 == 0 {
                exec.check()?;
            }
            let corners = mesh.corners(triangle);
            let [a, b, c] = corners;
            let weight = (b - a).cross(c - a).length() / (4.0 * PI);
            parts.push(Part { bounds: Aabb::from_points(corners), weight });
        }
        Ok(Self { boundary, triangles: Tree::new(parts, 3, exec)? })
    }

    /// Whether the gradient of the winding number is nowhere longer than `slope`, turns a cell, within `radius` of a place that no
    /// triangle comes as near to. May say no where it is.
    pub fn is_at_most(&self, center: DVec3, radius: f64, slope: f64) -> bool {
        self.boundary.is_at_most(center, radius, slope) || self.triangles.is_at_most(center, radius, slope)
    }
}

/// Something that adds its weight over a power of its distance.
#[derive(Clone, Copy)]
struct Part {
    bounds: Aabb,
    weight: f64,
}

/// How many parts are in a group.
const GROUP: usize = 8;

/// Groups of so small a size beside their distance are taken whole: their bound is too large by a half on average.
const SMALL: f64 = 0.35;

/// How many nodes wait at most: one on each level and one more, levels being fewer than bits of an index.
const WAITING: usize = 66;

/// Parts in a complete binary tree: the nodes of a level follow those of the level above, the last level being groups.
struct Tree {
    parts: Vec<Part>,
    nodes: Vec<Part>,
    levels: u32,
    power: i32,
    _memory: Reservation,
}

impl Tree {
    /// Puts near parts together by halving along the longest axis, and makes the nodes.
    fn new(mut parts: Vec<Part>, power: i32, exec: &Exec) -> Result<Self, ConvertError> {
        let len = parts.len();
        let levels = len.div_ceil(GROUP).max(1).next_power_of_two().trailing_zeros();
        let memory = exec.reserve_elements(len as u64 + (2u64 << levels), size_of::<Part>())?;
        for level in 0..levels {
            for part in 0..1usize << level {
                if part % 64 == 0 {
                    exec.check()?;
                }
                let range = span(len, levels, level, part);
                let middle = span(len, levels, level + 1, 2 * part).end;
                let (start, inner) = (range.start, middle > range.start && middle < range.end);
                let parts = &mut parts[range];
                let size = Aabb::from_points(parts.iter().map(|part| part.bounds.center())).size();
                let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
                if inner {
                    let place = |part: &Part| part.bounds.center()[axis];
                    parts.select_nth_unstable_by(middle - start, |a, b| place(a).total_cmp(&place(b)));
                }
            }
        }
        let mut nodes = Vec::with_capacity(2usize << levels);
        for level in 0..=levels {
            exec.check()?;
            for part in 0..1usize << level {
                let parts = &parts[span(len, levels, level, part)];
                let bounds = Aabb::from_points(parts.iter().flat_map(|part| [part.bounds.min, part.bounds.max]));
                nodes.push(Part { bounds, weight: parts.iter().map(|part| part.weight).sum() });
            }
        }
        Ok(Self { parts, nodes, levels, power, _memory: memory })
    }

    /// What a part adds at most at a distance.
    fn at_most(&self, part: &Part, distance: f64) -> f64 {
        match distance > 0.0 {
            true if self.power == 2 => part.weight / (distance * distance),
            true => part.weight / (distance * distance * distance),
            false if part.weight > 0.0 => f64::INFINITY,
            false => 0.0,
        }
    }

    fn is_at_most(&self, center: DVec3, radius: f64, slope: f64) -> bool {
        let total = self.nodes.first().map_or(0.0, |root| root.weight);
        let mut left = slope;
        let mut waiting = [(0u32, 0usize); WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let (level, at) = waiting[count];
            let node = &self.nodes[(1usize << level) - 1 + at];
            let distance = node.bounds.distance_squared(center).sqrt() - radius;
            let share = self.at_most(node, distance);
            // Taken whole is what is small beside its distance, as opening it would lower the bound little, and what would stay within
            // half of the allowance if all were like it.
            let small = node.bounds.size().length_squared() <= SMALL * SMALL * distance * distance;
            if (distance > 0.0 && small) || share <= 0.5 * slope * node.weight / total || node.weight == 0.0 {
                left -= share;
            } else if level < self.levels {
                waiting[count] = (level + 1, 2 * at);
                waiting[count + 1] = (level + 1, 2 * at + 1);
                count += 2;
            } else {
                let parts = &self.parts[span(self.parts.len(), self.levels, level, at)];
                let each = |part: &Part| self.at_most(part, part.bounds.distance_squared(center).sqrt() - radius);
                left -= parts.iter().map(each).sum::<f64>();
            }
            if left < 0.0 {
                return false;
            }
        }
        true
    }
}

/// The sides that are not passed as often one way as the other, each with its length as often as it is passed too often.
fn boundary(mesh: &InCells<'_>, exec: &Exec) -> Result<Vec<Part>, ConvertError> {
    let count = mesh.triangles.len() as u64 * 3;
    let _memory = exec.reserve_elements(count, size_of::<(u32, u32, i32)>() + size_of::<Part>())?;
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
            let [a, b] = [same[0].0, same[0].1].map(|corner| mesh.positions[corner as usize]);
            let weight = net.unsigned_abs() as f64 * a.distance(b) / (4.0 * PI);
            sides.push(Part { bounds: Aabb::from_points([a, b]), weight });
        }
    }
    Ok(sides)
}

/// The parts of a node: all are cut into as many groups as the last level has, of sizes that differ by one at most.
fn span(len: usize, levels: u32, level: u32, part: usize) -> Range<usize> {
    let groups = 1usize << levels;
    let width = 1usize << (levels - level);
    let at = |group: usize| (group as u128 * len as u128 / groups as u128) as usize;
    at(part * width)..at((part + 1) * width)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Dice, icosahedron, some, soup};
    use shapeloom_isosurface::Lattice;
    use shapeloom_spatial::generalized_winding_number;

    /// Difference quotients of exact winding numbers never exceed a slope that is said not to be exceeded, and not much larger
    /// slopes are said to be enough.
    #[test]
    fn winding_numbers_change_no_faster_than_is_said() {
        let exec = Exec::default();
        let mut dice = Dice(17);
        for mesh in [some(&icosahedron(), |i| i % 4 != 1), soup(40, 0.3, 2), some(&icosahedron(), |i| i == 0)] {
            let lattice = Lattice::along_axes([2; 3], DVec3::ZERO, DVec3::ONE).unwrap();
            let cells = InCells::new(&mesh, &lattice, 1.0, &exec).unwrap();
            let steepness = Steepness::new(&cells, &exec).unwrap();
            let (mut told, mut tight) = (0, 0);
            for _ in 0..400 {
                let center = dice.point() * 3.0;
                let free = crate::fixtures::brute_distance(&mesh, center);
                let radius = 0.4 * free;
                let direction = dice.point().normalize();
                let winding =
                    |p: DVec3| generalized_winding_number(mesh.positions(), mesh.triangles(), p, &exec).unwrap().value;
                let step = radius * 1e-3;
                let place = center + direction * radius * 0.9;
                let quotient = (winding(place + direction * step) - winding(place)).abs() / step;
                for slope in [quotient * 0.7, quotient * 0.98] {
                    assert!(!steepness.is_at_most(center, radius, slope), "{center}: {quotient}");
                }
                told += 1;
                tight += u32::from(steepness.is_at_most(center, radius, quotient * 100.0));
            }
            assert!(told == 400 && tight > 20, "{tight} of {told}");
        }
    }
}
