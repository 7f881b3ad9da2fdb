//! Numbers as the language writes them.

/// The shortest digits that read back to the same finite number, in powers of ten where it is very large or small.
pub(super) fn shortest(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-5..1e16).contains(&size) { format!("{value:e}") } else { format!("{value}") }
}
