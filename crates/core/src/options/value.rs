//! The kinds and values of options.

use std::fmt;

use super::Bounds;

/// What kind of value an option takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OptionKind {
    /// A real number.
    Float,
    /// A whole number.
    Integer,
    /// `true` or `false`.
    Bool,
    /// Any text.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
}

/// The value of an option.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionValue {
    /// A real number.
    Float(f64),
    /// A whole number.
    Integer(i64),
    /// `true` or `false`.
    Bool(bool),
    /// A text or a word of a choice.
    Text(String),
}

impl fmt::Display for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float(value) => write!(f, "{value}"),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Text(value) => f.write_str(value),
        }
    }
}

/// One option: its name, meaning, kind, bounds and default.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionSpec {
    /// The field's name.
    pub name: &'static str,
    /// Its documentation.
    pub doc: String,
    /// What it takes.
    pub kind: OptionKind,
    /// The numbers that are accepted.
    pub bounds: Bounds,
    /// The value when none is given; none for a required option.
    pub default: Option<OptionValue>,
}

/// A field type that the [`options!`](crate::options) macro accepts.
pub trait OptionType: Sized {
    /// What kind of value it is.
    const KIND: OptionKind;

    /// The value as text would give it; none if the text is no such value.
    fn parse(text: &str) -> Option<Self>;

    /// The value in its general form.
    fn to_value(&self) -> OptionValue;

    /// The value as a number that bounds apply to, if it is one.
    fn number(&self) -> Option<f64> {
        None
    }
}

impl OptionType for f64 {
    const KIND: OptionKind = OptionKind::Float;

    fn parse(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn to_value(&self) -> OptionValue {
        OptionValue::Float(*self)
    }

    fn number(&self) -> Option<f64> {
        Some(*self)
    }
}

macro_rules! whole_numbers {
    ($($type:ty),*) => {$(
        impl OptionType for $type {
            const KIND: OptionKind = OptionKind::Integer;

            fn parse(text: &str) -> Option<Self> {
                text.trim().parse().ok()
            }

            fn to_value(&self) -> OptionValue {
                OptionValue::Integer(i64::from(*self))
            }

            fn number(&self) -> Option<f64> {
                Some(f64::from(*self))
            }
        }
    )*};
}

whole_numbers!(u8, u16, u32, i32);

impl OptionType for bool {
    const KIND: OptionKind = OptionKind::Bool;

    fn parse(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn to_value(&self) -> OptionValue {
        OptionValue::Bool(*self)
    }
}

impl OptionType for String {
    const KIND: OptionKind = OptionKind::Text;

    fn parse(text: &str) -> Option<Self> {
        Some(text.to_owned())
    }

    fn to_value(&self) -> OptionValue {
        OptionValue::Text(self.clone())
    }
}

/// An enum without fields whose variants have names, declared with [`choice!`](crate::choice).
pub trait ChoiceOption: Sized + Copy + 'static {
    /// The names, in the order of the variants.
    const NAMES: &'static [&'static str];
    /// The variant of that name.
    fn from_name(name: &str) -> Option<Self>;
    /// The name of this variant.
    fn name(self) -> &'static str;
}

impl<T: ChoiceOption> OptionType for T {
    const KIND: OptionKind = OptionKind::Choice(T::NAMES);

    fn parse(text: &str) -> Option<Self> {
        T::from_name(text.trim())
    }

    fn to_value(&self) -> OptionValue {
        OptionValue::Text(self.name().to_owned())
    }
}

impl fmt::Display for OptionKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Float => f.write_str("a number"),
            Self::Integer => f.write_str("a whole number"),
            Self::Bool => f.write_str("true or false"),
            Self::Text => f.write_str("a text"),
            Self::Choice(names) => write!(f, "one of {}", names.join(", ")),
        }
    }
}
