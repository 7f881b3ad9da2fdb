//! Nodes of eight boxes, and a ray against them.

use glam::DVec3;
use shapeloom_core::Ray;

use crate::scaled_input::Units;

/// Children of a node: as many as AVX2 has lanes of `f32`.
pub(crate) const WIDTH: usize = 8;

/// Eight numbers side by side, so that the compiler works on all at once.
pub(crate) type Lanes = [f32; WIDTH];

/// Eight boxes with what they hold. Unused places have a box that nothing meets.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// `sides[0]` are the smaller and `sides[1]` the larger coordinates, by axis, then by child.
    pub sides: [[Lanes; 3]; 2],
    /// The index of a node, or of a block of triangles.
    pub first: [u32; WIDTH],
    /// The place of a block's first triangle; [`Node::INNER`] for a node.
    pub place: [u32; WIDTH],
}

impl Node {
    /// What stands for the place of a child that is a node.
    pub const INNER: u32 = u32::MAX;

    /// No children. The numbers are finite, so that differences with finite numbers are never NaN.
    pub const UNUSED: Self = Self {
        sides: [[[f32::MAX; WIDTH]; 3], [[f32::MIN; WIDTH]; 3]],
        first: [0; WIDTH],
        place: [Self::INNER; WIDTH],
    };

    /// Whether a child is there.
    pub fn is_used(&self, lane: usize) -> bool {
        self.sides[0][0][lane] <= self.sides[1][0][lane]
    }
}

/// A bit for each lane, the first lane's the lowest.
pub(crate) type Mask = u32;

/// Which numbers have a minus sign. Processors do this in one step, which the compiler does not find by itself: the
/// versions of a function for them hand it down to the loops.
pub(crate) trait Signs: Fn(&Lanes) -> Mask + Copy {}

impl<F: Fn(&Lanes) -> Mask + Copy> Signs for F {}

/// Which numbers have a minus sign, anywhere.
#[inline(always)]
pub(crate) fn signs(lanes: &Lanes) -> Mask {
    lanes.iter().enumerate().fold(0, |signs, (lane, number)| signs | (number.to_bits() >> 31) << lane)
}

/// Which numbers have no minus sign. Zero without it counts; no number may be NaN, whose sign says nothing.
#[inline(always)]
pub(crate) fn not_negative(lanes: &Lanes, signs: impl Signs) -> Mask {
    !signs(lanes) & 0xff
}

/// The lanes of a mask, rising.
#[inline(always)]
pub(crate) fn lanes_of(mut mask: Mask) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if mask == 0 {
            return None;
        }
        let lane = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        Some(lane % WIDTH)
    })
}

#[inline(always)]
pub(crate) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(crate) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// A ray against boxes: in local units, from a start close to the shape, in `f32` with room for every rounding.
#[derive(Debug)]
pub(crate) struct Slabs {
    /// The start moved against and along the direction, by axis: the first makes boxes begin too early, the second end
    /// too late, by more than the start's and the boxes' coordinates can be off.
    early: [f32; 3],
    late: [f32; 3],
    inverse: [f32; 3],
    /// A little larger, so that rounding makes no box end before it begins: four roundings on either side (Ize: Robust
    /// BVH Ray Traversal, JCGT 2013), and one of this; 2^-24 each.
    inverse_late: [f32; 3],
    /// Which side of a box is met first, by axis.
    near: [usize; 3],
    /// How far coordinates along the ray can be off.
    pub slack: f64,
    /// The distance of the start along the ray, in scaled units.
    start: f64,
    /// The start, in local units.
    pub from: [f64; 3],
}

impl Slabs {
    #[inline(always)]
    pub fn new(ray: &Ray, units: &Units) -> Self {
        let direction = ray.direction();
        let origin = ray.origin() * units.per_unit - units.center;
        // The shape lies within the ball of radius 4 about the local origin.
        let start = (-origin.dot(direction) - 4.0).max(ray.reach.lo * units.per_unit);
        let from = origin + direction * start;
        let size = origin.abs().max_element() + units.center.abs().max_element() + start.abs();
        // 2^-21 covers f32 at magnitudes up to 4, 2^-46 the f64 arithmetic before, with a factor of 8 each.
        let slack = 2f64.powi(-21) + size * 2f64.powi(-46);
        // From where the shape is lost in rounding, every box may be met: a slack beside which they are nothing. Sizes
        // are such that no box that is there gives an infinity or NaN.
        let lost = !slack.is_finite() || slack > 1e6;
        let (from, slack) = if lost { (DVec3::ZERO, 1e18) } else { (from, slack) };
        let mut slabs = Self {
            early: [0.0; 3],
            late: [0.0; 3],
            inverse: [0.0; 3],
            inverse_late: [0.0; 3],
            near: [0; 3],
            slack,
            start,
            from: from.to_array(),
        };
        for axis in 0..3 {
            let backward = direction[axis] < 0.0 && !lost;
            let sign = if backward { -1.0f32 } else { 1.0 };
            // A direction of less than 1e-18 moves nothing within the shape; a finite inverse keeps NaN away.
            slabs.inverse[axis] = if lost { 1e-30 } else { sign / larger(direction[axis].abs() as f32, 1e-18) };
            slabs.inverse_late[axis] = slabs.inverse[axis] * (1.0 + 1.5e-6);
            slabs.near[axis] = usize::from(backward);
            slabs.early[axis] = (from[axis] + f64::from(sign) * slack).clamp(-2e18, 2e18) as f32;
            slabs.late[axis] = (from[axis] - f64::from(sign) * slack).clamp(-2e18, 2e18) as f32;
        }
        slabs
    }

