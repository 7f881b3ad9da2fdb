//! All pairs of boxes that meet.

use glam::DVec3;
use shapeloom_core::parallel::{CHUNK, fill_chunks, map_chunks};
use shapeloom_core::{Aabb, Exec, Reservation, Stop};

use crate::BvhError;
use crate::space_order::space_order;

/// Boxes in a block, the leaves of the tree. With 4 the walks from the root cost more than they save, with 16 the tests
/// between blocks do.
const BLOCK: usize = 8;
/// Children of a node.
const FAN: usize = 4;
/// Blocks whose pairs one thread finds at a time.
const BLOCKS: usize = 64;
/// Pairs, or nodes, between two polls: a caller's test of a pair takes microseconds at worst.
const POLL: u32 = 512;

/// Boxes, ready to name every two that meet.
///
/// The boxes are sorted along a space-filling curve (Morton 1966) and a tree of boxes is laid over the sorted row; each
/// block of eight walks it for the blocks after it. Boxes keep their double precision, so none meet by rounding, and
/// where many fall into one cell of the curve that cell is sorted again on its own scale: one far box spoils nothing.
///
/// Cost: O(n log n) to build, and about O(n + pairs) to visit; where all boxes overlap, n²/2. Memory: 56 bytes a box,
/// 170 while it is built; visiting needs none.
#[derive(Debug)]
pub struct BoxPairs {
    /// The box's number at each place.
    items: Vec<u32>,
    /// The boxes at the places, then the boxes of the blocks, then of [`FAN`] of those and so on up to one.
    levels: Vec<Vec<Sides>>,
    _memory: Reservation,
}

#[derive(Clone, Copy, Debug)]
struct Sides {
    min: [f64; 3],
    max: [f64; 3],
}

impl Sides {
    const NONE: Self = Self { min: [f64::INFINITY; 3], max: [f64::NEG_INFINITY; 3] };

    #[inline(always)]
    fn meets(&self, other: &Self) -> bool {
        // Without branches: which side parts two boxes is anyone's guess.
        (0..3).fold(true, |all, axis| all & (self.min[axis] <= other.max[axis]) & (other.min[axis] <= self.max[axis]))
    }

    fn union(parts: &[Self]) -> Self {
        parts.iter().fold(Self::NONE, |mut all, part| {
            for axis in 0..3 {
                all.min[axis] = all.min[axis].min(part.min[axis]);
                all.max[axis] = all.max[axis].max(part.max[axis]);
            }
            all
        })
    }
}

impl BoxPairs {
    const BYTES: usize = 56;
    const BUILD_BYTES: usize = 170;

    /// Sorts `count` boxes and builds the tree. Boxes that are empty or have a NaN meet nothing.
    ///
    /// # Errors
    /// Too little memory, or the reason to stop.
    pub fn build(count: u32, bounds: impl Fn(u32) -> Aabb + Sync, exec: &Exec) -> Result<Self, BvhError> {
        let building = exec.reserve_elements(u64::from(count), Self::BUILD_BYTES)?;
        let mut given = vec![Sides::NONE; count as usize];
        fill_chunks(exec, &mut given, CHUNK, |first, part| {
            for (i, sides) in part.iter_mut().enumerate() {
                let Aabb { min, max } = bounds((first + i) as u32);
                *sides = Sides { min: min.to_array(), max: max.to_array() };
            }
            Ok::<_, Stop>(())
        })?;
        let center = |item: u32| {
            let Sides { min, max } = given[item as usize];
            DVec3::from_array(min) * 0.5 + DVec3::from_array(max) * 0.5
        };
        let items = space_order(count, BLOCK, center, exec)?;
        let mut levels = vec![vec![Sides::NONE; count as usize]];
        fill_chunks(exec, &mut levels[0], CHUNK, |first, part| {
            let places = items[first..].iter();
            part.iter_mut().zip(places).for_each(|(sides, &item)| *sides = given[item as usize]);
            Ok::<_, Stop>(())
        })?;
        let mut width = BLOCK;
        while levels[levels.len() - 1].len() > 1 || levels.len() == 1 {
            exec.check()?;
            let above: Vec<Sides> = levels[levels.len() - 1].chunks(width).map(Sides::union).collect();
            if above.is_empty() {
                break;
            }
            levels.push(above);
            width = FAN;
        }
        drop((building, given));
        let _memory = exec.reserve_elements(u64::from(count), Self::BYTES)?;
        Ok(Self { items, levels, _memory })
    }

