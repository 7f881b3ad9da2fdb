//! Numbers that carry their derivatives.

/// A value with its derivatives along x, y and z: forward automatic differentiation (Wengert, 1964).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivatives along x, y and z.
    pub gradient: [f64; 3],
}

impl Dual {
    /// A number that does not change.
    pub fn constant(value: f64) -> Self {
        Self { value, gradient: [0.0; 3] }
    }

    /// A coordinate, along `axis` (0, 1 or 2).
    ///
    /// # Panics
    /// When there is no such axis.
    pub fn coordinate(value: f64, axis: usize) -> Self {
        let mut gradient = [0.0; 3];
        gradient[axis] = 1.0;
        Self { value, gradient }
    }
}
