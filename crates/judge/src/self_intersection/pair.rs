//! How two triangles meet.

use std::cmp::Ordering::{self, Equal};

use super::PairKind;
use super::flat::{Common, common};
use super::triangle::{Axis, Points, Triangle};
use super::{section, thin};

/// How two triangles meet beyond the corners and the side that they share; none if they do not.
///
/// Neighbours are most of the pairs, so what they share is found first: a common side takes one determinant, a common
/// corner two to four, no common corner at most eight.
pub(super) fn meeting(points: Points, first: &Triangle, second: &Triangle) -> Option<PairKind> {
    let (Some(axis), Some(_)) = (first.seen_along, second.seen_along) else {
        return thin::meeting(points, first, second);
    };
    let (a, b) = (first.corners, second.corners);
    let (mut count, mut place, mut places) = (0, [0; 2], [0; 2]);
    for (i, mine) in a.iter().enumerate() {
        for (j, theirs) in b.iter().enumerate() {
            if mine == theirs {
                count += 1;
                place = [i, j];
                places = [places[0] + i, places[1] + j];
            }
        }
    }
    match count {
        0 => without_corner(points, axis, first, second),
        1 => {
            let [a, b] = [(a, place[0]), (b, place[1])].map(|(t, i)| [t[i], t[(i + 1) % 3], t[(i + 2) % 3]]);
            with_corner(points, axis, [first, second], a, b)
        }
        // The places of all three corners sum to 3, so the one left over is known.
        2 => with_side(points, axis, [first, second], [3 - places[0], 3 - places[1]]),
        // Equal triangles are grouped before; these are said to be what they are all the same.
        _ => Some(if turned_over(a, b) { PairKind::Coincident } else { PairKind::Duplicate }),
    }
}

/// Whether two triangles with the same corners look opposite ways.
pub(super) fn turned_over(a: [u32; 3], b: [u32; 3]) -> bool {
    let shift = b.iter().position(|&corner| corner == a[0]).unwrap_or(0);
    b[(shift + 1) % 3] != a[1]
}

fn without_corner(points: Points, axis: Axis, first: &Triangle, second: &Triangle) -> Option<PairKind> {
    let (a, b) = (first.corners, second.corners);
    let b_sides = b.map(|corner| points.side_of(first, corner));
    if strictly_one(&b_sides) {
        return None;
    }
    if b_sides == [Equal; 3] {
        return in_one_plane(points, axis, a, b, false);
    }
    let a_sides = a.map(|corner| points.side_of(second, corner));
    if strictly_one(&a_sides) {
        return None;
    }
    section::apart_or_meeting(points, [a, b], [a_sides, b_sides])
}

/// The corners of both, turned so that the common one is the first.
fn with_corner(
    points: Points,
    axis: Axis,
    [first, second]: [&Triangle; 2],
    a: [u32; 3],
    b: [u32; 3],
) -> Option<PairKind> {
    let b_sides = [b[1], b[2]].map(|corner| points.side_of(first, corner));
    if strictly_one(&b_sides) {
        return None;
    }
    if b_sides == [Equal; 2] {
        return in_one_plane(points, axis, a, b, true);
    }
    let a_sides = [a[1], a[2]].map(|corner| points.side_of(second, corner));
    if strictly_one(&a_sides) {
        return None;
    }
    section::beyond_corner([a_sides, b_sides])
}

/// Triangles with a common side, and where their other corners are: in different planes they share nothing more.
fn with_side(points: Points, axis: Axis, [first, second]: [&Triangle; 2], others: [usize; 2]) -> Option<PairKind> {
    let (a, b) = (first.corners, second.corners);
    let (other, opposite) = (a[others[0]], b[others[1]]);
    let (from, to) = (a[(others[0] + 1) % 3], a[(others[0] + 2) % 3]);
    if points.side_of(first, opposite) != Equal {
        return None;
    }
    let turns = [other, opposite].map(|corner| points.turn(axis, from, to, corner));
    (turns[0] == turns[1]).then_some(PairKind::Folded)
}

fn in_one_plane(points: Points, axis: Axis, a: [u32; 3], b: [u32; 3], corner_shared: bool) -> Option<PairKind> {
    match common(points, axis, &a, &b) {
        Common::Nothing => None,
        Common::Inside => {
            let [one, other] = [a, b].map(|[p, q, r]| points.turn(axis, p, q, r));
            Some(if one == other { PairKind::Overlap } else { PairKind::Contact })
        }
        Common::Along(from, to) if from != to => Some(PairKind::TouchAlongSegment),
        Common::Along(..) => (!corner_shared).then_some(PairKind::TouchAtPoint),
    }
}

/// Whether all lie on the same side of a plane and none in it.
fn strictly_one(sides: &[Ordering]) -> bool {
    sides[0] != Equal && sides.iter().all(|&side| side == sides[0])
}
