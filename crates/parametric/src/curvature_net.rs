//! Control nets of second derivatives, for bounds over parts of a patch.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Interval, VectorSpace};

use crate::{BezierPatch, SecondDerivativeBounds, de_casteljau};

/// A net of vectors in Bernstein form.
#[derive(Clone, Debug)]
struct Net {
    width: usize,
    vectors: Vec<DVec3>,
    longest: f64,
    /// A bound of how far forming and restricting the vectors rounds them.
    rounding: f64,
}

impl Net {
    /// `size` is the largest coordinate of the control points, `factor` what differences are multiplied with.
    fn new(width: usize, vectors: Vec<DVec3>, size: f64, factor: f64) -> Self {
        let longest = longest(&vectors);
        // A second difference of rounded points is off by a few units in the last place of the points. Restriction to
        // a part is up to four triangular schemes, each of which adds a unit or so for each of its rounds.
        let rounds = (width + vectors.len() / width.max(1)) as f64;
        let rounding = 8.0 * f64::EPSILON * (factor * size + rounds * longest);
        Self { width, vectors, longest, rounding }
    }

    /// Bounds the length over the whole domain.
    fn whole(&self) -> f64 {
        self.longest + self.rounding
    }

    /// Restricts the net in v, into `strip`.
    fn restrict_v(&self, v: Interval, strip: &mut Vec<DVec3>, column: &mut Vec<DVec3>) {
        strip.clear();
        strip.extend_from_slice(&self.vectors);
        if self.longest == 0.0 {
            return;
        }
        for i in 0..self.width {
            column.clear();
            column.extend(self.vectors.iter().skip(i).step_by(self.width));
            de_casteljau::restrict(column, v.lo, v.hi);
            for (slot, &vector) in strip.iter_mut().skip(i).step_by(self.width).zip(column.iter()) {
                *slot = vector;
            }
        }
    }

    /// Bounds the length over a part of the domain, from the net as it was restricted in v.
    fn bound(&self, u: Interval, strip: &[DVec3], row: &mut Vec<DVec3>) -> f64 {
        if self.longest == 0.0 {
            return self.rounding;
        }
        let mut most = 0.0f64;
        for source in strip.chunks_exact(self.width) {
            row.clear();
            row.extend_from_slice(source);
            de_casteljau::restrict(row, u.lo, u.hi);
            most = most.max(longest(row));
        }
        most + self.rounding
    }
}

fn longest(vectors: &[DVec3]) -> f64 {
    let squares = vectors.iter().map(|vector| vector.length_squared()).fold(0.0, f64::max);
    if (1e-280..1e280).contains(&squares) {
        return squares.sqrt();
    }
    // Squares that vanish or overflow say nothing of the lengths.
    vectors.iter().map(|&vector| VectorSpace::length(vector)).fold(0.0, f64::max)
}

/// Space for [`CurvatureNets::bounds`] to work in. It keeps the nets as they were last restricted in v: pieces of a patch
/// come row by row. Used with one patch only.
#[derive(Default)]
pub(crate) struct Scratch {
    v: Option<Interval>,
    strips: [Vec<DVec3>; 3],
    line: Vec<DVec3>,
}

/// The second partial derivatives of a patch in Bernstein form.
pub(crate) struct CurvatureNets {
    uu: Net,
    uv: Net,
    vv: Net,
}

impl CurvatureNets {
    pub(crate) fn new(patch: &BezierPatch) -> Self {
        let (m, n) = (patch.degree_u(), patch.degree_v());
        let size = patch.control_points().iter().map(|point| point.abs().max_element()).fold(0.0, f64::max);
        let net = |along_u: usize, along_v: usize| {
            if m < along_u || n < along_v {
                return Net::new(1, Vec::new(), 0.0, 0.0);
            }
            let factor = falling(m, along_u) * falling(n, along_v);
            let mut vectors = Vec::with_capacity((m + 1 - along_u) * (n + 1 - along_v));
            for j in 0..=n - along_v {
                for i in 0..=m - along_u {
                    let at = |di: usize, dj: usize| patch.control_point(i + di, j + dj);
                    let difference = match (along_u, along_v) {
                        (2, 0) => (at(0, 0) - at(1, 0)) + (at(2, 0) - at(1, 0)),
                        (0, 2) => (at(0, 0) - at(0, 1)) + (at(0, 2) - at(0, 1)),
                        _ => (at(1, 1) - at(0, 1)) - (at(1, 0) - at(0, 0)),
                    };
                    vectors.push(difference * factor);
                }
            }
            Net::new(m + 1 - along_u, vectors, size, factor)
        };
        Self { uu: net(2, 0), uv: net(1, 1), vv: net(0, 2) }
    }

    /// How many multiplications [`CurvatureNets::bounds`] takes, roughly.
    pub(crate) fn work(&self) -> usize {
        let net = &self.uv;
        let height = net.vectors.len() / net.width.max(1);
        64 + 6 * net.vectors.len() * (net.width + height)
    }

    /// Bounds over the whole patch.
    pub(crate) fn whole(&self) -> SecondDerivativeBounds {
        SecondDerivativeBounds { uu: self.uu.whole(), uv: self.uv.whole(), vv: self.vv.whole() }
    }

