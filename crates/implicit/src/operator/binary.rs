//! Operators of two operands.

use super::enclosure::least;
use super::unary::LIBRARY;
use super::{Dual, Enclosure};

/// An operator of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a - b`.
    Subtract,
    /// `a * b`.
    Multiply,
    /// `a / b`.
    Divide,
    /// The smaller one; of a number and not a number, the number.
    Minimum,
    /// The larger one; of a number and not a number, the number.
    Maximum,
    /// -1, 0 or 1 as `a` is less than, equal to or more than `b`; else not a number.
    Compare,
    /// What remains of `a` after whole multiples of `b`, from 0 up to `|b|`.
    Modulo,
    /// `b` where `a` is not 0, else `a`.
    And,
    /// `a` where it is not 0, else `b`.
    Or,
    /// The angle of the point (b, a), in `[-π, π]`.
    ArcTangent2,
    /// `a` to the power of `b`.
    Power,
}

impl Binary {
    /// Every operator.
    pub const ALL: [Self; 12] = [
        Self::Add,
        Self::Subtract,
        Self::Multiply,
        Self::Divide,
        Self::Minimum,
        Self::Maximum,
        Self::Compare,
        Self::Modulo,
        Self::And,
        Self::Or,
        Self::ArcTangent2,
        Self::Power,
    ];

    /// The name in text, such as `min`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Subtract => "sub",
            Self::Multiply => "mul",
            Self::Divide => "div",
            Self::Minimum => "min",
            Self::Maximum => "max",
            Self::Compare => "compare",
            Self::Modulo => "mod",
            Self::And => "and",
            Self::Or => "or",
            Self::ArcTangent2 => "atan2",
            Self::Power => "pow",
        }
    }

    /// The operator of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|operator| operator.name() == name)
    }

    /// Whether the operands may change places.
    pub fn is_symmetric(self) -> bool {
        matches!(self, Self::Add | Self::Multiply)
    }

    /// The result for two numbers.
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Add => a + b,
            Self::Subtract => a - b,
            Self::Multiply => a * b,
            Self::Divide => a / b,
            // Written out, because the library's leaves the sign of the smaller zero open.
            Self::Minimum => {
                if a < b || b.is_nan() {
                    a
                } else {
                    b
                }
            }
            Self::Maximum => {
                if a > b || b.is_nan() {
                    a
                } else {
                    b
                }
            }
            Self::Compare => a.partial_cmp(&b).map_or(f64::NAN, |order| f64::from(order as i8)),
            Self::Modulo => a.rem_euclid(b),
            Self::And => {
                if a == 0.0 {
                    a
                } else {
                    b
                }
            }
            Self::Or => {
                if a == 0.0 {
                    b
                } else {
                    a
                }
            }
            Self::ArcTangent2 => a.atan2(b),
            Self::Power => a.powf(b),
        }
    }

    /// The result and its derivatives. Where a derivative does not exist, one side's.
    pub fn of_dual(self, a: Dual, b: Dual) -> Dual {
        let value = self.of(a.value, b.value);
        let both = |along_a: f64, along_b: f64| {
            let mut gradient = [0.0; 3];
            for (i, part) in gradient.iter_mut().enumerate() {
                // A side that does not change adds nothing, even where the slope along it is infinite.
                let part_of = |slope: f64, change: f64| if change == 0.0 { 0.0 } else { slope * change };
                *part = part_of(along_a, a.gradient[i]) + part_of(along_b, b.gradient[i]);
            }
            Dual { value, gradient }
        };
        match self {
            Self::Add => both(1.0, 1.0),
            Self::Subtract => both(1.0, -1.0),
            Self::Multiply => both(b.value, a.value),
            Self::Divide => both(1.0 / b.value, -value / b.value),
            Self::Minimum => {
                if a.value < b.value || b.value.is_nan() {
                    a
                } else {
                    b
                }
            }
            Self::Maximum => {
                if a.value > b.value || b.value.is_nan() {
                    a
                } else {
                    b
                }
            }
            Self::Compare => Dual::constant(value),
            Self::Modulo => both(1.0, -(a.value - value) / b.value),
            Self::And => {
                if a.value == 0.0 {
                    a
                } else {
                    b
                }
            }
            Self::Or => {
                if a.value == 0.0 {
                    b
                } else {
                    a
                }
            }
            Self::ArcTangent2 => {
                let square = a.value * a.value + b.value * b.value;
                both(b.value / square, -a.value / square)
            }
            Self::Power => both(b.value * a.value.powf(b.value - 1.0), value * a.value.ln()),
        }
    }

    /// Bounds of the result over two intervals, and for the operators that choose an operand, which.
    // Callers mostly know the operator.
    #[inline(always)]
    pub fn of_enclosures(self, a: Enclosure, b: Enclosure) -> (Enclosure, Choice) {
        let result = match self {
            Self::Add => a.plus(b),
            Self::Subtract => a.plus(b.negate()),
            Self::Multiply => a.times(b),
            Self::Divide => a.over(b),
            Self::Minimum => return minimum(a, b),
            Self::Maximum => {
                let (result, choice) = minimum(a.negate(), b.negate());
                return (result.negate(), choice);
            }
            Self::Compare => {
                let lo = if a.lo > b.hi {
                    1.0
                } else if a.lo >= b.hi {
                    0.0
                } else {
                    -1.0
                };
                let hi = if a.hi < b.lo {
                    -1.0
                } else if a.hi <= b.lo {
                    0.0
                } else {
                    1.0
                };
                Enclosure { lo, hi, undefined: a.undefined || b.undefined }
            }
            Self::Modulo => modulo(a, b),
            Self::And => return zero_or_not(a, b, Choice::Left, Choice::Right),
            Self::Or => return zero_or_not(a, b, Choice::Right, Choice::Left),
            Self::ArcTangent2 => angle(a, b),
            Self::Power => raised(a, b),
        };
        (result, Choice::Both)
    }
}

