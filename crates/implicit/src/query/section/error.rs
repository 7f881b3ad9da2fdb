//! Why a plane has no curves.

use std::fmt;

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Category, Diagnostic, Words};

/// Why curves in a plane cannot be found.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionError {
    /// Corners that make no window.
    Window {
        /// The lower left corner.
        lo: DVec2,
        /// The upper right corner.
        hi: DVec2,
    },
    /// A length that is too small for the window.
    Fine {
        /// Which option.
        option: &'static str,
        /// The length as given.
        found: f64,
        /// The least that the window takes.
        least: f64,
    },
    /// More cells than allowed.
    Cells {
        /// How many are allowed.
        most: u32,
    },
}

impl fmt::Display for SectionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Window { lo, hi } => write!(
                f,
                "window: found corners [{}, {}] and [{}, {}], expected finite ones with the second above and to the right",
                Words(lo.x),
                Words(lo.y),
                Words(hi.x),
                Words(hi.y)
            ),
            Self::Fine { option, found, least } => {
                write!(f, "{option}: found {}, expected at least {} for this window", Words(*found), Words(*least))
            }
            Self::Cells { most } => write!(f, "cells: found more than {most}, expected at most as many"),
        }
    }
}

impl std::error::Error for SectionError {}

impl Diagnostic for SectionError {
    fn code(&self) -> &'static str {
        match self {
            Self::Window { .. } => "E-section-window",
            Self::Fine { .. } => "E-section-fine",
            Self::Cells { .. } => "E-section-cells",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Cells { .. } => Category::OverLimit,
            _ => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::Window { .. } => None,
            _ => Some("take a smaller window, larger cells or a larger tolerance".into()),
        }
    }
}
