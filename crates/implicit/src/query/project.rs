//! A point moved to the surface along the gradient.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, Field, VectorWords, Words};

use super::bounds::Bounds;
use super::error::{usable_point, usable_tolerance};
use super::root::side_change;
use super::{Certainty, QueryError, Side};

/// How often Newton's step is taken. Simple roots take 5, double ones 50 for double precision.
const STEPS: u32 = 100;
/// How often a step is halved that makes the value no smaller.
const HALVINGS: u32 = 40;

/// A point of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// The point.
    pub point: DVec3,
    /// How far it lies from where it started. The nearest point may be nearer.
    pub distance: f64,
    /// The field's value there.
    pub value: f64,
    /// The unit normal outward; zero where the field has no gradient.
    pub normal: DVec3,
    /// Proven if points of both sides were found within the tolerance of it; estimated where the side does not change.
    pub certainty: Certainty,
    /// How many steps were taken.
    pub steps: u32,
}

/// Why a point did not reach the surface.
#[derive(Clone, Debug, PartialEq)]
pub enum ProjectError {
    /// A point or tolerance that cannot be used.
    Query(QueryError),
    /// The field is not a number where the point starts.
    Undefined {
        /// Where.
        point: DVec3,
    },
    /// The gradient is zero or not finite, and the value is not 0.
    NoGradient {
        /// Where.
        point: DVec3,
        /// The value there.
        value: f64,
    },
    /// Steps along the gradient make the value no smaller: a ridge, or a place where the field does not come to 0.
    Stuck {
        /// Where.
        point: DVec3,
        /// The value there.
        value: f64,
    },
}

impl fmt::Display for ProjectError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Query(error) => error.fmt(f),
            Self::Undefined { point } => {
                write!(f, "projection: found no number as the value at {}, expected one", VectorWords(*point))
            }
            Self::NoGradient { point, value } => write!(
                f,
                "projection: found no gradient at {}, where the value is {}; expected one along which to go",
                VectorWords(*point),
                Words(*value)
            ),
            Self::Stuck { point, value } => write!(
                f,
                "projection: ended at {} with the value {}, expected the surface",
                VectorWords(*point),
                Words(*value)
            ),
        }
    }
}

impl std::error::Error for ProjectError {}

impl Diagnostic for ProjectError {
    fn code(&self) -> &'static str {
        match self {
            Self::Query(error) => error.code(),
            Self::Undefined { .. } => "E-project-undefined",
            Self::NoGradient { .. } => "E-project-gradient",
            Self::Stuck { .. } => "E-project-stuck",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Query(error) => error.category(),
            _ => Category::Failed,
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::Query(error) => error.advice(),
            _ => Some("start nearer to the surface, or look along a ray".into()),
        }
    }
}

impl From<QueryError> for ProjectError {
    fn from(error: QueryError) -> Self {
        Self::Query(error)
    }
}