/// Which operand an operator that chooses takes, all over a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choice {
    /// Always the first.
    Left,
    /// Always the second.
    Right,
    /// Now one and now the other, or a mixture.
    Both,
}

#[inline(always)]
fn minimum(a: Enclosure, b: Enclosure) -> (Enclosure, Choice) {
    let (lo, hi) = (least(a.lo, b.lo), least(a.hi, b.hi));
    if !a.undefined && !b.undefined {
        // Without a branch, which could not be foretold. Both at once cannot be.
        let choice = [Choice::Both, Choice::Left, Choice::Right, Choice::Both]
            [usize::from(a.hi < b.lo) + 2 * usize::from(b.hi < a.lo)];
        return (Enclosure { lo, hi, undefined: false }, choice);
    }
    let mut result = Enclosure { lo, hi, undefined: a.undefined && b.undefined };
    // Where one is not a number the other one counts.
    if a.undefined {
        result.hi = result.hi.max(b.hi);
    }
    if b.undefined {
        result.hi = result.hi.max(a.hi);
    }
    (result, Choice::Both)
}

/// `zero` is chosen where `a` is 0, `other` elsewhere.
fn zero_or_not(a: Enclosure, b: Enclosure, zero: Choice, other: Choice) -> (Enclosure, Choice) {
    let of = |choice| if choice == Choice::Left { a } else { b };
    if a.lo > 0.0 || a.hi < 0.0 {
        // Not a number is not 0 either.
        (of(other), other)
    } else if a.lo == 0.0 && a.hi == 0.0 && !a.undefined {
        (of(zero), zero)
    } else if zero == Choice::Left {
        (Enclosure { lo: b.lo.min(0.0), hi: b.hi.max(0.0), undefined: b.undefined }, Choice::Both)
    } else {
        (a.hull(b), Choice::Both)
    }
}

fn modulo(a: Enclosure, b: Enclosure) -> Enclosure {
    let most = b.hi.abs().max(b.lo.abs());
    let undefined = a.undefined
        || b.undefined
        || (b.lo <= 0.0 && b.hi >= 0.0)
        || a.lo == f64::NEG_INFINITY
        || a.hi == f64::INFINITY;
    let whole = Enclosure { lo: 0.0, hi: most.next_up(), undefined };
    if b.lo != b.hi || undefined || a.hi - a.lo >= most {
        return whole;
    }
    // Within one period the remainder rises with `a`, unless a multiple of `b` lies between.
    let (lo, hi) = (a.lo.rem_euclid(b.lo), a.hi.rem_euclid(b.lo));
    let turns = |value: f64| ((value / most) - (value / most).abs() * 1e-15).floor();
    let more = |value: f64| ((value / most) + (value / most).abs() * 1e-15).floor();
    if turns(a.lo) != more(a.hi) || lo > hi {
        return whole;
    }
    Enclosure { lo: lo.next_down().max(0.0), hi: hi.next_up(), undefined: false }
}

