//! Interval arithmetic with outward rounding.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::unary::LIBRARY;

/// Bounds of a quantity: every value lies in `[lo, hi]`, or is not a number where `undefined` says that this may happen.
///
/// Every operation rounds its ends outward, so that bounds hold for the values that the operators compute, rounding included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosure {
    /// No value is less.
    pub lo: f64,
    /// No value is more.
    pub hi: f64,
    /// Whether the value may be not a number somewhere.
    pub undefined: bool,
}

/// How far an end moves outward.
#[inline(always)]
fn room(end: f64) -> f64 {
    end.abs() * f64::EPSILON + f64::MIN_POSITIVE
}

/// The smaller of two ends, neither of which is not a number: the library's takes care of those, which costs more.
#[inline(always)]
pub(super) fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The larger of two ends.
#[inline(always)]
pub(super) fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl Enclosure {
    /// Nothing is known.
    pub const UNKNOWN: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, undefined: true };

    /// `[lo, hi]`; nothing known where an end is not a number.
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo.is_nan() || hi.is_nan() { Self::UNKNOWN } else { Self { lo, hi, undefined: false } }
    }

    /// One number.
    pub fn exactly(value: f64) -> Self {
        Self::new(value, value)
    }

    /// Whether all values are below 0, and defined.
    pub fn is_negative(&self) -> bool {
        self.hi < 0.0 && !self.undefined
    }

    /// Whether all values that are defined are above 0.
    pub fn is_positive(&self) -> bool {
        self.lo > 0.0
    }

    fn or_undefined(mut self, undefined: bool) -> Self {
        self.undefined |= undefined;
        self
    }

    /// The ends of an operation's result, rounded outward by one or two units in the last place.
    ///
    /// An end v moves by e = |v| · 2⁻⁵² + the least normal number. That is at least the distance from v to its neighbour: for normal v
    /// the first part alone is, and it loses nothing to rounding unless it is subnormal itself, where the second part is more. So the exact
    /// v ± e lies at the neighbour or beyond, and rounding, which is monotone, does not bring it back. An end that is not
    /// finite and faces inward gives not a number, hence nothing known.
    #[inline(always)]
    pub(crate) fn outward(lo: f64, hi: f64) -> Self {
        let (lo, hi) = (lo - room(lo), hi + room(hi));
        if lo.is_nan() || hi.is_nan() {
            return Self::UNKNOWN;
        }
        Self { lo, hi, undefined: false }
    }

    /// Whether both ends of both are finite. Said of fewer where the lengths overflow.
    #[inline(always)]
    fn both_finite(self, other: Self) -> bool {
        (self.hi - self.lo) + (other.hi - other.lo) < f64::INFINITY
    }

    #[inline(always)]
    pub(super) fn at_least(mut self, bound: f64) -> Self {
        self.lo = most(self.lo, bound);
        self
    }

    fn clamped(mut self, least: f64, most: f64) -> Self {
        self.lo = self.lo.clamp(least, most);
        self.hi = self.hi.clamp(least, most);
        self
    }

    /// The part inside a function's domain; the rest is not a number.
    pub(super) fn within(self, least: f64, most: f64) -> Self {
        if self.hi < least || self.lo > most {
            // No value is defined. The ends must still be in the domain.
            return Self { lo: least.max(-1.0), hi: most.min(1.0), undefined: true };
        }
        let undefined = self.undefined || self.lo < least || self.hi > most;
        Self { lo: self.lo.max(least), hi: self.hi.min(most), undefined }
    }

    /// A function that does not fall, off by at most `ulps` units in the last place.
    pub(super) fn rising(self, function: impl Fn(f64) -> f64, ulps: u32) -> Self {
        let mut result = Self::new(function(self.lo), function(self.hi));
        for _ in 0..ulps {
            result.lo = result.lo.next_down();
            result.hi = result.hi.next_up();
        }
        result.or_undefined(self.undefined)
    }

    #[inline(always)]
    pub(super) fn negate(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo, undefined: self.undefined }
    }

    #[inline(always)]
    pub(super) fn absolute(self) -> Self {
        // Without asking where the interval lies: no branch could be foretold.
        Self { lo: most(most(self.lo, -self.hi), 0.0), hi: most(self.hi, -self.lo), undefined: self.undefined }
    }

    #[inline(always)]
    pub(super) fn square(self) -> Self {
        let size = self.absolute();
        Self::outward(size.lo * size.lo, size.hi * size.hi).at_least(0.0).or_undefined(self.undefined)
    }

    /// A whole power; of 0 it is 1.
    pub(crate) fn power(self, exponent: i32) -> Self {
        if exponent < 0 {
            return Self::exactly(1.0).over(self.power_up(exponent.unsigned_abs()));
        }
        self.power_up(exponent.unsigned_abs())
    }

    fn power_up(self, exponent: u32) -> Self {
        let even = exponent.is_multiple_of(2);
        let base = if even { self.absolute() } else { self };
        // Each factor of the product by repeated squaring adds less than one rounding.
        let slack = 1.0 + 2.0 * f64::EPSILON * f64::from(exponent);
        let end = |value: f64, outward: f64| {
            let power = crate::power::power(value, exponent as i32);
            let wide = power * if (power > 0.0) == (outward > 0.0) { slack } else { 1.0 / slack };
            if outward > 0.0 { wide.next_up() } else { wide.next_down() }
        };
        let result = Self::new(end(base.lo, -1.0), end(base.hi, 1.0)).or_undefined(self.undefined);
        if even { result.at_least(0.0) } else { result }
    }

    #[inline(always)]
    pub(super) fn plus(self, other: Self) -> Self {
        let undefined = self.undefined
            || other.undefined
            || (!self.both_finite(other)
                && ((self.hi == f64::INFINITY && other.lo == f64::NEG_INFINITY)
                    || (self.lo == f64::NEG_INFINITY && other.hi == f64::INFINITY)));
        let sum = Self::outward(self.lo + other.lo, self.hi + other.hi).or_undefined(undefined);
        sum.not_below_0_if(self.lo >= 0.0 && other.lo >= 0.0)
    }

    /// Rounding makes no sum or product of numbers from 0 on negative; a root of it would else be undefined.
    #[inline(always)]
    fn not_below_0_if(self, holds: bool) -> Self {
        if holds { self.at_least(0.0) } else { self }
    }

    #[inline(always)]
    pub(super) fn times(self, other: Self) -> Self {
        if !self.both_finite(other) {
            return self.times_any(other);
        }
        let (a, b) = (self.lo * other.lo, self.lo * other.hi);
        let (c, d) = (self.hi * other.lo, self.hi * other.hi);
        Self::outward(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
            .or_undefined(self.undefined || other.undefined)
            .not_below_0_if(self.lo >= 0.0 && other.lo >= 0.0)
    }

    fn times_any(self, other: Self) -> Self {
        let holds_zero = |a: Self| a.lo <= 0.0 && a.hi >= 0.0;
        let undefined = self.undefined
            || other.undefined
            || (holds_zero(self) && other.is_wide())
            || (holds_zero(other) && self.is_wide());
        // Nothing times infinity is not a number at that very end only; the products beside it come near 0.
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let (a, b) = (product(self.lo, other.lo), product(self.lo, other.hi));
        let (c, d) = (product(self.hi, other.lo), product(self.hi, other.hi));
        Self::outward(least(least(a, b), least(c, d)), most(most(a, b), most(c, d)))
            .or_undefined(undefined)
            .not_below_0_if(self.lo >= 0.0 && other.lo >= 0.0)
    }

    pub(super) fn over(self, other: Self) -> Self {
        if other.lo <= 0.0 && other.hi >= 0.0 {
            let undefined = self.undefined || other.undefined || (self.lo <= 0.0 && self.hi >= 0.0);
            return Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, undefined: undefined || other.is_wide() };
        }
        let undefined = self.undefined || other.undefined || (self.is_wide() && other.is_wide());
        let quotients = [self.lo / other.lo, self.lo / other.hi, self.hi / other.lo, self.hi / other.hi];
        if quotients.into_iter().any(f64::is_nan) {
            return Self::UNKNOWN;
        }
        let [a, b, c, d] = quotients;
        Self::outward(least(least(a, b), least(c, d)), most(most(a, b), most(c, d))).or_undefined(undefined)
    }

    fn is_wide(self) -> bool {
        self.lo == f64::NEG_INFINITY || self.hi == f64::INFINITY
    }

    /// Bounds of everything in either.
    pub(crate) fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), undefined: self.undefined || other.undefined }
    }

    pub(super) fn sine(self) -> Self {
        // The sine is the cosine a quarter turn later; the peaks are found with room for rounding.
        self.wave(FRAC_PI_2, f64::sin)
    }

    pub(super) fn cosine(self) -> Self {
        self.wave(0.0, f64::cos)
    }

    /// A wave of period 2π whose peaks lie at `peak + 2πk`.
    fn wave(self, peak: f64, function: impl Fn(f64) -> f64) -> Self {
        let full = Self { lo: -1.0, hi: 1.0, undefined: self.undefined || self.is_wide() };
        // Beyond this, the place within the period is lost in rounding.
        if self.is_wide() || self.hi - self.lo >= TAU || self.lo.abs().max(self.hi.abs()) > 1e8 {
            return full;
        }
        // 1e8 turns carry an error of 1e-8 here.
        let meets = |place: f64| {
            let first = ((self.lo - place) / TAU - 1e-7).ceil();
            place + first * TAU <= self.hi + 1e-6
        };
        let (a, b) = (function(self.lo), function(self.hi));
        let mut result = Self::new(a.min(b), a.max(b));
        for _ in 0..LIBRARY {
            result.lo = result.lo.next_down();
            result.hi = result.hi.next_up();
        }
        if meets(peak) {
            result.hi = 1.0;
        }
        if meets(peak + PI) {
            result.lo = -1.0;
        }
        result.clamped(-1.0, 1.0).or_undefined(self.undefined)
    }

    pub(super) fn tangent(self) -> Self {
        let all = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY, undefined: self.undefined || self.is_wide() };
        if self.is_wide() || self.hi - self.lo >= PI || self.lo.abs().max(self.hi.abs()) > 1e8 {
            return all;
        }
        let branch = |x: f64, room: f64| ((x + FRAC_PI_2) / PI + room).floor();
        if branch(self.lo, -1e-7) != branch(self.hi, 1e-7) {
            return all;
        }
        self.rising(f64::tan, LIBRARY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_hold_samples() {
        for exponent in [-5, -2, -1, 0, 1, 2, 3, 4, 7, 20] {
            for (lo, hi) in [(-1.5, -0.5), (-2.0, 1.0), (0.3, 4.0), (1.0, 1.0), (-3.0, 0.0)] {
                let bounds = Enclosure::new(lo, hi).power(exponent);
                for step in 0..=100 {
                    let base = (lo + (hi - lo) * f64::from(step) / 100.0).clamp(lo, hi);
                    let value = crate::power::power(base, exponent);
                    assert!(bounds.lo <= value && value <= bounds.hi, "{exponent} [{lo}, {hi}] {value} {bounds:?}");
                }
            }
        }
    }

    #[test]
    fn ends_move_to_their_neighbours_or_beyond() {
        let mut ends =
            vec![0.0, f64::MIN_POSITIVE, f64::MAX, f64::from_bits(1), 1.0, 1.0_f64.next_down(), 2.0_f64.powi(-970)];
        let mut bits = 1_u64;
        for _ in 0..20_000 {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ends.push(f64::from_bits(bits ^ bits >> 17));
        }
        for end in ends.into_iter().filter(|end| end.is_finite()).flat_map(|end| [end, -end]) {
            let moved = Enclosure::outward(end, end);
            assert!(moved.lo <= end.next_down() && moved.hi >= end.next_up(), "{end:e} {moved:?}");
            let far = if end.abs() < 1e-290 { 1.0 } else { 3.0 * f64::EPSILON * end.abs() };
            assert!(!moved.lo.is_finite() || end - moved.lo <= far, "{end:e} {moved:?}");
        }
        assert!(Enclosure::outward(f64::INFINITY, f64::INFINITY).undefined);
        assert_eq!(Enclosure::outward(2.0, f64::INFINITY).hi, f64::INFINITY);
    }

    #[test]
    fn sums_of_squares_have_roots() {
        let square = Enclosure::new(-1.0, 2.0).square();
        let sum = square.plus(square).plus(square.times(square));
        assert!(sum.lo == 0.0 && !sum.within(0.0, f64::INFINITY).undefined);
    }

    #[test]
    fn infinite_ends_keep_what_is_known() {
        let all = Enclosure::new(f64::NEG_INFINITY, f64::INFINITY);
        assert!(all.plus(all.negate()).undefined);
        assert!(all.times(Enclosure::exactly(0.0)).undefined);
        assert_eq!(Enclosure::new(1.0, f64::INFINITY).times(Enclosure::new(2.0, 3.0)).hi, f64::INFINITY);
        assert!(Enclosure::new(-3.0, -2.0).within(0.0, f64::INFINITY).undefined);
    }
}
