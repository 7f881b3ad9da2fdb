//! Operators of one operand.

use super::{Dual, Enclosure};

/// An operator of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Unary {
    /// `-a`.
    Negate,
    /// `|a|`.
    Absolute,
    /// `1 / a`.
    Reciprocal,
    /// The square root; not a number below 0.
    SquareRoot,
    /// `a * a`.
    Square,
    /// The sine.
    Sine,
    /// The cosine.
    Cosine,
    /// The tangent.
    Tangent,
    /// The arc sine; not a number outside `[-1, 1]`.
    ArcSine,
    /// The arc cosine; not a number outside `[-1, 1]`.
    ArcCosine,
    /// The arc tangent.
    ArcTangent,
    /// `e` to the power of `a`.
    Exponential,
    /// The natural logarithm; not a number below 0.
    Logarithm,
    /// 1 where `a` is 0, else 0.
    Not,
    /// The largest whole number not above.
    Floor,
    /// The smallest whole number not below.
    Ceiling,
    /// The nearest whole number, halves away from zero.
    Round,
}

impl Unary {
    /// Every operator.
    pub const ALL: [Self; 17] = [
        Self::Negate,
        Self::Absolute,
        Self::Reciprocal,
        Self::SquareRoot,
        Self::Square,
        Self::Sine,
        Self::Cosine,
        Self::Tangent,
        Self::ArcSine,
        Self::ArcCosine,
        Self::ArcTangent,
        Self::Exponential,
        Self::Logarithm,
        Self::Not,
        Self::Floor,
        Self::Ceiling,
        Self::Round,
    ];

    /// The name in text, such as `sqrt`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Negate => "neg",
            Self::Absolute => "abs",
            Self::Reciprocal => "recip",
            Self::SquareRoot => "sqrt",
            Self::Square => "square",
            Self::Sine => "sin",
            Self::Cosine => "cos",
            Self::Tangent => "tan",
            Self::ArcSine => "asin",
            Self::ArcCosine => "acos",
            Self::ArcTangent => "atan",
            Self::Exponential => "exp",
            Self::Logarithm => "ln",
            Self::Not => "not",
            Self::Floor => "floor",
            Self::Ceiling => "ceil",
            Self::Round => "round",
        }
    }

    /// The operator of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|operator| operator.name() == name)
    }

    /// The result for a number.
    pub fn of(self, a: f64) -> f64 {
        match self {
            Self::Negate => -a,
            Self::Absolute => a.abs(),
            Self::Reciprocal => 1.0 / a,
            Self::SquareRoot => a.sqrt(),
            Self::Square => a * a,
            Self::Sine => a.sin(),
            Self::Cosine => a.cos(),
            Self::Tangent => a.tan(),
            Self::ArcSine => a.asin(),
            Self::ArcCosine => a.acos(),
            Self::ArcTangent => a.atan(),
            Self::Exponential => a.exp(),
            Self::Logarithm => a.ln(),
            Self::Not => f64::from(u8::from(a == 0.0)),
            Self::Floor => a.floor(),
            Self::Ceiling => a.ceil(),
            Self::Round => a.round(),
        }
    }

    /// The result and its derivatives. Where a derivative does not exist, one side's; at the root of 0 it is 0.
    pub fn of_dual(self, a: Dual) -> Dual {
        let value = self.of(a.value);
        let slope = match self {
            Self::Negate => -1.0,
            Self::Absolute => {
                if a.value < 0.0 {
                    -1.0
                } else {
                    1.0
                }
            }
            Self::Reciprocal => -value * value,
            Self::SquareRoot => {
                if value == 0.0 {
                    0.0
                } else {
                    0.5 / value
                }
            }
            Self::Square => 2.0 * a.value,
            Self::Sine => a.value.cos(),
            Self::Cosine => -a.value.sin(),
            Self::Tangent => 1.0 + value * value,
            Self::ArcSine => 1.0 / (1.0 - a.value * a.value).sqrt(),
            Self::ArcCosine => -1.0 / (1.0 - a.value * a.value).sqrt(),
            Self::ArcTangent => 1.0 / (1.0 + a.value * a.value),
            Self::Exponential => value,
            Self::Logarithm => 1.0 / a.value,
            Self::Not | Self::Floor | Self::Ceiling | Self::Round => 0.0,
        };
        Dual { value, gradient: if slope == 0.0 { [0.0; 3] } else { a.gradient.map(|part| slope * part) } }
    }

    /// Bounds of the result over an interval.
    // Callers mostly know the operator.
    #[inline(always)]
    pub fn of_enclosure(self, a: Enclosure) -> Enclosure {
        match self {
            Self::Negate => a.negate(),
            Self::Absolute => a.absolute(),
            Self::Reciprocal => Enclosure::exactly(1.0).over(a),
            Self::SquareRoot => a.within(0.0, f64::INFINITY).rising(f64::sqrt, 1).at_least(0.0),
            Self::Square => a.square(),
            Self::Sine => a.sine(),
            Self::Cosine => a.cosine(),
            Self::Tangent => a.tangent(),
            Self::ArcSine => a.within(-1.0, 1.0).rising(f64::asin, LIBRARY),
            Self::ArcCosine => a.within(-1.0, 1.0).negate().rising(|negative| (-negative).acos(), LIBRARY),
            Self::ArcTangent => a.rising(f64::atan, LIBRARY),
            Self::Exponential => a.rising(f64::exp, LIBRARY).at_least(0.0),
            Self::Logarithm => a.within(0.0, f64::INFINITY).rising(f64::ln, LIBRARY),
            Self::Not => {
                if a.lo > 0.0 || a.hi < 0.0 {
                    Enclosure::exactly(0.0)
                } else if a.lo == 0.0 && a.hi == 0.0 && !a.undefined {
                    Enclosure::exactly(1.0)
                } else {
                    Enclosure::new(0.0, 1.0)
                }
            }
            Self::Floor => a.rising(f64::floor, 0),
            Self::Ceiling => a.rising(f64::ceil, 0),
            Self::Round => a.rising(f64::round, 0),
        }
    }
}

