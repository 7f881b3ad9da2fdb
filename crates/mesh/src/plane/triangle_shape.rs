//! What refinement looks at in a triangle.

use shapeloom_core::glam::DVec2;

use super::scale::flushed;

/// What decides about a triangle.
pub(crate) struct Shape {
    /// The square of the sine of the smallest angle.
    pub(crate) sine_squared: f64,
    /// The root of the area.
    pub(crate) side: f64,
    /// The corner from which the shortest side leads to the next.
    pub(super) shortest: usize,
    /// The square of its length.
    pub(super) shortest_squared: f64,
}

impl Shape {
    pub(crate) fn of(corners: [DVec2; 3]) -> Self {
        let squared = [0, 1, 2].map(|k: usize| corners[k].distance_squared(corners[(k + 1) % 3]));
        let shortest = (0..3).min_by(|&a, &b| squared[a].total_cmp(&squared[b])).unwrap_or(0);
        let twice = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
        let others = squared[(shortest + 1) % 3] * squared[(shortest + 2) % 3];
        let sine_squared = if others > 0.0 { (twice * twice / others).min(0.75) } else { 0.0 };
        Self { sine_squared, side: (0.5 * twice.abs()).sqrt(), shortest, shortest_squared: squared[shortest] }
    }
}

/// The circumcentre; none where it is not finite or too far away to be a vertex.
pub(super) fn circumcenter([a, b, c]: [DVec2; 3]) -> Option<DVec2> {
    let (b, c) = (b - a, c - a);
    let twice = 2.0 * b.perp_dot(c);
    let (bb, cc) = (b.length_squared(), c.length_squared());
    let center = a + DVec2::new(c.y * bb - b.y * cc, b.x * cc - c.x * bb) / twice;
    (center.is_finite() && center.abs().max_element() < FARTHEST).then_some(flushed(center))
}

/// Coordinates that the triangulation takes; its own come to lie far below.
const FARTHEST: f64 = f64::from_bits((1023 + 200) << 52);
