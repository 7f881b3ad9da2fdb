//! Whether two segments in space meet, exactly.

use std::cmp::Ordering;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{orient2d, orient3d};

/// Whether the closed segments `a`–`b` and `c`–`d` have a point in common. Exact on positions of [`Scaled`](crate::Scaled).
pub(crate) fn segments_meet([a, b]: [DVec3; 2], [c, d]: [DVec3; 2]) -> bool {
    let apart =
        |axis: usize| a[axis].max(b[axis]) < c[axis].min(d[axis]) || c[axis].max(d[axis]) < a[axis].min(b[axis]);
    if apart(0) || apart(1) || apart(2) || orient3d(a, b, c, d) != Ordering::Equal {
        return false;
    }
    // All in one plane: they meet if they do in every projection along an axis. A projection that keeps the plane a plane
    // decides; one that flattens it says yes wherever they meet, so asking all three is right.
    [[0, 1], [1, 2], [2, 0]].into_iter().all(|[i, j]| {
        let flat = |p: DVec3| DVec2::new(p[i], p[j]);
        meet_in_plane([flat(a), flat(b)], [flat(c), flat(d)])
    })
}

/// Whether `point` lies on the closed segment.
pub(crate) fn on_segment(point: DVec3, [a, b]: [DVec3; 2]) -> bool {
    let within = (0..3).all(|axis| point[axis] >= a[axis].min(b[axis]) && point[axis] <= a[axis].max(b[axis]));
    within && collinear(a, b, point)
}

/// Whether three points lie on one line.
pub(crate) fn collinear(a: DVec3, b: DVec3, c: DVec3) -> bool {
    [[0, 1], [1, 2], [2, 0]].into_iter().all(|[i, j]| {
        let flat = |p: DVec3| DVec2::new(p[i], p[j]);
        orient2d(flat(a), flat(b), flat(c)) == Ordering::Equal
    })
}

fn meet_in_plane([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    let (c_side, d_side) = (orient2d(a, b, c), orient2d(a, b, d));
    let (a_side, b_side) = (orient2d(c, d, a), orient2d(c, d, b));
    let touches = |side: Ordering, p: DVec2, [s, t]: [DVec2; 2]| {
        side == Ordering::Equal && p.cmpge(s.min(t)).all() && p.cmple(s.max(t)).all()
    };
    let opposite = |one: Ordering, other: Ordering| one == other.reverse() && one != Ordering::Equal;
    opposite(c_side, d_side) && opposite(a_side, b_side)
        || touches(c_side, c, [a, b])
        || touches(d_side, d, [a, b])
        || touches(a_side, a, [c, d])
        || touches(b_side, b, [c, d])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All pairs of segments between lattice points against the exact solution of the linear system in integers.
    #[test]
    fn agrees_with_integers_on_the_lattice() {
        type P = [i64; 3];
        let sub = |a: P, b: P| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let cross = |a: P, b: P| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let dot = |a: P, b: P| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let on = |p: P, a: P, b: P| cross(sub(b, a), sub(p, a)) == [0; 3] && dot(sub(p, a), sub(p, b)) <= 0;
        // a + s u = c + t v: s = (w × v)·n / n·n, t = (w × u)·n / n·n with w = c − a, n = u × v.
        let meet = |[a, b]: [P; 2], [c, d]: [P; 2]| {
            let (u, v, w) = (sub(b, a), sub(d, c), sub(c, a));
            let n = cross(u, v);
            if n == [0; 3] {
                return on(a, c, d) || on(b, c, d) || on(c, a, b) || on(d, a, b);
            }
            let (s, t, size) = (dot(cross(w, v), n), dot(cross(w, u), n), dot(n, n));
            dot(w, n) == 0 && (0..=size).contains(&s) && (0..=size).contains(&t)
        };
        let mut state = 1u64;
        let mut draw = || {
            state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            i64::try_from(state >> 33).unwrap_or(0) % 4
        };
        let mut met = 0;
        for _ in 0..200_000 {
            let p: [P; 4] = std::array::from_fn(|_| std::array::from_fn(|_| draw()));
            let q = p.map(|p| DVec3::from_array(p.map(|x| x as f64)));
            let wanted = meet([p[0], p[1]], [p[2], p[3]]);
            met += u32::from(wanted);
            assert_eq!(segments_meet([q[0], q[1]], [q[2], q[3]]), wanted, "{p:?}");
            assert_eq!(on_segment(q[0], [q[1], q[2]]), on(p[0], p[1], p[2]), "{p:?}");
        }
        assert!(met > 5000);
    }
}
