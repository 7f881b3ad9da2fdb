//! Where rows of samples cross a triangle, exactly.

use std::cmp::Ordering;
use std::ops::Range;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};

/// Rows of samples parallel to an axis: at whole numbers across, and at whole numbers plus `offset` along.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    /// The direction of the rows: 0, 1, 2.
    pub axis: usize,
    /// Of samples along a row: 0 for samples, -1/2 for the faces between cells around them.
    pub offset: f64,
    /// How many samples are in a row.
    pub count: u32,
    /// Which rows, across in the directions that follow `axis` cyclically.
    pub across: [Range<u32>; 2],
}

/// A crossing of a row with a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crossing {
    /// Which row.
    pub row: [u32; 2],
    /// The first sample beyond the triangle; as many as there are if all lie before it.
    pub first_beyond: u32,
    /// How the winding number changes there: -1 out of the front of the triangle, 1 into it.
    pub change: i32,
}

impl Rows {
    /// Tells `visit` each crossing with a triangle. For rows through edges and corners, of all triangles there together those
    /// cross that a row moved by something infinitely small would cross, so that closed surfaces are never left open. A sample in
    /// a triangle itself counts as before it.
    pub fn cross(&self, corners: &[DVec3; 3], mut visit: impl FnMut(Crossing)) {
        let [x, y, z] = [self.axis, (self.axis + 1) % 3, (self.axis + 2) % 3];
        let flat = corners.map(|p| DVec2::new(p[y], p[z]));
        let solid = corners.map(|p| DVec3::new(p[x], p[y], p[z]));
        let between = |axis: usize, range: &Range<u32>| {
            let [a, b, c] = solid.map(|p| p[axis]);
            whole_numbers(a.min(b).min(c), a.max(b).max(c), range)
        };
        for k in between(2, &self.across[1]) {
            for j in between(1, &self.across[0]) {
                let turns = turns(&flat, DVec2::new(f64::from(j), f64::from(k)));
                if turns != 0 {
                    let first_beyond = self.first_beyond(&solid, [j, k], turns);
                    visit(Crossing { row: [j, k], first_beyond, change: -turns });
                }
            }
        }
    }

    /// The first sample of a row beyond a triangle that it crosses.
    fn first_beyond(&self, corners: &[DVec3; 3], [j, k]: [u32; 2], turns: i32) -> u32 {
        let [a, b, c] = corners.map(|p| p.x - self.offset);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // All samples before `start` are before the triangle, all from `end` on are beyond.
        let at = |x: f64| x.clamp(0.0, f64::from(self.count)) as u32;
        let (mut start, mut end) = (at(low.ceil()), at(high.floor() + 1.0));
        let beyond = if turns > 0 { Ordering::Greater } else { Ordering::Less };
        while start < end {
            let middle = start + (end - start) / 2;
            let sample = DVec3::new(f64::from(middle) + self.offset, f64::from(j), f64::from(k));
            if orient3d(corners[0], corners[1], corners[2], sample) == beyond {
                end = middle;
            } else {
                start = middle + 1;
            }
        }
        start
    }
}

/// The whole numbers from `low` to `high` that are in a range.
pub(crate) fn whole_numbers(low: f64, high: f64, range: &Range<u32>) -> Range<u32> {
    let (start, end) = (f64::from(range.start), f64::from(range.end));
    let (low, high) = (low.ceil().clamp(start, end), (high.floor() + 1.0).clamp(start, end));
    low as u32..high as u32
}

/// How often a triangle in the plane winds around a point: 1, -1 or 0. A point on a side counts as a little above it and on the
/// side's left where that rises, whichever way it is passed: so for two triangles that share a side just one of them has it.
fn turns(triangle: &[DVec2; 3], point: DVec2) -> i32 {
    let mut turns = 0;
    for i in 0..3 {
        let (from, to) = (triangle[i], triangle[(i + 1) % 3]);
        let (below, ends_below) = (from.y <= point.y, to.y <= point.y);
        if below && !ends_below && orient2d(from, to, point) == Ordering::Greater {
            turns += 1;
        } else if !below && ends_below && orient2d(from, to, point) == Ordering::Less {
            turns -= 1;
        }
    }
    turns
}
