//! The account of what a conversion cost.

use std::fmt;

use crate::Findings;

/// How far a result may lie from its source: the two-sided Hausdorff distance in model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Deviation {
    /// None, up to rounding of a few units in the last place.
    Exact,
    /// Proven not to exceed this.
    AtMost(f64),
    /// Measured or extrapolated, not proven.
    Estimated(f64),
    /// Nothing is known.
    Unknown,
}

impl Deviation {
    /// The deviation of two conversions in a row, by the triangle inequality: bounds add to a bound, anything estimated
    /// makes an estimate, unknown absorbs. The sum of bounds is rounded up.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        use Deviation::{AtMost, Estimated, Exact, Unknown};
        match (self, next) {
            (Unknown, _) | (_, Unknown) => Unknown,
            (Exact, other) | (other, Exact) => other,
            (AtMost(a), AtMost(b)) => AtMost((a + b).next_up()),
            (AtMost(a) | Estimated(a), AtMost(b) | Estimated(b)) => Estimated(a + b),
        }
    }

    /// The deviation of two things side by side in one shape: the larger one.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        use Deviation::{AtMost, Estimated, Exact, Unknown};
        match (self, other) {
            (Unknown, _) | (_, Unknown) => Unknown,
            (Exact, known) | (known, Exact) => known,
            (AtMost(a), AtMost(b)) => AtMost(a.max(b)),
            (AtMost(a) | Estimated(a), AtMost(b) | Estimated(b)) => Estimated(a.max(b)),
        }
    }

    /// The number, if there is one: 0 for exact, none for unknown.
    pub fn value(self) -> Option<f64> {
        match self {
            Self::Exact => Some(0.0),
            Self::AtMost(value) | Self::Estimated(value) => Some(value),
            Self::Unknown => None,
        }
    }

    /// Whether the deviation is proven not to exceed `tolerance`.
    pub fn is_within(self, tolerance: f64) -> bool {
        match self {
            Self::Exact => true,
            Self::AtMost(bound) => bound <= tolerance,
            Self::Estimated(_) | Self::Unknown => false,
        }
    }

    /// The name of the kind: `exact`, `at_most`, `estimated`, `unknown`.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::AtMost(_) => "at_most",
            Self::Estimated(_) => "estimated",
            Self::Unknown => "unknown",
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Exact => f.write_str("exact up to rounding"),
            Self::AtMost(bound) => write!(f, "at most {bound:.4e} (proven)"),
            Self::Estimated(value) => write!(f, "about {value:.4e} (estimated)"),
            Self::Unknown => f.write_str("unknown"),
        }
    }
}

/// Something of the source that the result does not hold.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Loss {
    /// What: `vertex attribute "heat"`, `materials`.
    pub what: String,
    /// Why it could not be kept.
    pub why: String,
}

impl Loss {
    /// A loss, named and explained.
    pub fn new(what: impl Into<String>, why: impl Into<String>) -> Self {
        Self { what: what.into(), why: why.into() }
    }
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.what, self.why)
    }
}

/// A named number of a report, such as a count or a measured quality.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The name in the manner of an identifier: `triangles`, `edges_shared`.
    pub name: String,
    /// The value.
    pub value: f64,
}

/// What a conversion cost: how far the result may be from its source, what was lost, what was noticed.
///
/// A report holds no time: libraries have no clock, and outputs that embed reports are reproducible byte for byte.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The algorithms that ran, in order.
    pub steps: Vec<&'static str>,
    /// How far the result may lie from the source.
    pub deviation: Deviation,
    /// Why the deviation is what it says: the theorem, the measurement.
    pub basis: String,
    /// What the result does not hold.
    pub losses: Vec<Loss>,
    /// What was odd about the source.
    pub findings: Findings,
    /// Sizes and qualities by name.
    pub figures: Vec<Figure>,
    /// Proven bounds by part of the source (patch, curve), where the algorithm has them; else empty.
    pub certificates: Vec<f64>,
}

impl Report {
    /// The report of one step.
    pub fn new(step: &'static str, deviation: Deviation, basis: impl Into<String>) -> Self {
        Self {
            steps: vec![step],
            deviation,
            basis: basis.into(),
            losses: Vec::new(),
            findings: Findings::default(),
            figures: Vec::new(),
            certificates: Vec::new(),
        }
    }

    /// The report of a step that changes no geometry.
    pub fn exact(step: &'static str, basis: impl Into<String>) -> Self {
        Self::new(step, Deviation::Exact, basis)
    }

    /// Adds a named number.
    pub fn figure(&mut self, name: impl Into<String>, value: impl Into<f64>) {
        self.figures.push(Figure { name: name.into(), value: value.into() });
    }

    /// The figure of that name, the latest if there are several.
    pub fn find(&self, name: &str) -> Option<f64> {
        self.figures.iter().rev().find(|figure| figure.name == name).map(|figure| figure.value)
    }

    /// The report of this conversion followed by another.
    #[must_use]
    pub fn then(mut self, next: Self) -> Self {
        self.steps.extend(next.steps);
        self.deviation = self.deviation.then(next.deviation);
        if self.basis.is_empty() {
            self.basis = next.basis;
        } else if !next.basis.is_empty() && next.basis != self.basis {
            self.basis = format!("{}; then {}", self.basis, next.basis);
        }
        for loss in next.losses {
            if !self.losses.contains(&loss) {
                self.losses.push(loss);
            }
        }
        self.findings.extend(next.findings);
        self.figures.extend(next.figures);
        if self.certificates.is_empty() {
            self.certificates = next.certificates;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Deviation::{AtMost, Estimated, Exact, Unknown};

    #[test]
    fn bounds_add_to_a_bound_that_is_not_too_small() {
        let AtMost(sum) = AtMost(0.1).then(AtMost(0.2)) else { panic!("bounds stay bounds") };
        assert!((0.1 + 0.2..0.300_000_000_000_001).contains(&sum));
        assert_eq!(Exact.then(AtMost(1.0)), AtMost(1.0));
        assert_eq!(AtMost(1.0).then(Estimated(2.0)), Estimated(3.0));
        assert_eq!(Estimated(1.0).then(Unknown), Unknown);
        assert_eq!(AtMost(1.0).or(AtMost(2.0)), AtMost(2.0));
    }

    #[test]
    fn only_proven_bounds_meet_a_tolerance() {
        assert!(AtMost(1.0).is_within(1.0));
        assert!(!Estimated(0.0).is_within(1.0));
        assert!(!AtMost(f64::NAN).is_within(1.0));
    }

    #[test]
    fn chained_reports_keep_everything() {
        let mut first = Report::new("first", AtMost(1.0), "a");
        first.losses.push(Loss::new("colour", "no place"));
        first.figure("triangles", 3);
        let mut second = Report::exact("second", "b");
        second.losses.push(Loss::new("colour", "no place"));
        second.figure("triangles", 2);
        let both = first.then(second);
        assert_eq!(both.steps, ["first", "second"]);
        assert_eq!(both.losses.len(), 1);
        assert_eq!(both.find("triangles"), Some(2.0));
        assert_eq!(both.deviation, AtMost(1.0));
    }
}
