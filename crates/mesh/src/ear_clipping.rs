//! Triangulation of one outline in the plane.

use std::cmp::Ordering;

use shapeloom_core::glam::DVec2;
use shapeloom_core::predicates::orient2d;
use shapeloom_core::{Exec, Stop};

/// Cuts a counter-clockwise outline into `n - 2` triangles of corner indices by clipping ears (Meisters 1975), decided
/// by exact signs. Returns whether the outline was simple as far as the clipping noticed.
///
/// Every corner is kept, those on straight sides too, so that neighbouring polygons meet without gaps; a simple outline
/// gives no triangle of zero area. Where no ear is left (the outline crosses or touches itself) a convex corner is cut
/// all the same. Cost: linear for convex outlines; else each look at a corner takes the reflex corners near its triangle,
/// found by a grid, and a corner that is no ear is looked at again only when the corner that stood in its way is gone.
pub(crate) fn clip_ears(outline: &[DVec2], exec: &Exec, out: &mut Vec<[u32; 3]>) -> Result<bool, Stop> {
    let count = outline.len();
    if count < 3 {
        return Ok(false);
    }
    let mut ring = Ring::new(outline);
    let mut simple = true;
    let mut at = 0usize;
    let mut left = count;
    let mut work = 0usize;
    while left > 3 {
        work += 1;
        if work > 1 << 14 || ring.looked_at > 1 << 18 {
            exec.check()?;
            work = 0;
            ring.looked_at = 0;
        }
        match ring.candidates.next(at) {
            Some(corner) if !ring.is_ear(corner) => continue,
            Some(corner) => at = corner,
            None => {
                // Where the outline crosses itself a convex corner is cut all the same, else any.
                simple = false;
                at = ring.convex.next(at).unwrap_or(at);
            }
        }
        out.push([ring.previous[at] as u32, at as u32, ring.next[at] as u32]);
        ring.clip(at);
        left -= 1;
        // Going on past the neighbour spreads the ears and avoids fans of slivers.
        at = ring.next[ring.next[at]];
    }
    out.push([ring.previous[at] as u32, at as u32, ring.next[at] as u32]);
    Ok(simple && ring.turn(at) == Ordering::Greater)
}

/// The corners that are left, as a ring in the order of their numbers.
struct Ring<'a> {
    outline: &'a [DVec2],
    previous: Vec<usize>,
    next: Vec<usize>,
    /// Convex corners.
    convex: Marks,
    /// Convex corners that may be ears: no reflex corner is known that is in the way.
    candidates: Marks,
    /// For a reflex corner the first entry of the list of corners whose triangles it was found in.
    first_blocked: Vec<u32>,
    /// Entries of all of these lists: a corner, and the next entry.
    blocked: Vec<(u32, u32)>,
    /// The first of the entries that are free again.
    unused: u32,
    grid: Grid,
    /// How many reflex corners were looked at.
    looked_at: usize,
}

const NOTHING: u32 = u32::MAX;

impl<'a> Ring<'a> {
    fn new(outline: &'a [DVec2]) -> Self {
        let count = outline.len();
        let mut ring = Self {
            outline,
            previous: (0..count).map(|i| (i + count - 1) % count).collect(),
            next: (0..count).map(|i| (i + 1) % count).collect(),
            convex: Marks::new(count),
            candidates: Marks::new(count),
            first_blocked: vec![NOTHING; count],
            blocked: Vec::new(),
            unused: NOTHING,
            grid: Grid::default(),
            looked_at: 0,
        };
        let (convex, reflex): (Vec<u32>, Vec<u32>) =
            (0..count as u32).partition(|&corner| ring.turn(corner as usize) == Ordering::Greater);
        for corner in convex {
            ring.convex.set(corner as usize, true);
            ring.candidates.set(corner as usize, true);
        }
        ring.grid = Grid::new(outline, reflex);
        ring
    }

    fn turn(&self, corner: usize) -> Ordering {
        orient2d(self.outline[self.previous[corner]], self.outline[corner], self.outline[self.next[corner]])
    }

