//! What an error says beyond its text: a category, a stable code, advice.

use std::error::Error;
use std::fmt;

/// The broad kinds of failure; the command line gives each an exit code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Category {
    /// The request itself is wrong: an unknown option, a value out of range.
    Usage,
    /// The input cannot be read or is malformed.
    Malformed,
    /// No way exists from this source to this target, or a feature is not supported.
    Unsupported,
    /// The conversion failed, or a tolerance could not be met.
    Failed,
    /// The output cannot be written.
    CannotWrite,
    /// A limit on memory or time was passed.
    OverLimit,
    /// The caller cancelled.
    Cancelled,
}

impl Category {
    /// A phrase for people: what kind of failure this is.
    pub fn phrase(self) -> &'static str {
        match self {
            Self::Usage => "wrong request",
            Self::Malformed => "malformed input",
            Self::Unsupported => "not supported",
            Self::Failed => "conversion failed",
            Self::CannotWrite => "cannot write",
            Self::OverLimit => "over a limit",
            Self::Cancelled => "cancelled",
        }
    }
}

/// An error that names its category, a stable code and what to do.
///
/// Every narrow error of the workspace implements it; the text of [`Display`](fmt::Display) says the place, what was
/// found and what was expected.
pub trait Diagnostic: Error + Send + Sync + 'static {
    /// A stable code such as `E-bpt-count`, listed by the command line's `explain`.
    fn code(&self) -> &'static str;
    /// The broad kind of failure.
    fn category(&self) -> Category;
    /// What the user can do about it, if that is known.
    fn advice(&self) -> Option<String> {
        None
    }
}

/// Why a conversion failed: any crate's narrow error, seen through its [`Category`].
///
/// The narrow error is the [`source`](Error::source); its text is this error's text.
pub struct ConvertError(Box<dyn Diagnostic>);

impl ConvertError {
    /// The broad kind of failure.
    pub fn category(&self) -> Category {
        self.0.category()
    }

    /// The narrow error.
    pub fn diagnostic(&self) -> &dyn Diagnostic {
        &*self.0
    }

    /// The narrow error as the type `E`, if it is one.
    pub fn narrow<E: Diagnostic>(&self) -> Option<&E> {
        let error: &(dyn Error + 'static) = &*self.0;
        error.downcast_ref()
    }
}

impl<E: Diagnostic> From<E> for ConvertError {
    fn from(error: E) -> Self {
        Self(Box::new(error))
    }
}

impl fmt::Debug for ConvertError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("ConvertError").field(&self.category()).field(&self.0).finish()
    }
}

impl fmt::Display for ConvertError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl Error for ConvertError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&*self.0)
    }
}
