//! Options that can be listed, set and read by name.

use std::fmt;

use crate::{Category, Diagnostic};

/// The numbers that an option accepts. NaN is in no bounds; infinity is in none but [`Bounds::ANY`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The smallest number, or the limit that it must exceed.
    pub min: f64,
    /// Whether `min` itself is refused.
    pub above: bool,
    /// The largest number.
    pub max: f64,
}

impl Bounds {
    /// Every number but NaN.
    pub const ANY: Self = Self { min: f64::NEG_INFINITY, above: false, max: f64::INFINITY };
    /// Every finite number above 0.
    pub const POSITIVE: Self = Self { min: 0.0, above: true, max: f64::MAX };
    /// Every finite number from 0 on.
    pub const NON_NEGATIVE: Self = Self { min: 0.0, above: false, max: f64::MAX };
    /// Every finite number.
    pub const FINITE: Self = Self { min: f64::MIN, above: false, max: f64::MAX };

    /// From `min` to `max`, both included.
    pub const fn closed(min: f64, max: f64) -> Self {
        Self { min, above: false, max }
    }

    /// Whether `value` is accepted.
    pub fn contains(&self, value: f64) -> bool {
        value <= self.max && if self.above { value > self.min } else { value >= self.min }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lower = match (self.above, self.min) {
            (_, f64::NEG_INFINITY | f64::MIN) => String::new(),
            (true, min) => format!("above {min}"),
            (false, min) => format!("from {min}"),
        };
        let upper = match self.max {
            f64::INFINITY => String::new(),
            f64::MAX => "finite".to_owned(),
            max => format!("to {max}"),
        };
        match (lower.is_empty(), upper.is_empty()) {
            (true, true) => f.write_str("any number"),
            (true, false) => f.write_str(&upper),
            (false, true) => f.write_str(&lower),
            (false, false) if self.max == f64::MAX => write!(f, "{lower}, {upper}"),
            (false, false) => write!(f, "{lower} {upper}"),
        }
    }
}

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

/// A struct of options, declared with [`options!`](crate::options).
pub trait Options {
    /// The name of the algorithm, in lower case with hyphens.
    const NAME: &'static str;

    /// What it does: the first paragraph of the struct's documentation.
    fn summary() -> String;

    /// Every option, the required ones first.
    fn specs() -> Vec<OptionSpec>;

    /// Sets an option by name from text.
    ///
    /// # Errors
    /// No option has that name, the text is no such value, or the value is out of bounds; nothing is changed then.
    fn set(&mut self, name: &str, value: &str) -> Result<(), OptionError>;

    /// The value of an option by name.
    ///
    /// # Errors
    /// No option has that name.
    fn get(&self, name: &str) -> Result<OptionValue, OptionError>;

    /// Checks every field against its bounds.
    ///
    /// # Errors
    /// The first field that is out of bounds.
    fn validate(&self) -> Result<(), OptionError>;
}

/// Why an option cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionError {
    /// No option has that name.
    Unknown {
        /// The algorithm.
        algorithm: &'static str,
        /// The name as given.
        name: String,
        /// The names that exist.
        known: Vec<&'static str>,
    },
    /// The text is no value of the option's kind.
    Unreadable {
        /// The algorithm.
        algorithm: &'static str,
        /// The option.
        name: &'static str,
        /// The text as given.
        found: String,
        /// What kind of value is wanted.
        kind: OptionKind,
    },
    /// The number is out of bounds.
    OutOfBounds {
        /// The algorithm.
        algorithm: &'static str,
        /// The option.
        name: &'static str,
        /// The value as given.
        found: f64,
        /// What is accepted.
        bounds: Bounds,
    },
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

