//! The numbers that an option accepts.

use std::fmt;

use crate::Words;

/// The numbers that an option accepts. NaN is in no bounds; infinity is in none but [`Bounds::ANY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest number, or the limit that it must exceed.
    pub min: f64,
    /// Whether `min` itself is refused.
    pub above: bool,
    /// The largest number.
    pub max: f64,
}

impl Bounds {
    /// Every number but NaN.
    pub const ANY: Self = Self { min: f64::NEG_INFINITY, above: false, max: f64::INFINITY };
    /// Every finite number above 0.
    pub const POSITIVE: Self = Self { min: 0.0, above: true, max: f64::MAX };
    /// Every finite number from 0 on.
    pub const NON_NEGATIVE: Self = Self { min: 0.0, above: false, max: f64::MAX };
    /// Every finite number.
    pub const FINITE: Self = Self { min: f64::MIN, above: false, max: f64::MAX };

    /// From `min` to `max`, both included.
    pub const fn closed(min: f64, max: f64) -> Self {
        Self { min, above: false, max }
    }

    /// Whether `value` is accepted.
    pub fn contains(&self, value: f64) -> bool {
        value <= self.max && if self.above { value > self.min } else { value >= self.min }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lower = match (self.above, self.min) {
            (_, f64::NEG_INFINITY | f64::MIN) => String::new(),
            (true, min) => format!("above {}", Words(min)),
            (false, min) => format!("from {}", Words(min)),
        };
        let upper = match self.max {
            f64::INFINITY => String::new(),
            f64::MAX => "finite".to_owned(),
            max => format!("to {}", Words(max)),
        };
        match (lower.is_empty(), upper.is_empty()) {
            (true, true) => f.write_str("any number"),
            (true, false) => f.write_str(&upper),
            (false, true) => f.write_str(&lower),
            (false, false) if self.max == f64::MAX => write!(f, "{lower}, {upper}"),
            (false, false) => write!(f, "{lower} {upper}"),
        }
    }
}
