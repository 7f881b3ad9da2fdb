//! The place on a line where a function changes its sign.

use super::Side;

/// A root within two ends of different sides, by ITP (Oliveira and Takahashi, 2021): no more steps than bisection plus one, and for
/// smooth functions few.
///
/// The place where the side changes is found to within a few units in the last place of the larger end. That is a zero of the function where it is
/// continuous there, a jump or the border of its domain otherwise. The end with the smaller value is taken.
pub(super) fn side_change(mut function: impl FnMut(f64) -> f64, start: (f64, f64), end: (f64, f64)) -> f64 {
    let ((mut a, mut at_a), (mut b, mut at_b)) = (start, end);
    let first = Side::of(at_a);
    let length = b - a;
    let fine = (2.0 * f64::EPSILON * a.abs().max(b.abs())).max(f64::MIN_POSITIVE);
    let halvings = (length.abs() / (2.0 * fine)).log2().ceil().clamp(0.0, 1100.0);
    let most = halvings as i32 + 1;
    for step in 0..=most + 1 {
        let width = b - a;
        if width.abs() <= fine || at_a == 0.0 && first == Side::Outside || at_b == 0.0 && first == Side::Inside {
            break;
        }
        let middle = a + width * 0.5;
        let secant = (at_b * a - at_a * b) / (at_b - at_a);
        let toward = (middle - secant).signum();
        let shift = 0.2 * (width / length) * width.abs();
        let truncated = if shift <= (middle - secant).abs() { secant + toward * shift } else { middle };
        let room = fine * 2.0_f64.powi(most - step) - width.abs() * 0.5;
        let mut place = if (truncated - middle).abs() <= room { truncated } else { middle - toward * room.max(0.0) };
        if !(place > a.min(b) && place < a.max(b)) {
            place = middle;
        }
        if place == a || place == b {
            break;
        }
        let value = function(place);
        if Side::of(value) == first { (a, at_a) = (place, value) } else { (b, at_b) = (place, value) }
    }
    if at_b.is_nan() || at_a.abs() <= at_b.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(function: impl Fn(f64) -> f64, a: f64, b: f64) -> (f64, u32) {
        let mut calls = 0;
        let place = side_change(
            |x| {
                calls += 1;
                function(x)
            },
            (a, function(a)),
            (b, function(b)),
        );
        (place, calls)
    }

    #[test]
    fn roots_are_the_closed_forms() {
        for (function, a, b, expected) in [
            ((|x| x * x - 2.0) as fn(f64) -> f64, 0.0, 2.0, 2.0_f64.sqrt()),
            (|x| 2.0 - x * x, 0.0, 2.0, 2.0_f64.sqrt()),
            (|x| x.exp() - 1e6, -5.0, 20.0, 1e6_f64.ln()),
            (|x| (x - 1.5).powi(9), 0.0, 4.0, 1.5),
            (|x| x - 1e9 - 0.25, 0.0, 3e9, 1e9 + 0.25),
            (|x| if x < 0.3 { -1.0 } else { 7.0 }, 0.0, 1.0, 0.3),
            (|x| 1e-300 * (x - 0.7), 0.0, 1.0, 0.7),
        ] {
            let (found, calls) = root(function, a, b);
            // The ninth power underflows near its root.
            let room = if expected == 1.5 { 1e-30 } else { 0.0 } + 4.0 * f64::EPSILON * b;
            assert!((found - expected).abs() <= room, "{found} {expected}");
            assert!(calls <= 64, "{calls}");
        }
        let (_, calls) = root(|x| x * x - 2.0, 0.0, 2.0);
        assert!(calls <= 12, "{calls}");
    }

    #[test]
    fn undefined_values_end_at_the_border() {
        let (found, calls) = root(|x| if x > 0.6 { f64::NAN } else { -1.0 }, 0.0, 1.0);
        assert!((found - 0.6).abs() < 1e-15 && calls < 64);
        let (found, _) = root(|x| if x > 0.6 { f64::INFINITY } else { f64::NEG_INFINITY }, 0.0, 1.0);
        assert!((found - 0.6).abs() < 1e-15);
    }
}
