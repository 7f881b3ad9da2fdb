//! Numbers as people read them.

use std::fmt;

use glam::DVec3;

/// A number that is written with an exponent where it would have many zeros: `1e300`, not 301 digits.
pub struct Words(pub f64);

impl fmt::Display for Words {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size != 0.0 && size.is_finite() && !(1e-5..1e15).contains(&size) {
            write!(f, "{:e}", self.0)
        } else {
            write!(f, "{}", self.0)
        }
    }
}

/// A vector in the same manner.
pub struct VectorWords(pub DVec3);

impl fmt::Display for VectorWords {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "[{}, {}, {}]", Words(self.0.x), Words(self.0.y), Words(self.0.z))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_numbers_have_an_exponent() {
        let words = [0.0, 10.0, -0.25, 1e300, -1e-300, 1e15, 999e12, f64::NAN].map(|number| Words(number).to_string());
        assert_eq!(words, ["0", "10", "-0.25", "1e300", "-1e-300", "1e15", "999000000000000", "NaN"]);
    }
}
