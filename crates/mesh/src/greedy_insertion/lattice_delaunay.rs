//! Constrained Delaunay triangulation of points with whole coordinates.

/// Of a side that lies on the border: no triangle.
pub(super) const NONE: u32 = u32::MAX;

/// A triangle, counter-clockwise. Side `i` is opposite corner `i`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Its points.
    pub corners: [u32; 3],
    /// The triangles beside it.
    pub beside: [u32; 3],
    /// Which sides may not be flipped.
    pub fixed: [bool; 3],
}

/// Where a point lies in a triangle.
enum Spot {
    Inside,
    Side(usize),
    Corner(u32),
}

/// A Delaunay triangulation of a rectangle, grown point by point (Lawson 1977), with sides that are kept.
///
/// Every decision is the sign of a determinant of whole numbers, so there is no rounding, and no triangle is ever flat or
/// turned over. Coordinates are below 2³²; the product of the sides of the rectangle is too, which keeps determinants in
/// 128 bits.
pub(super) struct LatticeDelaunay {
    points: Vec<[u32; 2]>,
    triangles: Vec<Triangle>,
    /// A triangle at each point.
    at: Vec<u32>,
    /// Where the last point went in: the next is likely near.
    last: u32,
    /// The triangles that the last insertion made or changed; some twice.
    changed: Vec<u32>,
    stack: Vec<u32>,
    walks: u32,
}

/// Twice the signed area of a triangle.
pub(super) fn doubled_area(a: [u32; 2], b: [u32; 2], c: [u32; 2]) -> i64 {
    let [bx, by] = apart(a, b);
    let [cx, cy] = apart(a, c);
    bx * cy - by * cx
}

fn apart(a: [u32; 2], b: [u32; 2]) -> [i64; 2] {
    [i64::from(b[0]) - i64::from(a[0]), i64::from(b[1]) - i64::from(a[1])]
}

/// Whether `d` is inside the circle through the corners of a triangle.
fn in_circle(a: [u32; 2], b: [u32; 2], c: [u32; 2], d: [u32; 2]) -> bool {
    let [a, b, c] = [a, b, c].map(|p| apart(d, p));
    let minor = |p: [i64; 2], q: [i64; 2]| i128::from(p[0] * q[1] - p[1] * q[0]);
    let square = |p: [i64; 2]| i128::from(p[0]) * i128::from(p[0]) + i128::from(p[1]) * i128::from(p[1]);
    square(a) * minor(b, c) + square(b) * minor(c, a) + square(c) * minor(a, b) > 0
}

fn after(i: usize) -> usize {
    (i + 1) % 3
}

impl LatticeDelaunay {
    /// Two triangles over a rectangle from the origin.
    pub(super) fn new(width: u32, height: u32) -> Self {
        let points = vec![[0, 0], [width, 0], [width, height], [0, height]];
        let triangle = |corners, beside| Triangle { corners, beside, fixed: [false; 3] };
        Self {
            points,
            triangles: vec![triangle([0, 1, 2], [NONE, 1, NONE]), triangle([0, 2, 3], [NONE, NONE, 0])],
            at: vec![0, 0, 0, 1],
            last: 0,
            changed: vec![0, 1],
            stack: Vec::new(),
            walks: 0,
        }
    }

    pub(super) fn points(&self) -> &[[u32; 2]] {
        &self.points
    }

    pub(super) fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// The triangles that the last insertion made or changed; some may be there twice.
    pub(super) fn changed(&self) -> &[u32] {
        &self.changed
    }

    fn place(&self, triangle: u32) -> [[u32; 2]; 3] {
        self.triangles[triangle as usize].corners.map(|point| self.points[point as usize])
    }

    /// Adds a point of the rectangle and returns its number: the old one if it is there. The search starts at a
    /// triangle, if one is named.
    pub(super) fn insert(&mut self, point: [u32; 2], near: Option<u32>) -> u32 {
        self.changed.clear();
        let (triangle, spot) = self.locate(point, near.unwrap_or(self.last));
        self.last = triangle;
        let number = self.points.len() as u32;
        match spot {
            Spot::Corner(known) => return known,
            Spot::Inside => self.split(triangle, point, number),
            Spot::Side(side) => self.split_side(triangle, side, point, number),
        }
        while let Some(triangle) = self.stack.pop() {
            self.make_delaunay(triangle, number);
        }
        number
    }