fn angle(y: Enclosure, x: Enclosure) -> Enclosure {
    use std::f64::consts::PI;
    let undefined = y.undefined || x.undefined;
    let all = Enclosure { lo: -PI, hi: PI, undefined };
    // The cut along the negative x axis, and the origin.
    if x.lo <= 0.0 && y.lo <= 0.0 && y.hi >= 0.0 {
        return all;
    }
    let corners = [y.lo.atan2(x.lo), y.lo.atan2(x.hi), y.hi.atan2(x.lo), y.hi.atan2(x.hi)];
    let mut lo = corners.into_iter().fold(f64::INFINITY, f64::min);
    let mut hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
    if lo > hi {
        return Enclosure { undefined: true, ..all };
    }
    for _ in 0..LIBRARY {
        lo = lo.next_down();
        hi = hi.next_up();
    }
    Enclosure { lo: lo.max(-PI), hi: hi.min(PI), undefined }
}

/// A power with any exponent: not a number for a negative base, unless the exponent is whole.
fn raised(a: Enclosure, b: Enclosure) -> Enclosure {
    if a.lo <= 0.0 || a.undefined || b.undefined {
        return Enclosure::UNKNOWN;
    }
    let corners = [a.lo.powf(b.lo), a.lo.powf(b.hi), a.hi.powf(b.lo), a.hi.powf(b.hi)];
    if corners.into_iter().any(f64::is_nan) {
        return Enclosure::UNKNOWN;
    }
    let mut lo = corners.into_iter().fold(f64::INFINITY, f64::min);
    let mut hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
    for _ in 0..LIBRARY {
        lo = lo.next_down();
        hi = hi.next_up();
    }
    Enclosure { lo: lo.max(0.0), hi, undefined: false }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        assert!(Binary::ALL.into_iter().all(|operator| Binary::from_name(operator.name()) == Some(operator)));
    }

    #[test]
    fn derivatives_are_difference_quotients() {
        let step = 1e-6;
        for operator in Binary::ALL {
            for (a, b) in [(0.7, 1.3), (1.9, 0.6), (2.4, 2.9), (0.3, -1.1)] {
                let along = |da: f64, db: f64| operator.of(a + da, b + db);
                let result = operator.of_dual(Dual::coordinate(a, 0), Dual::coordinate(b, 1));
                let expected = [
                    (along(step, 0.0) - along(-step, 0.0)) / (2.0 * step),
                    (along(0.0, step) - along(0.0, -step)) / (2.0 * step),
                ];
                for i in 0..2 {
                    assert!(
                        (result.gradient[i] - expected[i]).abs() < 1e-7,
                        "{operator:?} {a} {b} {result:?} {expected:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn enclosures_hold_samples() {
        let ends = [-3.1, -1.0, -0.2, 0.0, 0.4, 1.0, 2.7];
        for operator in Binary::ALL {
            for (i, &a) in ends.iter().enumerate() {
                for &b in &ends[i..] {
                    for (j, &c) in ends.iter().enumerate() {
                        for &d in &ends[j..] {
                            let (left, right) = (Enclosure::new(a, b), Enclosure::new(c, d));
                            let (bounds, choice) = operator.of_enclosures(left, right);
                            for step in 0..=64 {
                                let at = |lo: f64, hi: f64, part: i32| {
                                    (lo + (hi - lo) * f64::from(part) / 8.0).clamp(lo, hi)
                                };
                                let (x, y) = (at(a, b, step % 9), at(c, d, step / 9));
                                let value = operator.of(x, y);
                                let held = if value.is_nan() {
                                    bounds.undefined
                                } else {
                                    bounds.lo <= value && value <= bounds.hi
                                };
                                assert!(
                                    held,
                                    "{operator:?} {left:?} {right:?}: {x} {y} gives {value}, not in {bounds:?}"
                                );
                                match choice {
                                    Choice::Left => assert_eq!(value, x),
                                    Choice::Right => assert_eq!(value, y),
                                    Choice::Both => {}
                                }
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_not_a_number_gives_way() {
        assert_eq!(Binary::Minimum.of(f64::NAN, 2.0), 2.0);
        assert_eq!(Binary::Maximum.of(2.0, f64::NAN), 2.0);
        let unknown = Enclosure::UNKNOWN;
        let (bounds, choice) =
            Binary::Maximum.of_enclosures(Enclosure { lo: 0.0, ..unknown }, Enclosure::new(-5.0, -3.0));
        assert_eq!(choice, Choice::Both);
        assert!(bounds.lo <= -5.0 && !bounds.undefined);
    }
}
