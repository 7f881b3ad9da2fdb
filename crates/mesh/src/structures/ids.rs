//! Numbers of elements, each kind a type of its own.

use std::fmt;

macro_rules! id {
    ($(#[$doc:meta])* $name:ident, $word:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Default)]
        #[repr(transparent)]
        pub struct $name(pub u32);

        impl $name {
            /// The number as an index.
            pub const fn index(self) -> usize {
                self.0 as usize
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, concat!($word, " {}"), self.0)
            }
        }
    };
}

id!(
    /// A vertex: the same number in every structure made from one mesh.
    VertexId,
    "vertex"
);
id!(
    /// An edge, numbered as its structure likes; its vertices are what structures agree on.
    EdgeId,
    "edge"
);
id!(
    /// A face: the same number in every structure made from one mesh.
    FaceId,
    "face"
);
id!(
    /// A side of a face with its direction. Of triangles, side `3f + i` runs from corner `i` of face `f` to the next.
    HalfEdgeId,
    "half-edge"
);
id!(
    /// A corner of a triangle: `3f + i` is corner `i` of triangle `f`.
    CornerId,
    "corner"
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_say_what_they_are() {
        assert_eq!(
            (VertexId(7).to_string(), HalfEdgeId(2).to_string()),
            ("vertex 7".to_owned(), "half-edge 2".to_owned())
        );
        assert_eq!(size_of::<Option<FaceId>>(), 8);
    }
}
