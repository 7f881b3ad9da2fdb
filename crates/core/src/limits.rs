//! What a reader accepts from an untrusted input.

/// Upper bounds that readers keep, whatever a header claims.
///
/// A reader never allocates what a header merely claims: it grows with the data that is really there, and stops with a
/// typed error at the first bound that is passed. Memory is bounded apart, by [`Exec::reserve`](crate::Exec::reserve).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The largest input in bytes.
    pub max_bytes: u64,
    /// The largest number of elements of one kind (vertices, faces, control points, nodes).
    pub max_elements: u64,
    /// The largest number of samples of a compressed image, whatever the length of its file. An image may always have as
    /// many as its file has bytes.
    pub max_samples: u64,
    /// The largest polynomial degree of a curve or surface, in each direction.
    pub max_degree: u32,
    /// The largest number of corners of one polygon.
    pub max_polygon: u32,
    /// The deepest nesting (scene nodes, groups, brackets).
    pub max_depth: u32,
    /// The longest line of text in bytes.
    pub max_line: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_bytes: 1 << 40,
            // Element ids are u32 and u32::MAX is kept free as "none".
            max_elements: u32::MAX as u64 - 1,
            // 8192 × 8192: half a gigabyte of heights from what may be a few kilobytes.
            max_samples: 1 << 26,
            // De Casteljau is quadratic in the degree: 255 keeps one evaluation under a millisecond.
            max_degree: 255,
            max_polygon: 1 << 24,
            // Deeper than any scene seen in practice, shallow enough for an explicit stack.
            max_depth: 1 << 16,
            max_line: 1 << 30,
        }
    }
}
