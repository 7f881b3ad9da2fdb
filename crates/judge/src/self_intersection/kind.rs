//! How two faces meet.

/// How two faces meet beyond the corners and the side that they share. Corners are shared where their positions are
/// equal, whatever their indices.
///
/// A triangle without area is the segment or the point that it covers. The order is that of strength: a pair of
/// polygons has the strongest kind of its triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PairKind {
    /// The inside of one passes through the inside of the other; they share no corner. A segment without area crosses a
    /// triangle if it passes through its inside.
    Crossing,
    /// The inside of one passes through the inside of the other from a corner that they share.
    CrossingAtCorner,
    /// They lie in one plane on the same side of a side that they share, and so overlap in an area.
    Folded,
    /// They lie in one plane, look the same way and overlap in an area, with other corners.
    Overlap,
    /// They lie in one plane, look opposite ways and have an area in common, with other corners: solids in contact.
    Contact,
    /// They have the same corners and look the same way, or have no area.
    Duplicate,
    /// They have the same corners and look opposite ways.
    Coincident,
    /// They meet along a segment that is not a shared side, and neither passes through the other.
    TouchAlongSegment,
    /// They meet in a point that is not a shared corner, and neither passes through the other.
    TouchAtPoint,
}

impl PairKind {
    /// Every kind, the strongest first.
    pub const ALL: [Self; 9] = [
        Self::Crossing,
        Self::CrossingAtCorner,
        Self::Folded,
        Self::Overlap,
        Self::Contact,
        Self::Duplicate,
        Self::Coincident,
        Self::TouchAlongSegment,
        Self::TouchAtPoint,
    ];

    /// The name of the kind in plain words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Crossing => "crossing",
            Self::CrossingAtCorner => "crossing at a shared corner",
            Self::Folded => "folded onto each other",
            Self::Overlap => "overlapping in a plane",
            Self::Contact => "in contact in a plane",
            Self::Duplicate => "duplicate",
            Self::Coincident => "coincident",
            Self::TouchAlongSegment => "touching along a segment",
            Self::TouchAtPoint => "touching at a point",
        }
    }

    /// Whether the inside of one passes through the inside of the other.
    pub fn crosses(self) -> bool {
        matches!(self, Self::Crossing | Self::CrossingAtCorner)
    }

    /// Whether they overlap in an area, looking the same way with other corners or folded along a side.
    pub fn overlaps(self) -> bool {
        matches!(self, Self::Folded | Self::Overlap)
    }

    /// Whether they only touch: neither crossing nor overlapping. Coincident and duplicate faces touch.
    pub fn touches(self) -> bool {
        !self.crosses() && !self.overlaps()
    }
}

/// Two faces that meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FacePair {
    /// The faces, the smaller number first.
    pub faces: [u32; 2],
    /// How they meet.
    pub kind: PairKind,
}