    /// Calls `visit` once for every two boxes that meet, with a state that `start` makes for each part of the work and
    /// `merge` gets back in a fixed order. Boxes that only touch do meet. Which of the two comes first, and the order
    /// of the pairs, depend on the boxes alone, never on the number of threads.
    ///
    /// At most `parts` states exist at a time; that bounds their memory, and at least as many as threads keep them busy.
    ///
    /// # Errors
    /// The first that `visit` or `merge` gives, or the reason to stop.
    pub fn visit<T, E>(
        &self,
        exec: &Exec,
        parts: usize,
        start: impl Fn() -> T + Sync,
        visit: impl Fn(&mut T, u32, u32) -> Result<(), E> + Sync,
        mut merge: impl FnMut(T) -> Result<(), E>,
    ) -> Result<(), E>
    where
        T: Send,
        E: Send + From<Stop>,
    {
        let blocks = self.levels.get(1).map_or(0, Vec::len);
        let wave = BLOCKS * parts.max(1);
        for first in (0..blocks).step_by(wave) {
            let states = map_chunks(exec, wave.min(blocks - first), BLOCKS, |range| {
                let mut state = start();
                let mut polled = 0;
                for block in range {
                    self.visit_block(first + block, exec, &mut |a, b| {
                        polled += 1;
                        if polled % POLL == 0 {
                            exec.check()?;
                        }
                        visit(&mut state, a, b)
                    })?;
                }
                Ok::<T, E>(state)
            })?;
            states.into_iter().try_for_each(&mut merge)?;
            exec.progress((first + wave).min(blocks) as f64 / blocks as f64);
        }
        Ok(())
    }

    /// The pairs inside a block, and of it with later ones.
    fn visit_block<E: From<Stop>>(
        &self,
        block: usize,
        exec: &Exec,
        visit: &mut impl FnMut(u32, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        let (places, blocks) = (&self.levels[0], &self.levels[1]);
        let part = |block: usize| block * BLOCK..((block + 1) * BLOCK).min(places.len());
        let mine = part(block);
        for i in mine.clone() {
            for j in i + 1..mine.end {
                if places[i].meets(&places[j]) {
                    visit(self.items[i], self.items[j])?;
                }
            }
        }
        let bounds = blocks[block];
        // Nodes still to be opened: three siblings a level at most stay behind.
        let mut open = [(0u8, 0u32); OPEN];
        open[0] = (self.levels.len() as u8 - 1, 0);
        let (mut left, mut opened) = (1, 0u32);
        while left > 0 {
            left -= 1;
            opened = opened.wrapping_add(1);
            if opened % POLL == 0 {
                exec.check()?;
            }
            let (level, node) = (open[left].0 as usize, open[left].1 as usize);
            if level == 1 {
                if node > block {
                    self.visit_blocks(mine.clone(), part(node), [bounds, blocks[node]], visit)?;
                }
                continue;
            }
            let below = &self.levels[level - 1];
            // How many blocks a child holds: those before this one were its own business.
            let shift = 2 * (level as u32 - 2);
            let from = (node * FAN).max(block >> shift);
            for child in (from..((node + 1) * FAN).min(below.len())).rev() {
                if below[child].meets(&bounds) {
                    open[left] = (level as u8 - 1, child as u32);
                    left += 1;
                }
            }
        }
        Ok(())
    }

    /// The pairs between two blocks: first which boxes of each meet the other block at all.
    fn visit_blocks<E>(
        &self,
        mine: std::ops::Range<usize>,
        theirs: std::ops::Range<usize>,
        bounds: [Sides; 2],
        visit: &mut impl FnMut(u32, u32) -> Result<(), E>,
    ) -> Result<(), E> {
        let places = &self.levels[0];
        let (mut near, mut count) = ([0; BLOCK], 0);
        for j in theirs {
            near[count] = j;
            count += usize::from(places[j].meets(&bounds[0]));
        }
        for i in mine.filter(|&i| places[i].meets(&bounds[1])) {
            for &j in &near[..count] {
                if places[i].meets(&places[j]) {
                    visit(self.items[i], self.items[j])?;
                }
            }
        }
        Ok(())
    }
}

/// Room for 2^32 boxes: 16 levels of four, three siblings left behind at each, and the last four.
const OPEN: usize = 64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Draws;

    fn pairs(boxes: &[Aabb], exec: &Exec) -> Vec<[u32; 2]> {
        let tree = BoxPairs::build(boxes.len() as u32, |i| boxes[i as usize], exec).unwrap();
        let mut found = Vec::new();
        let visit = |list: &mut Vec<[u32; 2]>, a, b| {
            list.push([a, b]);
            Ok::<_, Stop>(())
        };
        let merge = |list: Vec<[u32; 2]>| {
            found.extend(list);
            Ok(())
        };
        tree.visit(exec, 2, Vec::new, visit, merge).unwrap();
        found
    }

