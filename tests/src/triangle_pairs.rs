//! How two triangles with small whole coordinates meet, by another way than the library: their common part is clipped out
//! in rational numbers, and judged by its size, by what it shares and by whether it reaches into both.

use shapeloom::judge::PairKind;

/// A point `(x / w, y / w, z / w)` with `w > 0`, in lowest terms.
type Rational = [i128; 4];
type Whole = [i128; 3];

pub fn kind_of_pair(first: [Whole; 3], second: [Whole; 3]) -> Option<PairKind> {
    let [one, other] = [first, second].map(|[a, b, c]| cross(minus(b, a), minus(c, a)));
    let opposite = dot(one, other) < 0;
    let [first, second] = [first, second].map(distinct);
    let shared: Vec<Whole> = first.iter().copied().filter(|corner| second.contains(corner)).collect();
    if shared.len() == first.len() && shared.len() == second.len() {
        return Some(if opposite { PairKind::Coincident } else { PairKind::Duplicate });
    }
    let (one, other) = (Set::new(&first), Set::new(&second));
    let mut common: Vec<Rational> = first.iter().map(|&[x, y, z]| [x, y, z, 1]).collect();
    for &plane in other.planes.iter() {
        common = clipped(&clipped(&common, plane), plane.map(|c| -c));
    }
    for &side in other.sides.iter() {
        common = clipped(&common, side);
    }
    if common.is_empty() {
        return None;
    }
    let low = common.iter().copied().reduce(|a, b| if before(a, b) { a } else { b })?;
    let high = common.iter().copied().reduce(|a, b| if before(a, b) { b } else { a })?;
    let dimension = if low == high { 0 } else { 1 + usize::from(common.iter().any(|&p| !on_line(low, high, p))) };
    let ends = if low == high { vec![low] } else { vec![low, high] };
    let is_shared = |end: &Rational| shared.iter().any(|&[x, y, z]| *end == [x, y, z, 1]);
    if dimension < 2 && ends.len() == shared.len() && ends.iter().all(is_shared) {
        return None;
    }
    // A point inside the common part is inside a set exactly if no side of the set holds the whole common part.
    let inside = |set: &Set| set.sides.iter().all(|&side| common.iter().any(|&p| value(side, p) > 0));
    if inside(&one) && inside(&other) {
        let within = |points: &[Whole], set: &Set| {
            points.iter().all(|&[x, y, z]| set.planes.iter().all(|&plane| value(plane, [x, y, z, 1]) == 0))
        };
        let flat = within(&first, &other) || within(&second, &one);
        match (dimension, shared.len()) {
            (2, 2) => return Some(PairKind::Folded),
            (2, _) => return Some(if opposite { PairKind::Contact } else { PairKind::Overlap }),
            (_, 0) if !flat && one.area | other.area => return Some(PairKind::Crossing),
            (_, _) if !flat && one.area | other.area => return Some(PairKind::CrossingAtCorner),
            _ => {}
        }
    }
    Some(if dimension == 0 { PairKind::TouchAtPoint } else { PairKind::TouchAlongSegment })
}

fn distinct(corners: [Whole; 3]) -> Vec<Whole> {
    let mut corners = corners.to_vec();
    corners.sort_unstable();
    corners.dedup();
    corners
}

/// A triangle, segment or point as the solutions of equations `plane · (p, 1) = 0` and `side · (p, 1) >= 0`; the sides
/// are strict inside it.
struct Set {
    planes: Vec<Rational>,
    sides: Vec<Rational>,
    area: bool,
}

impl Set {
    fn new(corners: &[Whole]) -> Self {
        let from = corners[0];
        let through = |normal: Whole, point: Whole| [normal[0], normal[1], normal[2], -dot(normal, point)];
        let area = corners.len() == 3 && cross(minus(corners[1], from), minus(corners[2], from)) != [0; 3];
        if area {
            let normal = cross(minus(corners[1], from), minus(corners[2], from));
            let side = |i: usize| through(cross(normal, minus(corners[(i + 1) % 3], corners[i])), corners[i]);
            return Self { planes: vec![through(normal, from)], sides: (0..3).map(side).collect(), area };
        }
        // Sorted, so the first and the last are the ends.
        let to = corners[corners.len() - 1];
        let along = minus(to, from);
        if along == [0; 3] {
            let planes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| through(axis, from));
            return Self { planes: planes.to_vec(), sides: Vec::new(), area };
        }
        let planes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|axis| through(cross(along, axis), from));
        let sides = vec![through(along, from), through(along.map(|c| -c), to)];
        Self { planes: planes.to_vec(), sides, area }
    }
}

/// The part of a convex polygon, segment or point where `half · (p, 1) >= 0`.
fn clipped(polygon: &[Rational], half: Rational) -> Vec<Rational> {
    let mut kept = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (at_p, at_q) = (value(half, p), value(half, q));
        if at_p >= 0 {
            kept.push(p);
        }
        if (at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0) {
            // Homogeneous values weigh homogeneous points.
            let (a, b) = (at_q.abs(), at_p.abs());
            kept.push(lowest([0, 1, 2, 3].map(|i| a * p[i] + b * q[i])));
        }
    }
    kept.dedup();
    if kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    kept
}

fn value(plane: Rational, p: Rational) -> i128 {
    (0..4).map(|i| plane[i] * p[i]).sum()
}

fn lowest(p: Rational) -> Rational {
    let divisor = p.into_iter().fold(0, |a: i128, b: i128| gcd(a, b.abs()));
    p.map(|c| c / divisor)
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

fn before(a: Rational, b: Rational) -> bool {
    let by = |i: usize| (a[i] * b[3]).cmp(&(b[i] * a[3]));
    by(0).then_with(|| by(1)).then_with(|| by(2)).is_lt()
}

fn on_line(a: Rational, b: Rational, p: Rational) -> bool {
    let difference = |q: Rational| [0, 1, 2].map(|i| q[i] * a[3] - a[i] * q[3]);
    cross(difference(b), difference(p)) == [0; 3]
}

fn minus(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn dot(a: Whole, b: Whole) -> i128 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn cross(a: Whole, b: Whole) -> Whole {
    [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}
