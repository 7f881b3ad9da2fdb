//! How many parts a file may have.

/// A part takes about a kilobyte: beyond this many, and one for every 32 bytes of the file, they would take memory out of
/// proportion to it. A part with a triangle of its own takes more text.
const MANY_PARTS: usize = 1 << 14;

/// The most parts that a file of so many bytes may have.
pub(crate) fn most_parts(bytes: usize) -> usize {
    MANY_PARTS + bytes / 32
}
