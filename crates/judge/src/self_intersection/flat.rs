//! Triangles, segments and points in one plane.

use std::cmp::Ordering::{self, Equal};

use super::triangle::{Axis, Points};

/// What two convex sets in a plane have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Common {
    Nothing,
    /// The segment between two corners, or one corner twice; it lies on a line that parts the sets otherwise.
    Along(u32, u32),
    /// Points inside both: an area of two triangles, a segment of a triangle and a segment, else one point.
    Inside,
}

/// What the hulls of one to three corners have in common, all in one plane (or on one line), seen along an axis from which
/// the plane keeps its area. Three corners are never on a line; corners with different numbers are apart.
///
/// Convex sets without common inner points are parted by a line through a side of one of them, so trying the sides
/// decides. Where one parts them, what they share lies on it and runs between corners.
pub(super) fn common(points: Points, axis: Axis, first: &[u32], second: &[u32]) -> Common {
    for (mine, theirs) in [(first, second), (second, first)] {
        let sides: &[[usize; 3]] = match mine.len() {
            3 => &[[0, 1, 2], [1, 2, 0], [2, 0, 1]],
            2 => &[[0, 1, 1]],
            _ => &[],
        };
        for &[i, j, k] in sides {
            let (a, b) = (mine[i], mine[j]);
            // A segment has nothing on either side of its line.
            let inner = points.turn(axis, a, b, mine[k]);
            let turn = |&corner: &u32| points.turn(axis, a, b, corner);
            let parts = |outer: Ordering| theirs.iter().all(|corner| [outer, Equal].contains(&turn(corner)));
            let parted = match inner {
                Equal => parts(Ordering::Less) || parts(Ordering::Greater),
                inner => parts(inner.reverse()),
            };
            if parted {
                return on_line(points, [a, b], theirs.iter().copied().filter(|corner| turn(corner) == Equal));
            }
        }
    }
    match (first, second) {
        ([a], [b]) if a != b => Common::Nothing,
        ([a], [_]) => Common::Along(*a, *a),
        _ => Common::Inside,
    }
}

/// What a segment and the hull of other corners on its line have in common.
fn on_line(points: Points, segment: [u32; 2], others: impl Iterator<Item = u32>) -> Common {
    let order = |[a, b]: [u32; 2]| if points.along(a, b).is_gt() { [b, a] } else { [a, b] };
    let wider = |span: Option<[u32; 2]>, corner: u32| {
        Some(span.map_or([corner; 2], |[low, high]| [order([low, corner])[0], order([high, corner])[1]]))
    };
    let (Some([low, high]), [start, end]) = (others.fold(None, wider), order(segment)) else {
        return Common::Nothing;
    };
    let (from, to) = (order([low, start])[1], order([high, end])[0]);
    if points.along(from, to).is_gt() { Common::Nothing } else { Common::Along(from, to) }
}
