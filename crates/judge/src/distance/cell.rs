//! Pieces of a shape: what bounds the distance over one, and how it is cut.

use shapeloom_core::glam::DVec3;

use super::foot::{distance_to_triangle, length_up};
use super::patchwork::{self, Patchwork};
use super::side::{Probe, Side};

/// What rounding can do to a new corner, in scaled units: one step of cutting moves it by less, so a cell at depth `n`
/// and the piece that it stands for are within `n` times this of each other.
const DRIFT: f64 = 1.0 / (1u64 << 50) as f64;

/// Rounding has the last word over cells as deep or as small as this.
const DEEPEST: u16 = 200;
const SMALLEST: f64 = 1.0 / (1u64 << 46) as f64;

/// How many times in a row a cell is cut along planes before it is halved.
const CUTS: u8 = 6;

/// No triangle.
const NONE: u32 = u32::MAX;

/// A triangle, segment `[a, b, b]` or point `[p, p, p]` that is a piece of a shape, in scaled units.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub corners: [DVec3; 3],
    /// No less than the distances of the corners, and the elements of the other shape that are nearest to them.
    distances: [f64; 3],
    elements: [u32; 3],
    /// The element of the other shape that is nearest to this piece as a whole, as far as is known.
    common: u32,
    /// The element that this is a piece of.
    pub root: u32,
    /// No point of the piece is farther from the other shape than this.
    pub upper: f64,
    depth: u16,
    cuts: u8,
}

/// The point with the largest distance that is proven.
#[derive(Clone, Copy, Debug)]
pub(super) struct Farthest {
    /// Some point of the shape is at least this far from the other.
    pub lower: f64,
    pub place: DVec3,
    pub root: u32,
    pub probe: Probe,
}

impl Farthest {
    pub fn new(place: DVec3, root: u32, probe: Probe, depth: u16) -> Self {
        let lower = (probe.lower - f64::from(depth) * DRIFT).max(0.0);
        // What is no number proves nothing.
        let lower = if lower.is_finite() { lower } else { 0.0 };
        Self { lower, place, root, probe }
    }

    /// The farther one; the first between equals.
    pub fn or(self, other: Self) -> Self {
        if other.lower > self.lower { other } else { self }
    }
}

/// When a bound is as near to what is proven from below as was asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    pub lower: f64,
    pub relative: f64,
    pub absolute: f64,
}

impl Goal {
    pub fn is_met(&self, upper: f64) -> bool {
        upper - self.lower <= (self.relative * upper).max(self.absolute)
    }

    /// About the largest bound that meets the goal, and no larger.
    fn enough(&self) -> f64 {
        (self.lower / (1.0 - self.relative)).max(self.lower + self.absolute) * (1.0 - 1e-12)
    }
}

/// What the pieces of a shape are measured against, and what measuring them found.
pub(super) struct Search<'a> {
    pub other: &'a Side<'a>,
    pub goal: Goal,
    pub farthest: Option<Farthest>,
    pub queries: u64,
}

impl<'a> Search<'a> {
    pub fn new(other: &'a Side<'a>, goal: Goal) -> Self {
        Self { other, goal, farthest: None, queries: 0 }
    }

    /// The distance of a place in a cell.
    fn probe(&mut self, cell: &Cell, place: DVec3) -> Probe {
        let known = match cell.common {
            NONE => f64::INFINITY,
            common => distance_to_triangle(&self.other.corners(common), place),
        };
        let probe = self.other.probe_within(place, known);
        self.queries += 1;
        let found = Farthest::new(place, cell.root, probe, cell.depth + 1);
        self.farthest = Some(self.farthest.map_or(found, |known| known.or(found)));
        probe
    }

    /// A whole element whose corners are probed.
    pub fn whole(&mut self, corners: [DVec3; 3], probes: [&Probe; 3], root: u32) -> Cell {
        let [a, b, c] = corners;
        // Segments have their double corner last.
        let order = if a == b && a != c {
            [2, 0, 1]
        } else if a == c && a != b {
            [1, 0, 2]
        } else {
            [0, 1, 2]
        };
        let mut cell = Cell {
            corners: order.map(|i| corners[i]),
            distances: order.map(|i| probes[i].upper),
            elements: order.map(|i| probes[i].element),
            common: NONE,
            root,
            upper: f64::INFINITY,
            depth: 0,
            cuts: 0,
        };
        // An element that the other shape has too, under the same number: a shape is 0 away from itself, however its
        // elements overlap.
        let twin = (root as usize) < self.other.triangles.len() && self.other.corners(root) == corners;
        if twin {
            (cell.upper, cell.common) = (0.0, root);
        } else {
            self.bound(&mut cell);
        }
        cell
    }

