//! Accuracies as people write them.

use std::fmt;
use std::str::FromStr;

use crate::{Category, Diagnostic, Words};

/// A tolerance in model units, or relative to the diagonal of the shape's bounding box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// In model units.
    Absolute(f64),
    /// As a fraction of the bounding box's diagonal: 0.001 for `0.1%`.
    OfDiagonal(f64),
}

impl Tolerance {
    /// The tolerance in model units for a shape whose bounding box has that diagonal.
    ///
    /// # Errors
    /// The tolerance is not a positive finite number, or relative to a diagonal that is zero or not finite.
    pub fn resolve(self, diagonal: f64) -> Result<f64, ToleranceError> {
        let usable = |value: f64| value.is_finite() && value > 0.0;
        match self {
            Self::Absolute(value) if usable(value) => Ok(value),
            Self::OfDiagonal(fraction) if usable(fraction) => match fraction * diagonal {
                value if usable(value) => Ok(value),
                _ => Err(ToleranceError::NoScale { diagonal }),
            },
            Self::Absolute(value) => Err(ToleranceError::NotPositive { found: Words(value).to_string() }),
            Self::OfDiagonal(fraction) => Err(ToleranceError::NotPositive { found: format!("{}%", fraction * 100.0) }),
        }
    }
}

impl FromStr for Tolerance {
    type Err = ToleranceError;

    fn from_str(text: &str) -> Result<Self, ToleranceError> {
        let unreadable = || ToleranceError::Unreadable { found: text.to_owned() };
        let tolerance = match text.trim().strip_suffix('%') {
            Some(number) => Self::OfDiagonal(number.trim_end().parse::<f64>().map_err(|_| unreadable())? / 100.0),
            None => Self::Absolute(text.trim().parse::<f64>().map_err(|_| unreadable())?),
        };
        let (Self::Absolute(value) | Self::OfDiagonal(value)) = tolerance;
        if value.is_finite() && value > 0.0 {
            Ok(tolerance)
        } else {
            Err(ToleranceError::NotPositive { found: text.to_owned() })
        }
    }
}

impl fmt::Display for Tolerance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Absolute(value) => write!(f, "{}", Words(*value)),
            Self::OfDiagonal(fraction) => write!(f, "{}%", fraction * 100.0),
        }
    }
}

/// Why a tolerance cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum ToleranceError {
    /// The text is no number, nor a number with `%`.
    Unreadable {
        /// The text.
        found: String,
    },
    /// Zero, negative, infinite or NaN.
    NotPositive {
        /// The value as given.
        found: String,
    },
    /// Relative to a shape without size.
    NoScale {
        /// The diagonal of the bounding box.
        diagonal: f64,
    },
}

impl fmt::Display for ToleranceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { found } => {
                write!(f, "tolerance: found \"{found}\", expected a number such as 0.01 or 0.1%")
            }
            Self::NotPositive { found } => {
                write!(f, "tolerance: found {found}, expected a finite number above 0")
            }
            Self::NoScale { diagonal } => {
                write!(
                    f,
                    "tolerance: found one in per cent, but the shape's bounding box has the diagonal {}",
                    Words(*diagonal)
                )
            }
        }
    }
}

impl std::error::Error for ToleranceError {}

impl Diagnostic for ToleranceError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unreadable { .. } => "E-tolerance-text",
            Self::NotPositive { .. } => "E-tolerance-range",
            Self::NoScale { .. } => "E-tolerance-scale",
        }
    }

    fn category(&self) -> Category {
        Category::Usage
    }

    fn advice(&self) -> Option<String> {
        Some(match self {
            Self::Unreadable { .. } | Self::NotPositive { .. } => {
                "give a length in model units (0.01) or per cent of the diagonal (0.1%)".into()
            }
            Self::NoScale { .. } => "give the tolerance in model units, without %".into(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_lengths_and_percentages() {
        assert_eq!("0.5".parse(), Ok(Tolerance::Absolute(0.5)));
        assert_eq!("50%".parse(), Ok(Tolerance::OfDiagonal(0.5)));
        assert_eq!(Tolerance::OfDiagonal(0.5).resolve(4.0), Ok(2.0));
    }

    #[test]
    fn refuses_what_is_no_accuracy() {
        for text in ["0", "-1", "nan", "inf", "1e400", "0%", "-0.1%"] {
            assert!(matches!(text.parse::<Tolerance>(), Err(ToleranceError::NotPositive { .. })), "{text}");
        }
        for text in ["", "%", "tight", "0.1 %%"] {
            assert!(matches!(text.parse::<Tolerance>(), Err(ToleranceError::Unreadable { .. })), "{text}");
        }
        assert!(matches!(Tolerance::OfDiagonal(0.1).resolve(0.0), Err(ToleranceError::NoScale { .. })));
        assert!(Tolerance::Absolute(f64::NAN).resolve(1.0).is_err());
    }
}
