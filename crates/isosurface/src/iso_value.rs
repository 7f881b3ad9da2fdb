//! The value that a surface is drawn at.

use shapeloom_core::{Bounds, OptionKind, OptionType, OptionValue};

/// The value that a surface is drawn at.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum IsoValue {
    /// What the samples suggest: 0 for distances, a half for occupancy, else Otsu's threshold.
    #[default]
    Auto,
    /// This value, rounded to single precision.
    At(f64),
}

impl IsoValue {
    /// The values that single precision holds.
    pub const BOUNDS: Bounds = Bounds::closed(f32::MIN as f64, f32::MAX as f64);
}

impl OptionType for IsoValue {
    const KIND: OptionKind = OptionKind::Float;

    fn parse(text: &str) -> Option<Self> {
        match text.trim() {
            "auto" => Some(Self::Auto),
            number => number.parse().ok().map(Self::At),
        }
    }

    fn to_value(&self) -> OptionValue {
        match *self {
            Self::Auto => OptionValue::Text("auto".to_owned()),
            Self::At(value) => OptionValue::Float(value),
        }
    }

    fn number(&self) -> Option<f64> {
        match *self {
            Self::Auto => None,
            Self::At(value) => Some(value),
        }
    }
}
