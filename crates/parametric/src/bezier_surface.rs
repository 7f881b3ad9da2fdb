//! Surfaces of several patches.

use shapeloom_core::{Aabb, Affine};

use crate::BezierPatch;
use crate::bounds::tight_bounds;

/// One of the four sides of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PatchSide {
    /// `v = 0`, along rising u.
    Bottom,
    /// `v = 1`, along rising u.
    Top,
    /// `u = 0`, along rising v.
    Left,
    /// `u = 1`, along rising v.
    Right,
}

impl PatchSide {
    /// The four sides.
    pub const ALL: [Self; 4] = [Self::Bottom, Self::Top, Self::Left, Self::Right];
}

/// Bézier patches that together make a surface. Which sides they share follows from their control points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BezierSurface {
    /// The patches.
    pub patches: Vec<BezierPatch>,
}

impl BezierSurface {
    /// A surface of these patches.
    pub fn new(patches: Vec<BezierPatch>) -> Self {
        Self { patches }
    }

    /// The number of control points, shared ones counted each time.
    pub fn control_point_count(&self) -> usize {
        self.patches.iter().map(|patch| patch.control_points().len()).sum()
    }

    /// The box around the control nets, which holds the surface.
    pub fn hull_bounds(&self) -> Aabb {
        self.patches.iter().map(BezierPatch::hull_bounds).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The box of the surface itself: it holds the surface, and is larger by at most a billionth of its size (degrees
    /// beyond about a hundred may leave more, as the work is bounded). Found by subdividing the patches whose hull still
    /// reaches beyond the points known to be on the surface.
    pub fn bounds(&self) -> Aabb {
        tight_bounds(self.patches.iter().map(|patch| (patch.degree_u() + 1, patch.control_points())))
    }

    /// The image under an affine map; see [`BezierPatch::transformed`].
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self { patches: self.patches.iter().map(|patch| patch.transformed(map)).collect() }
    }

    /// The memory that the surface takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.patches.iter().map(|patch| size_of::<BezierPatch>() + size_of_val(patch.control_points())).sum()
    }
}