    /// Walks towards a point. Between constrained sides the straight choice may go round in circles, so the side to try
    /// first is drawn (Devillers, Pion and Teillaud 2002).
    fn locate(&mut self, point: [u32; 2], from: u32) -> (u32, Spot) {
        let mut at = from;
        loop {
            let triangle = self.triangles[at as usize];
            let corners = self.place(at);
            self.walks = self.walks.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let first = (self.walks >> 16) as usize;
            let mut on = [false; 3];
            let mut onward = None;
            for side in (0..3).map(|step| (first + step) % 3) {
                let area = doubled_area(corners[after(side)], corners[after(after(side))], point);
                if area < 0 {
                    onward = Some(triangle.beside[side]);
                    break;
                }
                on[side] = area == 0;
            }
            match onward {
                Some(next) => {
                    assert!(next != NONE, "a point outside of the rectangle");
                    at = next;
                }
                None => {
                    let spot = match on {
                        [false, false, false] => Spot::Inside,
                        // On two sides: on the corner that they share.
                        [true, true, _] => Spot::Corner(triangle.corners[2]),
                        [_, true, true] => Spot::Corner(triangle.corners[0]),
                        [true, _, true] => Spot::Corner(triangle.corners[1]),
                        [true, _, _] => Spot::Side(0),
                        [_, true, _] => Spot::Side(1),
                        _ => Spot::Side(2),
                    };
                    return (at, spot);
                }
            }
        }
    }

    fn put(&mut self, index: u32, corners: [u32; 3], beside: [u32; 3], fixed: [bool; 3]) {
        let triangle = Triangle { corners, beside, fixed };
        match self.triangles.get_mut(index as usize) {
            Some(old) => *old = triangle,
            None => self.triangles.push(triangle),
        }
        for corner in corners {
            self.at[corner as usize] = index;
        }
        self.changed.push(index);
    }

    /// The side of a triangle that borders another one.
    fn side_to(&self, triangle: u32, other: u32) -> usize {
        let beside = self.triangles[triangle as usize].beside;
        beside.iter().position(|&found| found == other).unwrap_or_default()
    }

    /// Tells the triangle beside that its neighbour has another number now.
    fn relink(&mut self, triangle: u32, before: u32, now: u32) {
        if triangle != NONE && before != now {
            let side = self.side_to(triangle, before);
            self.triangles[triangle as usize].beside[side] = now;
        }
    }

    fn split(&mut self, t: u32, point: [u32; 2], p: u32) {
        let Triangle { corners: [a, b, c], beside: [na, nb, nc], fixed: [fa, fb, fc] } = self.triangles[t as usize];
        let (u, v) = (self.triangles.len() as u32, self.triangles.len() as u32 + 1);
        self.points.push(point);
        self.at.push(t);
        self.put(t, [a, b, p], [u, v, nc], [false, false, fc]);
        self.put(u, [b, c, p], [v, t, na], [false, false, fa]);
        self.put(v, [c, a, p], [t, u, nb], [false, false, fb]);
        self.relink(na, t, u);
        self.relink(nb, t, v);
        self.stack.extend([t, u, v]);
    }

    fn split_side(&mut self, t: u32, side: usize, point: [u32; 2], p: u32) {
        let old = self.triangles[t as usize];
        let turned = [side, after(side), after(after(side))];
        let [a, b, c] = turned.map(|i| old.corners[i]);
        let [across, nb, nc] = turned.map(|i| old.beside[i]);
        let [kept, fb, fc] = turned.map(|i| old.fixed[i]);
        let u = self.triangles.len() as u32;
        self.points.push(point);
        self.at.push(t);
        let (o, v) = if across == NONE { (NONE, NONE) } else { (across, u + 1) };
        self.put(t, [a, b, p], [v, u, nc], [kept, false, fc]);
        self.put(u, [a, p, c], [o, nb, t], [kept, fb, false]);
        self.relink(nb, t, u);
        self.stack.extend([t, u]);
        if across != NONE {
            let other = self.triangles[o as usize];
            // Its corners are d, c, b, where d is opposite the split side.
            let side = other.beside.iter().position(|&found| found == t).unwrap_or_default();
            let turned = [side, after(side), after(after(side))];
            let [_, to_b_d, to_d_c] = turned.map(|i| other.beside[i]);
            let [_, fixed_b_d, fixed_d_c] = turned.map(|i| other.fixed[i]);
            let d = other.corners[side];
            self.put(o, [d, c, p], [u, v, to_d_c], [kept, false, fixed_d_c]);
            self.put(v, [d, p, b], [t, to_b_d, o], [kept, fixed_b_d, false]);
            self.relink(to_b_d, o, v);
            self.stack.extend([o, v]);
        }
    }

