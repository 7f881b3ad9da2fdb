//! Polygons: closed, planar, simple, convex, each with a witness.

use std::cmp::Ordering;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};
use shapeloom_core::{Aabb, Exec};
use shapeloom_mesh::newell_vector;

use crate::scaled::times_power;
use crate::segments::{collinear, on_segment, segments_meet};
use crate::{JudgeError, Scaled};

/// What is known of a polygon: a row of corners joined by straight sides.
///
/// Every "no" has a witness. All but the flatness is decided exactly on the coordinates as they are, where a polygon that
/// was turned in space is seldom planar to the last bit: `flatness` says how far from it.
///
/// Cost: O(n log n) for n corners, and one exact test for each pair of sides whose boxes meet; at worst that is O(n²).
#[derive(Clone, Debug, PartialEq)]
pub struct PolygonReport {
    /// Whether the last side ends where the first begins: it was said to, or the last corner is at the first's place.
    /// The gap between the ends where it does not.
    pub open: Option<f64>,
    /// Four corners that lie in no plane; none where all corners lie in one.
    pub not_planar: Option<[u32; 4]>,
    /// The largest distance of a corner from the plane through the corners' mean across their Newell vector.
    pub flatness: f64,
    /// Two sides, by their first corners, that have more in common than the corner between neighbours; none where the
    /// polygon is simple. A side without length is given with the next.
    pub not_simple: Option<[u32; 2]>,
    /// Why it is not convex; none where it is.
    pub not_convex: Option<NotConvex>,
}

/// Why a polygon is not convex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotConvex {
    /// It is open, or crosses or touches itself, or all its corners are on one line.
    NoRegion,
    /// It is not in one plane.
    NotPlanar,
    /// It turns the other way at this corner.
    Corner(u32),
}

impl PolygonReport {
    /// Judges the polygon with these corners; `closed` says that a last side leads back to the first corner.
    ///
    /// # Errors
    /// A corner that is not finite or loses bits (see [`Scaled`]), the memory budget, or the reason to stop.
    pub fn of(corners: &[DVec3], closed: bool, exec: &Exec) -> Result<Self, JudgeError> {
        let _memory = exec.reserve_elements(corners.len() as u64, 64)?;
        let scaled = Scaled::new(corners)?;
        let mut points = scaled.positions;
        // A last corner that repeats the first is a way to say closed.
        let repeated = points.len() > 1 && points.first() == points.last();
        if repeated && !closed {
            points.pop();
        }
        let open = match (points.first(), points.last()) {
            (Some(&first), Some(&last)) if !closed && !repeated => {
                let gap = first.distance(last);
                Some(times_power(DVec3::X * gap, -scaled.exponent).x)
            }
            (None, _) => Some(0.0),
            _ => None,
        };
        let not_planar = not_planar(&points);
        let not_simple = not_simple(&points, open.is_none(), exec)?;
        let not_convex = if open.is_some() || not_simple.is_some() || points.len() < 3 {
            Some(NotConvex::NoRegion)
        } else if not_planar.is_some() {
            Some(NotConvex::NotPlanar)
        } else {
            turns_back(&points)
        };
        let normal = newell_vector(points.iter().copied()).normalize_or_zero();
        let mean = points.iter().sum::<DVec3>() / points.len().max(1) as f64;
        let off = points.iter().map(|&point| normal.dot(point - mean).abs()).fold(0.0, f64::max);
        let flatness = times_power(DVec3::X * off, -scaled.exponent).x;
        Ok(Self { open, not_planar, flatness, not_simple, not_convex })
    }

    /// Whether the last side ends where the first begins.
    pub fn is_closed(&self) -> bool {
        self.open.is_none()
    }

    /// Whether all corners lie in one plane, exactly.
    pub fn is_planar(&self) -> bool {
        self.not_planar.is_none()
    }

    /// Whether sides have nothing in common but the corners between neighbours.
    pub fn is_simple(&self) -> bool {
        self.not_simple.is_none()
    }

    /// Whether it is closed, planar, simple, and turns one way at every corner where it turns.
    pub fn is_convex(&self) -> bool {
        self.not_convex.is_none()
    }
}

fn not_planar(points: &[DVec3]) -> Option<[u32; 4]> {
    let first = *points.first()?;
    let second = points.iter().position(|&point| point != first)?;
    let third = points.iter().position(|&point| !collinear(first, points[second], point))?;
    let off = |&point: &DVec3| orient3d(first, points[second], points[third], point) != Ordering::Equal;
    let fourth = points.iter().position(off)?;
    Some([0, second as u32, third as u32, fourth as u32])
}

