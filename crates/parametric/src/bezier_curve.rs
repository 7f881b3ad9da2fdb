//! Bézier curves.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine, Curve, Interval, VectorSpace};

use crate::BezierError;
use crate::bounds::tight_bounds;
use crate::de_casteljau::{self, MAX_DEGREE};

/// A Bézier curve of any degree up to 255 over `[0, 1]`, in the plane or in space.
///
/// It starts at the first and ends at the last control point, tangent to the first and last leg, and lies in the convex
/// hull of the control points. Evaluation is de Casteljau's: exact at both ends, stable, quadratic in the degree.
#[derive(Clone, Debug, PartialEq)]
pub struct BezierCurve<P> {
    control: Vec<P>,
}

impl<P: VectorSpace> BezierCurve<P> {
    /// The curve with these control points; one more than the degree.
    ///
    /// # Errors
    /// No control points, more than 256, or one that is not finite.
    pub fn try_new(control: Vec<P>) -> Result<Self, BezierError> {
        if control.is_empty() {
            return Err(BezierError::Empty);
        }
        if control.len() > MAX_DEGREE + 1 {
            return Err(BezierError::Degree { found: control.len() - 1, max: MAX_DEGREE });
        }
        match control.iter().position(|point| !point.is_finite()) {
            Some(index) => Err(BezierError::NotFinite { index }),
            None => Ok(Self { control }),
        }
    }

    /// The control points.
    pub fn control_points(&self) -> &[P] {
        &self.control
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.control.len() - 1
    }

    /// The parts before and after `t` in `[0, 1]` (subdivision).
    pub fn split(&self, t: f64) -> (Self, Self) {
        let mut before = self.control.clone();
        let after = de_casteljau::split(&mut before, t);
        (Self { control: before }, Self { control: after })
    }

    /// The part over `[a, b]` within `[0, 1]`, over `[0, 1]` anew.
    #[must_use]
    pub fn segment(&self, a: f64, b: f64) -> Self {
        let mut control = self.control.clone();
        de_casteljau::restrict(&mut control, a, b);
        Self { control }
    }

    /// The same curve run through backwards.
    #[must_use]
    pub fn reversed(&self) -> Self {
        Self { control: self.control.iter().rev().copied().collect() }
    }

    /// The same curve with one control point more.
    ///
    /// # Errors
    /// The degree is the largest already.
    pub fn elevated(&self) -> Result<Self, BezierError> {
        let count = self.control.len();
        if count > MAX_DEGREE {
            return Err(BezierError::Degree { found: count, max: MAX_DEGREE });
        }
        let mut control = Vec::with_capacity(count + 1);
        control.push(self.control[0]);
        for i in 1..count {
            let share = i as f64 / count as f64;
            control.push(self.control[i - 1] * share + self.control[i] * (1.0 - share));
        }
        control.push(self.control[count - 1]);
        Ok(Self { control })
    }

    /// A curve of one degree less with the same ends, and a bound of how far apart the two are at equal parameters.
    ///
    /// The control points are found from both ends (Forrest 1972); a curve that was elevated comes back, up to
    /// rounding. The bound is the largest distance between the control points after elevation: a convex combination
    /// of them is the difference of the curves.
    ///
    /// # Errors
    /// The degree is below 2: there is nothing to leave out between the ends.
    pub fn reduced(&self) -> Result<(Self, f64), BezierError> {
        let degree = self.degree();
        if degree < 2 {
            return Err(BezierError::Count { degree_u: 2, degree_v: 0, found: self.control.len() });
        }
        let n = degree as f64;
        // From the front, c_i = (n·b_i - i·c_(i-1)) / (n - i); from the back likewise.
        let (mut front, mut back) = (vec![self.control[0]; degree], vec![self.control[degree]; degree]);
        for i in 1..degree {
            let k = i as f64;
            front[i] = (self.control[i] * n - front[i - 1] * k) * (1.0 / (n - k));
            let j = degree - 1 - i;
            back[j] = (self.control[j + 1] * n - back[j + 1] * k) * (1.0 / (n - k));
        }
        // Each recursion is good near its own end; the middle of an odd degree takes both.
        let control = (0..degree)
            .map(|i| match (2 * i).cmp(&(degree - 1)) {
                std::cmp::Ordering::Less => front[i],
                std::cmp::Ordering::Equal => (front[i] + back[i]) * 0.5,
                std::cmp::Ordering::Greater => back[i],
            })
            .collect();
        let reduced = Self { control };
        let again = reduced.elevated()?;
        let apart = again.control.iter().zip(&self.control).map(|(&a, &b)| (a - b).length()).fold(0.0, f64::max);
        Ok((reduced, apart))
    }

