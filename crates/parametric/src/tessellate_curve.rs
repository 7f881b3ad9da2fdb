//! Bézier curves to polylines.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Curve, Deviation, Exec, FromTolerance, Options, Report, VectorSpace,
    options,
};
use shapeloom_mesh::{Column, Polyline, Values};

use crate::{BezierCurve, TessellationError};

options! {
    /// Samples a Bézier curve at equal parameter steps, so that no chord is farther from it than a tolerance.
    ///
    /// The number of steps follows from second differences of the control points (Filip, Magedson and Markot 1986): a
    /// chord over a step h is within h²/8 times a bound of the second derivative, at equal parameters. The report has
    /// the largest such bound over the steps, each with its own part of the control polygon. A curve that ends where it
    /// starts becomes a closed polyline. The parameter of each point is its attribute "parameter". Cost: linear in the
    /// number of points, which grows as one over the square root of the tolerance.
    pub struct TessellateCurve("tessellate-curve") {
        required {
            /// The largest distance between the curve and its chords, in model units.
            chord_tolerance: f64 [Bounds::POSITIVE],
        }
        optional {
            /// The most segments.
            max_segments: u32 [Bounds::closed(1.0, 268435456.0)] = 1 << 24,
        }
    }
}

impl<P: VectorSpace> FromTolerance<BezierCurve<P>> for TessellateCurve {
    fn from_tolerance(_: &BezierCurve<P>, tolerance: f64) -> Self {
        Self::new(tolerance)
    }
}

impl<P: VectorSpace> Convert<BezierCurve<P>> for TessellateCurve {
    type Output = Polyline;

    fn convert_with(&self, source: &BezierCurve<P>, exec: &Exec) -> Result<Converted<Polyline>, ConvertError> {
        self.validate()?;
        let rounding = rounding(source.control_points(), source.degree());
        let share = chord_share(self.chord_tolerance, rounding)?;
        let bound = source.second_derivative_bound();
        if !bound.is_finite() {
            return Err(TessellationError::TooLarge { kind: "curve", index: 0 }.into());
        }
        let found = segments_for(bound, share).max(f64::from(fewest_segments(source)));
        if found > f64::from(self.max_segments) {
            let allowed = self.max_segments;
            return Err(TessellationError::TooManySegments { kind: "curve", index: 0, found, allowed }.into());
        }
        let count = found as u32;
        let _memory = exec.reserve_elements(u64::from(count) + 1, 2 * size_of::<P>() + 40)?;
        let parameters: Vec<f64> = (0..=count).map(|k| f64::from(k) / f64::from(count)).collect();
        let mut points = vec![P::ZERO; parameters.len()];
        for (part, out) in parameters.chunks(1024).zip(points.chunks_mut(1024)) {
            exec.check()?;
            source.points(part, out);
        }
        let certificate = certificate(source, count, exec)? + rounding;
        let mut positions: Vec<_> = points.iter().map(|point| point.to_space()).collect();
        let mut parameters = parameters;
        let closed = count > 1 && positions.first() == positions.last();
        if closed {
            positions.pop();
            parameters.pop();
        }
        let mut line = Polyline::new(positions, closed);
        let column =
            Column::try_new("parameter", 1, Values::F64(parameters)).map_err(shapeloom_mesh::MeshError::from)?;
        line.insert_attribute(column).map_err(shapeloom_mesh::MeshError::from)?;
        let mut report =
            Report::new(Self::NAME, Deviation::AtMost(certificate), "second differences of the control points");
        report.figure("segments", count);
        report.certificates = vec![certificate];
        Ok(Converted::new(line, report))
    }
}

/// A bound of how far de Casteljau's algorithm rounds: a few units in the last place a round.
pub(crate) fn rounding<P: VectorSpace>(control: &[P], rounds: usize) -> f64 {
    let size = control.iter().map(|point| point.to_space().abs().max_element()).fold(0.0, f64::max);
    // Where numbers themselves are about to vanish their rounding no longer shrinks with them.
    let vanishing = if size > 0.0 { (rounds as f64 + 2.0) * f64::MIN_POSITIVE } else { 0.0 };
    4.0 * (rounds as f64 + 2.0) * f64::EPSILON * size + vanishing
}

/// The part of a tolerance that chords may use: what rounding leaves.
pub(crate) fn chord_share(tolerance: f64, rounding: f64) -> Result<f64, TessellationError> {
    let share = tolerance - rounding;
    // With less than half left the vertices themselves are no better than the tolerance.
    if share >= rounding && share > 0.0 {
        Ok(share)
    } else {
        Err(TessellationError::BelowRounding { tolerance, rounding })
    }
}

