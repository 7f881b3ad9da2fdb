//! The tree of clusters, and what it answers.

use std::fmt;

use glam::DVec3;
use shapeloom_core::{Aabb, Reservation};

use super::far::Node;
use super::near::Block;
use super::reference::{WindingNumber, beyond, beyond_horizon};
use super::sum::Sum;
use super::{bounded, walk};
use crate::scaled_input::Units;

/// Triangles prepared for generalised winding numbers: fast ones, ones within a tolerance, and exact ones.
///
/// The tree of Barill, Dickson, Schmidt, Levin and Jacobson 2018 (Fast winding numbers for soups and clouds): far
/// clusters of triangles are replaced by the first three terms of their expansion. The winding number says how often
/// triangles wrap around a point, 1 inside an outward closed mesh and 0 outside, and stays meaningful for meshes with
/// holes, flipped or duplicate faces and for soups; "above 1/2" is the usual test for inside. On the surface it is the
/// mean of both sides, as [`generalized_winding_number`](super::generalized_winding_number) says. Triangles without
/// area count nothing.
///
/// Memory: about 90 bytes a triangle, reserved as long as the tree lives; about 100 more while it is built. The same
/// bits come out for any number of threads, on every machine, in batches and alone.
pub struct WindingTree {
    /// Triangles in eights, in scaled units about the origin.
    pub(super) blocks: Vec<Block>,
    /// Levels of nodes, the children of the finest being blocks: node `i` has the children `8 i ..= 8 i + 7` of the
    /// level before.
    pub(super) levels: Vec<Vec<Node>>,
    pub(super) triangles: usize,
    pub(super) bounds: Aabb,
    pub(super) units: Units,
    pub(super) accuracy: f32,
    pub(super) _memory: Reservation,
}

impl WindingTree {
    /// The accuracy of a new tree: Barill and others' choice.
    pub const DEFAULT_ACCURACY: f32 = 2.0;

    /// Sets β for [`WindingTree::winding_number`]: clusters farther than β times their radius are replaced by their
    /// expansion. Larger is slower and closer to the truth; the error shrinks about with β³. Values below 1 and NaN
    /// count as 1.
    #[must_use]
    pub fn with_accuracy(self, accuracy: f32) -> Self {
        Self { accuracy: accuracy.max(1.0), ..self }
    }

    /// How many triangles there are.
    pub fn len(&self) -> usize {
        self.triangles
    }

    /// Whether there is no triangle.
    pub fn is_empty(&self) -> bool {
        self.triangles == 0
    }

    /// The box around the triangles; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The winding number around a point, quickly; NaN where the query is not finite.
    ///
    /// The error is not bounded here; at the default accuracy it is typically below 1e-3 and seldom above 4e-3 on
    /// meshes (docs/algorithms/winding_number.md has figures). Use [`WindingTree::winding_number_within`] where it
    /// matters. Cost: about the logarithm of the number of triangles; 1.4 µs for a query beside a million of them.
    pub fn winding_number(&self, query: DVec3) -> f64 {
        match self.place(query) {
            Ok((scaled, local)) => walk::winding_number(self, scaled.into(), local.into()),
            Err(outside) => outside.value,
        }
    }

    /// The winding number with a proven bound, at most `tolerance` where rounding allows it.
    ///
    /// Clusters are opened until the proven bounds of those that are left sum up to no more than the tolerance. The
    /// bound holds truncation and rounding, so the true winding number lies within `bound` of `value`, whatever the
    /// sizes of triangles and distances; only coordinates below 1e-307 of the shape's size count as rounded (see
    /// [`WindingNumber::bound`]). The bound exceeds the tolerance only where rounding alone does: see
    /// [`WindingTree::winding_number_exact`]. The tighter the tolerance, the slower: 0.3 costs a few times the fast
    /// value, 0.01 fifty times; below 1e-6 nearly every triangle is visited. A NaN or negative tolerance counts as 0.
    pub fn winding_number_within(&self, query: DVec3, tolerance: f64) -> WindingNumber {
        match self.place(query) {
            Ok((scaled, local)) => bounded::winding_number(self, scaled.into(), local.into(), tolerance),
            Err(outside) => outside,
        }
    }

    /// The sum over all triangles, with a bound of its rounding error: about 1e-15 a triangle, more for triangles whose
    /// border is near. Cost: O(n), about 10 ns a triangle.
    pub fn winding_number_exact(&self, query: DVec3) -> WindingNumber {
        let (scaled, _) = match self.place(query) {
            Ok(places) => places,
            Err(outside) => return outside,
        };
        let (mut sum, mut bound) = (Sum::default(), 0.0);
        walk::visit_all(&self.blocks, scaled.into(), &mut sum, &mut bound);
        WindingNumber { value: sum.total(), bound: (bound + sum.error()) * (1.0 + 1e-6) }
    }

    pub(crate) fn units(&self) -> &Units {
        &self.units
    }

    /// The query in scaled and in local units, or the answer where it is too far for them.
    fn place(&self, query: DVec3) -> Result<(DVec3, DVec3), WindingNumber> {
        if !query.is_finite() {
            return Err(WindingNumber::UNKNOWN);
        }
        let scaled = query * self.units.per_unit;
        let local = scaled - self.units.center;
        if beyond(local) {
            return Err(beyond_horizon(self.triangles));
        }
        Ok((scaled, local))
    }
}

impl fmt::Debug for WindingTree {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("WindingTree")
            .field("triangles", &self.triangles)
            .field("levels", &self.levels.len())
            .field("bounds", &self.bounds)
            .field("accuracy", &self.accuracy)
            .finish_non_exhaustive()
    }
}