    /// Lowers the bound of a cell by one way after the other until the goal is met.
    fn bound(&mut self, cell: &mut Cell) {
        let drift = f64::from(cell.depth) * DRIFT;
        let lower_to = |cell: &mut Cell, bound: f64| cell.upper = cell.upper.min(bound * (1.0 + 1e-15) + drift);
        // A distance changes no faster than the place: no place of a triangle is farther from all corners than its
        // longest side divided by the root of 3, nor from any one corner than that one's longer side.
        let [a, b, c] = cell.corners;
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| length_up(to - from));
        let longest = ab.max(bc).max(ca);
        let [da, db, dc] = cell.distances;
        lower_to(cell, da.max(db).max(dc) + longest * 0.577_350_269_189_626);
        lower_to(cell, (da + ab.max(ca)).min(db + bc.max(ab)).min(dc + ca.max(bc)));
        if self.goal.is_met(cell.upper) {
            return;
        }
        // The distance to one triangle is convex, so that over the cell it is largest at a corner.
        let candidates = [cell.elements[0], cell.elements[1], cell.elements[2], cell.common];
        let (other, mut least) = (self.other, f64::INFINITY);
        let mut lower_by = |cell: &mut Cell, element: u32| {
            let triangle = other.corners(element);
            let bound = cell.corners.iter().map(|&corner| distance_to_triangle(&triangle, corner)).fold(0.0, f64::max);
            if bound < least {
                least = bound;
                cell.common = element;
            }
            lower_to(cell, bound);
        };
        for (i, &element) in candidates.iter().enumerate() {
            if element != NONE && !candidates[..i].contains(&element) {
                lower_by(cell, element);
            }
        }
        if self.goal.is_met(cell.upper) || longest == 0.0 {
            return;
        }
        if self.cover(cell, NONE) {
            return;
        }
        // A place inside, which lies on the triangle that the cell lies on where the shapes agree.
        let middle = if b == c { (a + b) * 0.5 } else { (a + b + c) / 3.0 };
        let probe = self.probe(cell, middle);
        if !candidates.contains(&probe.element) {
            lower_by(cell, probe.element);
        }
        let reach = [a, b, c].map(|corner| length_up(corner - middle)).into_iter().fold(0.0, f64::max);
        lower_to(cell, probe.upper + reach + DRIFT);
        if !self.goal.is_met(cell.upper) && !candidates.contains(&probe.element) {
            self.cover(cell, probe.element);
        }
    }

    /// Lowers the bound of a cell by the triangles that are near to its corners, to it as a whole, and by another one, all
    /// together. Whether that meets the goal.
    fn cover(&self, cell: &mut Cell, another: u32) -> bool {
        let mut triangles = [[DVec3::ZERO; 3]; 5];
        let mut elements = [NONE; 5];
        let mut count = 0;
        for element in [cell.elements[0], cell.elements[1], cell.elements[2], cell.common, another] {
            if element != NONE && !elements[..count].contains(&element) {
                elements[count] = element;
                triangles[count] = self.other.corners(element);
                count += 1;
            }
        }
        if count < 2 {
            return false;
        }
        let drift = f64::from(cell.depth) * DRIFT + patchwork::DRIFT;
        let patchwork = Patchwork { triangles: &triangles[..count], enough: self.goal.enough() - 2.0 * drift };
        cell.upper = cell.upper.min(patchwork.bound(&cell.corners) * (1.0 + 1e-15) + drift);
        self.goal.is_met(cell.upper)
    }

    /// The pieces of a cell, with their bounds; none where rounding leaves nothing to gain.
    pub fn split(&mut self, cell: &Cell, pieces: &mut Vec<Cell>) {
        pieces.clear();
        let sides = [0, 1, 2].map(|i| cell.corners[i].distance(cell.corners[(i + 1) % 3]));
        let longest = sides.into_iter().fold(0.0, f64::max);
        if cell.depth >= DEEPEST || longest <= SMALLEST {
            return;
        }
        let cut = if cell.cuts < CUTS { self.plane(cell, longest) } else { None };
        match cut {
            Some(heights) => self.cut(cell, heights, longest, pieces),
            None => {
                let side = (0..3).find(|&i| sides[i] == longest).unwrap_or(0);
                self.divide(cell, [side, (side + 1) % 3, (side + 2) % 3], 0.5, 0, pieces);
            }
        }
        for piece in pieces.iter_mut() {
            piece.upper = cell.upper + DRIFT;
            self.bound(piece);
        }
    }

    /// The heights of a cell's corners above the plane, upright on the nearest triangle along one of its sides, that has
    /// most of the cell outside: inside of all such planes the distance to the triangle is that to its plane.
    fn plane(&self, cell: &Cell, longest: f64) -> Option<[f64; 3]> {
        if cell.common == NONE {
            return None;
        }
        let triangle = self.other.corners(cell.common);
        let sides = [0, 1, 2].map(|i| triangle[(i + 1) % 3] - triangle[i]);
        let size = sides.iter().map(|side| side.length()).fold(0.0, f64::max);
        // A cell that dwarfs the triangle would be whittled away slowly: it is halved.
        if size == 0.0 || longest > 2.0 * size {
            return None;
        }
        let normal = sides[0].cross(-sides[2]);
        let mut best: Option<[f64; 3]> = None;
        for i in 0..3 {
            // Of a triangle without area, a segment, the planes at its ends.
            let outward = if normal.length_squared() > 0.0 { sides[i].cross(normal) } else { sides[i] };
            let Some(outward) = outward.try_normalize() else { continue };
            let from = if normal.length_squared() > 0.0 { triangle[i] } else { triangle[(i + 1) % 3] };
            let heights = cell.corners.map(|corner| (corner - from).dot(outward));
            let (low, high) =
                heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &x| (l.min(x), h.max(x)));
            let least = longest * 1e-6;
            if low < -least && high > least && best.is_none_or(|best| high > best.into_iter().fold(0.0, f64::max)) {
                best = Some(heights);
            }
        }
        best
    }

    /// Cuts a cell where the heights of its corners change sign.
    fn cut(&mut self, cell: &Cell, heights: [f64; 3], longest: f64, pieces: &mut Vec<Cell>) {
        let cuts = cell.cuts + 1;
        let signs = heights.map(|height| if height.abs() <= longest * 1e-9 { 0 } else { height.signum() as i32 });
        let share = |i: usize, j: usize| heights[i] / (heights[i] - heights[j]);
        let [a, b, c] = cell.corners;
        if b == c && a != b {
            return self.divide(cell, [0, 1, 2], share(0, 1), cuts, pieces);
        }
        if let Some(on) = (0..3).find(|&i| signs[i] == 0) {
            let (i, j) = ((on + 1) % 3, (on + 2) % 3);
            return self.divide(cell, [i, j, on], share(i, j), cuts, pieces);
        }
        // The corner alone on its side of the plane.
        let Some(i) = (0..3).find(|&i| signs[i] != signs[(i + 1) % 3] && signs[i] != signs[(i + 2) % 3]) else {
            return;
        };
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let at_j = self.corner(cell, i, j, share(i, j));
        let at_k = self.corner(cell, i, k, share(i, k));
        let [at_i, end_j, end_k] = [i, j, k].map(|i| (cell.corners[i], cell.distances[i], cell.elements[i]));
        pieces.push(piece(cell, [at_i, at_j, at_k], cuts));
        // The shorter diagonal of what is left.
        if at_j.0.distance_squared(end_k.0) <= at_k.0.distance_squared(end_j.0) {
            pieces.push(piece(cell, [at_j, end_j, end_k], cuts));
            pieces.push(piece(cell, [at_j, end_k, at_k], cuts));
        } else {
            pieces.push(piece(cell, [at_j, end_j, at_k], cuts));
            pieces.push(piece(cell, [end_j, end_k, at_k], cuts));
        }
    }

    /// Divides the side from corner `i` to corner `j` at a fraction.
    fn divide(&mut self, cell: &Cell, [i, j, k]: [usize; 3], fraction: f64, cuts: u8, pieces: &mut Vec<Cell>) {
        let new = self.corner(cell, i, j, fraction);
        let [at_i, at_j, at_k] = [i, j, k].map(|i| (cell.corners[i], cell.distances[i], cell.elements[i]));
        if cell.corners[1] == cell.corners[2] {
            let end = (cell.corners[1], cell.distances[1], cell.elements[1]);
            let start = (cell.corners[0], cell.distances[0], cell.elements[0]);
            pieces.push(piece(cell, [start, new, new], cuts));
            pieces.push(piece(cell, [new, end, end], cuts));
        } else {
            pieces.push(piece(cell, [at_i, new, at_k], cuts));
            pieces.push(piece(cell, [new, at_j, at_k], cuts));
        }
    }

    /// A new corner on a side: the same bits from both ends when it is the middle.
    fn corner(&mut self, cell: &Cell, i: usize, j: usize, fraction: f64) -> Corner {
        let (a, b) = (cell.corners[i], cell.corners[j]);
        let place = if fraction == 0.5 { (a + b) * 0.5 } else { a + (b - a) * fraction.clamp(0.0, 1.0) };
        let probe = self.probe(cell, place);
        (place, probe.upper, probe.element)
    }
}