    /// The derivative as a curve of one degree less; a point at zero for degree 0.
    #[must_use]
    pub fn hodograph(&self) -> Self {
        let mut control = self.control.clone();
        let count = de_casteljau::hodograph(&mut control);
        control.truncate(count);
        if control.is_empty() {
            control.push(P::ZERO);
        }
        Self { control }
    }

    /// A bound of the length of the second derivative over the whole curve: `n(n-1)` times the longest second
    /// difference of the control points (the second derivative lies in their convex hull).
    pub fn second_derivative_bound(&self) -> f64 {
        let n = self.degree() as f64;
        let longest = self.control.windows(3).map(|w| ((w[0] - w[1]) + (w[2] - w[1])).length()).fold(0.0, f64::max);
        n * (n - 1.0).max(0.0) * longest
    }

    /// The box around the control points, which holds the curve.
    pub fn hull_bounds(&self) -> Aabb {
        Aabb::from_points(self.control.iter().map(|point| point.to_space()))
    }

    /// The box of the curve itself: it holds the curve, and is larger by at most a billionth of its size.
    pub fn bounds(&self) -> Aabb {
        let control: Vec<DVec3> = self.control.iter().map(|point| point.to_space()).collect();
        tight_bounds([(control.len(), control.as_slice())])
    }

    /// The length of the control polygon, which is no less than the curve's.
    pub fn polygon_length(&self) -> f64 {
        self.control.windows(2).map(|pair| (pair[1] - pair[0]).length()).sum()
    }
}

impl BezierCurve<DVec3> {
    /// The image under an affine map: the curve of the mapped control points.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self { control: self.control.iter().map(|&point| map.point(point)).collect() }
    }
}

impl<P: VectorSpace> Curve<P> for BezierCurve<P> {
    fn domain(&self) -> Interval {
        Interval::UNIT
    }

    fn point(&self, t: f64) -> P {
        de_casteljau::evaluate(&mut self.control.clone(), t)
    }

    fn derivatives(&self, t: f64, out: &mut [P]) {
        let mut control = self.control.clone();
        for value in out {
            *value = if control.is_empty() { P::ZERO } else { de_casteljau::evaluate(&mut control.clone(), t) };
            let count = if control.is_empty() { 0 } else { de_casteljau::hodograph(&mut control) };
            control.truncate(count);
        }
    }

