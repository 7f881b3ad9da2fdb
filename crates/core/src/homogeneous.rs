//! Points and vectors as homogeneous 4-tuples.

use std::fmt;

use glam::DVec3;

use crate::{Affine, Category, Diagnostic};

/// A homogeneous 4-tuple `(x, y, z, w)`: a point when `w` is 1, a vector when `w` is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// The first three coordinates.
    pub xyz: DVec3,
    /// The last coordinate.
    pub w: f64,
}

/// What a combination of homogeneous 4-tuples is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Combination {
    /// An affine combination of points: the weights of the points sum to 1.
    Point(DVec3),
    /// A difference of points, or a combination of vectors: they sum to 0.
    Vector(DVec3),
}

impl Homogeneous {
    /// A point, `w` = 1.
    pub fn point(position: DVec3) -> Self {
        Self { xyz: position, w: 1.0 }
    }

    /// A vector, `w` = 0.
    pub fn vector(direction: DVec3) -> Self {
        Self { xyz: direction, w: 0.0 }
    }

    /// The image under an affine map: translations move points and leave vectors.
    #[must_use]
    pub fn transformed(self, map: &Affine) -> Self {
        Self { xyz: map.linear * self.xyz + map.translation * self.w, w: self.w }
    }

    /// The sum of `weight · tuple`: a vector when its `w` is 0, a point when it is 1. A `w` within the rounding of the
    /// sum counts as 0 or 1.
    ///
    /// # Errors
    /// Any other `w`: adding two points means nothing.
    pub fn combine(terms: &[(f64, Self)]) -> Result<Combination, HomogeneousError> {
        let xyz = terms.iter().map(|&(weight, term)| term.xyz * weight).sum();
        let w: f64 = terms.iter().map(|&(weight, term)| term.w * weight).sum();
        let size: f64 = terms.iter().map(|&(weight, term)| (term.w * weight).abs()).sum();
        let rounding = size * terms.len() as f64 * f64::EPSILON;
        if w.abs() <= rounding {
            Ok(Combination::Vector(xyz))
        } else if (w - 1.0).abs() <= rounding {
            Ok(Combination::Point(xyz))
        } else {
            Err(HomogeneousError { w })
        }
    }
}

/// A combination that is neither a point nor a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HomogeneousError {
    /// The last coordinate of the sum.
    pub w: f64,
}

impl fmt::Display for HomogeneousError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "combination of homogeneous tuples: found w = {}, expected 1 (a point) or 0 (a vector)", self.w)
    }
}

impl std::error::Error for HomogeneousError {}

impl Diagnostic for HomogeneousError {
    fn code(&self) -> &'static str {
        "E-homogeneous-weight"
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_of_points_is_a_point_and_difference_a_vector() {
        let (p, q) = (Homogeneous::point(DVec3::X), Homogeneous::point(DVec3::Y));
        assert_eq!(Homogeneous::combine(&[(0.5, p), (0.5, q)]), Ok(Combination::Point(DVec3::new(0.5, 0.5, 0.0))));
        assert_eq!(Homogeneous::combine(&[(1.0, p), (-1.0, q)]), Ok(Combination::Vector(DVec3::X - DVec3::Y)));
        assert_eq!(Homogeneous::combine(&[(1.0, p), (1.0, q)]), Err(HomogeneousError { w: 2.0 }));
        assert_eq!(Homogeneous::combine(&[]), Ok(Combination::Vector(DVec3::ZERO)));
    }

    #[test]
    fn ten_tenths_are_one() {
        let p = Homogeneous::point(DVec3::X);
        assert!(matches!(Homogeneous::combine(&[(0.1, p); 10]), Ok(Combination::Point(_))));
        assert!(Homogeneous::combine(&[(f64::NAN, p)]).is_err());
    }

    #[test]
    fn translation_moves_points_only() {
        let map = Affine::from_translation(DVec3::Z);
        assert_eq!(Homogeneous::point(DVec3::X).transformed(&map).xyz, DVec3::X + DVec3::Z);
        assert_eq!(Homogeneous::vector(DVec3::X).transformed(&map).xyz, DVec3::X);
    }
}
