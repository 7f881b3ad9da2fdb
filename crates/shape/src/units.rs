//! Units of length and the up direction.

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Category, Diagnostic};

/// How long one model unit is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    meters: f64,
}

impl Units {
    /// One unit is a metre.
    pub const METERS: Self = Self { meters: 1.0 };
    /// One unit is a millimetre.
    pub const MILLIMETERS: Self = Self { meters: 1e-3 };
    /// One unit is an inch.
    pub const INCHES: Self = Self { meters: 0.0254 };

    /// One unit is that many metres.
    ///
    /// # Errors
    /// A length that is not positive and finite.
    pub fn from_meters(meters: f64) -> Result<Self, UnitError> {
        if meters > 0.0 && meters.is_finite() { Ok(Self { meters }) } else { Err(UnitError { found: meters }) }
    }

    /// The length of one unit in metres.
    pub fn meters(self) -> f64 {
        self.meters
    }
}

/// A length that is no unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnitError {
    /// The length in metres.
    pub found: f64,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unit of length: found {} metres, expected a finite number above 0", self.found)
    }
}

impl std::error::Error for UnitError {}

impl Diagnostic for UnitError {
    fn code(&self) -> &'static str {
        "E-shape-unit"
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

/// The direction that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum UpAxis {
    /// +y, as in glTF.
    Y,
    /// +z, as in most engineering.
    Z,
}

impl UpAxis {
    /// The unit vector.
    pub fn vector(self) -> DVec3 {
        match self {
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

    /// The name: `y` or `z`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    /// The rotation about x by a multiple of 90 degrees that turns this direction into another; exact.
    pub fn rotation_to(self, other: Self) -> Affine {
        use shapeloom_core::glam::DMat3;
        let (y, z) = match (self, other) {
            (Self::Z, Self::Y) => (-DVec3::Z, DVec3::Y),
            (Self::Y, Self::Z) => (DVec3::Z, -DVec3::Y),
            _ => (DVec3::Y, DVec3::Z),
        };
        Affine::from_linear(DMat3::from_cols(DVec3::X, y, z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_turns_into_up_and_back() {
        let turn = UpAxis::Z.rotation_to(UpAxis::Y);
        assert_eq!(turn.vector(DVec3::Z), DVec3::Y);
        assert_eq!(turn.determinant(), 1.0);
        assert_eq!((UpAxis::Y.rotation_to(UpAxis::Z) * turn).linear, Affine::IDENTITY.linear);
    }

    #[test]
    fn units_are_positive() {
        assert!(Units::from_meters(0.0).is_err() && Units::from_meters(f64::NAN).is_err());
        assert_eq!(Units::from_meters(1e-3), Ok(Units::MILLIMETERS));
    }
}
