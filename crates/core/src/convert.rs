//! Conversions as values.

use crate::{ConvertError, Exec, Report};

/// An algorithm that turns a source shape into another one; `Self` is the algorithm with its options.
///
/// Implementors are declared with [`options!`](crate::options), so that a caller can build one by name. Every
/// implementation validates its options first, polls [`Exec::check`] often enough to be cancelled within a fraction of
/// a second, reserves memory before it allocates in proportion to its input, and never panics on any source.
///
/// An implementor has either one blanket source (`F: Field + ?Sized`) or concrete sources, never both.
pub trait Convert<S: ?Sized> {
    /// What comes out.
    type Output;

    /// Converts `source` under `exec`.
    ///
    /// # Errors
    /// A [`ConvertError`] whose [`category`](ConvertError::category) tells wrong options, unusable input, failure,
    /// exhausted budgets and cancellation apart. The source is never changed.
    fn convert_with(&self, source: &S, exec: &Exec) -> Result<Converted<Self::Output>, ConvertError>;

    /// Converts `source` with the default [`Exec`]: no progress, not cancellable, 4 GiB, all threads.
    ///
    /// # Errors
    /// As [`Convert::convert_with`].
    fn convert(&self, source: &S) -> Result<Converted<Self::Output>, ConvertError> {
        self.convert_with(source, &Exec::default())
    }
}

/// A result with the account of what it cost.
#[must_use]
#[derive(Clone, Debug, PartialEq)]
pub struct Converted<T> {
    /// The result.
    pub value: T,
    /// What the conversion cost.
    pub report: Report,
}

impl<T> Converted<T> {
    /// A result with its report.
    pub fn new(value: T, report: Report) -> Self {
        Self { value, report }
    }

    /// The same report with another value.
    pub fn map<U>(self, f: impl FnOnce(T) -> U) -> Converted<U> {
        Converted { value: f(self.value), report: self.report }
    }

    /// Runs a second conversion on the value; the reports are chained.
    ///
    /// # Errors
    /// Those of `next`.
    pub fn then<C: Convert<T>>(self, next: &C, exec: &Exec) -> Result<Converted<C::Output>, ConvertError> {
        let second = next.convert_with(&self.value, exec)?;
        Ok(Converted { value: second.value, report: self.report.then(second.report) })
    }
}

/// Builds a converter for one source and one absolute tolerance in model units.
///
/// A converter that is exact ignores the tolerance. What the tolerance means for the result is in the converter's
/// report, never assumed.
pub trait FromTolerance<S: ?Sized> {
    /// The converter with default options and the accuracy asked for. The values are checked when it runs.
    fn from_tolerance(source: &S, tolerance: f64) -> Self;
}
