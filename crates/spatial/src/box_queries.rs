//! Box queries on the hierarchy.

use glam::DVec3;
use shapeloom_core::Aabb;

use crate::TriangleBvh;
use crate::triangle_block::Block;
use crate::triangle_box::triangle_meets_box;
use crate::wide_node::{Node, WIDTH};

impl TriangleBvh {
    /// Every triangle that has a point in common with a box, rising; decided exactly, touching counts. What `found`
    /// held before is gone.
    pub fn overlapping(&self, region: &Aabb, found: &mut Vec<u32>) {
        found.clear();
        if self.nodes.is_empty() || region.is_empty() || region.min.is_nan() || region.max.is_nan() {
            return;
        }
        let scaled = Aabb { min: region.min * self.units.per_unit, max: region.max * self.units.per_unit };
        // Nodes are about the centre, and the difference rounds by far less than this.
        let center = self.units.center;
        let slack = DVec3::splat(1e-14) * (center.abs() + DVec3::ONE);
        let (min, max) = ((scaled.min - center - slack).to_array(), (scaled.max - center + slack).to_array());
        let mut open = vec![0u32];
        while let Some(node) = open.pop() {
            let node = &self.nodes[node as usize];
            for lane in (0..WIDTH).filter(|&lane| node.is_used(lane)) {
                let [low, high] = &node.sides;
                let meets = (0..3)
                    .all(|axis| f64::from(low[axis][lane]) <= max[axis] && f64::from(high[axis][lane]) >= min[axis]);
                if !meets {
                    continue;
                }
                let (first, place) = (node.first[lane], node.place[lane]);
                if place == Node::INNER {
                    open.push(first);
                    continue;
                }
                let block = &self.blocks[first as usize];
                for (lane, &element) in block.elements.iter().enumerate().filter(|(_, e)| **e != Block::NONE) {
                    if triangle_meets_box(&self.corners_at(block, place, lane), &scaled) {
                        found.push(element);
                        found.extend(self.twins_of(element));
                    }
                }
            }
        }
        found.sort_unstable();
    }
}