    /// A distance along the ray, in scaled units, as one from the start, no less.
    #[inline(always)]
    pub fn limit(&self, distance: f64) -> f32 {
        let limit = (distance - self.start) * (1.0 + 1e-6) + 2.0 * self.slack;
        // Also where NaN comes of infinite numbers.
        if limit < 1e37 { limit as f32 } else { 1e37 }
    }

    /// The child whose box the ray enters first; none where it meets none.
    #[inline(always)]
    pub fn nearest(&self, node: &Node, limit: f32) -> Option<usize> {
        let (entry, room) = self.stretch(node, limit);
        let mut keys = [u32::MAX; WIDTH];
        for lane in 0..WIDTH {
            // Entries are not negative, so that their bits rise with them.
            let key = entry[lane].to_bits() & !7 | lane as u32;
            keys[lane] = if room[lane] < 0.0 { u32::MAX } else { key };
        }
        let nearest = keys.into_iter().fold(u32::MAX, u32::min);
        (nearest != u32::MAX).then_some(nearest as usize % WIDTH)
    }

    /// Where the ray enters each box of a node, and which boxes it may meet before `limit`.
    #[inline(always)]
    pub fn enter(&self, node: &Node, limit: f32, signs: impl Signs) -> (Lanes, Mask) {
        let (entry, room) = self.stretch(node, limit);
        (entry, not_negative(&room, signs))
    }

    /// Where the ray enters each box of a node, and how long it may stay there, negative where it does not meet it.
    #[inline(always)]
    fn stretch(&self, node: &Node, limit: f32) -> (Lanes, Lanes) {
        let (mut begin, mut end) = ([[0f32; WIDTH]; 3], [[0f32; WIDTH]; 3]);
        for axis in 0..3 {
            let near = self.near[axis] & 1;
            let first = &node.sides[near][axis];
            let last = &node.sides[1 - near][axis];
            for lane in 0..WIDTH {
                begin[axis][lane] = (first[lane] - self.early[axis]) * self.inverse[axis];
                end[axis][lane] = (last[lane] - self.late[axis]) * self.inverse_late[axis];
            }
        }
        let (mut entry, mut room) = ([0f32; WIDTH], [0f32; WIDTH]);
        for lane in 0..WIDTH {
            // In pairs, so that no step waits for more than one before.
            entry[lane] = larger(larger(begin[0][lane], begin[1][lane]), larger(begin[2][lane], 0.0));
            let exit = smaller(smaller(end[0][lane], end[1][lane]), smaller(end[2][lane], limit));
            room[lane] = exit - entry[lane];
        }
        (entry, room)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_those_of_the_numbers_and_lanes_those_of_the_bits() {
        let lanes = [1.0, -1.0, 0.0, -0.0, f32::MIN, f32::MAX, f32::INFINITY, f32::NEG_INFINITY];
        assert_eq!(signs(&lanes), 0b1001_1010);
        assert!(lanes_of(not_negative(&lanes, signs)).eq([0, 2, 5, 6]));
        assert_eq!(lanes_of(0).count(), 0);
    }

    /// A node of no children is met by nothing, also by a ray from so far that it may meet everything else.
    #[test]
    fn unused_places_are_never_met() {
        let units = Units { unit: 1.0, per_unit: 1.0, center: DVec3::ZERO };
        for origin in [DVec3::ZERO, DVec3::splat(1e3), DVec3::splat(-1e300), DVec3::X * 1e25] {
            for direction in [DVec3::X, DVec3::NEG_X, DVec3::ONE, DVec3::new(1e-30, -1.0, 1e-8)] {
                let slabs = Slabs::new(&Ray::new(origin, direction).unwrap(), &units);
                assert_eq!(slabs.enter(&Node::UNUSED, 1e37, signs).1, 0);
                let mut one = Node::UNUSED;
                one.sides.iter_mut().flatten().for_each(|lanes| lanes[5] = 0.0);
                let met = slabs.enter(&one, 1e37, signs).1;
                assert!(met == 0 || met == 1 << 5);
                assert!(origin != DVec3::splat(-1e300) || met == 1 << 5);
                assert_eq!(slabs.nearest(&one, 1e37), (met != 0).then_some(5));
            }
        }
    }
}
