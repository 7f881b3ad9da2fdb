//! Surfaces of several patches.

use shapeloom_core::{Aabb, Affine};

use crate::BezierPatch;

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