impl fmt::Display for OptionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { algorithm, name, known } if known.is_empty() => {
                write!(f, "{algorithm}: found option \"{name}\", expected none: it has no options")
            }
            Self::Unknown { algorithm, name, known } => {
                write!(f, "{algorithm}: found option \"{name}\", expected one of {}", known.join(", "))
            }
            Self::Unreadable { algorithm, name, found, kind } => {
                write!(f, "{algorithm}: option {name}: found \"{found}\", expected {kind}")
            }
            Self::OutOfBounds { algorithm, name, found, bounds } => {
                write!(f, "{algorithm}: option {name}: found {found}, expected a number {bounds}")
            }
        }
    }
}

impl std::error::Error for OptionError {}

impl Diagnostic for OptionError {
    fn code(&self) -> &'static str {
        match self {
            Self::Unknown { .. } => "E-option-unknown",
            Self::Unreadable { .. } => "E-option-text",
            Self::OutOfBounds { .. } => "E-option-range",
        }
    }

    fn category(&self) -> Category {
        Category::Usage
    }
}

#[doc(hidden)]
pub mod private {
    //! What the expansion of `options!` calls.
    use super::{Bounds, OptionError, OptionType};

    pub fn check<T: OptionType>(
        algorithm: &'static str,
        name: &'static str,
        value: &T,
        bounds: Bounds,
    ) -> Result<(), OptionError> {
        match value.number() {
            Some(found) if !bounds.contains(found) => Err(OptionError::OutOfBounds { algorithm, name, found, bounds }),
            _ => Ok(()),
        }
    }

    pub fn parse<T: OptionType>(
        algorithm: &'static str,
        name: &'static str,
        text: &str,
        bounds: Bounds,
    ) -> Result<T, OptionError> {
        let value = T::parse(text).ok_or_else(|| OptionError::Unreadable {
            algorithm,
            name,
            found: text.to_owned(),
            kind: T::KIND,
        })?;
        check(algorithm, name, &value, bounds)?;
        Ok(value)
    }

    pub fn doc(lines: &[&str]) -> String {
        let lines: Vec<&str> = lines.iter().map(|line| line.trim()).collect();
        lines.join(" ").trim().to_owned()
    }

    pub fn summary(lines: &[&str]) -> String {
        let first: Vec<&str> = lines.iter().map(|line| line.trim()).take_while(|line| !line.is_empty()).collect();
        first.join(" ")
    }
}

