//! Inside, on or outside, with a tolerance.

use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;

use super::bounds::Bounds;
use super::error::{usable_point, usable_tolerance};
use super::survey::Survey;
use super::{Certainty, QueryError, Side};
use crate::Program;

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointPlace {
    /// Inside, and farther from the surface than the tolerance: in the interior.
    Inside,
    /// Within the tolerance of the surface: on the boundary.
    On,
    /// Outside, and farther from the surface than the tolerance: in the exterior.
    Outside,
    /// The field is not a number there.
    Unknown,
}

impl PointPlace {
    /// Whether the point belongs to the closed set: inside or on.
    pub fn is_in_closure(self) -> bool {
        matches!(self, Self::Inside | Self::On)
    }

    pub(super) fn beyond(side: Side) -> Self {
        if side == Side::Inside { Self::Inside } else { Self::Outside }
    }
}

/// Where a point lies, and how sure that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Classification {
    /// The place.
    pub place: PointPlace,
    /// How sure it is.
    pub certainty: Certainty,
    /// The field's value at the point.
    pub value: f64,
}

/// Where a point lies, with a tolerance that is a distance: on the surface if the surface passes within it.
///
/// The surface is where values change sign, or are 0. Asked in turn: the Lipschitz constant, whether points of both sides lie in the
/// ball (then the surface does too), the range of values over the ball, in parts where needed. If none of these decides, the
/// distance is estimated as the value over the gradient's length. What is not a number is [`PointPlace::Unknown`].
///
/// Costs at most some 600 ranges and values, and one where the Lipschitz constant decides.
///
/// # Errors
/// A tolerance that is negative or not finite, a point that is not finite.
pub fn classify<F: Field + ?Sized>(field: &F, point: DVec3, tolerance: f64) -> Result<Classification, QueryError> {
    answer(field, point, tolerance, false)
}

/// The same for a field that the caller knows to be the signed distance: its value alone decides.
///
/// # Errors
/// As [`classify`].
pub fn classify_exact<F: Field + ?Sized>(
    field: &F,
    point: DVec3,
    tolerance: f64,
) -> Result<Classification, QueryError> {
    answer(field, point, tolerance, true)
}

impl Program {
    /// Where a point lies: [`classify`], by the value alone where the program is a signed distance.
    ///
    /// # Errors
    /// As [`classify`].
    pub fn classify(&self, point: DVec3, tolerance: f64) -> Result<Classification, QueryError> {
        answer(self, point, tolerance, self.nature().exact)
    }
}

