//! Where a field is sampled, as an option.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, OptionKind, OptionType, OptionValue};

/// Where a field is sampled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Region {
    /// In a box that is found by [`find_bounds`](super::find_bounds).
    #[default]
    Auto,
    /// In this box.
    Box(Aabb),
}

impl OptionType for Region {
    const KIND: OptionKind = OptionKind::Text;

    fn parse(text: &str) -> Option<Self> {
        if text.trim() == "auto" {
            return Some(Self::Auto);
        }
        let numbers: Option<Vec<f64>> = text.split(',').map(|number| number.trim().parse().ok()).collect();
        match numbers?.as_slice() {
            // As given: what is no box is refused with its numbers when it is used.
            &[x0, y0, z0, x1, y1, z1] => {
                Some(Self::Box(Aabb { min: DVec3::new(x0, y0, z0), max: DVec3::new(x1, y1, z1) }))
            }
            _ => None,
        }
    }

    fn to_value(&self) -> OptionValue {
        OptionValue::Text(match self {
            Self::Auto => "auto".to_owned(),
            Self::Box(Aabb { min, max }) => {
                let numbers = [min.to_array(), max.to_array()].into_iter().flatten();
                numbers.map(|number| number.to_string()).collect::<Vec<String>>().join(",")
            }
        })
    }
}