/// Moves a point to the surface along the gradient: Newton's steps, halved until the value becomes smaller; as soon as a step changes
/// the side, the surface is found on it by ITP, to a few units in the last place.
///
/// The point found is on the surface; it is the nearest one for signed distances, near the nearest one where the start is near
/// the surface, and some point of it elsewhere. Where the surface does not change sides (a double root), steps end when they are
/// shorter than the tolerance. For the surface along a given direction see [`RayIntervals`](super::RayIntervals).
///
/// # Errors
/// A point or tolerance that cannot be used, a field that is not a number at the start, no gradient, or no surface where the gradient leads.
pub fn project<F: Field + ?Sized>(field: &F, point: DVec3, tolerance: f64) -> Result<Projection, ProjectError> {
    let (start, tolerance) = (usable_point(point)?, usable_tolerance(tolerance)?);
    let mut at = start;
    let mut value = field.value(at);
    if value.is_nan() {
        return Err(ProjectError::Undefined { point });
    }
    let done = |point: DVec3, certainty: Certainty, steps: u32| Projection {
        point,
        distance: point.distance(start),
        value: field.value(point),
        normal: field.gradient(point).normalize_or_zero(),
        certainty,
        steps,
    };
    let bounds = Bounds::new(field);
    for steps in 0..STEPS {
        let gradient = field.gradient(at);
        let slope = gradient.length();
        if value == 0.0 {
            let across = if at == start { gradient } else { at - start };
            return Ok(done(at, two_sided(&bounds, at, across.normalize_or_zero() * tolerance), steps));
        }
        if !(slope > 0.0 && slope.is_finite()) {
            return Err(ProjectError::NoGradient { point: at, value });
        }
        let direction = gradient / -slope * value.signum();
        // What a step must be at least, so that it does not end short of the surface by rounding for ever.
        let least = tolerance.max(at.abs().max_element() * 4.0 * f64::EPSILON);
        let mut length = value.abs() / slope;
        if length <= least {
            // The surface should be within the tolerance: look on its other side.
            let far = at + direction * (2.0 * length).max(least);
            let there = field.value(far);
            if !there.is_nan() && Side::of(there) != Side::of(value) {
                return Ok(found(&bounds, &done, (at, value), (far, there), tolerance, steps));
            }
            // At a root of order m a step leaves (1 - 1/m)^m of the value, less than 1/e.
            let end = at + direction * length;
            let after = field.value(end).abs();
            if after <= 0.5 * value.abs() {
                return Ok(done(end, Certainty::Estimated, steps));
            }
            // The place is within rounding of the surface, or of a jump behind which values are larger again.
            if length <= at.abs().max_element() * 8.0 * f64::EPSILON {
                return Ok(done(at, Certainty::Estimated, steps));
            }
            return Err(ProjectError::Stuck { point: at, value });
        }
        let mut accepted = None;
        for _ in 0..HALVINGS {
            let next = at + direction * length;
            let there = field.value(next);
            if !there.is_nan() && Side::of(there) != Side::of(value) {
                return Ok(found(&bounds, &done, (at, value), (next, there), tolerance, steps));
            }
            // A quarter of what the slope promises is enough (Armijo, 1966).
            if there.abs() <= value.abs() - 0.25 * length * slope {
                accepted = Some((next, there));
                break;
            }
            length *= 0.5;
        }
        let Some(next) = accepted else { return Err(ProjectError::Stuck { point: at, value }) };
        (at, value) = next;
    }
    Err(ProjectError::Stuck { point: at, value })
}

/// The place between two points of different sides where the side changes.
fn found<F: Field + ?Sized>(
    bounds: &Bounds<'_, F>,
    done: &impl Fn(DVec3, Certainty, u32) -> Projection,
    from: (DVec3, f64),
    to: (DVec3, f64),
    tolerance: f64,
    steps: u32,
) -> Projection {
    let on = |part: f64| from.0.lerp(to.0, part);
    let part = side_change(|part| bounds.field.value(on(part)), (0.0, from.1), (1.0, to.1));
    let point = on(part);
    let arm = (to.0 - from.0).normalize_or_zero() * tolerance;
    done(point, two_sided(bounds, point, arm), steps + 1)
}

