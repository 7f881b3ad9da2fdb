//! Options that can be listed, set and read by name.

mod bounds;
pub mod declare;
mod error;
mod value;

pub use bounds::Bounds;
pub use error::OptionError;
pub use value::{ChoiceOption, OptionKind, OptionSpec, OptionType, OptionValue};

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
