//! Closed intervals of real numbers.

/// A closed interval `[lo, hi]`; empty when `lo > hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The lower end.
    pub lo: f64,
    /// The upper end.
    pub hi: f64,
}

impl Interval {
    /// `[0, 1]`.
    pub const UNIT: Self = Self { lo: 0.0, hi: 1.0 };
    /// Every real number, for bounds that are not known.
    pub const ALL: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// `[lo, hi]`.
    pub const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi }
    }

    /// Whether `value` lies in the interval. False for NaN.
    pub fn contains(&self, value: f64) -> bool {
        self.lo <= value && value <= self.hi
    }

    /// Whether no number lies in the interval.
    pub fn is_empty(&self) -> bool {
        self.lo > self.hi || self.lo.is_nan() || self.hi.is_nan()
    }

    /// `hi - lo`.
    pub fn length(&self) -> f64 {
        self.hi - self.lo
    }

    /// The point at `fraction` of the way; exactly `lo` at 0 and `hi` at 1.
    pub fn at(&self, fraction: f64) -> f64 {
        self.lo * (1.0 - fraction) + self.hi * fraction
    }

    /// The nearest point of the interval to `value`.
    pub fn clamp(&self, value: f64) -> f64 {
        value.max(self.lo).min(self.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_met_exactly() {
        let domain = Interval::new(0.1, 0.7);
        assert_eq!(domain.at(0.0), 0.1);
        assert_eq!(domain.at(1.0), 0.7);
    }

    #[test]
    fn nan_is_in_no_interval() {
        assert!(!Interval::ALL.contains(f64::NAN));
        assert!(Interval::new(f64::NAN, 1.0).is_empty());
    }
}