    /// Whether the triangle of a convex corner holds no other corner, borders included. One that does is no candidate
    /// until the corner that was found in it is gone or convex.
    fn is_ear(&mut self, corner: usize) -> bool {
        let triangle = [self.previous[corner], corner, self.next[corner]].map(|i| self.outline[i]);
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let (outline, convex, looked_at) = (self.outline, &self.convex, &mut self.looked_at);
        let gone = |other: usize| self.next[self.previous[other]] != other;
        let inside = |other: u32| {
            *looked_at += 1;
            let p = outline[other as usize];
            let near = low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
            near && !convex.is_set(other as usize)
                && !gone(other as usize)
                && !triangle.contains(&p)
                && orient2d(a, b, p) != Ordering::Less
                && orient2d(b, c, p) != Ordering::Less
                && orient2d(c, a, p) != Ordering::Less
        };
        let Some(found) = self.grid.find(low, high, inside) else {
            return true;
        };
        self.candidates.set(corner, false);
        let entry = (corner as u32, self.first_blocked[found as usize]);
        self.first_blocked[found as usize] = match self.blocked.get_mut(self.unused as usize) {
            Some(free) => {
                let at = std::mem::replace(&mut self.unused, free.1);
                *free = entry;
                at
            }
            None => {
                self.blocked.push(entry);
                self.blocked.len() as u32 - 1
            }
        };
        false
    }

    fn clip(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.convex.set(corner, false);
        self.candidates.set(corner, false);
        self.free(corner);
        // Corners can only become convex by clipping, as long as the outline is simple; a forced cut may do otherwise.
        for other in [before, after] {
            let convex = self.turn(other) == Ordering::Greater;
            if !convex && self.convex.is_set(other) {
                self.grid.late.push(other as u32);
            }
            self.convex.set(other, convex);
            self.candidates.set(other, convex);
            if convex {
                self.free(other);
            }
        }
    }

    /// Makes the corners in whose triangles a corner was found candidates again: it is no longer in their way.
    fn free(&mut self, corner: usize) {
        let mut at = std::mem::replace(&mut self.first_blocked[corner], NOTHING);
        while let Some(entry) = self.blocked.get_mut(at as usize) {
            let (blocked, next) = *entry;
            entry.1 = std::mem::replace(&mut self.unused, at);
            if self.convex.is_set(blocked as usize) {
                self.candidates.set(blocked as usize, true);
            }
            at = next;
        }
    }
}

/// Marks on corners, of which the next one is found fast.
struct Marks {
    words: Vec<u64>,
    /// For each word whether it has a mark.
    summary: Vec<u64>,
}

impl Marks {
    fn new(count: usize) -> Self {
        let words = count.div_ceil(64);
        Self { words: vec![0; words], summary: vec![0; words.div_ceil(64)] }
    }

    fn is_set(&self, corner: usize) -> bool {
        self.words[corner / 64] >> (corner % 64) & 1 == 1
    }

    fn set(&mut self, corner: usize, on: bool) {
        let word = &mut self.words[corner / 64];
        *word = *word & !(1 << (corner % 64)) | u64::from(on) << (corner % 64);
        let (slot, any) = (corner / 64, u64::from(*word != 0));
        let word = &mut self.summary[slot / 64];
        *word = *word & !(1 << (slot % 64)) | any << (slot % 64);
    }

    /// The first mark from a corner on, going round.
    fn next(&self, corner: usize) -> Option<usize> {
        self.from(corner).or_else(|| self.from(0))
    }

    fn from(&self, corner: usize) -> Option<usize> {
        let word = corner / 64;
        let here = self.words.get(word)? & (!0 << (corner % 64));
        if here != 0 {
            return Some(word * 64 + here.trailing_zeros() as usize);
        }
        let slot = word + 1;
        let mut at = slot / 64;
        let mut summary = self.summary.get(at)? & (!0 << (slot % 64));
        while summary == 0 {
            at += 1;
            summary = *self.summary.get(at)?;
        }
        let word = at * 64 + summary.trailing_zeros() as usize;
        Some(word * 64 + self.words[word].trailing_zeros() as usize)
    }
}

/// Corners by the cell of a square grid that they lie in.
#[derive(Default)]
struct Grid {
    low: DVec2,
    /// Cells to a unit in each direction; 0 where all corners are in line.
    scale: DVec2,
    side: usize,
    /// Where the corners of each cell start in `corners`.
    starts: Vec<u32>,
    corners: Vec<u32>,
    /// Corners that came later, in no cell.
    late: Vec<u32>,
}

