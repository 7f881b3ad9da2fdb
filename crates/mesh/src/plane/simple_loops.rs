//! Whether loops neither cross nor touch.

use std::cmp::Ordering;
use std::ops::Range;

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{Exec, Stop};

/// Whether no two sides of the loops share a point, but for the corner between neighbours; by exact signs (Shamos and Hoey
/// 1976). Loops are ranges of corners. A corner that repeats, a side without length, or a loop of fewer than three corners
/// is not simple.
///
/// Cost: n log n, and at each corner moving what lies above it in a list of the sides that cross a vertical line.
pub(crate) fn are_simple(corners: &[DVec2], loops: &[Range<usize>], exec: &Exec) -> Result<bool, Stop> {
    if loops.iter().any(|range| range.len() < 3) {
        return Ok(false);
    }
    // The corner after each, and the one before.
    let mut after: Vec<u32> = (1..=corners.len() as u32).collect();
    let mut before: Vec<u32> = (0..corners.len() as u32).map(|corner| corner.wrapping_sub(1)).collect();
    for range in loops {
        after[range.end - 1] = range.start as u32;
        before[range.start] = range.end as u32 - 1;
    }
    let at = |corner: u32| corners[corner as usize];
    let order = |a: DVec2, b: DVec2| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    let mut events: Vec<u32> = loops.iter().flat_map(|range| range.start as u32..range.end as u32).collect();
    events.sort_unstable_by(|&a, &b| order(at(a), at(b)));
    // The sides that cross the line of the sweep, from below, each from its first corner to its last.
    let mut active: Vec<[u32; 2]> = Vec::new();
    for (index, &corner) in events.iter().enumerate() {
        if index % 256 == 0 {
            exec.check()?;
        }
        let point = at(corner);
        if index > 0 && at(events[index - 1]) == point {
            return Ok(false);
        }
        let side_of = |side: &[u32; 2]| orient2d(at(side[0]), at(side[1]), point);
        let first = active.partition_point(|side| side_of(side) == Ordering::Greater);
        let last = first + active[first..].partition_point(|side| side_of(side) == Ordering::Equal);
        // Sides through the corner end there.
        if active[first..last].iter().any(|side| side[1] != corner) {
            return Ok(false);
        }
        let ends = [before[corner as usize], after[corner as usize]];
        let mut starting: Vec<[u32; 2]> =
            ends.into_iter().filter(|&end| order(point, at(end)).is_lt()).map(|end| [corner, end]).collect();
        if let [one, other] = starting[..] {
            match orient2d(point, at(one[1]), at(other[1])) {
                Ordering::Greater => {}
                Ordering::Less => starting.reverse(),
                Ordering::Equal => return Ok(false),
            }
        }
        let count = starting.len();
        if last - first + count != 2 {
            return Ok(false);
        }
        active.splice(first..last, starting);
        let meet = |k: usize| match (k.checked_sub(1).and_then(|below| active.get(below)), active.get(k)) {
            (Some(&one), Some(&other)) => meet(one, other, &at),
            _ => false,
        };
        if meet(first) || (count > 0 && meet(first + count)) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Whether two sides share a point that is no common corner.
fn meet(one: [u32; 2], other: [u32; 2], at: &impl Fn(u32) -> DVec2) -> bool {
    let ([a, b], [u, v]) = (one.map(at), other.map(at));
    if one.iter().any(|corner| other.contains(corner)) {
        // Sides that start together were compared; those that end together meet elsewhere only along each other.
        return one[1] == other[1] && orient2d(a, b, u) == Ordering::Equal;
    }
    let apart = |p: Ordering, q: Ordering| p == q && p != Ordering::Equal;
    let [p, q, r, s] = [orient2d(a, b, u), orient2d(a, b, v), orient2d(u, v, a), orient2d(u, v, b)];
    let boxes = a.min(b).cmple(u.max(v)).all() && u.min(v).cmple(a.max(b)).all();
    boxes && !apart(p, q) && !apart(r, s)
}

#[cfg(test)]
mod tests {
    use super::super::tests::Dice;
    use super::*;

    /// Every pair of sides, tried.
    fn plainly(corners: &[DVec2], loops: &[Range<usize>]) -> bool {
        let sides: Vec<[usize; 2]> = loops
            .iter()
            .flat_map(|range| range.clone().map(|k| [k, if k + 1 == range.end { range.start } else { k + 1 }]))
            .collect();
        let on = |p: DVec2, a: DVec2, b: DVec2| {
            orient2d(a, b, p).is_eq() && a.min(b).cmple(p).all() && a.max(b).cmpge(p).all()
        };
        let pairs = (0..sides.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        let bad = |(i, j): (usize, usize)| {
            let ([a, b], [u, v]) = (sides[i].map(|k| corners[k]), sides[j].map(|k| corners[k]));
            let shared = sides[i].iter().filter(|corner| sides[j].contains(corner)).count();
            let touching = [on(u, a, b), on(v, a, b), on(a, u, v), on(b, u, v)].iter().filter(|on| **on).count();
            let turn = |a: DVec2, b: DVec2, p: DVec2| orient2d(a, b, p) as i8;
            let across = turn(a, b, u) * turn(a, b, v) < 0 && turn(u, v, a) * turn(u, v, b) < 0;
            // A common corner is seen from both sides.
            across || touching > 2 * shared
        };
        let long = loops.iter().all(|range| range.len() > 2);
        let lengths = sides.iter().all(|side| corners[side[0]] != corners[side[1]]);
        long && lengths && !pairs.into_iter().any(bad)
    }

    #[test]
    fn a_sweep_finds_what_trying_all_pairs_finds() {
        let mut dice = Dice(9);
        let (mut simple, mut all) = (0, 0);
        for round in 0..6000u64 {
            let reach = [3, 6, 12, 1 << 20][(round % 4) as usize];
            let mut corners = Vec::new();
            let mut loops = Vec::new();
            for _ in 0..1 + dice.next(3) {
                let (first, count) = (corners.len(), 2 + dice.next(4) as usize);
                let shift = DVec2::new(dice.whole(reach), dice.whole(reach));
                corners.extend((0..count).map(|_| shift + DVec2::new(dice.whole(reach), dice.whole(reach))));
                loops.push(first..corners.len());
            }
            let found = are_simple(&corners, &loops, &Exec::default()).unwrap();
            assert_eq!(found, plainly(&corners, &loops), "{corners:?} {loops:?}");
            simple += usize::from(found);
            all += 1;
        }
        assert!(simple > 500 && simple < all - 500, "{simple} of {all}");
    }
}
