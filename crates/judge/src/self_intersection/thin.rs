//! Triangles without area: the segments or points that they cover.

use std::cmp::Ordering::{Equal, Greater, Less};

use super::PairKind;
use super::flat::{Common, common};
use super::triangle::{Axis, Points, Triangle};

/// The corners that span a triangle, each once: three, or the ends of a segment, or a point.
#[derive(Clone, Copy)]
struct Hull {
    corners: [u32; 3],
    len: usize,
}

impl Hull {
    fn of(points: Points, triangle: &Triangle) -> Self {
        if triangle.seen_along.is_some() {
            return Self { corners: triangle.corners, len: 3 };
        }
        let mut corners = triangle.corners;
        corners.sort_by(|&a, &b| points.along(a, b));
        let [low, _, high] = corners;
        Self { corners: [low, high, high], len: if low == high { 1 } else { 2 } }
    }

    fn corners(&self) -> &[u32] {
        &self.corners[..self.len]
    }
}

/// How two triangles meet of which at least one has no area.
pub(super) fn meeting(points: Points, first: &Triangle, second: &Triangle) -> Option<PairKind> {
    let has = |triangle: &Triangle, corner: u32| triangle.corners.contains(&corner);
    let mut shared: Vec<u32> = first.corners.into_iter().filter(|&corner| has(second, corner)).collect();
    shared.sort_unstable();
    shared.dedup();
    let within = |triangle: &Triangle| triangle.corners.iter().all(|corner| shared.contains(corner));
    if within(first) && within(second) {
        return Some(PairKind::Duplicate);
    }
    let hulls = [first, second].map(|triangle| Hull::of(points, triangle));
    let (common, through) = match hulls.map(|hull| hull.len) {
        [3, _] => with_area(points, first, hulls[1]),
        [_, 3] => with_area(points, second, hulls[0]),
        _ => (both_thin(points, hulls), false),
    };
    let point = if shared.is_empty() { Some(PairKind::TouchAtPoint) } else { None };
    match common {
        Common::Nothing => None,
        Common::Along(a, b) if a == b => point,
        Common::Along(a, b) => {
            let side = shared.len() == 2 && shared.contains(&a) && shared.contains(&b);
            (!side).then_some(PairKind::TouchAlongSegment)
        }
        Common::Inside if through => point.map(|_| PairKind::Crossing),
        Common::Inside if hulls[0].len + hulls[1].len == 5 => Some(PairKind::TouchAlongSegment),
        Common::Inside => point,
    }
}

/// What a triangle with area and a segment or point have in common, and whether that is a point in which the segment
/// passes through the inside.
fn with_area(points: Points, triangle: &Triangle, hull: Hull) -> (Common, bool) {
    let axis = triangle.seen_along.unwrap_or(Axis::Z);
    let in_plane = |corners: &[u32]| match (common(points, axis, &triangle.corners, corners), corners) {
        // An end of a segment that leaves the plane.
        (Common::Inside, &[corner]) => (Common::Along(corner, corner), false),
        (common, _) => (common, false),
    };
    let side = |corner: u32| points.side_of(triangle, corner);
    match *hull.corners() {
        [only] if side(only) == Equal => in_plane(&[only]),
        [low, high] => match (side(low), side(high)) {
            (Equal, Equal) => in_plane(&[low, high]),
            (Equal, _) => in_plane(&[low]),
            (_, Equal) => in_plane(&[high]),
            (one, other) if one == other => (Common::Nothing, false),
            _ => {
                let [a, b, c] = triangle.corners;
                let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| points.side([low, high, from], to));
                match (turns.contains(&Less) && turns.contains(&Greater), turns.contains(&Equal)) {
                    (true, _) => (Common::Nothing, false),
                    // The point has no number; any stands for it.
                    (false, true) => (Common::Along(low, low), false),
                    (false, false) => (Common::Inside, true),
                }
            }
        },
        _ => (Common::Nothing, false),
    }
}

fn both_thin(points: Points, hulls: [Hull; 2]) -> Common {
    let [[a, b, _], [c, d, _]] = hulls.map(|hull| hull.corners);
    if points.side([a, b, c], d) != Equal {
        return Common::Nothing;
    }
    let triples = [[a, b, c], [a, b, d], [c, d, a], [c, d, b]];
    let keeps_area = |&axis: &Axis| triples.iter().any(|&[i, j, k]| points.turn(axis, i, j, k) != Equal);
    let axis = Axis::ALL.into_iter().find(keeps_area).unwrap_or(Axis::Z);
    common(points, axis, hulls[0].corners(), hulls[1].corners())
}
