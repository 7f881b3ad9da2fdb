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
/// all the same. Cost: corners times reflex corners, linear for convex outlines.
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
        work += 1 + ring.reflex.len();
        if work > 1 << 18 {
            exec.check()?;
            work = 0;
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

/// The corners that are left, as a ring, with those that are not convex listed.
struct Ring<'a> {
    outline: &'a [DVec2],
    previous: Vec<usize>,
    next: Vec<usize>,
    reflex: Vec<usize>,
}

impl<'a> Ring<'a> {
    fn new(outline: &'a [DVec2]) -> Self {
        let count = outline.len();
        let previous = (0..count).map(|i| (i + count - 1) % count).collect();
        let next = (0..count).map(|i| (i + 1) % count).collect();
        let mut ring = Self { outline, previous, next, reflex: Vec::new() };
        ring.reflex = (0..count).filter(|&corner| ring.turn(corner) != Ordering::Greater).collect();
        ring
    }

    fn turn(&self, corner: usize) -> Ordering {
        orient2d(self.outline[self.previous[corner]], self.outline[corner], self.outline[self.next[corner]])
    }

    /// Whether the corner is convex and its triangle holds no other corner, borders included.
    fn is_ear(&self, corner: usize) -> bool {
        let triangle = [self.previous[corner], corner, self.next[corner]].map(|i| self.outline[i]);
        let [a, b, c] = triangle;
        self.turn(corner) == Ordering::Greater
            && !self.reflex.iter().any(|&other| {
                let p = self.outline[other];
                !triangle.contains(&p)
                    && orient2d(a, b, p) != Ordering::Less
                    && orient2d(b, c, p) != Ordering::Less
                    && orient2d(c, a, p) != Ordering::Less
            })
    }

    fn clip(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        // Corners can only become convex by clipping, as long as the outline is simple; a forced cut may do otherwise.
        let outline = std::mem::take(&mut self.reflex);
        let mut reflex: Vec<usize> =
            outline.into_iter().filter(|&other| other != corner && other != before && other != after).collect();
        reflex.extend([before, after].into_iter().filter(|&other| self.turn(other) != Ordering::Greater));
        self.reflex = reflex;
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