/// Whether the two points at an arm's length from one lie on different sides for certain.
fn two_sided<F: Field + ?Sized>(bounds: &Bounds<'_, F>, point: DVec3, arm: DVec3) -> Certainty {
    let sides = [point + arm, point - arm].map(|end| bounds.side_at(end).filter(|side| side.1).map(|side| side.0));
    Certainty::proven_if(sides[0].zip(sides[1]).is_some_and(|(a, b)| a != b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::{Numbers, samples};
    use crate::{Quadric, Tree, Unary};

    #[test]
    fn signed_distances_lead_to_the_nearest_point() {
        let mut numbers = Numbers::new(31);
        let mut unproven = 0;
        for tree in [Tree::sphere(1.2), Tree::torus(1.5, 0.4), Tree::cuboid(1.0, 2.0, 3.0), Tree::cone(1.0, 0.3, 2.0)] {
            let program = tree.compile().unwrap();
            for _ in 0..200 {
                let p = numbers.point(2.0);
                let found = project(&program, p, 1e-9).unwrap();
                assert!((found.distance - program.value(p).abs()).abs() < 1e-9, "{tree:?} {p} {found:?}");
                assert!(found.value.abs() < 1e-14 && found.steps <= 4, "{found:?}");
                unproven += usize::from(found.certainty == Certainty::Estimated);
            }
        }
        // At edges one of the two points at an arm's length may lie within rounding of a face.
        assert!(unproven <= 40, "{unproven}");
    }

    #[test]
    fn signs_alone_lead_to_the_surface() {
        let ellipsoid = Tree::from(Quadric::Ellipsoid(DVec3::new(1.0, 2.0, 0.5))).compile().unwrap();
        let mut numbers = Numbers::new(32);
        for _ in 0..300 {
            let p = numbers.point(3.0);
            let found = project(&ellipsoid, p, 1e-9).unwrap();
            let q = found.point / DVec3::new(1.0, 2.0, 0.5);
            assert!((q.length() - 1.0).abs() < 1e-14, "{p} {found:?}");
            assert!(found.steps <= 12 && found.certainty == Certainty::Proven, "{found:?}");
        }
    }

    /// On every kind of node: an answer is a point where the side changes, or near a value of 0.
    #[test]
    fn answers_are_on_the_surface() {
        let mut numbers = Numbers::new(33);
        let (mut reached, mut asked) = (0, 0);
        for tree in samples() {
            let program = tree.compile().unwrap();
            for _ in 0..20 {
                asked += 1;
                let p = numbers.point(1.5);
                let Ok(found) = project(&program, p, 1e-7) else { continue };
                reached += 1;
                let proven = found.certainty == Certainty::Proven;
                // A side may change by a jump, which no bounds prove.
                let arm = (found.point - p).normalize_or_zero() * 1e-6;
                let jumps = Side::of(program.value(found.point + arm)) != Side::of(program.value(found.point - arm));
                assert!(proven || jumps || found.value.abs() < 1e-3, "{tree:?} {found:?}");
            }
        }
        assert!(reached * 3 > asked, "{reached} of {asked}");
    }

    #[test]
    fn failures_are_typed() {
        let squares = |shift: f64| Tree::x().square() + Tree::y().square() + Tree::z().square() + shift;
        let ball = squares(-1.0).compile().unwrap();
        assert!(matches!(project(&ball, DVec3::ZERO, 0.1), Err(ProjectError::NoGradient { .. })));
        let nothing = squares(1.0).compile().unwrap();
        let error = project(&nothing, DVec3::new(1.0, 0.5, 0.2), 1e-6).unwrap_err();
        assert!(matches!(error, ProjectError::NoGradient { .. } | ProjectError::Stuck { .. }), "{error:?}");
        let root = Tree::x().square_root().compile().unwrap();
        assert!(matches!(project(&root, DVec3::NEG_X, 0.1), Err(ProjectError::Undefined { .. })));
        assert!(matches!(project(&ball, DVec3::NAN, 0.1), Err(ProjectError::Query(QueryError::Point { .. }))));
        assert!(matches!(project(&ball, DVec3::X, -1.0), Err(ProjectError::Query(QueryError::Tolerance { .. }))));
        let double = Tree::x().square().compile().unwrap();
        let found = project(&double, DVec3::X, 1e-9).unwrap();
        assert!(found.certainty == Certainty::Estimated && found.point.x.abs() < 1e-8, "{found:?}");
        // Newton's first step leads out to where there is no slope left; halved it helps.
        let pit = (1.0 - (-Tree::x().square()).unary(Unary::Exponential)).compile().unwrap();
        let found = project(&pit, DVec3::X * 2.0, 1e-6).unwrap();
        assert!(found.point.x.abs() < 1e-5, "{found:?}");
        let far = Tree::sphere(1e150).compile().unwrap();
        // Squares of 1e160 overflow: a typed failure or a point on the surface, no more is asked.
        let _ = project(&far, DVec3::X * 1e160, 1.0);
    }
}
