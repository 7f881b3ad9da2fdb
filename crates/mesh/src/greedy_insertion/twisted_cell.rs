//! Cells that two triangles cannot follow closely enough.

/// How a cell is cut so that its triangles are within |twist| / (4 steps²) of its surface: `steps` of 1 are two
/// triangles, of 2 four about the middle. More put a grid of `steps` by `steps` smaller cells inside, cut in two each, and
/// join it to the corners, so that the sides of the cell stay whole and neighbours need not know.
///
/// The grid begins at δ = 2 / (n (n + 1)) from the sides. A smaller cell, of side (1 − 2δ) / n, is within its own quarter,
/// |T| (1 − 2δ)² / (4n²). Of the triangles around it only the sides from corners of the cell deviate, by |T|·Δs·Δt / 4 in
/// their middles; they are δ by at most 1/2 + 1/(2n), as each point of the grid is joined to the nearer corner: that is
/// |T| / (4n²) at most.
pub(super) struct CellCut {
    steps: u32,
}

impl CellCut {
    /// The cut with the fewest steps that is within the tolerance for a cell of that twist, and at most `most` steps.
    pub(super) fn new(twist: f64, tolerance: f64, most: u32) -> Self {
        let wanted = (twist.abs() / 4.0 / tolerance).sqrt().ceil();
        let mut cut = Self { steps: if wanted <= f64::from(most) { (wanted as u32).max(2) - 1 } else { most } };
        // The root may be rounded past a whole number, either way.
        while cut.error(twist) > tolerance && cut.steps < most {
            cut.steps += 1;
        }
        cut
    }

    /// How far its triangles are from the surface at most.
    pub(super) fn error(&self, twist: f64) -> f64 {
        let steps = f64::from(self.steps);
        twist.abs() / (4.0 * steps * steps)
    }

    /// How many vertices it has beside the cell's corners, and how many triangles.
    pub(super) fn counts(&self) -> [u64; 2] {
        let n = u64::from(self.steps);
        match n {
            1 => [0, 2],
            2 => [1, 4],
            _ => [(n + 1) * (n + 1), 2 * n * n + 4 * (n + 1)],
        }
    }

    /// Its inner vertices in parts of the cell, row by row.
    pub(super) fn vertices(&self) -> Vec<[f64; 2]> {
        let n = f64::from(self.steps);
        match self.steps {
            1 => Vec::new(),
            2 => vec![[0.5, 0.5]],
            _ => {
                let first = 2.0 / (n * (n + 1.0));
                let at = |i: u32| first + (1.0 - 2.0 * first) * f64::from(i) / n;
                (0..=self.steps).flat_map(|j| (0..=self.steps).map(move |i| [at(i), at(j)])).collect()
            }
        }
    }

    /// Its triangles, counter-clockwise: 0 to 3 are the corners of the cell, going round; what follows are the vertices.
    pub(super) fn triangles(&self) -> Vec<[u32; 3]> {
        let n = self.steps;
        if n == 1 {
            return vec![[0, 1, 2], [0, 2, 3]];
        }
        if n == 2 {
            return vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
        }
        let inner = |i: u32, j: u32| 4 + j * (n + 1) + i;
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..n {
                let [a, b, c, d] = [inner(i, j), inner(i + 1, j), inner(i + 1, j + 1), inner(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        // Each side of the cell with the row of the grid beside it.
        for side in 0..4 {
            let row = |k: u32| match side {
                0 => inner(k, 0),
                1 => inner(n, k),
                2 => inner(n - k, n),
                _ => inner(0, n - k),
            };
            let (from, to) = (side, (side + 1) % 4);
            let middle = n / 2;
            triangles.extend((0..middle).map(|k| [from, row(k + 1), row(k)]));
            triangles.push([from, to, row(middle)]);
            triangles.extend((middle..n).map(|k| [to, row(k + 1), row(k)]));
        }
        triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    /// Against s·t at a lattice of points of every triangle; the triangles cover the cell once.
    #[test]
    fn every_cut_is_within_its_bound_and_covers_the_cell() {
        for steps in 1..=9u32 {
            let cut = CellCut::new(1.0, 0.25001 / f64::from(steps * steps), 100);
            assert_eq!(cut.steps, steps);
            let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
            let points: Vec<DVec2> = corners.into_iter().chain(cut.vertices().into_iter().map(DVec2::from)).collect();
            let triangles = cut.triangles();
            assert_eq!([points.len() as u64 - 4, triangles.len() as u64], cut.counts());
            let (mut area, mut worst) = (0.0, 0.0f64);
            for triangle in triangles {
                let [a, b, c] = triangle.map(|point| points[point as usize]);
                let doubled = (b - a).perp_dot(c - a);
                assert!(doubled > 0.0, "{steps} {triangle:?}");
                area += doubled / 2.0;
                for k in 0..=30 {
                    for l in 0..=30 - k {
                        let (u, v) = (f64::from(k) / 30.0, f64::from(l) / 30.0);
                        let p = a + (b - a) * u + (c - a) * v;
                        let flat = a.x * a.y * (1.0 - u - v) + b.x * b.y * u + c.x * c.y * v;
                        worst = worst.max((p.x * p.y - flat).abs());
                    }
                }
            }
            let bound = cut.error(1.0);
            assert!((area - 1.0).abs() < 1e-14 && worst <= bound && worst > 0.4 * bound, "{steps} {worst} {bound}");
        }
        assert_eq!(CellCut::new(1.0, 0.0, 7).steps, 7);
        assert_eq!(CellCut::new(0.0, 0.0, 7).steps, 7);
        assert_eq!(CellCut::new(1e-3, 1.0, 7).steps, 1);
    }

    #[test]
    fn tolerances_just_below_a_bound_take_one_step_more() {
        for steps in 1..=100u32 {
            let bound = CellCut { steps }.error(1.0);
            assert_eq!(CellCut::new(1.0, bound, 1000).steps, steps);
            assert_eq!(CellCut::new(1.0, bound.next_down(), 1000).steps, steps + 1);
        }
    }
}
