//! The macros that declare options.

#[doc(hidden)]
pub mod private {
    //! What the expansion of `options!` calls.
    use crate::{Bounds, OptionError, OptionType};

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
    use crate::Bounds;
    use crate::{OptionError, OptionKind, OptionValue, Options};

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