/// The first pair of sides, by their boxes along an axis, that meet where they should not.
fn not_simple(points: &[DVec3], closed: bool, exec: &Exec) -> Result<Option<[u32; 2]>, JudgeError> {
    let count = points.len();
    let sides = if closed { count } else { count.saturating_sub(1) };
    let side = |k: u32| [points[k as usize], points[(k as usize + 1) % count]];
    // Closed polygons of one and two corners go back on themselves.
    if closed && count < 3 {
        return Ok((count > 0).then_some([0, count as u32 - 1]));
    }
    let next = |k: u32| if closed { (k + 1) % sides as u32 } else { k + 1 };
    if let Some(flat) = (0..sides as u32).find(|&k| side(k)[0] == side(k)[1]) {
        let other = if next(flat) < sides as u32 { next(flat) } else { flat.saturating_sub(1) };
        return Ok(Some([flat.min(other), flat.max(other)]));
    }
    // Along the axis on which the polygon is longest: across a plane of it all sides would stand at one place.
    let size = Aabb::from_points(points.iter().copied()).size();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    let low = |k: u32| side(k)[0][axis].min(side(k)[1][axis]);
    let mut order: Vec<u32> = (0..sides as u32).collect();
    order.sort_by(|&a, &b| low(a).total_cmp(&low(b)).then(a.cmp(&b)));
    let mut tests = 0u32;
    for (place, &one) in order.iter().enumerate() {
        exec.check()?;
        let high = side(one)[0][axis].max(side(one)[1][axis]);
        for &other in order[place + 1..].iter().take_while(|&&other| low(other) <= high) {
            tests += 1;
            if tests.is_multiple_of(1 << 14) {
                exec.check()?;
            }
            let (a, b) = (one.min(other), one.max(other));
            let ([p, q], [r, s]) = (side(a), side(b));
            let bad = if next(a) == b {
                // q and r are one corner: the ends may not lie on the other side.
                on_segment(p, [r, s]) || on_segment(s, [p, q])
            } else if next(b) == a {
                on_segment(q, [r, s]) || on_segment(r, [p, q])
            } else {
                segments_meet([p, q], [r, s])
            };
            if bad {
                return Ok(Some([a, b]));
            }
        }
    }
    Ok(None)
}

