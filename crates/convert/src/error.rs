//! Why there is no way from one kind to another.

use std::fmt;

use shapeloom_core::{Category, Diagnostic};
use shapeloom_shape::Kind;

/// Why a conversion cannot be planned.
#[derive(Clone, Debug, PartialEq)]
pub enum PlanError {
    /// No converters lead from the source to the target.
    NoWay {
        /// What the shape is.
        from: Kind,
        /// What was wanted: any of these.
        to: Vec<Kind>,
        /// What can be reached instead.
        reachable: Vec<Kind>,
        /// Converters that lead there, but are used only where they are named.
        by_name: Vec<&'static str>,
    },
    /// No converter has that name.
    UnknownMethod {
        /// The name as given.
        found: String,
        /// The names that exist.
        known: Vec<&'static str>,
    },
    /// The converter named cannot be on a way from the source to the target.
    MethodOffTheWay {
        /// The converter.
        method: &'static str,
        /// What it takes.
        takes: Kind,
        /// What it gives.
        gives: Kind,
        /// What the shape is.
        from: Kind,
        /// What was wanted.
        to: Vec<Kind>,
    },
    /// An option that follows from nothing else is not set.
    MissingOption {
        /// The converter.
        method: &'static str,
        /// Its option.
        option: &'static str,
    },
    /// An option that no converter on the way has.
    UnknownOption {
        /// The option as given.
        found: String,
        /// The options that exist on the way, as `converter.option`.
        known: Vec<String>,
    },
}

fn list<T: fmt::Display>(items: &[T]) -> String {
    items.iter().map(T::to_string).collect::<Vec<_>>().join(", ")
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoWay { from, to, reachable, by_name } => {
                write!(f, "found no way from {from} to {}", list(to))?;
                match (reachable.is_empty(), by_name.is_empty()) {
                    (true, true) => write!(f, ": no converter makes another kind from a {from} yet"),
                    (true, false) => write!(f, ", only, where it is named, through {}", list(by_name)),
                    (false, true) => write!(f, ", only to {}", list(reachable)),
                    (false, false) => {
                        write!(f, ", only to {} and, where it is named, through {}", list(reachable), list(by_name))
                    }
                }
            }
            Self::UnknownMethod { found, known } => {
                write!(f, "found method \"{found}\", expected one of {}", list(known))
            }
            Self::MethodOffTheWay { method, takes, gives, from, to } => {
                write!(f, "{method} turns {takes} into {gives}: found no way through it from {from} to {}", list(to))
            }
            Self::MissingOption { method, option } => {
                write!(f, "{method}: found no {option}, expected --set {option}=VALUE: no tolerance gives it")
            }
            Self::UnknownOption { found, known } if known.is_empty() => {
                write!(f, "found option \"{found}\", expected none: no step on this way has options")
            }
            Self::UnknownOption { found, known } => {
                write!(f, "found option \"{found}\", expected one of {}", list(known))
            }
        }
    }
}

impl std::error::Error for PlanError {}

impl Diagnostic for PlanError {
    fn code(&self) -> &'static str {
        match self {
            Self::NoWay { .. } => "E-plan-no-way",
            Self::UnknownMethod { .. } => "E-plan-method",
            Self::MethodOffTheWay { .. } => "E-plan-off-the-way",
            Self::MissingOption { .. } => "E-plan-missing",
            Self::UnknownOption { .. } => "E-plan-option",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::NoWay { .. } | Self::MethodOffTheWay { .. } => Category::Unsupported,
            Self::UnknownMethod { .. } | Self::MissingOption { .. } | Self::UnknownOption { .. } => Category::Usage,
        }
    }

    fn advice(&self) -> Option<String> {
        match self {
            Self::NoWay { by_name, .. } => Some(match by_name.first() {
                Some(name) => format!("say --method {name}; `shapeloom graph` tells what it makes of the shape"),
                None => "`shapeloom graph` lists every converter".into(),
            }),
            Self::MissingOption { .. } => Some("`shapeloom graph` tells what it means".into()),
            _ => None,
        }
    }
}
