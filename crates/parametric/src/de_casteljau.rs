//! De Casteljau's algorithm on rows of control points.

use shapeloom_core::VectorSpace;

/// The largest degree: beyond it the quadratic cost of an evaluation passes a millisecond.
pub const MAX_DEGREE: usize = 255;

/// The blossom of one parameter: replaces `points` by one point less, `k` times for the polynomial's `k`-th polar form.
fn step<P: VectorSpace>(points: &mut [P], t: f64) {
    for i in 0..points.len() - 1 {
        // Exact at both ends, and at equal points for every t in [0, 1] up to rounding.
        points[i] = points[i] * (1.0 - t) + points[i + 1] * t;
    }
}

/// The point at `t`. Uses `points` as scratch space.
pub(crate) fn evaluate<P: VectorSpace>(points: &mut [P], t: f64) -> P {
    for len in (2..=points.len()).rev() {
        step(&mut points[..len], t);
    }
    points[0]
}

/// The point and the derivative at `t`: the last two points of the scheme span the tangent. Uses `points` as scratch
/// space.
pub(crate) fn evaluate_with_derivative<P: VectorSpace>(points: &mut [P], t: f64) -> [P; 2] {
    let degree = points.len() - 1;
    if degree == 0 {
        return [points[0], P::ZERO];
    }
    for len in (3..=points.len()).rev() {
        step(&mut points[..len], t);
    }
    let derivative = (points[1] - points[0]) * degree as f64;
    [points[0] * (1.0 - t) + points[1] * t, derivative]
}

/// Replaces the control points by those of the part before `t`.
fn keep_before<P: VectorSpace>(points: &mut [P], t: f64) {
    for round in 1..points.len() {
        for i in (round..points.len()).rev() {
            points[i] = points[i - 1] * (1.0 - t) + points[i] * t;
        }
    }
}

/// Replaces the control points by those of the part after `t`.
fn keep_after<P: VectorSpace>(points: &mut [P], t: f64) {
    for len in (2..=points.len()).rev() {
        step(&mut points[..len], t);
    }
}

/// Cuts the control points at `t`: `points` becomes the part before it, the result is the part after.
pub(crate) fn split<P: VectorSpace>(points: &mut [P], t: f64) -> Vec<P> {
    let mut after = points.to_vec();
    keep_after(&mut after, t);
    keep_before(points, t);
    after
}

/// Restricts the control points to `[a, b]`.
pub(crate) fn restrict<P: VectorSpace>(points: &mut [P], a: f64, b: f64) {
    if b < 1.0 {
        keep_before(points, b);
    }
    if a > 0.0 {
        // The share of the part [0, b] that lies before a.
        keep_after(points, if b > 0.0 { a / b } else { 0.0 });
    }
}

/// Replaces the control points by those of the derivative, one less, in place; returns their number.
pub(crate) fn hodograph<P: VectorSpace>(points: &mut [P]) -> usize {
    let degree = points.len() - 1;
    for i in 0..degree {
        points[i] = (points[i + 1] - points[i]) * degree as f64;
    }
    degree
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec2;

    #[test]
    fn splitting_meets_in_the_point() {
        let mut left = [(0.0, 0.0), (1.0, 2.0), (3.0, 2.0), (4.0, 0.0)].map(DVec2::from);
        let whole = left;
        let right = split(&mut left, 0.25);
        assert_eq!(left[3], right[0]);
        assert_eq!(left[3], evaluate(&mut whole.clone(), 0.25));
        assert_eq!((left[0], right[3]), (whole[0], whole[3]));
        let mut middle = whole;
        restrict(&mut middle, 0.25, 0.75);
        for i in 0..=8 {
            let t = f64::from(i) / 8.0;
            let wanted = evaluate(&mut whole.clone(), 0.25 + 0.5 * t);
            assert!((evaluate(&mut middle.clone(), t) - wanted).length() < 1e-15);
        }
    }
}