fn answer<F: Field + ?Sized>(
    field: &F,
    point: DVec3,
    tolerance: f64,
    exact: bool,
) -> Result<Classification, QueryError> {
    let (point, tolerance) = (usable_point(point)?, usable_tolerance(tolerance)?);
    let value = field.value(point);
    let told =
        |place: PointPlace, proven: bool| Ok(Classification { place, certainty: Certainty::proven_if(proven), value });
    if value.is_nan() {
        return told(PointPlace::Unknown, true);
    }
    let side = PointPlace::beyond(Side::of(value));
    if exact {
        return told(if value.abs() <= tolerance { PointPlace::On } else { side }, true);
    }
    let bounds = Bounds::new(field);
    if Side::of_bounds(bounds.by_slope(point, tolerance)).is_some() {
        return told(side, true);
    }
    let survey = Survey::of(&bounds, point, tolerance);
    if let (Some(a), Some(b)) = (survey.inside, survey.outside) {
        return told(PointPlace::On, a.min(b) == Certainty::Proven);
    }
    if value == 0.0 {
        return told(PointPlace::On, false);
    }
    if survey.lowest > 0.0 || survey.highest < 0.0 {
        return told(side, true);
    }
    let slope = field.gradient(point).length();
    let near = tolerance > 0.0 && slope > 0.0 && value.abs() <= tolerance * slope;
    told(if near { PointPlace::On } else { side }, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Numbers;
    use crate::{Primitive, Quadric, Tree, Unary};

    /// Distances in closed form; fields that are distances, bounds and signs only must tell the same places.
    #[test]
    fn places_are_those_of_the_distance() {
        let ball = Tree::sphere(1.0);
        let quadric: Tree = Quadric::Ellipsoid(DVec3::ONE).into();
        let forms = [
            (ball.clone(), true),
            (ball.clone() * 3.0, true),
            (quadric, true),
            (Tree::x().square() + Tree::y().square() + Tree::z().square() - 1.0, true),
            // The cube of a distance: no slope at the surface.
            (ball.power(3), false),
        ];
        let mut numbers = Numbers::new(11);
        for (tree, sloped) in forms {
            let program = tree.compile().unwrap();
            for round in 0..400 {
                let p = numbers.point(1.5);
                let distance = p.length() - 1.0;
                let tolerance = 10.0_f64.powi(-(round % 4));
                // Not within a hundredth of the decision.
                if (distance.abs() - tolerance).abs() < 0.01 * tolerance {
                    continue;
                }
                let found = program.classify(p, tolerance).unwrap();
                let expected = match distance {
                    d if d.abs() <= tolerance => PointPlace::On,
                    d if d < 0.0 => PointPlace::Inside,
                    _ => PointPlace::Outside,
                };
                // Estimates are for short distances and fields with a slope.
                let estimated = found.certainty == Certainty::Estimated;
                let may_fail = estimated && (!sloped || tolerance > 0.1);
                assert!(found.place == expected || may_fail, "{tree:?} {p} {tolerance} {found:?}");
                let near = (distance.abs() - tolerance).abs() < 0.5 * tolerance;
                assert!(!estimated || near || !sloped, "{tree:?} {p} {tolerance} {found:?}");
            }
        }
    }

    #[test]
    fn proofs_near_the_decision_are_not_wrong() {
        let program = Tree::from(Primitive::QuarticTorus { major: 2.0, minor: 0.5 }).compile().unwrap();
        let mut numbers = Numbers::new(12);
        let mut proven = 0;
        for _ in 0..2000 {
            let p = numbers.point(3.0);
            let distance = ((p.x.hypot(p.y) - 2.0).hypot(p.z) - 0.5).abs();
            let tolerance = distance * numbers.within(0.8, 1.2);
            let found = program.classify(p, tolerance).unwrap();
            if found.certainty == Certainty::Proven {
                proven += 1;
                assert_eq!(found.place == PointPlace::On, distance <= tolerance, "{p} {distance} {tolerance}");
            }
        }
        assert!(proven > 700, "{proven}");
    }

    #[test]
    fn what_is_not_a_number_is_unknown_and_nonsense_is_refused() {
        let program = Tree::x().unary(Unary::SquareRoot).compile().unwrap();
        let found = program.classify(DVec3::NEG_X, 0.1).unwrap();
        assert_eq!((found.place, found.certainty), (PointPlace::Unknown, Certainty::Proven));
        for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(classify(&program, DVec3::X, tolerance), Err(QueryError::Tolerance { .. })));
        }
        assert!(matches!(classify(&program, DVec3::NAN, 0.1), Err(QueryError::Point { .. })));
        for scale in [1e-300, 1e-9, 1e9, 1e150] {
            let ball = Tree::sphere(scale).compile().unwrap();
            for (at, place) in
                [(0.5, PointPlace::Inside), (1.0, PointPlace::On), (1.01, PointPlace::On), (1.5, PointPlace::Outside)]
            {
                let found = classify(&ball, DVec3::X * (at * scale), scale * 0.1).unwrap();
                // Squares of 1e-300 are 0, so that the field itself is wrong there.
                assert!(found.place == place || scale == 1e-300, "{scale} {at} {found:?}");
            }
        }
    }

    #[test]
    fn a_tolerance_of_0_asks_for_the_point_alone() {
        let program = Tree::cuboid(2.0, 2.0, 2.0).compile().unwrap();
        assert_eq!(classify(&program, DVec3::X, 0.0).unwrap().place, PointPlace::On);
        assert_eq!(classify(&program, DVec3::X * 0.999, 0.0).unwrap().place, PointPlace::Inside);
        assert_eq!(classify(&program, DVec3::X * 1.001, 0.0).unwrap().certainty, Certainty::Proven);
    }

    struct Mute;

    impl Field for Mute {
        fn value(&self, point: DVec3) -> f64 {
            point.x
        }

        fn gradient(&self, _: DVec3) -> DVec3 {
            DVec3::X
        }
    }

    #[test]
    fn fields_without_bounds_give_estimates() {
        for (x, place) in [(0.05, PointPlace::On), (0.2, PointPlace::Outside), (-0.2, PointPlace::Inside)] {
            let found = classify(&Mute, DVec3::X * x, 0.1).unwrap();
            assert_eq!((found.place, found.certainty), (place, Certainty::Estimated));
        }
    }
}