    /// Bounds over a part of the patch.
    pub(crate) fn bounds(&self, u: Interval, v: Interval, scratch: &mut Scratch) -> SecondDerivativeBounds {
        let Scratch { v: last, strips, line } = scratch;
        let nets = [&self.uu, &self.uv, &self.vv];
        if *last != Some(v) {
            for (net, strip) in nets.iter().zip(strips.iter_mut()) {
                net.restrict_v(v, strip, line);
            }
            *last = Some(v);
        }
        let mut bound = |k: usize| nets[k].bound(u, &strips[k], line);
        SecondDerivativeBounds { uu: bound(0), uv: bound(1), vv: bound(2) }
    }
}

/// `n · (n - 1) ⋯` with `factors` factors.
fn falling(n: usize, factors: usize) -> f64 {
    (0..factors).map(|k| (n - k) as f64).product()
}

impl SecondDerivativeBounds {
    /// How far a triangle may be from the surface it interpolates, over any parameter triangle in a box of that width
    /// and height.
    ///
    /// Let p be a point of the triangle with barycentric weights λᵢ, dᵢ the steps from p to its corners, H a bound of
    /// the second derivative. By Taylor's theorem with the integral remainder the distance is at most
    /// ½ Σ λᵢ (uu·duᵢ² + 2·uv·|duᵢ·dvᵢ| + vv·dvᵢ²). Σ λᵢ duᵢ² is a variance over an interval of length `width`, hence at
    /// most width²/4 (Popoviciu), and the mixed term follows by Cauchy and Schwarz. For right triangles this is the
    /// bound of Filip, Magedson and Markot (1986).
    pub(crate) fn chord_error(&self, width: f64, height: f64) -> f64 {
        (self.uu * width * width + 2.0 * self.uv * width * height + self.vv * height * height) / 8.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Surface;

    fn wavy() -> BezierPatch {
        let control = (0..20)
            .map(|k| {
                let (i, j) = (f64::from(k % 5), f64::from(k / 5));
                DVec3::new(i + 0.2 * (j * 1.7).sin(), j, (i * 1.3).cos() * (j * 0.9).sin() * 2.0)
            })
            .collect();
        BezierPatch::try_new(4, 3, control).unwrap()
    }

    #[test]
    fn bounds_hold_over_every_part_and_tighten() {
        let (patch, mut scratch) = (wavy(), Scratch::default());
        let nets = CurvatureNets::new(&patch);
        let whole = nets.whole();
        for cut in 0..16 {
            let (i, j) = (f64::from(cut % 4) / 4.0, f64::from(cut / 4) / 4.0);
            let (u, v) = (Interval::new(i, i + 0.25), Interval::new(j, j + 0.25));
            let bounds = nets.bounds(u, v, &mut scratch);
            let mut largest = SecondDerivativeBounds { uu: 0.0, uv: 0.0, vv: 0.0 };
            for sample in 0..121 {
                let jet = patch.jet(u.at(f64::from(sample % 11) / 10.0), v.at(f64::from(sample / 11) / 10.0));
                largest.uu = largest.uu.max(jet.duu.length());
                largest.uv = largest.uv.max(jet.duv.length());
                largest.vv = largest.vv.max(jet.dvv.length());
            }
            for (bound, found) in [(bounds.uu, largest.uu), (bounds.uv, largest.uv), (bounds.vv, largest.vv)] {
                assert!(found <= bound && bound < 1.5 * found, "{cut}: {bound} {found}");
            }
            let slack = 1.0 + 1e-12;
            assert!(bounds.uu <= slack * whole.uu && bounds.uv <= slack * whole.uv && bounds.vv <= slack * whole.vv);
        }
    }

    /// The bound against the true error of triangles of every shape over a quadratic, where it can be met.
    #[test]
    fn chord_error_bounds_triangles_of_any_shape_and_is_met() {
        let bowl = |p: [f64; 2]| p[0] * p[0] + p[1] * p[1];
        let bounds = SecondDerivativeBounds { uu: 2.0, uv: 0.0, vv: 2.0 };
        let mut closest = 0.0f64;
        for code in 0..4096u32 {
            let at = |k: u32| [f64::from(code >> (2 * k) & 3) / 3.0, f64::from(code >> (2 * k + 1) & 3) / 3.0];
            let corners = [at(0), at(2), at(4)];
            let extent = |axis: usize| {
                let coordinates = corners.map(|corner| corner[axis]);
                coordinates.iter().fold(0.0, |m: f64, &x| m.max(x))
                    - coordinates.iter().fold(1.0, |m: f64, &x| m.min(x))
            };
            let bound = bounds.chord_error(extent(0), extent(1));
            for weight in 0..66u32 {
                let (a, b) = (f64::from(weight % 11) / 10.0, f64::from(weight / 11) / 10.0);
                let weights = [a, b * (1.0 - a), (1.0 - b) * (1.0 - a)];
                let mix = |f: &dyn Fn([f64; 2]) -> f64| (0..3).map(|k| weights[k] * f(corners[k])).sum::<f64>();
                let p = [mix(&|c| c[0]), mix(&|c| c[1])];
                let error = (mix(&bowl) - bowl(p)).abs();
                assert!(error <= bound + 1e-15, "{corners:?}");
                closest = closest.max(if bound > 0.0 { error / bound } else { 0.0 });
            }
        }
        assert!(closest > 0.999);
    }
}
