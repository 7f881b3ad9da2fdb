//! The boundary curves of a surface, each once.

use std::cmp::Ordering;
use std::collections::HashMap;

use shapeloom_core::glam::DVec3;

use crate::tessellate_curve::{fewest_segments, segments_for};
use crate::{BezierCurve, BezierSurface, PatchSide, TessellationError};

/// A boundary curve that one or more patches share.
pub(super) struct Edge {
    pub(super) curve: BezierCurve<DVec3>,
    /// How many equal steps it is sampled with.
    pub(super) segments: u32,
    /// Whether all control points are equal: a pole.
    pub(super) collapsed: bool,
    /// How many sides of patches it is.
    pub(super) uses: u32,
}

/// A side of a patch: which edge it is, and whether it runs against the edge's direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SideUse {
    pub(super) edge: u32,
    pub(super) reversed: bool,
}

impl SideUse {
    /// The edge's sample at the side's `k`-th of `segments` steps.
    pub(super) fn sample(self, k: u32, segments: u32) -> u32 {
        if self.reversed { segments - k } else { k }
    }
}

/// Every boundary curve of a surface once, and where each side of each patch finds its own.
pub(super) struct EdgeTable {
    pub(super) edges: Vec<Edge>,
    /// For each patch the bottom, top, left and right side.
    pub(super) sides: Vec<[SideUse; 4]>,
}

/// The bits of a coordinate, with -0 as 0.
pub(super) fn bits(point: DVec3) -> [u64; 3] {
    point.to_array().map(|coordinate| (coordinate + 0.0).to_bits())
}

impl EdgeTable {
    /// Finds the shared sides: those whose control points are equal to the bit, in either direction. Curves that are
    /// equal under another parameterisation or degree are not recognised.
    pub(super) fn new(surface: &BezierSurface) -> Self {
        let mut known: HashMap<Vec<[u64; 3]>, u32> = HashMap::new();
        let mut edges: Vec<Edge> = Vec::new();
        let sides = surface
            .patches
            .iter()
            .map(|patch| {
                PatchSide::ALL.map(|side| {
                    let curve = patch.side(side);
                    let forward: Vec<_> = curve.control_points().iter().map(|&point| bits(point)).collect();
                    let backward: Vec<_> = forward.iter().rev().copied().collect();
                    let reversed = backward.cmp(&forward) == Ordering::Less;
                    let next = edges.len() as u32;
                    let edge = *known.entry(if reversed { backward } else { forward }).or_insert(next);
                    if edge == next {
                        let curve = if reversed { curve.reversed() } else { curve };
                        let control = curve.control_points();
                        let collapsed = control.iter().all(|&point| point == control[0]);
                        edges.push(Edge { curve, segments: 1, collapsed, uses: 0 });
                    }
                    edges[edge as usize].uses += 1;
                    SideUse { edge, reversed }
                })
            })
            .collect();
        Self { edges, sides }
    }

    /// Samples each edge by its own bound: as many equal steps as keep its chords within `share`.
    ///
    /// # Errors
    /// An edge that needs more than `allowed`, or whose second differences overflow, told by the first patch that uses it.
    pub(super) fn sample(&mut self, share: f64, allowed: u32) -> Result<(), TessellationError> {
        for index in 0..self.edges.len() {
            let curve = &self.edges[index].curve;
            let bound = curve.second_derivative_bound();
            let found = segments_for(bound, share);
            if !bound.is_finite() {
                return Err(TessellationError::TooLarge { kind: "patch", index: self.patch_of(index) });
            }
            if found > f64::from(allowed) {
                let index = self.patch_of(index);
                return Err(TessellationError::TooManySegments { kind: "patch", index, found, allowed });
            }
            self.edges[index].segments = (found as u32).max(fewest_segments(curve));
        }
        Ok(())
    }

    /// The patch that first uses an edge.
    fn patch_of(&self, edge: usize) -> usize {
        let uses = |sides: &[SideUse; 4]| sides.iter().any(|side| side.edge as usize == edge);
        self.sides.iter().position(uses).unwrap_or(0)
    }
}