    /// Flips the side opposite a new point where the circle says so.
    fn make_delaunay(&mut self, t: u32, p: u32) {
        let old = self.triangles[t as usize];
        let Some(side) = old.corners.iter().position(|&corner| corner == p) else { return };
        let o = old.beside[side];
        if o == NONE || old.fixed[side] {
            return;
        }
        let across = self.side_to(o, t);
        let other = self.triangles[o as usize];
        let d = other.corners[across];
        let [pa, pb, pc] = self.place(t);
        if !in_circle(pa, pb, pc, self.points[d as usize]) {
            return;
        }
        let (i, j) = (after(side), after(after(side)));
        let (b, c) = (old.corners[i], old.corners[j]);
        // The other triangle has the corners d, c, b.
        let (k, l) = (after(across), after(after(across)));
        let (to_b_d, to_d_c) = (other.beside[k], other.beside[l]);
        self.put(t, [p, b, d], [to_b_d, o, old.beside[j]], [other.fixed[k], false, old.fixed[j]]);
        self.put(o, [p, d, c], [to_d_c, old.beside[i], t], [other.fixed[l], old.fixed[i], false]);
        self.relink(to_b_d, o, t);
        self.relink(old.beside[i], t, o);
        self.stack.extend([t, o]);
    }

    /// Keeps the side between two points from being flipped; false if there is no such side.
    pub(super) fn fix(&mut self, a: u32, b: u32) -> bool {
        let start = self.at[a as usize];
        // Around `a`, first one way; at a border the other way from the start.
        for clockwise in [false, true] {
            let mut t = start;
            loop {
                let triangle = self.triangles[t as usize];
                let Some(i) = triangle.corners.iter().position(|&corner| corner == a) else { return false };
                for side in [after(i), after(after(i))] {
                    if triangle.corners[3 - i - side] == b {
                        self.triangles[t as usize].fixed[side] = true;
                        let other = triangle.beside[side];
                        if other != NONE {
                            let across = self.side_to(other, t);
                            self.triangles[other as usize].fixed[across] = true;
                        }
                        return true;
                    }
                }
                t = triangle.beside[if clockwise { after(after(i)) } else { after(i) }];
                if t == NONE || t == start {
                    break;
                }
            }
            if t == start {
                return false;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dice(state: &mut u64, bound: u64) -> u32 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 33) % bound) as u32
    }

    /// The whole rectangle once, links both ways, no point inside a circle across a side that is not fixed.
    fn check(mesh: &LatticeDelaunay, area: i64) {
        let mut sum = 0;
        for (index, triangle) in mesh.triangles().iter().enumerate() {
            let [a, b, c] = mesh.place(index as u32);
            let doubled = doubled_area(a, b, c);
            assert!(doubled > 0, "{index} {a:?} {b:?} {c:?}");
            sum += doubled;
            for side in 0..3 {
                let other = triangle.beside[side];
                if other == NONE {
                    continue;
                }
                let across = mesh.side_to(other, index as u32);
                let beside = mesh.triangles()[other as usize];
                assert_eq!(beside.beside[across], index as u32);
                assert_eq!(beside.fixed[across], triangle.fixed[side]);
                assert_eq!(beside.corners[after(across)], triangle.corners[after(after(side))]);
                let d = mesh.points()[beside.corners[across] as usize];
                assert!(triangle.fixed[side] || !in_circle(a, b, c, d));
            }
        }
        assert_eq!(sum, 2 * area);
    }

    #[test]
    fn random_points_stay_delaunay_and_cover_the_rectangle() {
        let mut state = 3;
        for round in 0..60 {
            let (width, height) = (1 + dice(&mut state, 40), 1 + dice(&mut state, 40));
            let mut mesh = LatticeDelaunay::new(width, height);
            let mut known = std::collections::HashMap::new();
            for step in 0..200 {
                let p = [dice(&mut state, u64::from(width) + 1), dice(&mut state, u64::from(height) + 1)];
                let near = (step % 3 == 0).then(|| dice(&mut state, mesh.triangles().len() as u64));
                let number = mesh.insert(p, near);
                assert_eq!(*known.entry(p).or_insert(number), number);
                if step == 50 && round % 2 == 0 {
                    for corner in mesh.triangles()[0].corners {
                        let next = mesh.triangles()[0].corners[0];
                        assert_eq!(mesh.fix(corner, next), corner != next);
                    }
                }
            }
            check(&mesh, i64::from(width) * i64::from(height));
            assert!(!mesh.fix(0, u32::MAX));
        }
    }

    #[test]
    fn extents_of_one_row_do_not_overflow() {
        let width = 1 << 31;
        let mut mesh = LatticeDelaunay::new(width, 1);
        for x in [1, 7, 1 << 20, width - 1, width / 2] {
            mesh.insert([x, 0], None);
            mesh.insert([x, 1], None);
        }
        check(&mesh, i64::from(width));
    }
}
