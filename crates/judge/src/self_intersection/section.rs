//! Two triangles in different planes: where their sections with the line common to the planes lie.
//!
//! Both sections are intervals of one line. Their ends lie on sides of the triangles, and two ends are compared by one
//! sign of a determinant of four corners, without ever computing a point (the idea of Guigue and Devillers 2003, here
//! with ends at corners too).

use std::cmp::Ordering::{self, Equal, Greater, Less};

use super::PairKind;
use super::triangle::Points;

/// An end of a section: the point where the segment from a corner `low` to a corner `high` meets the other triangle's
/// plane, `low` on a smaller side of it than `high`. One of the two may lie in the plane.
#[derive(Clone, Copy, Debug)]
struct End {
    low: u32,
    high: u32,
}

/// The ends of the section of a triangle with a plane, in the direction of `own normal × normal of the plane`. At least
/// one side is not `Equal`, and not all are the same.
fn section(corners: [u32; 3], sides: [Ordering; 3]) -> [End; 2] {
    // Walking around the triangle counter-clockwise, the section starts where the walk comes to the upper side and ends
    // where it leaves it; without an upper side, where it leaves and comes to the lower one.
    let upper = sides.contains(&Greater);
    let inside = |side: Ordering| if upper { side == Greater } else { side != Less };
    let (mut start, mut end) = (End { low: 0, high: 0 }, End { low: 0, high: 0 });
    for i in 0..3 {
        let j = (i + 1) % 3;
        match (inside(sides[i]), inside(sides[j])) {
            (false, true) => start = End { low: corners[i], high: corners[j] },
            (true, false) => end = End { low: corners[j], high: corners[i] },
            _ => {}
        }
    }
    [start, end]
}

/// Where the end of the second triangle's section lies against the first one's: `Greater` if it comes after it in the
/// direction of `first normal × second normal`.
///
/// With `p` and `p + λd` the ends, `e` from low to high of the first and `f` of the second, the determinant is
/// `λ det(e, d, f)` times two positive lengths, and `det(e, d, f) = (n₁·f)(n₂·e) > 0`.
fn follows(points: Points, first: End, second: End) -> Ordering {
    points.side([first.low, first.high, second.low], second.high)
}

/// Two triangles without a common corner in different planes; the sides are those of the corners against the other's
/// plane, not all the same strict one.
pub(super) fn apart_or_meeting(points: Points, corners: [[u32; 3]; 2], sides: [[Ordering; 3]; 2]) -> Option<PairKind> {
    let first = section(corners[0], sides[0]);
    // Seen from the second triangle the direction is the opposite one.
    let [end, start] = section(corners[1], sides[1]);
    let before = follows(points, first[0], end);
    let after = follows(points, first[1], start);
    if before == Less || after == Greater {
        return None;
    }
    if before == Equal || after == Equal || sides.iter().any(|sides| only_touched(*sides)) {
        return Some(PairKind::TouchAtPoint);
    }
    Some(if sides.iter().all(|sides| straddles(*sides)) { PairKind::Crossing } else { PairKind::TouchAlongSegment })
}

/// Two triangles in different planes whose first corners are the same; the sides are those of the second and third
/// corners, not the same strict one. Both sections start there, so they share more exactly if they run the same way.
pub(super) fn beyond_corner(sides: [[Ordering; 2]; 2]) -> Option<PairKind> {
    let starts = |[next, last]: [Ordering; 2]| next == Greater || (next == Equal && last == Less);
    // Seen from the second triangle the direction is the opposite one.
    if starts(sides[0]) == starts(sides[1]) {
        return None;
    }
    let straddles = |[next, last]: [Ordering; 2]| next != Equal && last == next.reverse();
    let through = sides.into_iter().all(straddles);
    Some(if through { PairKind::CrossingAtCorner } else { PairKind::TouchAlongSegment })
}

fn straddles(sides: [Ordering; 3]) -> bool {
    sides.contains(&Greater) && sides.contains(&Less)
}

/// Whether the plane meets the triangle in one corner alone.
fn only_touched(sides: [Ordering; 3]) -> bool {
    !straddles(sides) && sides.iter().filter(|&&side| side == Equal).count() == 1
}
