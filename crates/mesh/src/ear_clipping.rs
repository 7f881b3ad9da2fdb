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
/// What is left is a walk around the ring for each ear in the worst case, a few nanoseconds a step.
pub(crate) fn clip_ears(outline: &[DVec2], exec: &Exec, out: &mut Vec<[u32; 3]>) -> Result<bool, Stop> {
    let count = outline.len();
    if count < 3 {
        return Ok(false);
    }
    let mut ring = Ring::new(outline);
    let mut simple = true;
    let mut at = 0usize;
    let mut left = count;
    let mut tried = 0;
    let mut work = 0usize;
    while left > 3 {
        let forced = tried >= left;
        if forced {
            simple = false;
            at = ring.least_bad(at, left);
        }
        work += 1;
        if work > 1 << 14 || ring.looked_at > 1 << 18 {
            exec.check()?;
            work = 0;
            ring.looked_at = 0;
        }
        if forced || ring.is_ear(at) {
            out.push([ring.previous[at] as u32, at as u32, ring.next[at] as u32]);
            ring.clip(at);
            left -= 1;
            tried = 0;
            // Going on past the neighbour spreads the ears and avoids fans of slivers.
            at = ring.next[ring.next[at]];
        } else {
            tried += 1;
            at = ring.next[at];
        }
    }
    out.push([ring.previous[at] as u32, at as u32, ring.next[at] as u32]);
    Ok(simple && ring.turn(at) == Ordering::Greater)
}

/// The corners that are left, as a ring, with those that are not convex marked.
struct Ring<'a> {
    outline: &'a [DVec2],
    previous: Vec<usize>,
    next: Vec<usize>,
    reflex: Vec<bool>,
    /// For a corner that was found to be no ear, the reflex corner in its way.
    in_the_way: Vec<u32>,
    grid: Grid,
    /// How many reflex corners were looked at.
    looked_at: usize,
}

const NOTHING: u32 = u32::MAX;

impl<'a> Ring<'a> {
    fn new(outline: &'a [DVec2]) -> Self {
        let count = outline.len();
        let previous = (0..count).map(|i| (i + count - 1) % count).collect();
        let next = (0..count).map(|i| (i + 1) % count).collect();
        let in_the_way = vec![NOTHING; count];
        let mut ring =
            Self { outline, previous, next, reflex: Vec::new(), in_the_way, grid: Grid::default(), looked_at: 0 };
        ring.reflex = (0..count).map(|corner| ring.turn(corner) != Ordering::Greater).collect();
        let reflex = (0..count as u32).filter(|&corner| ring.reflex[corner as usize]);
        ring.grid = Grid::new(outline, reflex.collect());
        ring
    }

    fn turn(&self, corner: usize) -> Ordering {
        orient2d(self.outline[self.previous[corner]], self.outline[corner], self.outline[self.next[corner]])
    }

    /// Whether the corner is convex and its triangle holds no other corner, borders included.
    fn is_ear(&mut self, corner: usize) -> bool {
        if self.reflex[corner] {
            return false;
        }
        if let Some(true) = self.reflex.get(self.in_the_way[corner] as usize) {
            return false;
        }
        let triangle = [self.previous[corner], corner, self.next[corner]].map(|i| self.outline[i]);
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let (outline, reflex, looked_at) = (self.outline, &self.reflex, &mut self.looked_at);
        let inside = |other: u32| {
            *looked_at += 1;
            let p = outline[other as usize];
            let near = low.x <= p.x && p.x <= high.x && low.y <= p.y && p.y <= high.y;
            near && reflex[other as usize]
                && !triangle.contains(&p)
                && orient2d(a, b, p) != Ordering::Less
                && orient2d(b, c, p) != Ordering::Less
                && orient2d(c, a, p) != Ordering::Less
        };
        let found = self.grid.find(low, high, inside);
        self.in_the_way[corner] = found.unwrap_or(NOTHING);
        found.is_none()
    }

    fn clip(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.reflex[corner] = false;
        // Corners can only become convex by clipping, as long as the outline is simple; a forced cut may do otherwise.
        for other in [before, after] {
            let reflex = self.turn(other) != Ordering::Greater;
            if reflex && !self.reflex[other] {
                self.grid.late.push(other as u32);
            }
            self.reflex[other] = reflex;
            self.in_the_way[other] = NOTHING;
        }
    }

    /// The first convex corner from `at` on, or `at` if there is none.
    fn least_bad(&self, at: usize, left: usize) -> usize {
        let mut corner = at;
        for _ in 0..left {
            if self.turn(corner) == Ordering::Greater {
                return corner;
            }
            corner = self.next[corner];
        }
        at
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
}
