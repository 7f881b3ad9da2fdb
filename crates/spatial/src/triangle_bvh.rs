//! A bounding volume hierarchy over triangles.

use std::fmt;
use std::sync::atomic::{AtomicBool, Ordering};

use glam::DVec3;
use shapeloom_core::parallel::fill_chunks;
use shapeloom_core::{Aabb, Exec, Reservation, Stop};

use crate::BvhError;
use crate::equal_triangles::Groups;
use crate::hierarchy::{Bounds, Hierarchy};
use crate::scaled_input::Units;
use crate::scaled_input::checked_bounds;
use crate::triangle_block::Block;
use crate::wide_node::Node;

/// A bounding volume hierarchy over triangles, for rays and closest points.
///
/// Boxes are `f32` in local units, rounded outward; what they let through is decided in `f64` on the given coordinates,
/// so shapes far from the origin lose nothing, and neighbours that share corners leave no gap for a ray. Hits count
/// the border of a triangle, so a ray through a shared side meets both neighbours. Triangles without area are met by no
/// ray but have closest points. Elements are the triangles' places in the given slice.
///
/// Equal triangles (the same three corners in the same order) are stored once; [`all_hits`](shapeloom_core::Rays) still
/// names each of them. Memory: about 75 bytes a triangle where all coordinates are numbers of single precision and the
/// shape lies near the origin, else about 150, reserved as long as the hierarchy lives; about 400 more while it is built.
/// A query costs about the logarithm of the number of triangles.
pub struct TriangleBvh {
    pub(crate) nodes: Vec<Node>,
    /// The leaves.
    pub(crate) blocks: Vec<Block>,
    /// Corners in scaled units, in the order of the leaves; none where the blocks hold them exactly.
    corners: Vec<[DVec3; 3]>,
    groups: Groups,
    len: usize,
    bounds: Aabb,
    pub(crate) units: Units,
    _memory: Vec<Reservation>,
}

impl Units {
    /// The origin of blocks, in scaled units: none where the shape lies near it, so that coordinates given in single
    /// precision are held exactly.
    pub fn block_origin(&self) -> DVec3 {
        if self.center.abs().max_element() <= 2.0 { DVec3::ZERO } else { self.center }
    }
}

