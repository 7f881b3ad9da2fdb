//! Whether a triangle meets a cube.

use shapeloom_core::glam::DVec3;

/// A triangle prepared for tests against unit cubes around whole numbers: the separating axis test (Akenine-Möller 2001, Fast 3D
/// triangle-box overlap testing), with axes and offsets computed once for all cubes (Schwarz and Seidel 2010).
///
/// Conservative: rounding never makes it miss a cube that the closed triangle touches; cubes that it misses by some 1e-14 of the
/// coordinates may count as met.
pub(crate) struct Overlap {
    /// The box around the triangle, from the centre of the first cube that it touches to that of the last.
    low: DVec3,
    high: DVec3,
    /// Axes with what the triangle and the cube's half extent span on each: a cube at `c` is apart where `axis · c` is outside.
    axes: [(DVec3, f64, f64); 10],
}

impl Overlap {
    pub fn new(corners: &[DVec3; 3]) -> Self {
        let [a, b, c] = *corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        // What rounding may do: a few ulps of the largest number at hand.
        let largest = low.abs().max(high.abs()).max_element() + 1.0;
        let slack = largest * 2f64.powi(-46);
        let edges = [b - a, c - b, a - c];
        let normal = edges[0].cross(edges[1]);
        let mut axes = [(DVec3::ZERO, 0.0, 0.0); 10];
        let crosses = edges.into_iter().flat_map(|edge| DVec3::AXES.map(|axis| axis.cross(edge)));
        for (place, axis) in axes.iter_mut().zip(std::iter::once(normal).chain(crosses)) {
            // Axes of length 1 at most: the slack is one of lengths, whatever the triangle's size. An axis of nothing parts nothing.
            let axis = axis / axis.abs().max_element().max(f64::MIN_POSITIVE);
            let spans = corners.map(|corner| axis.dot(corner));
            let half = 0.5 * (axis.x.abs() + axis.y.abs() + axis.z.abs()) + 4.0 * slack;
            *place = (axis, spans[0].min(spans[1]).min(spans[2]) - half, spans[0].max(spans[1]).max(spans[2]) + half);
        }
        Self { low: low - 0.5 - slack, high: high + 0.5 + slack, axes }
    }

    /// The corners of the box in which cubes can meet the triangle.
    pub fn bounds(&self) -> [DVec3; 2] {
        [self.low, self.high]
    }

    /// From where to where centres in a row can be near the triangle's plane; all of it where the plane is along the row.
    pub fn row(&self, y: f64, z: f64) -> (f64, f64) {
        let (normal, low, high) = self.axes[0];
        if normal.x.abs() < 1e-3 {
            return (f64::NEG_INFINITY, f64::INFINITY);
        }
        let across = normal.y * y + normal.z * z;
        let (a, b) = ((low - across) / normal.x, (high - across) / normal.x);
        // What rounding may do to a quotient is far below a thousandth of a cell; the test decides.
        let slack = 1e-3 + 1e-12 * (a.abs() + b.abs());
        (a.min(b) - slack, a.max(b) + slack)
    }

    /// Whether a cube whose centre lies in [`Overlap::bounds`] meets the triangle.
    pub fn meets(&self, center: DVec3) -> bool {
        self.axes.iter().all(|&(axis, low, high)| {
            let at = axis.dot(center);
            at >= low && at <= high
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixtures::Dice;

    /// The separating axis test in whole numbers, exact: everything times 2, so that cubes reach from -1 to 1.
    fn meets_exactly(corners: [[i64; 3]; 3], center: [i64; 3]) -> bool {
        let p = corners.map(|corner| [0, 1, 2].map(|k| corner[k] - center[k]));
        let sub = |a: [i64; 3], b: [i64; 3]| [0, 1, 2].map(|k| a[k] - b[k]);
        let cross = |a: [i64; 3], b: [i64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot = |a: [i64; 3], b: [i64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let edges = [sub(p[1], p[0]), sub(p[2], p[1]), sub(p[0], p[2])];
        let units = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
        let mut axes = units.to_vec();
        axes.push(cross(edges[0], edges[1]));
        axes.extend(edges.iter().flat_map(|&edge| units.map(|unit| cross(unit, edge))));
        axes.into_iter().all(|axis| {
            let spans = p.map(|corner| dot(axis, corner));
            let half: i64 = axis.iter().map(|x| x.abs()).sum();
            spans.iter().min() <= Some(&half) && spans.iter().max() >= Some(&-half)
        })
    }

    #[test]
    fn cubes_met_are_those_of_exact_integers() {
        let mut dice = Dice(5);
        let (mut met, mut apart) = (0, 0);
        for round in 0..20_000 {
            let range = if round % 2 == 0 { 9 } else { 31 };
            let mut draw = || [0; 3].map(|_: i64| (dice.next() % range) as i64 - range as i64 / 2);
            let corners = [draw(), draw(), draw()];
            let center = draw().map(|x| x / 4 * 2);
            let exact = meets_exactly(corners, center);
            let half = |p: [i64; 3]| DVec3::from_array(p.map(|x| x as f64 / 2.0));
            let overlap = Overlap::new(&corners.map(half));
            let [low, high] = overlap.bounds();
            let center = half(center);
            let found = center.cmpge(low).all() && center.cmple(high).all() && overlap.meets(center);
            assert_eq!(found, exact, "{corners:?} {center}");
            met += u32::from(exact);
            apart += u32::from(!exact);
        }
        assert!(met > 2000 && apart > 2000, "{met} {apart}");
    }
}
