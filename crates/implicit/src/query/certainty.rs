//! How sure an answer is.

use shapeloom_core::Interval;

/// How sure an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Certainty {
    /// It follows from values at points and from slopes there: right for fields that change evenly.
    Estimated,
    /// It follows from bounds of the field over boxes or from its Lipschitz constant.
    Proven,
}

impl Certainty {
    pub(super) fn proven_if(proven: bool) -> Self {
        if proven { Self::Proven } else { Self::Estimated }
    }
}

/// One side of the surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Where values are below 0.
    Inside,
    /// Where values are above 0, or not a number.
    Outside,
}

impl Side {
    /// The side of a value; 0 and what is not a number count as outside.
    pub fn of(value: f64) -> Self {
        if value < 0.0 { Self::Inside } else { Self::Outside }
    }

    /// The side on which all values within bounds lie, if it is one.
    pub(super) fn of_bounds(bounds: Interval) -> Option<Self> {
        if bounds.hi < 0.0 {
            Some(Self::Inside)
        } else if bounds.lo > 0.0 {
            Some(Self::Outside)
        } else {
            None
        }
    }
}