    fn assert_all_pairs(boxes: &[Aabb]) {
        let meets = |a: &Aabb, b: &Aabb| a.min.cmple(b.max).all() && b.min.cmple(a.max).all();
        let all = (0..boxes.len()).flat_map(|i| (i + 1..boxes.len()).map(move |j| [i, j]));
        let wanted: Vec<[u32; 2]> =
            all.filter(|&[i, j]| meets(&boxes[i], &boxes[j])).map(|pair| pair.map(|i| i as u32)).collect();
        let found = pairs(boxes, &Exec::default());
        let alone = pairs(boxes, &Exec::default().with_threads(shapeloom_core::Threads::Sequential));
        assert_eq!(found, alone);
        let mut sorted: Vec<[u32; 2]> = found.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
        sorted.sort_unstable();
        assert_eq!(sorted, wanted);
    }

    #[test]
    fn every_pair_is_named_once() {
        let mut draws = Draws::new(5);
        for (count, size) in
            [(0, 0.1), (1, 0.1), (7, 0.5), (9, 0.5), (100, 0.3), (1500, 0.05), (400, 2.0), (2100, 0.01)]
        {
            let boxes: Vec<Aabb> = (0..count)
                .map(|_| {
                    let corner = draws.point();
                    Aabb::from_corners(corner, corner + draws.point() * size)
                })
                .collect();
            assert_all_pairs(&boxes);
        }
    }

    #[test]
    fn boxes_that_touch_meet_and_far_ones_spoil_nothing() {
        let mut draws = Draws::new(6);
        let mut boxes: Vec<Aabb> = (0..900)
            .map(|_| {
                let corner = draws.lattice(9);
                Aabb::from_corners(corner, corner + draws.lattice(1))
            })
            .collect();
        assert_all_pairs(&boxes);
        for far in [1e9, 1e300, f64::MAX] {
            boxes.push(Aabb::from_corners(DVec3::splat(far), DVec3::splat(far)));
            boxes.push(Aabb::from_corners(DVec3::splat(-far), DVec3::splat(-far)));
        }
        assert_all_pairs(&boxes);
        assert_all_pairs(&vec![boxes[0]; 100]);
    }

    #[test]
    fn boxes_that_are_none_meet_nothing() {
        let nan = Aabb { min: DVec3::NAN, max: DVec3::NAN };
        let all = Aabb { min: DVec3::NEG_INFINITY, max: DVec3::INFINITY };
        let one = Aabb::from_corners(DVec3::ZERO, DVec3::ONE);
        assert_all_pairs(&[nan, one, Aabb::EMPTY, one, nan, all, Aabb::EMPTY]);
    }

    #[test]
    fn a_far_box_does_not_make_all_others_neighbours_in_the_row() {
        let mut draws = Draws::new(7);
        let mut boxes: Vec<Aabb> = (0..4000).map(|_| draws.point()).map(|p| Aabb::from_corners(p, p)).collect();
        boxes.push(Aabb::from_corners(DVec3::splat(1e12), DVec3::splat(1e12)));
        let tree = BoxPairs::build(4001, |i| boxes[i as usize], &Exec::default()).unwrap();
        let size = |sides: &Sides| (0..3).map(|axis| sides.max[axis] - sides.min[axis]).fold(0.0, f64::max);
        let small = tree.levels[1].iter().filter(|sides| size(sides) < 0.7).count();
        assert!(small > 450, "{small} of {} blocks are small", tree.levels[1].len());
    }

    #[test]
    fn visits_stop_and_builds_keep_to_their_memory() {
        let one = Aabb::from_corners(DVec3::ZERO, DVec3::ONE);
        assert!(matches!(
            BoxPairs::build(1000, |_| one, &Exec::default().with_memory(10_000)),
            Err(BvhError::OverBudget(_))
        ));
        let exec = Exec::default();
        let tree = BoxPairs::build(3000, |_| one, &exec).unwrap();
        assert_eq!(exec.memory_taken(), 3000 * BoxPairs::BYTES as u64);
        let flag = shapeloom_core::CancelFlag::default();
        let exec = exec.with_cancel(&flag);
        let seen = std::sync::atomic::AtomicU32::new(0);
        let visit = |_: &mut (), _, _| {
            seen.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            flag.cancel();
            Ok(())
        };
        assert_eq!(tree.visit(&exec, 64, || (), visit, |()| Ok(())), Err(Stop::Cancelled));
        // Each thread notices at its next poll.
        assert!(seen.into_inner() < 100_000);
    }
}
