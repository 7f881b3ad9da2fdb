//! What codes mean.

/// Every code of this crate with what it means and what can be done, sorted by code.
pub const EXPLANATIONS: &[(&str, &str)] = &[];

/// The explanation of a code of this crate.
pub fn explanation(code: &str) -> Option<&'static str> {
    EXPLANATIONS.iter().find(|(known, _)| *known == code).map(|(_, text)| *text)
}