/// By how many units in the last place the platform's functions may be off; their libraries state one or less.
pub(super) const LIBRARY: u32 = 4;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        assert!(Unary::ALL.into_iter().all(|operator| Unary::from_name(operator.name()) == Some(operator)));
    }

    #[test]
    fn derivatives_are_difference_quotients() {
        let step = 1e-6;
        for operator in Unary::ALL {
            for a in [-0.83, -0.31, 0.27, 0.9] {
                let at = |x: f64| operator.of(x);
                let quotient = (at(a + step) - at(a - step)) / (2.0 * step);
                let slope = operator.of_dual(Dual::coordinate(a, 0)).gradient[0];
                assert!(quotient.is_nan() || (slope - quotient).abs() < 1e-7, "{operator:?} {a}: {slope} {quotient}");
            }
        }
    }

    #[test]
    fn enclosures_hold_samples() {
        for operator in Unary::ALL {
            for (lo, hi) in
                [(-0.9, -0.1), (-0.4, 0.7), (0.2, 0.3), (-8.0, 9.0), (0.0, 0.0), (2.5, 2.5), (0.0, 40.0), (-1e9, 3.0)]
            {
                let bounds = operator.of_enclosure(Enclosure::new(lo, hi));
                for step in 0..=1000 {
                    let value = operator.of((lo + (hi - lo) * f64::from(step) / 1000.0).clamp(lo, hi));
                    assert!(
                        if value.is_nan() { bounds.undefined } else { bounds.lo <= value && value <= bounds.hi },
                        "{operator:?} [{lo}, {hi}]: {value} not in {bounds:?}"
                    );
                }
            }
        }
    }
}