/// A corner, no less than its distance, and the element nearest to it.
type Corner = (DVec3, f64, u32);

fn piece(cell: &Cell, corners: [Corner; 3], cuts: u8) -> Cell {
    Cell {
        corners: corners.map(|corner| corner.0),
        distances: corners.map(|corner| corner.1),
        elements: corners.map(|corner| corner.2),
        depth: cell.depth + 1,
        cuts,
        ..*cell
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::Simplices;
    use crate::distance::side::Scale;
    use shapeloom_core::Exec;

    fn area(corners: &[DVec3; 3]) -> f64 {
        (corners[1] - corners[0]).cross(corners[2] - corners[0]).length() / 2.0
    }

    /// Cut along borders or in half, the parts of a cell are the cell.
    #[test]
    fn parts_have_the_area_or_length_of_the_whole() {
        let positions = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * 0.4);
        let shape = Simplices::new(&positions[..], &[[0, 1, 2]][..]);
        let scale = Scale::of([&shape, &shape]);
        let other = Side::new(&shape, 1, scale, &Exec::default()).unwrap();
        let goal = Goal { lower: 0.0, relative: 0.0, absolute: 0.0 };
        let (mut cuts, mut halves) = (0, 0);
        for k in 0..300u32 {
            let corner = |i: u32| {
                let turn = f64::from(k * 7 + i * 5);
                DVec3::new((turn * 1.3).sin() * 0.4 + 0.2, (turn * 2.1).cos() * 0.4 + 0.2, 0.1 * (turn * 0.7).sin())
            };
            let corners = match k % 3 {
                0 => [corner(0), corner(1), corner(1)],
                _ => [corner(0), corner(1), corner(2)],
            };
            let probes = corners.map(|corner| other.probe(corner));
            let mut search = Search::new(&other, goal);
            let cell = search.whole(corners, [&probes[0], &probes[1], &probes[2]], 0);
            let mut parts = Vec::new();
            search.split(&cell, &mut parts);
            let sum =
                |measure: &dyn Fn(&[DVec3; 3]) -> f64| parts.iter().map(|part| measure(&part.corners)).sum::<f64>();
            assert!((sum(&area) - area(&corners)).abs() < 1e-13, "{cell:?} {parts:?}");
            if k % 3 == 0 {
                let length = |corners: &[DVec3; 3]| corners[0].distance(corners[2]);
                assert!((sum(&length) - length(&corners)).abs() < 1e-13);
            }
            assert!(parts.len() > 1 && parts.iter().all(|part| part.upper <= cell.upper + 1e-13));
            cuts += u32::from(parts.len() == 3);
            halves += u32::from(parts.len() == 2);
        }
        assert!(cuts > 50 && halves > 50, "{cuts} {halves}");
    }
}
