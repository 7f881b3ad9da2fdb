//! Compensated summation.

/// A sum that carries its rounding error along (Neumaier 1974), and the sum of magnitudes, which bounds what is left.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sum {
    sum: f64,
    lost: f64,
    magnitudes: f64,
}

impl Sum {
    pub fn add(&mut self, value: f64) {
        let next = self.sum + value;
        self.lost += if self.sum.abs() >= value.abs() { (self.sum - next) + value } else { (value - next) + self.sum };
        self.sum = next;
        self.magnitudes += value.abs();
    }

    pub fn total(&self) -> f64 {
        self.sum + self.lost
    }

    /// How far the total may be from the true sum, for up to 2^40 terms.
    pub fn error(&self) -> f64 {
        // Neumaier: u |s| + O(n² u²) Σ|x|; half a hundred ulps of the magnitudes hold both with room.
        self.magnitudes * 2f64.powi(-48)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cancelling_terms_leave_the_small_ones() {
        let mut sum = Sum::default();
        for value in [1.0, 1e17, 3.0, -1e17, 1e-3] {
            sum.add(value);
        }
        assert_eq!(sum.total(), 4.001);
        assert!(sum.error() >= 0.0);
    }
}