/// Declares a struct of options with its name, documentation, bounds and defaults, once.
///
/// ```
/// use shapeloom_core::{Bounds, Options, options};
///
/// options! {
///     /// Slices a shape.
///     pub struct Slice("slice") {
///         required {
///             /// Distance between slices, in model units.
///             spacing: f64 [Bounds::POSITIVE],
///         }
///         optional {
///             /// How many slices at most.
///             max_slices: u32 [Bounds::closed(1.0, 1e6)] = 1000,
///             /// Whether open slices are closed.
///             close: bool = true,
///         }
///     }
/// }
///
/// let mut slice = Slice::new(0.5);
/// slice.set("max_slices", "12")?;
/// assert_eq!(slice.max_slices, 12);
/// assert_eq!(Slice::specs()[0].name, "spacing");
/// slice.spacing = f64::NAN;
/// assert!(slice.validate().is_err());
/// # Ok::<(), shapeloom_core::OptionError>(())
/// ```
///
/// Field types are [`OptionType`](crate::OptionType)s: `f64`, `u8`, `u16`, `u32`, `i32`, `bool`, `String`, and enums
/// declared with [`choice!`](crate::choice).
#[macro_export]
macro_rules! options {
    (
        $(#[doc = $doc:literal])*
        $vis:vis struct $type:ident($name:literal) {
            required {
                $( $(#[doc = $rdoc:literal])* $rfield:ident : $rtype:ty $([ $rbounds:expr ])? ),* $(,)?
            }
            optional {
                $( $(#[doc = $odoc:literal])* $ofield:ident : $otype:ty $([ $obounds:expr ])? = $odefault:expr ),* $(,)?
            }
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Debug, PartialEq)]
        $vis struct $type {
            $( $(#[doc = $rdoc])* pub $rfield: $rtype, )*
            $( $(#[doc = $odoc])* pub $ofield: $otype, )*
        }

        impl $type {
            /// The algorithm with its required options; the others have their defaults. Values are checked when it runs.
            #[must_use]
            #[allow(clippy::new_without_default)]
            pub fn new($( $rfield: $rtype ),*) -> Self {
                Self { $( $rfield, )* $( $ofield: $odefault, )* }
            }
        }

        impl $crate::Options for $type {
            const NAME: &'static str = $name;

            fn summary() -> String {
                $crate::options_private::summary(&[$( $doc ),*])
            }

            fn specs() -> Vec<$crate::OptionSpec> {
                #[allow(unused_imports)]
                use $crate::OptionType as _;
                vec![
                    $( $crate::OptionSpec {
                        name: stringify!($rfield),
                        doc: $crate::options_private::doc(&[$( $rdoc ),*]),
                        kind: <$rtype as $crate::OptionType>::KIND,
                        bounds: $crate::__bounds!($( $rbounds )?),
                        default: None,
                    }, )*
                    $( $crate::OptionSpec {
                        name: stringify!($ofield),
                        doc: $crate::options_private::doc(&[$( $odoc ),*]),
                        kind: <$otype as $crate::OptionType>::KIND,
                        bounds: $crate::__bounds!($( $obounds )?),
                        default: Some({
                            let value: $otype = $odefault;
                            <$otype as $crate::OptionType>::to_value(&value)
                        }),
                    }, )*
                ]
            }

            #[allow(unused_variables)]
            fn set(&mut self, name: &str, value: &str) -> Result<(), $crate::OptionError> {
                $( if name == stringify!($rfield) {
                    self.$rfield = $crate::options_private::parse(
                        $name, stringify!($rfield), value, $crate::__bounds!($( $rbounds )?))?;
                    return Ok(());
                } )*
                $( if name == stringify!($ofield) {
                    self.$ofield = $crate::options_private::parse(
                        $name, stringify!($ofield), value, $crate::__bounds!($( $obounds )?))?;
                    return Ok(());
                } )*
                Err($crate::OptionError::Unknown {
                    algorithm: $name,
                    name: name.to_owned(),
                    known: vec![$( stringify!($rfield), )* $( stringify!($ofield), )*],
                })
            }

            fn get(&self, name: &str) -> Result<$crate::OptionValue, $crate::OptionError> {
                #[allow(unused_imports)]
                use $crate::OptionType as _;
                $( if name == stringify!($rfield) {
                    return Ok(self.$rfield.to_value());
                } )*
                $( if name == stringify!($ofield) {
                    return Ok(self.$ofield.to_value());
                } )*
                Err($crate::OptionError::Unknown {
                    algorithm: $name,
                    name: name.to_owned(),
                    known: vec![$( stringify!($rfield), )* $( stringify!($ofield), )*],
                })
            }

            fn validate(&self) -> Result<(), $crate::OptionError> {
                $( $crate::options_private::check(
                    $name, stringify!($rfield), &self.$rfield, $crate::__bounds!($( $rbounds )?))?; )*
                $( $crate::options_private::check(
                    $name, stringify!($ofield), &self.$ofield, $crate::__bounds!($( $obounds )?))?; )*
                Ok(())
            }
        }
    };
}

#[doc(hidden)]
#[macro_export]
macro_rules! __bounds {
    () => {
        $crate::Bounds::ANY
    };
    ($bounds:expr) => {
        $bounds
    };
}

/// Declares an enum without fields whose variants have names, for use as an option.
///
/// ```
/// use shapeloom_core::{ChoiceOption, choice};
///
/// choice! {
///     /// How faces are shaded.
///     pub enum Shading {
///         /// One colour a face.
///         Flat = "flat",
///         /// Interpolated normals.
///         Smooth = "smooth",
///     }
/// }
/// assert_eq!(Shading::from_name("smooth"), Some(Shading::Smooth));
/// ```
#[macro_export]
macro_rules! choice {
    (
        $(#[$meta:meta])*
        $vis:vis enum $type:ident { $( $(#[$vmeta:meta])* $variant:ident = $name:literal ),* $(,)? }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        $vis enum $type { $( $(#[$vmeta])* $variant, )* }

        impl $crate::ChoiceOption for $type {
            const NAMES: &'static [&'static str] = &[$( $name ),*];

            fn from_name(name: &str) -> Option<Self> {
                match name {
                    $( $name => Some(Self::$variant), )*
                    _ => None,
                }
            }

            fn name(self) -> &'static str {
                match self {
                    $( Self::$variant => $name, )*
                }
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    crate::choice! {
        /// A choice.
        pub enum Word {
            /// One.
            One = "one",
            /// Two.
            Two = "two",
        }
    }

    crate::options! {
        /// Does nothing,
        /// at length.
        ///
        /// More about it.
        pub struct Nothing("nothing") {
            required {
                /// How far.
                distance: f64 [Bounds::POSITIVE],
            }
            optional {
                /// How often.
                count: u32 [Bounds::closed(1.0, 9.0)] = 3,
                /// Which.
                word: Word = Word::Two,
                /// Called.
                label: String = "x".to_owned(),
                /// Whether.
                on: bool = false,
            }
        }
    }

    #[test]
    fn specs_say_everything() {
        let specs = Nothing::specs();
        assert_eq!(Nothing::summary(), "Does nothing, at length.");
        assert_eq!(
            specs.iter().map(|spec| spec.name).collect::<Vec<_>>(),
            ["distance", "count", "word", "label", "on"]
        );
        assert_eq!(specs[0].default, None);
        assert_eq!(specs[0].doc, "How far.");
        assert_eq!(specs[2].kind, OptionKind::Choice(&["one", "two"]));
        assert_eq!(specs[2].default, Some(OptionValue::Text("two".into())));
    }

    #[test]
    fn every_option_survives_set_and_get() {
        let mut nothing = Nothing::new(2.0);
        for (name, value) in [("distance", "0.25"), ("count", "9"), ("word", "one"), ("label", "y z"), ("on", "true")] {
            nothing.set(name, value).unwrap();
            assert_eq!(nothing.get(name).unwrap().to_string(), value);
        }
        assert_eq!(nothing.validate(), Ok(()));
    }

    #[test]
    fn wrong_names_and_values_are_refused_and_change_nothing() {
        let mut nothing = Nothing::new(2.0);
        let before = nothing.clone();
        assert!(matches!(nothing.set("speed", "1"), Err(OptionError::Unknown { .. })));
        for (name, value) in [("distance", "fast"), ("count", "-1"), ("count", "2.5"), ("word", "three"), ("on", "1")] {
            assert!(matches!(nothing.set(name, value), Err(OptionError::Unreadable { .. })), "{name} {value}");
        }
        for value in ["0", "-1", "NaN", "inf", "-inf"] {
            assert!(matches!(nothing.set("distance", value), Err(OptionError::OutOfBounds { .. })), "{value}");
        }
        assert!(matches!(nothing.set("count", "10"), Err(OptionError::OutOfBounds { .. })));
        assert_eq!(nothing, before);
        nothing.distance = f64::INFINITY;
        assert!(nothing.validate().is_err());
    }

    #[test]
    fn messages_say_found_and_expected() {
        let mut nothing = Nothing::new(2.0);
        let error = nothing.set("count", "10").unwrap_err();
        assert_eq!(error.to_string(), "nothing: option count: found 10, expected a number from 1 to 9");
        let error = nothing.set("distance", "0").unwrap_err();
        assert_eq!(error.to_string(), "nothing: option distance: found 0, expected a number above 0, finite");
    }
}