impl Grid {
    /// About one corner a cell.
    fn new(outline: &[DVec2], members: Vec<u32>) -> Self {
        let bounds =
            outline.iter().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
        let side = (members.len() as f64).sqrt().ceil().clamp(1.0, 1024.0) as usize;
        let extent = bounds.1 - bounds.0;
        let per = |extent: f64| {
            let scale = side as f64 / extent;
            if scale.is_finite() { scale } else { 0.0 }
        };
        let scale = DVec2::new(per(extent.x), per(extent.y));
        let mut grid = Self { low: bounds.0, scale, side, ..Self::default() };
        let cells: Vec<usize> = members.iter().map(|&corner| grid.cell(outline[corner as usize])).collect();
        let mut starts = vec![0u32; side * side + 1];
        cells.iter().for_each(|&cell| starts[cell + 1] += 1);
        for cell in 0..side * side {
            starts[cell + 1] += starts[cell];
        }
        let mut next = starts.clone();
        grid.corners = vec![0; members.len()];
        for (&corner, &cell) in members.iter().zip(&cells) {
            grid.corners[next[cell] as usize] = corner;
            next[cell] += 1;
        }
        grid.starts = starts;
        grid
    }

    fn column_and_row(&self, point: DVec2) -> (usize, usize) {
        let at = (point - self.low) * self.scale;
        // Casts of numbers below 0 and of NaN give 0.
        ((at.x as usize).min(self.side - 1), (at.y as usize).min(self.side - 1))
    }

    fn cell(&self, point: DVec2) -> usize {
        let (column, row) = self.column_and_row(point);
        row * self.side + column
    }

    /// A corner in the cells of a box for which `is_it` holds.
    fn find(&self, low: DVec2, high: DVec2, mut is_it: impl FnMut(u32) -> bool) -> Option<u32> {
        if self.starts.is_empty() {
            return None;
        }
        let ((first, bottom), (last, top)) = (self.column_and_row(low), self.column_and_row(high));
        for row in bottom..=top {
            let cells = row * self.side + first..=row * self.side + last;
            let corners = self.starts[*cells.start()] as usize..self.starts[*cells.end() + 1] as usize;
            if let Some(&found) = self.corners[corners].iter().find(|&&corner| is_it(corner)) {
                return Some(found);
            }
        }
        self.late.iter().copied().find(|&corner| is_it(corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(outline: &[DVec2], triangles: &[[u32; 3]]) -> (f64, f64) {
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| outline[i as usize]);
            (b - a).perp_dot(c - a) / 2.0
        });
        (areas.clone().sum(), areas.fold(f64::INFINITY, f64::min))
    }

    fn clip(outline: &[DVec2]) -> (Vec<[u32; 3]>, bool) {
        let mut triangles = Vec::new();
        let simple = clip_ears(outline, &Exec::default(), &mut triangles).unwrap();
        assert_eq!(triangles.len(), outline.len() - 2);
        (triangles, simple)
    }

    #[test]
    fn corners_on_straight_sides_are_kept_without_flat_triangles() {
        let square: Vec<DVec2> = (0..40)
            .map(|i| {
                let t = f64::from(i % 10) / 10.0;
                [DVec2::new(t, 0.0), DVec2::new(1.0, t), DVec2::new(1.0 - t, 1.0), DVec2::new(0.0, 1.0 - t)]
                    [i as usize / 10]
            })
            .collect();
        let (triangles, simple) = clip(&square);
        let (total, smallest) = area(&square, &triangles);
        assert!(simple && (total - 1.0).abs() < 1e-14 && smallest > 1e-6);
    }

    #[test]
    fn stars_and_combs_are_covered_once() {
        for count in [5usize, 50, 1001] {
            let star: Vec<DVec2> = (0..2 * count)
                .map(|i| {
                    let angle = std::f64::consts::PI * i as f64 / count as f64;
                    DVec2::from_angle(angle) * if i % 2 == 0 { 1.0 } else { 0.3 }
                })
                .collect();
            let wanted = (0..star.len()).map(|i| star[i].perp_dot(star[(i + 1) % star.len()])).sum::<f64>() / 2.0;
            let (triangles, simple) = clip(&star);
            let (total, smallest) = area(&star, &triangles);
            assert!(simple && (total - wanted).abs() < 1e-12 && smallest > 0.0, "{count}");
        }
    }

