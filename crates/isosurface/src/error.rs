//! Why numbers make no lattice.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};

/// Why numbers make no lattice.
#[derive(Clone, Debug, PartialEq)]
pub enum LatticeError {
    /// A direction without samples.
    NoSamples {
        /// The samples in each direction.
        dimensions: [u32; 3],
    },
    /// More samples than any lattice may have.
    TooMany {
        /// The samples in each direction.
        dimensions: [u32; 3],
    },
    /// A distance between samples that is not positive and finite.
    Spacing {
        /// The direction: 0, 1, 2.
        axis: usize,
        /// The distance.
        found: f64,
    },
    /// Steps between samples that are not finite or lie in one plane.
    Placement,
    /// Another number of samples than the lattice has.
    SampleCount {
        /// How many the lattice has.
        expected: u64,
        /// How many were given.
        found: u64,
    },
}

impl fmt::Display for LatticeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoSamples { dimensions: [x, y, z] } => {
                write!(f, "lattice: found {x} x {y} x {z} samples, expected at least one in each direction")
            }
            Self::TooMany { dimensions: [x, y, z] } => {
                write!(f, "lattice: found {x} x {y} x {z} samples, expected at most 2^40, and 2^31 in a slab")
            }
            Self::Spacing { axis, found } => {
                let axis = ["x", "y", "z"].get(*axis).unwrap_or(&"?");
                write!(f, "lattice: found spacing {found:e} along {axis}, expected a positive number")
            }
            Self::Placement => {
                f.write_str("lattice: found steps between samples that are not finite or lie in one plane, expected three directions")
            }
            Self::SampleCount { expected, found } => {
                write!(f, "lattice: found {found} samples, expected {expected}")
            }
        }
    }
}

impl std::error::Error for LatticeError {}

impl Diagnostic for LatticeError {
    fn code(&self) -> &'static str {
        match self {
            Self::NoSamples { .. } | Self::TooMany { .. } => "E-lattice-size",
            Self::Spacing { .. } => "E-lattice-spacing",
            Self::Placement => "E-lattice-placement",
            Self::SampleCount { .. } => "E-lattice-samples",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::TooMany { .. } => Category::OverLimit,
            _ => Category::Malformed,
        }
    }
}
