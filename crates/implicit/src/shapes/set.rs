//! Union, intersection, difference.

/// An operation on solids as sets of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum SetOperation {
    /// What lies in any: the minimum.
    Union,
    /// What lies in all: the maximum.
    Intersection,
    /// What lies in the first and in no other: max(f, -g).
    Difference,
}

impl SetOperation {
    /// All three.
    pub const ALL: [Self; 3] = [Self::Union, Self::Intersection, Self::Difference];

    /// The name in text.
    pub fn name(self) -> &'static str {
        match self {
            Self::Union => "union",
            Self::Intersection => "intersection",
            Self::Difference => "difference",
        }
    }
}