/// How many equal steps keep a chord within `share`, for a second derivative up to `bound`.
pub(crate) fn segments_for(bound: f64, share: f64) -> f64 {
    (bound / (8.0 * share)).sqrt().ceil().max(1.0)
}

/// Curves that end where they start need three segments to enclose anything.
pub(crate) fn fewest_segments<P: VectorSpace>(curve: &BezierCurve<P>) -> u32 {
    let control = curve.control_points();
    let loops = control.first() == control.last() && control.iter().any(|point| *point != control[0]);
    if loops { 3 } else { 1 }
}

/// The largest bound over `count` equal steps, each from its own part of the control polygon.
fn certificate<P: VectorSpace>(curve: &BezierCurve<P>, count: u32, exec: &Exec) -> Result<f64, ConvertError> {
    let second = curve.hodograph().hodograph();
    let whole = longest(&second);
    let step = 1.0 / f64::from(count);
    let mut most = 0.0f64;
    for k in 0..count {
        if k % 1024 == 0 {
            exec.check()?;
        }
        let part = second.segment(f64::from(k) * step, (f64::from(k + 1) * step).min(1.0));
        most = most.max(longest(&part));
    }
    // Forming the differences and restricting them rounds, as for patches.
    let degree = curve.degree() as f64;
    let size = curve.control_points().iter().map(|point| point.to_space().abs().max_element()).fold(0.0, f64::max);
    let slack = 8.0 * f64::EPSILON * (degree * degree * size + (degree + 1.0) * whole);
    Ok((most + slack) * step * step / 8.0)
}

fn longest<P: VectorSpace>(curve: &BezierCurve<P>) -> f64 {
    curve.control_points().iter().map(|vector| vector.length()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::{DVec2, DVec3};

    fn distance_to_segment(p: DVec3, [a, b]: [DVec3; 2]) -> f64 {
        let along = b - a;
        let t = if along == DVec3::ZERO { 0.0 } else { ((p - a).dot(along) / along.length_squared()).clamp(0.0, 1.0) };
        p.distance(a + along * t)
    }

    /// A quarter of a circle as a cubic, with the usual handle 4/3·(√2 - 1).
    fn quarter() -> BezierCurve<DVec2> {
        let k = 4.0 / 3.0 * (2f64.sqrt() - 1.0);
        BezierCurve::try_new([(1.0, 0.0), (1.0, k), (k, 1.0), (0.0, 1.0)].map(DVec2::from).to_vec()).unwrap()
    }

    #[test]
    fn measured_error_is_within_the_certificate_and_that_within_the_tolerance() {
        for tolerance in [0.1, 1e-3, 1e-6] {
            let converted = TessellateCurve::new(tolerance).convert(&quarter()).unwrap();
            let Deviation::AtMost(bound) = converted.report.deviation else { panic!("a bound") };
            assert!(bound <= tolerance);
            let segments: Vec<[DVec3; 2]> = converted.value.segments().collect();
            let mut measured = 0.0f64;
            for (k, segment) in segments.iter().enumerate() {
                for sample in 0..=20 {
                    let t = (k as f64 + f64::from(sample) / 20.0) / segments.len() as f64;
                    measured = measured.max(distance_to_segment(quarter().point(t).to_space(), *segment));
                }
            }
            assert!(measured <= bound && measured > bound / 1.5, "{tolerance}: {measured} {bound}");
        }
    }

    #[test]
    fn straight_lines_need_one_segment_and_loops_three() {
        let line = BezierCurve::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0]).unwrap();
        assert_eq!(TessellateCurve::new(1e-9).convert(&line).unwrap().value.points().len(), 2);
        let looped = BezierCurve::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO]).unwrap();
        let polyline = TessellateCurve::new(100.0).convert(&looped).unwrap().value;
        assert_eq!((polyline.points().len(), polyline.is_closed()), (3, true));
    }

    #[test]
    fn impossible_tolerances_are_refused() {
        for tolerance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(TessellateCurve::new(tolerance).convert(&quarter()).is_err());
        }
        let error = TessellateCurve::new(1e-300).convert(&quarter()).unwrap_err();
        assert!(matches!(error.narrow(), Some(TessellationError::BelowRounding { .. })));
        let few = TessellateCurve { max_segments: 3, ..TessellateCurve::new(1e-6) };
        let error = few.convert(&quarter()).unwrap_err();
        assert!(matches!(error.narrow(), Some(TessellationError::TooManySegments { .. })));
    }
}