impl TriangleBvh {
    /// Builds the hierarchy over `triangles`, index triples into `positions`.
    ///
    /// Positions that no triangle names may be anything. The middle part of the work runs on one thread and cannot be
    /// cancelled (about half a second for a million triangles). The result does not depend on the number of threads.
    ///
    /// # Errors
    /// An index out of range, a corner that is not finite, more than `u32::MAX - 1` triangles, too little memory in
    /// the budget, or the reason to stop.
    pub fn build(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<Self, BvhError> {
        exec.check()?;
        let scratch = exec.reserve_elements(triangles.len() as u64, Hierarchy::BUILD_BYTES)?;
        let bounds = checked_bounds(positions, triangles, exec)?;
        let units = Units::new(&bounds);
        exec.progress(0.1);
        let corners_of = |element: u32| {
            // Adding zero turns -0 into 0, so that equal corners have equal bits.
            triangles[element as usize].map(|index| positions[index as usize] * units.per_unit + DVec3::ZERO)
        };
        let groups = Groups::of_equal(triangles.len() as u32, corners_of, exec)?;
        exec.check()?;
        exec.progress(0.3);
        let mut boxes = vec![Bounds::default(); groups.len()];
        fill_chunks(exec, &mut boxes, 1 << 13, |first, part| {
            for (group, bounds) in (first..).zip(part) {
                let [a, b, c] = corners_of(groups.leader(group)).map(|corner| corner - units.center);
                *bounds = Bounds::outward(a.min(b).min(c).to_array(), a.max(b).max(c).to_array());
            }
            Ok::<(), Stop>(())
        })?;
        let hierarchy = Hierarchy::build(&boxes);
        exec.check()?;
        exec.progress(0.9);
        let Hierarchy { nodes, leaves, mut order } = hierarchy;
        for primitive in &mut order {
            *primitive = groups.leader(*primitive as usize);
        }
        let bytes = nodes.capacity() * size_of::<Node>() + leaves.len() * size_of::<Block>() + groups.bytes();
        let mut memory = vec![exec.reserve(bytes as u64)?];
        let mut blocks = vec![Block::EMPTY; leaves.len()];
        let inexact = AtomicBool::new(false);
        fill_chunks(exec, &mut blocks, 1 << 11, |first, part| {
            let mut all_exact = true;
            for (leaf, block) in (first..).zip(part) {
                let end = leaves.get(leaf + 1).map_or(order.len(), |&end| end as usize);
                let leaf = order[leaves[leaf] as usize..end].iter();
                let exact;
                (*block, exact) = Block::of(leaf.map(|&element| (element, corners_of(element))), units.block_origin());
                all_exact &= exact;
            }
            if !all_exact {
                inexact.store(true, Ordering::Relaxed);
            }
            Ok::<(), Stop>(())
        })?;
        let mut corners = Vec::new();
        if inexact.into_inner() {
            memory.push(exec.reserve_elements(order.len() as u64, size_of::<[DVec3; 3]>())?);
            corners = vec![[DVec3::ZERO; 3]; order.len()];
            fill_chunks(exec, &mut corners, 1 << 13, |first, part| {
                for (corners, &element) in part.iter_mut().zip(&order[first..]) {
                    *corners = corners_of(element);
                }
                Ok::<(), Stop>(())
            })?;
        }
        drop(scratch);
        exec.progress(1.0);
        Ok(Self { nodes, blocks, corners, groups, len: triangles.len(), bounds, units, _memory: memory })
    }

    /// How many triangles there are, equal ones counted each.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The box around the triangles; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// How many different triangles there are: what is stored and searched.
    pub fn distinct(&self) -> usize {
        self.groups.len()
    }

    /// The corners of a stored triangle, in scaled units.
    #[inline(always)]
    pub(crate) fn corners_at(&self, block: &Block, place: u32, lane: usize) -> [DVec3; 3] {
        match self.corners.get(place as usize + lane) {
            Some(corners) => *corners,
            None => block.triangle(lane),
        }
    }

    /// The other elements with the corners of a stored triangle, given its smallest element.
    pub(crate) fn twins_of(&self, element: u32) -> impl Iterator<Item = u32> {
        self.groups.twins_of(element)
    }
}

impl fmt::Debug for TriangleBvh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TriangleBvh")
            .field("triangles", &self.len())
            .field("distinct", &self.distinct())
            .field("nodes", &self.nodes.len())
            .field("bounds", &self.bounds)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::{Draws, bumpy_ball};
    use shapeloom_core::{CancelFlag, ClosestPoint, Ray, Rays, Stop};