    fn points(&self, parameters: &[f64], out: &mut [P]) {
        assert_eq!(parameters.len(), out.len(), "slices of one length");
        let mut scratch = self.control.clone();
        for (&t, point) in parameters.iter().zip(out) {
            scratch.copy_from_slice(&self.control);
            *point = de_casteljau::evaluate(&mut scratch, t);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    fn cubic() -> BezierCurve<DVec2> {
        BezierCurve::try_new([(0.0, 0.0), (1.0, 2.0), (3.0, 2.0), (4.0, -1.0)].map(DVec2::from).to_vec()).unwrap()
    }

    /// The Bernstein form in closed form.
    fn bernstein(control: &[DVec2], t: f64) -> DVec2 {
        let n = control.len() - 1;
        let mut binomial = 1.0;
        let mut sum = DVec2::ZERO;
        for (i, &point) in control.iter().enumerate() {
            sum += point * (binomial * t.powi(i as i32) * (1.0 - t).powi((n - i) as i32));
            binomial *= (n - i) as f64 / (i + 1) as f64;
        }
        sum
    }

    #[test]
    fn points_are_the_bernstein_form() {
        let curve = cubic();
        for i in 0..=10 {
            let t = f64::from(i) / 10.0;
            assert!((curve.point(t) - bernstein(curve.control_points(), t)).length() < 1e-15);
        }
        let long: Vec<DVec2> = (0..=40).map(|i| DVec2::from_angle(f64::from(i) * 0.3)).collect();
        let curve = BezierCurve::try_new(long.clone()).unwrap();
        assert!((curve.point(0.37) - bernstein(&long, 0.37)).length() < 1e-13);
    }

    #[test]
    fn derivatives_are_those_of_the_power_basis() {
        // (t, t², t³) as a cubic: derivatives in closed form.
        let control = [(0.0, 0.0, 0.0), (1.0 / 3.0, 0.0, 0.0), (2.0 / 3.0, 1.0 / 3.0, 0.0), (1.0, 1.0, 1.0)];
        let curve = BezierCurve::try_new(control.map(DVec3::from).to_vec()).unwrap();
        let t: f64 = 0.3;
        let mut out = [DVec3::NAN; 5];
        curve.derivatives(t, &mut out);
        let wanted = [
            DVec3::new(t, t * t, t.powi(3)),
            DVec3::new(1.0, 2.0 * t, 3.0 * t * t),
            DVec3::new(0.0, 2.0, 6.0 * t),
            DVec3::new(0.0, 0.0, 6.0),
            DVec3::ZERO,
        ];
        for (found, wanted) in out.iter().zip(wanted) {
            assert!((*found - wanted).length() < 1e-14, "{found} {wanted}");
        }
        assert!((curve.hodograph().point(t) - wanted[1]).length() < 1e-15);
    }

    #[test]
    fn elevation_keeps_the_curve_and_reduction_undoes_it() {
        for curve in [cubic(), cubic().elevated().unwrap(), cubic().hodograph()] {
            let elevated = curve.elevated().unwrap();
            for i in 0..=10 {
                let t = f64::from(i) / 10.0;
                assert!((curve.point(t) - elevated.point(t)).length() < 1e-14);
            }
            let (back, bound) = elevated.reduced().unwrap();
            assert!(bound < 1e-14, "{bound}");
            assert!(back.control.iter().zip(&curve.control).all(|(a, b)| (*a - *b).length() < 1e-14));
        }
    }

    #[test]
    fn reduction_keeps_the_ends_and_its_bound() {
        for curve in [cubic(), cubic().elevated().unwrap().segment(0.1, 0.8)] {
            let mut bent = curve.clone();
            bent.control[1].y += 0.5;
            let (reduced, bound) = bent.reduced().unwrap();
            assert_eq!((reduced.point(0.0), reduced.point(1.0)), (bent.point(0.0), bent.point(1.0)));
            let apart = (0..=100).map(|i| f64::from(i) / 100.0).map(|t| (reduced.point(t) - bent.point(t)).length());
            assert!(apart.fold(0.0, f64::max) <= bound);
        }
        assert!(cubic().hodograph().hodograph().reduced().is_err());
    }

    #[test]
    fn second_differences_bound_the_second_derivative() {
        let curve = cubic();
        let bound = curve.second_derivative_bound();
        let mut out = [DVec2::ZERO; 3];
        let mut largest = 0.0f64;
        for i in 0..=100 {
            curve.derivatives(f64::from(i) / 100.0, &mut out);
            largest = largest.max(out[2].length());
        }
        // For a cubic the bound is taken at an end.
        assert!(largest <= bound * (1.0 + 1e-15) && largest > 0.999 * bound);
    }

    #[test]
    fn what_is_no_curve_is_refused() {
        assert_eq!(BezierCurve::<DVec2>::try_new(vec![]), Err(BezierError::Empty));
        assert_eq!(BezierCurve::try_new(vec![DVec2::ZERO, DVec2::NAN]), Err(BezierError::NotFinite { index: 1 }));
        assert!(BezierCurve::try_new(vec![DVec2::ZERO; 257]).is_err());
        let point = BezierCurve::try_new(vec![DVec2::X]).unwrap();
        assert_eq!((point.point(0.5), point.hodograph().point(0.5)), (DVec2::X, DVec2::ZERO));
        assert_eq!(point.second_derivative_bound(), 0.0);
    }
}