/// The first corner at which a planar, simple polygon turns against its sense.
fn turns_back(points: &[DVec3]) -> Option<NotConvex> {
    let count = points.len();
    for [i, j] in [[0, 1], [1, 2], [2, 0]] {
        let flat = |k: usize| DVec2::new(points[k % count][i], points[k % count][j]);
        let turns: Vec<Ordering> = (0..count).map(|k| orient2d(flat(k + count - 1), flat(k), flat(k + 1))).collect();
        // A projection that does not flatten the plane keeps convexity. Of the corners that turn, the extreme one turns
        // the way of the whole.
        let turning = (0..count).filter(|&k| turns[k] != Ordering::Equal);
        let by_place = |&a: &usize, &b: &usize| flat(a).x.total_cmp(&flat(b).x).then(flat(a).y.total_cmp(&flat(b).y));
        if let Some(extreme) = turning.min_by(by_place) {
            let back = turns.iter().position(|&turn| turn == turns[extreme].reverse());
            return back.map(|corner| NotConvex::Corner(corner as u32));
        }
    }
    Some(NotConvex::NoRegion)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report(corners: &[[f64; 3]], closed: bool) -> PolygonReport {
        let corners: Vec<DVec3> = corners.iter().map(|&corner| DVec3::from_array(corner)).collect();
        PolygonReport::of(&corners, closed, &Exec::default()).unwrap()
    }

    #[test]
    fn each_no_has_its_witness() {
        let square = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let found = report(&square, true);
        assert!(found.is_closed() && found.is_planar() && found.is_simple() && found.is_convex());
        assert_eq!(found.flatness, 0.0);
        assert_eq!(report(&square, false).open, Some(2.0));
        let mut again = square.to_vec();
        again.push(square[0]);
        assert!(report(&again, false).is_convex());
        // Said to be closed, and the first corner repeated: a side without length.
        assert_eq!(report(&again, true).not_simple, Some([0, 4]));
        let mut bent = square;
        bent[2][2] = 1e-300;
        let found = PolygonReport::of(&bent.map(DVec3::from_array), true, &Exec::default());
        assert!(matches!(found, Err(JudgeError::Underflow { vertex: 2, .. })));
        bent[2][2] = 1e-60;
        let found = report(&bent, true);
        assert_eq!((found.not_planar, found.not_convex), (Some([0, 1, 2, 3]), Some(NotConvex::NotPlanar)));
        assert!((found.flatness / 0.25e-60 - 1.0).abs() < 1e-9);
        let bow = [square[0], square[2], square[1], square[3]];
        assert_eq!(
            (report(&bow, true).not_simple, report(&bow, true).not_convex),
            (Some([0, 2]), Some(NotConvex::NoRegion))
        );
        let dart = [[0.0, 0.0, 1.0], [4.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 4.0, 1.0]];
        assert_eq!(report(&dart, true).not_convex, Some(NotConvex::Corner(2)));
        let straight = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 2.0]];
        assert!(report(&straight, true).is_convex());
        let line = [[0.0, 0.0, 0.0], [1.0, 1.0, 1.0], [2.0, 2.0, 2.0]];
        assert!(report(&line, true).not_simple.is_some() && report(&line, false).is_simple());
        // Open ones whose last side goes back on the one before, by less and by more.
        for end in [1.0, 3.0] {
            let back = [[4.0, 9.0, 0.0], [0.0, 0.0, 1.0], [2.0, 2.0, 0.0], [2.0 - end, 2.0 - end, end / 2.0]];
            assert!(report(&back, false).not_simple.is_some_and(|sides| sides[1] == 2), "{end}");
            let mut first = back;
            first.reverse();
            assert!(report(&first, false).not_simple.is_some_and(|sides| sides[0] == 0), "{end}");
        }
    }

    #[test]
    fn nothing_and_very_little_are_taken() {
        assert!(!report(&[], true).is_closed());
        for count in 0..3 {
            let found = report(&vec![[1.0, 2.0, 3.0]; count], true);
            assert!(found.is_planar() && !found.is_convex());
        }
        assert!(matches!(
            PolygonReport::of(&[DVec3::ZERO, DVec3::NAN], false, &Exec::default()),
            Err(JudgeError::NotFinite { vertex: 1, .. })
        ));
    }

    /// Lattice polygons in three planes against integers: sides pair by pair, convexity by sides that have all corners on
    /// one side of them.
    #[test]
    fn agrees_with_integers_on_the_lattice() {
        let mut state = 7u64;
        let mut draw = |top: i64| {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (state >> 33) as i64 % top
        };
        let (mut simple, mut convex) = (0, 0);
        for _ in 0..20_000 {
            let count = 3 + draw(4) as usize;
            let corners: Vec<[i64; 2]> = (0..count).map(|_| [draw(5), draw(5)]).collect();
            let at = |k: usize| corners[k % count];
            let turn =
                |a: [i64; 2], b: [i64; 2], c: [i64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            let on = |p: [i64; 2], a: [i64; 2], b: [i64; 2]| {
                turn(a, b, p) == 0 && (p[0] - a[0]) * (p[0] - b[0]) + (p[1] - a[1]) * (p[1] - b[1]) <= 0
            };
            let meet = |a, b, c, d| {
                on(a, c, d)
                    || on(b, c, d)
                    || on(c, a, b)
                    || on(d, a, b)
                    || turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0
            };
            let mut is_simple = true;
            for i in 0..count {
                is_simple &= at(i) != at(i + 1);
                for j in i + 1..count {
                    let neighbors = j == i + 1 || (i == 0 && j == count - 1);
                    let (p, q, r, s) = (at(i), at(i + 1), at(j), at(j + 1));
                    if !neighbors {
                        is_simple &= !meet(p, q, r, s);
                    }
                }
                // Neighbours go back on each other.
                let (p, q, r) = (at(i), at(i + 1), at(i + 2));
                let ahead = (q[0] - p[0]) * (r[0] - q[0]) + (q[1] - p[1]) * (r[1] - q[1]);
                is_simple &= turn(p, q, r) != 0 || ahead > 0;
            }
            let sides_of =
                |sign: i64| (0..count).all(|i| (0..count).all(|k| sign * turn(at(i), at(i + 1), at(k)) >= 0));
            let is_convex = is_simple && (sides_of(1) || sides_of(-1));
            let lift = draw(3);
            let place = |[x, y]: [i64; 2]| {
                let [x, y] = [x as f64, y as f64];
                match lift {
                    0 => DVec3::new(x, y, 3.0),
                    1 => DVec3::new(x + y, 1.0, y),
                    _ => DVec3::new(x, y, x - 2.0 * y),
                }
            };
            let placed: Vec<DVec3> = corners.iter().map(|&corner| place(corner)).collect();
            let found = PolygonReport::of(&placed, true, &Exec::default()).unwrap();
            assert!(found.is_planar());
            assert_eq!((found.is_simple(), found.is_convex()), (is_simple, is_convex), "{corners:?}");
            simple += u32::from(is_simple);
            convex += u32::from(is_convex);
        }
        assert!(simple > 3000 && convex > 1000, "{simple} {convex}");
    }
}