    #[test]
    fn wrong_input_is_named() {
        let exec = Exec::default();
        let found = TriangleBvh::build(&[DVec3::ZERO; 3], &[[0, 1, 2], [0, 7, 1]], &exec).unwrap_err();
        assert_eq!(found, BvhError::Index { triangle: 1, corner: 1, found: 7, positions: 3 });
        let positions = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, f64::INFINITY, 0.0)];
        let found = TriangleBvh::build(&positions, &[[0, 1, 1], [0, 1, 2]], &exec).unwrap_err();
        assert!(matches!(found, BvhError::NotFinite { triangle: 1, position: 2, .. }));
        assert!(TriangleBvh::build(&positions, &[[0, 1, 1]], &exec).is_ok());
    }

    #[test]
    fn budgets_and_cancelling_are_kept() {
        let (positions, triangles) = bumpy_ball(40, DVec3::ZERO, 1.0, 0.0);
        let small = Exec::default().with_memory(1000);
        assert!(matches!(TriangleBvh::build(&positions, &triangles, &small), Err(BvhError::OverBudget(_))));
        let flag = CancelFlag::default();
        flag.cancel();
        let stopped = TriangleBvh::build(&positions, &triangles, &Exec::default().with_cancel(&flag));
        assert_eq!(stopped.unwrap_err(), BvhError::Stop(Stop::Cancelled));
        let exec = Exec::default();
        let bvh = TriangleBvh::build(&positions, &triangles, &exec).unwrap();
        let stored =
            bvh.nodes.len() * size_of::<Node>() + bvh.corners.len() * 72 + bvh.blocks.len() * size_of::<Block>();
        assert!(exec.memory_taken() >= stored as u64, "{} {stored}", exec.memory_taken());
        drop(bvh);
        assert_eq!(exec.memory_taken(), 0);
    }

    #[test]
    fn coincident_triangles_are_handed_over_once() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, -DVec3::ZERO];
        let triangles: Vec<[u32; 3]> = (0..50_000).map(|i| [if i % 2 == 0 { 0 } else { 3 }, 1, 2]).collect();
        let bvh = TriangleBvh::build(&positions, &triangles, &Exec::default()).unwrap();
        assert_eq!((bvh.len(), bvh.distinct()), (50_000, 1));
        let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z).unwrap();
        let mut hits = Vec::new();
        bvh.all_hits(&ray, &mut hits);
        assert!(hits.iter().map(|hit| hit.element).eq(0..50_000));
        assert_eq!(bvh.first_hit(&ray), hits.first().copied());
        assert_eq!(bvh.closest(DVec3::Z).unwrap().element, 0);
    }

    #[test]
    fn nothing_one_and_flat_shapes_work() {
        let exec = Exec::default();
        let ray = Ray::new(DVec3::new(0.2, 0.2, 1.0), DVec3::NEG_Z).unwrap();
        let empty = TriangleBvh::build(&[], &[], &exec).unwrap();
        assert!(empty.first_hit(&ray).is_none() && empty.closest(DVec3::ZERO).is_none() && !empty.any_hit(&ray));
        assert!(empty.bounds().is_empty() && empty.is_empty());
        let point = TriangleBvh::build(&[DVec3::ONE], &[[0, 0, 0]], &exec).unwrap();
        assert!(point.first_hit(&ray).is_none());
        assert_eq!(point.closest(DVec3::ZERO).unwrap().distance_squared, 3.0);
        let mut draws = Draws::new(5);
        let (flat, triangles) = draws.soup(500, |draws, _| draws.point() * DVec3::new(1.0, 1.0, 0.0));
        let flat = TriangleBvh::build(&flat, &triangles, &exec).unwrap();
        assert!((flat.first_hit(&ray).unwrap().distance - 1.0).abs() < 1e-15);
    }

    #[test]
    fn the_unit_of_length_changes_nothing() {
        let mut draws = Draws::new(8);
        let (positions, triangles) = draws.soup(200, |draws, _| draws.point());
        let exec = Exec::default();
        let plain = TriangleBvh::build(&positions, &triangles, &exec).unwrap();
        for exponent in [-700, -30, 30, 700] {
            let scale = 2f64.powi(exponent);
            let scaled: Vec<DVec3> = positions.iter().map(|&p| p * scale).collect();
            let scaled = TriangleBvh::build(&scaled, &triangles, &exec).unwrap();
            for _ in 0..50 {
                let (origin, direction) = (draws.point() * 2.0, draws.point());
                let wanted = plain.first_hit(&Ray::new(origin, direction).unwrap());
                let found = scaled.first_hit(&Ray::new(origin * scale, direction).unwrap());
                assert_eq!(found.map(|hit| hit.distance), wanted.map(|hit| hit.distance * scale));
                let point = scaled.closest(origin * scale).unwrap();
                assert_eq!(point.point, plain.closest(origin).unwrap().point * scale);
            }
        }
    }
}
