//! What is known of a field's values.

use super::Operation;
use crate::operator::{Binary, Unary};
use crate::shapes::SetOperation;

/// What values mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meaning {
    /// The signed distance to the surface, up to rounding.
    Exact,
    /// No more than the distance to the surface, with the right sign: a ball of that radius meets no surface.
    Bound,
    /// The sign alone is right.
    Sign,
}

impl Meaning {
    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact distance",
            Self::Bound => "bound of the distance",
            Self::Sign => "sign only",
        }
    }
}

/// What is known of a field's values, from how it is built.
///
/// - Primitives that are distances say so. A union is exact outside and an intersection inside, but neither on the other side of its
///   surface, where the nearest surface of a part may lie within the other: both are bounds, and so are offsets, shells and all
///   that changes a value at most as fast as the place.
/// - R-functions at α change their values up to (2 + √(2 (1 - α))) / (1 + α) times as fast as the parts do: signs for α below 1.
/// - Bent, twisted, tapered and repeated space, formulas of higher degree and blobs keep the sign alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nature {
    /// Whether the values are signed distances up to rounding.
    pub exact: bool,
    /// A number L for which values at p and q differ by at most L·|p - q|, where one is known.
    pub lipschitz: Option<f64>,
}

impl Nature {
    /// The signed distance.
    pub const EXACT: Self = Self { exact: true, lipschitz: Some(1.0) };
    /// A bound of the distance.
    pub const BOUND: Self = Self { exact: false, lipschitz: Some(1.0) };
    /// Nothing but the sign.
    pub const SIGN: Self = Self { exact: false, lipschitz: None };

    /// The sign, with values that change at most so fast.
    pub fn at_most(lipschitz: f64) -> Self {
        Self { exact: false, lipschitz: Some(lipschitz) }
    }

    /// What values mean.
    pub fn meaning(self) -> Meaning {
        match self.lipschitz {
            _ if self.exact => Meaning::Exact,
            Some(lipschitz) if lipschitz <= 1.0 => Meaning::Bound,
            _ => Meaning::Sign,
        }
    }

    /// The same without the claim of exactness.
    pub fn inexact(self) -> Self {
        Self { exact: false, ..self }
    }

    /// The result changes `factor` times as fast.
    fn scaled(self, factor: f64) -> Self {
        Self { exact: self.exact && factor.abs() == 1.0, lipschitz: self.lipschitz.map(|bound| bound * factor.abs()) }
    }

    fn sum(self, other: Self) -> Self {
        let lipschitz = self.lipschitz.zip(other.lipschitz).map(|(a, b)| a + b);
        Self { exact: false, lipschitz }
    }

    fn largest(parts: impl Iterator<Item = Self>) -> Self {
        let mut most = Some(0.0_f64);
        for part in parts {
            most = most.zip(part.lipschitz).map(|(a, b)| a.max(b));
        }
        Self { exact: false, lipschitz: most }
    }

    pub(super) fn of(operation: &Operation) -> Self {
        use Operation as O;
        match operation {
            O::Constant(_) => Self::at_most(0.0),
            O::Coordinate(_) => Self::EXACT,
            O::Unary(operator, a) => Self::of_unary(*operator, a.nature()),
            O::Binary(operator, a, b) => {
                Self::of_binary(*operator, a.operation(), b.operation(), a.nature(), b.nature())
            }
            O::Power(a, 1) => a.nature(),
            O::Power(_, 0) => Self::at_most(0.0),
            O::Power(..) => Self::SIGN,
            O::Primitive(primitive) => primitive.nature(),
            O::Set(SetOperation::Difference, parts)
            | O::Set(SetOperation::Union, parts)
            | O::Set(SetOperation::Intersection, parts) => match parts.as_slice() {
                [part] => part.nature(),
                _ => Self::largest(parts.iter().map(|part| part.nature())),
            },
            O::Complement(a) | O::Named(_, a) => a.nature(),
            O::Blend(blend, a, b) => blend.nature(Self::largest([a.nature(), b.nature()].into_iter())),
            O::Offset(distance, a) if *distance == 0.0 => a.nature(),
            O::Offset(_, a) | O::Shell(_, a) => a.nature().inexact(),
            O::Displace(a, b) => a.nature().sum(b.nature()),
            O::Transform(map, a) => {
                let (least, most) = crate::shapes::stretches(map);
                // The value is scaled by the least stretch, and the map's inverse changes places at most by its inverse.
                let similar = most - least <= 1e-12 * most;
                Self { exact: a.nature().exact && similar, lipschitz: a.nature().lipschitz }
            }
            O::Domain(domain, a) => domain.nature(a.nature()),
            O::Substitute(places, of) => {
                let speeds = places.iter().map(|place| place.nature().lipschitz);
                let square = speeds.map(|speed| speed.map(|s| s * s)).try_fold(0.0, |sum, part| Some(sum + part?));
                let lipschitz = square.zip(of.nature().lipschitz).map(|(square, of)| square.sqrt() * of);
                Self { exact: false, lipschitz }
            }
            O::Foreign(foreign) => foreign.nature(),
            O::Blobs(blobs) => Self { exact: false, lipschitz: shapeloom_core::Field::lipschitz(&**blobs) },
        }
    }

    fn of_unary(operator: Unary, a: Self) -> Self {
        match operator {
            Unary::Negate => a,
            Unary::Absolute | Unary::Sine | Unary::Cosine | Unary::ArcTangent => a.inexact(),
            Unary::Not | Unary::Floor | Unary::Ceiling | Unary::Round => Self::SIGN,
            _ if a.lipschitz == Some(0.0) => a,
            _ => Self::SIGN,
        }
    }

    fn of_binary(operator: Binary, left: &Operation, right: &Operation, a: Self, b: Self) -> Self {
        match (operator, left, right) {
            (Binary::Multiply, Operation::Constant(factor), _) => b.scaled(*factor),
            (Binary::Multiply, _, Operation::Constant(factor)) => a.scaled(*factor),
            (Binary::Divide, _, Operation::Constant(divisor)) => a.scaled(1.0 / divisor),
            (Binary::Add | Binary::Subtract, ..) => a.sum(b),
            (Binary::Minimum | Binary::Maximum, ..) => Self::largest([a, b].into_iter()),
            _ if a.lipschitz == Some(0.0) && b.lipschitz == Some(0.0) => Self::at_most(0.0),
            _ => Self::SIGN,
        }
    }
}
