//! Regularised sets: the closure of the interior.

use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;

use super::bounds::Bounds;
use super::error::{usable_point, usable_tolerance};
use super::survey::Survey;
use super::{Certainty, PointPlace, QueryError};

/// Where a point lies with respect to the closure of the interior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegularClassification {
    /// The place.
    pub place: PointPlace,
    /// How sure it is.
    pub certainty: Certainty,
    /// No value within the tolerance of the point is less: how deep an interior that was not found may be.
    pub lowest: f64,
    /// No value within the tolerance of the point is more.
    pub highest: f64,
}

/// Where a point lies with respect to the regularised set, the closure of the interior (Requicha, 1980; Tilove, 1980).
///
/// The interior is where values are below 0, the exterior where they are above it. A point is
/// - on the boundary if points of the interior and points of the exterior lie within the tolerance of it,
/// - inside if points of the interior do and none of the exterior,
/// - outside if no point of the interior does.
///
/// So the face on which two boxes touch belongs to nothing of their intersection, whose values there are 0 and nowhere less,
/// and lies inside their union. Points of interior and exterior that were found are proofs where the range of the field at them, rounding
/// included, has one sign. That there are none is proven where bounds have one sign; where values come down to 0 they never do,
/// and the answer is estimated: `lowest` says how deep an interior may have been missed, and for a signed distance no ball of more than
/// that radius was.
///
/// # Errors
/// A tolerance that is negative or not finite, a point that is not finite.
pub fn classify_regularised<F: Field + ?Sized>(
    field: &F,
    point: DVec3,
    tolerance: f64,
) -> Result<RegularClassification, QueryError> {
    let (point, tolerance) = (usable_point(point)?, usable_tolerance(tolerance)?);
    let survey = Survey::of(&Bounds::new(field), point, tolerance);
    let (lowest, highest) = (survey.lowest, survey.highest);
    let told = |place: PointPlace, proven: bool| {
        Ok(RegularClassification { place, certainty: Certainty::proven_if(proven), lowest, highest })
    };
    if field.value(point).is_nan() {
        return told(PointPlace::Unknown, true);
    }
    // Where bounds are known, a value within rounding of 0 shows neither side.
    let known = lowest > f64::NEG_INFINITY || highest < f64::INFINITY;
    let seen = |side: Option<Certainty>| side.filter(|side| *side == Certainty::Proven || !known);
    match (seen(survey.inside), seen(survey.outside)) {
        (Some(a), Some(b)) => told(PointPlace::On, a.min(b) == Certainty::Proven),
        (Some(_), None) => told(PointPlace::Inside, highest < 0.0),
        (None, _) => told(PointPlace::Outside, lowest > 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Numbers;
    use crate::{SetOperation, Tree};
    use shapeloom_core::{Affine, AxisAngle};

    fn place(tree: &Tree, x: f64, y: f64) -> PointPlace {
        let program = tree.compile().unwrap();
        classify_regularised(&program, DVec3::new(x, y, 0.0), 0.01).unwrap().place
    }

    fn boxes(apart: f64) -> (Tree, Tree) {
        (Tree::cuboid(1.0, 1.0, 1.0), Tree::cuboid(1.0, 1.0, 1.0).translate(apart, 0.0, 0.0))
    }

    #[test]
    fn boxes_that_touch_intersect_in_nothing() {
        let (a, b) = boxes(1.0);
        let both = a.clone().intersection(b.clone());
        // The plain classification says that the face belongs to it.
        let program = both.compile().unwrap();
        assert_eq!(program.classify(DVec3::X * 0.5, 0.01).unwrap().place, PointPlace::On);
        for x in [0.3, 0.495, 0.5, 0.505, 0.7] {
            assert_eq!(place(&both, x, 0.1), PointPlace::Outside, "{x}");
        }
        let found = classify_regularised(&program, DVec3::X * 0.5, 0.01).unwrap();
        assert!(found.lowest >= -0.01 / 4.0 && found.certainty == Certainty::Estimated, "{found:?}");
        let clear = classify_regularised(&program, DVec3::X * 0.8, 0.01).unwrap();
        assert_eq!((clear.place, clear.certainty), (PointPlace::Outside, Certainty::Proven));
        // Their common face lies in the interior of the closure of their union.
        let union = a.clone().union(b.clone());
        assert_eq!(place(&union, 0.5, 0.1), PointPlace::Inside);
        assert_eq!(place(&union, 0.5, 0.5), PointPlace::On);
        // Taking away what only touches takes nothing away, and leaves the face as boundary.
        assert_eq!(place(&a.clone().difference(b), 0.5, 0.1), PointPlace::On);
        assert_eq!(place(&a.clone().difference(a), 0.5, 0.1), PointPlace::Outside);
    }

    #[test]
    fn boxes_that_overlap_or_are_apart() {
        for (apart, expected) in [(0.999, PointPlace::On), (0.9, PointPlace::On), (1.001, PointPlace::Outside)] {
            let (a, b) = boxes(apart);
            assert_eq!(place(&a.intersection(b), 0.5, 0.1), expected, "{apart}");
        }
        let (a, b) = boxes(0.5);
        assert_eq!(place(&a.intersection(b), 0.25, 0.1), PointPlace::Inside);
    }

    #[test]
    fn rounding_makes_no_interior() {
        // A turned box and the space beyond its face: values on the face are 1e-16 above or below 0.
        let mut numbers = Numbers::new(41);
        let mut below = 0;
        for _ in 0..400 {
            let turn = AxisAngle::new(DVec3::Z, numbers.within(0.0, 3.0)).unwrap();
            let outward = Affine::from_rotation(turn).vector(DVec3::X);
            let beyond = Tree::plane(outward * -3.7, -0.5);
            let program = Tree::cuboid(1.0, 1.0, 1.0).rotate(turn).intersection(beyond).compile().unwrap();
            let on_face = DVec3::new(0.5, numbers.within(-0.4, 0.4), numbers.within(-0.4, 0.4));
            let point = Affine::from_rotation(turn).point(on_face);
            below += usize::from(program.value(point) < 0.0);
            assert_eq!(classify_regularised(&program, point, 0.01).unwrap().place, PointPlace::Outside);
        }
        assert!(below > 0);
    }

    #[test]
    fn dangling_sheets_and_lines_are_dropped_and_cracks_closed() {
        // A ball with a sheet of no thickness: min(ball, |z|).
        let sheet = Tree::sphere(1.0).minimum(Tree::z().absolute());
        assert_eq!(place(&sheet, 1.5, 0.0), PointPlace::Outside);
        assert_eq!(place(&sheet, 1.0, 0.0), PointPlace::On);
        // A ball without the plane z = 0: the closure of its interior holds the plane.
        let cut = Tree::sphere(1.0).maximum(-Tree::z().absolute());
        assert_eq!(place(&cut, 0.2, 0.0), PointPlace::Inside);
        let blended = boxes(1.0);
        let form = crate::BlendForm::RFunction { alpha: 0.0 };
        let both = blended.0.blend(blended.1, SetOperation::Intersection, form);
        assert_eq!(place(&both, 0.5, 0.1), PointPlace::Outside);
    }
}