    #[test]
    fn outlines_that_cross_themselves_are_said_to() {
        let bow = [DVec2::ZERO, DVec2::new(2.0, 2.0), DVec2::new(2.0, 0.0), DVec2::new(0.0, 1.0)];
        assert!(!clip(&bow).1);
        assert!(!clip(&[DVec2::ZERO; 6]).1);
        assert!(!clip(&[DVec2::ZERO, DVec2::X, DVec2::X * 2.0, DVec2::X * 3.0]).1);
        assert!(!clip(&[DVec2::NAN; 5]).1);
    }

    /// The same by walking around and looking at every corner each time.
    fn plainly(outline: &[DVec2]) -> Vec<[u32; 3]> {
        let mut ring: Vec<usize> = (0..outline.len()).collect();
        let (mut at, mut triangles) = (0, Vec::new());
        while ring.len() > 3 {
            let count = ring.len();
            let corners = |k: usize| [ring[(k + count - 1) % count], ring[k % count], ring[(k + 1) % count]];
            let turn = |k: usize| {
                let [a, b, c] = corners(k).map(|i| outline[i]);
                orient2d(a, b, c)
            };
            let convex = |k: &usize| turn(*k) == Ordering::Greater;
            let is_ear = |k: &usize| {
                let triangle = corners(*k).map(|i| outline[i]);
                let [a, b, c] = triangle;
                convex(k)
                    && !(0..count).filter(|other| !convex(other)).any(|other| {
                        let p = outline[ring[other]];
                        let inside = [(a, b), (b, c), (c, a)].iter().all(|&(a, b)| orient2d(a, b, p) != Ordering::Less);
                        !triangle.contains(&p) && inside
                    })
            };
            let around = || (0..count).map(|step| (at + step) % count);
            let cut = around().find(is_ear).or_else(|| around().find(convex)).unwrap_or(at);
            triangles.push(corners(cut).map(|i| i as u32));
            ring.remove(cut);
            at = (cut + 1) % ring.len();
        }
        let last = at % 3;
        triangles.push([ring[(last + 2) % 3], ring[last], ring[(last + 1) % 3]].map(|i| i as u32));
        triangles
    }

    /// Simple, crossing, touching and flat outlines give the triangles that a plain walk gives, in its order.
    #[test]
    fn ears_are_those_of_a_plain_walk() {
        let mut state = 5u64;
        let mut next = |bound: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % bound
        };
        for round in 0..400 {
            let count = 4 + next(70) as usize;
            let fine = if round % 3 == 0 { 6 } else { 1 << 20 };
            let outline: Vec<DVec2> = (0..count)
                .map(|k| match round % 4 {
                    // A star with random spikes.
                    0 | 1 => {
                        let angle = k as f64 / count as f64 * std::f64::consts::TAU;
                        DVec2::from_angle(angle) * (1 + next(fine)) as f64
                    }
                    _ => DVec2::new(next(fine) as f64, next(fine) as f64),
                })
                .collect();
            assert_eq!(clip(&outline).0, plainly(&outline), "{outline:?}");
        }
        // Nothing convex, and everything in one point.
        for outline in [vec![DVec2::ONE; 30], (0..30).map(|k| DVec2::new(f64::from(k), 0.0)).collect()] {
            assert_eq!(clip(&outline).0, plainly(&outline));
        }
    }

    #[test]
    fn marks_are_found_going_round() {
        let mut marks = Marks::new(20_000);
        assert_eq!(marks.next(7), None);
        for corner in [3, 64, 5000, 19_999] {
            marks.set(corner, true);
        }
        let found = [0, 3, 4, 64, 65, 5000, 5001, 19_999].map(|from| marks.next(from).unwrap());
        assert_eq!(found, [3, 3, 64, 64, 5000, 5000, 19_999, 19_999]);
        marks.set(19_999, false);
        assert_eq!((marks.next(5001), marks.is_set(64)), (Some(3), true));
    }
}
