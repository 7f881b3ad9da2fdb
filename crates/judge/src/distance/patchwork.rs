//! A bound over a piece that lies along several triangles of the other shape: the piece is cut along their borders in
//! thought, without looking for closest points.

use shapeloom_core::glam::DVec3;

use super::foot::distance_to_triangle;

/// How many cuts are made one after the other.
const CUTS: usize = 6;
/// The most corners of a polygon: three, and one more for each cut.
const CORNERS: usize = 3 + CUTS;

/// What rounding can do to the corners of cuts, in scaled units, in all.
pub(super) const DRIFT: f64 = CUTS as f64 / (1u64 << 50) as f64;

/// A convex polygon in a plane, or a segment or point.
#[derive(Clone, Copy, Debug)]
struct Polygon {
    corners: [DVec3; CORNERS],
    count: usize,
}

impl Polygon {
    fn new(corners: &[DVec3]) -> Self {
        let mut all = [DVec3::ZERO; CORNERS];
        all[..corners.len()].copy_from_slice(corners);
        Self { corners: all, count: corners.len() }
    }

    fn corners(&self) -> &[DVec3] {
        &self.corners[..self.count]
    }

    /// The parts below and above a plane; none where rounding gives a part more corners than it can have.
    fn split(&self, heights: &[f64; CORNERS]) -> Option<[Self; 2]> {
        let mut parts = [Self::new(&[]); 2];
        let mut add = |part: usize, corner: DVec3| {
            let part: &mut Self = &mut parts[part];
            *part.corners.get_mut(part.count)? = corner;
            part.count += 1;
            Some(())
        };
        for (i, &corner) in self.corners().iter().enumerate() {
            let next = if i + 1 < self.count { i + 1 } else { 0 };
            let (here, there) = (heights[i], heights[next]);
            if here <= 0.0 {
                add(0, corner)?;
            }
            if here >= 0.0 {
                add(1, corner)?;
            }
            if (here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0) {
                let cut = corner + (self.corners[next] - corner) * (here / (here - there));
                add(0, cut)?;
                add(1, cut)?;
            }
        }
        Some(parts)
    }
}

/// Some triangles near a piece.
pub(super) struct Patchwork<'a> {
    pub triangles: &'a [[DVec3; 3]],
    /// A bound that is low enough.
    pub enough: f64,
}

impl Patchwork<'_> {
    /// No point of the convex hull of `corners` is farther from the triangles than this and [`DRIFT`].
    pub fn bound(&self, corners: &[DVec3; 3]) -> f64 {
        self.bound_of(&Polygon::new(corners), CUTS)
    }

    fn bound_of(&self, polygon: &Polygon, cuts: usize) -> f64 {
        let (mut least, mut nearest) = (f64::INFINITY, &[DVec3::ZERO; 3]);
        for triangle in self.triangles {
            let mut most = 0.0f64;
            for &corner in polygon.corners() {
                most = most.max(distance_to_triangle(triangle, corner));
                if most >= least {
                    break;
                }
            }
            if most < least {
                (least, nearest) = (most, triangle);
            }
        }
        if least <= self.enough || cuts == 0 {
            return least;
        }
        let Some([below, above]) = outermost(polygon, nearest).and_then(|heights| polygon.split(&heights)) else {
            return least;
        };
        // The part outside first: if that is not covered nothing is won.
        let outside = self.bound_of(&above, cuts - 1);
        if outside > self.enough {
            return least;
        }
        least.min(outside.max(self.bound_of(&below, cuts - 1)))
    }
}

/// The heights of a polygon's corners above the plane, upright on a triangle along one of its sides, that has most of
/// the polygon above; none where no side has some above and some below.
fn outermost(polygon: &Polygon, triangle: &[DVec3; 3]) -> Option<[f64; CORNERS]> {
    let sides = [0, 1, 2].map(|i| triangle[(i + 1) % 3] - triangle[i]);
    let normal = sides[0].cross(-sides[2]);
    let mut best: Option<(f64, [f64; CORNERS])> = None;
    for i in 0..3 {
        let Some(outward) = sides[i].cross(normal).try_normalize() else { continue };
        let mut heights = [0.0; CORNERS];
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (height, &corner) in heights.iter_mut().zip(polygon.corners()) {
            *height = (corner - triangle[i]).dot(outward);
            (low, high) = (low.min(*height), high.max(*height));
        }
        let least = (high - low) * 1e-6;
        if low < -least && high > least && best.is_none_or(|(most, _)| high > most) {
            best = Some((high, heights));
        }
    }
    best.map(|(_, heights)| heights)
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS_OF_SQUARE: [DVec3; 4] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 0.0)];

    #[test]
    fn a_piece_over_two_triangles_is_as_far_as_their_plane() {
        let [a, b, c, d] = CORNERS_OF_SQUARE;
        let triangles = [[a, b, c], [a, c, d]];
        let piece = [DVec3::new(0.9, 0.1, 0.01), DVec3::new(0.1, 0.9, 0.02), DVec3::new(0.8, 0.9, 0.015)];
        let both = Patchwork { triangles: &triangles, enough: 0.0201 }.bound(&piece);
        assert!((0.02..0.02 + 1e-12).contains(&both), "{both}");
        // One of them alone leaves a corner far outside.
        let one = Patchwork { triangles: &triangles[..1], enough: 0.0201 }.bound(&piece);
        assert!(one > 0.5, "{one}");
        // A piece beyond both is as far as its farthest corner, however it is cut.
        let beyond = piece.map(|corner| corner + DVec3::X * 0.5);
        let found = Patchwork { triangles: &triangles, enough: 0.1 }.bound(&beyond);
        assert!(found >= 0.4, "{found}");
    }

    #[test]
    fn parts_have_the_whole_between_them() {
        let polygon = Polygon::new(&CORNERS_OF_SQUARE);
        let mut heights = [0.0; CORNERS];
        polygon.corners().iter().zip(&mut heights).for_each(|(corner, height)| *height = corner.x + corner.y - 0.5);
        let [below, above] = polygon.split(&heights).unwrap();
        assert_eq!((below.count, above.count), (3, 5));
        let area = |polygon: &Polygon| {
            let corners = polygon.corners();
            (1..corners.len() - 1)
                .map(|i| (corners[i] - corners[0]).cross(corners[i + 1] - corners[0]).length() / 2.0)
                .sum::<f64>()
        };
        assert_eq!((area(&below), area(&above)), (0.125, 0.875));
    }
}
