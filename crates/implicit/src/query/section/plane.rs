//! A window in a plane, cut into cells that can be halved.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Aabb, Field, Frame, Interval};

use super::error::SectionError;
use crate::query::Side;

/// A field seen in a window of a plane: the source of [`AdaptiveMarchingSquares`](super::AdaptiveMarchingSquares).
#[derive(Debug)]
pub struct PlaneWindow<'a, F: ?Sized> {
    pub(super) field: &'a F,
    pub(super) frame: Frame,
    pub(super) lo: DVec2,
    pub(super) hi: DVec2,
}

impl<'a, F: Field + ?Sized> PlaneWindow<'a, F> {
    /// The window between two corners of the plane that the frame's first two axes span, in the frame's coordinates.
    ///
    /// # Errors
    /// Corners that are not finite, or a window without area.
    pub fn new(field: &'a F, frame: Frame, lo: DVec2, hi: DVec2) -> Result<Self, SectionError> {
        let size = hi - lo;
        if lo.is_finite() && size.is_finite() && size.x > 0.0 && size.y > 0.0 {
            Ok(Self { field, frame, lo, hi })
        } else {
            Err(SectionError::Window { lo, hi })
        }
    }

    /// The window between two corners of the plane z = 0: for curves f(x, y) = 0.
    ///
    /// # Errors
    /// As [`PlaneWindow::new`].
    pub fn in_xy(field: &'a F, lo: DVec2, hi: DVec2) -> Result<Self, SectionError> {
        Self::new(field, Frame::WORLD, lo, hi)
    }

    /// The longer side.
    pub(super) fn longer(&self) -> f64 {
        (self.hi - self.lo).max_element()
    }

    pub(super) fn value(&self, place: DVec2) -> f64 {
        self.field.value(self.frame.position(place.extend(0.0)))
    }

    pub(super) fn side(&self, place: DVec2) -> Side {
        Side::of(self.value(place))
    }

    /// A box in space that holds every point computed between two corners of the plane.
    pub(super) fn region(&self, lo: DVec2, hi: DVec2) -> Aabb {
        let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
        let tight = Aabb::from_points(corners.map(|corner| self.frame.position(corner.extend(0.0))));
        if self.frame == Frame::WORLD {
            return tight;
        }
        // Three products and sums, each rounded.
        let largest = |p: DVec3| p.abs().max_element();
        let size = largest(tight.min).max(largest(tight.max)).max(largest(self.frame.origin()));
        tight.padded(8.0 * f64::EPSILON * size)
    }
}

/// The finest lattice of a window: every corner of a cell has whole coordinates there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    lo: DVec2,
    hi: DVec2,
    /// Root cells along each axis.
    pub(super) roots: [u64; 2],
    /// How often a root cell is halved to the lattice's steps.
    pub(super) depth: u32,
}

/// Root cells along the longer side, at most, so that cells of narrow windows are about square.
const ROOTS: f64 = 64.0;
/// How often root cells can be halved; 64 roots of 2^40 steps are near what double precision tells apart.
pub(super) const DEEPEST: u32 = 40;

impl Lattice {
    pub(super) fn new(lo: DVec2, hi: DVec2, depth: u32) -> Self {
        let size = hi - lo;
        let shorter = size.min_element();
        let roots = [size.x, size.y].map(|side| (side / shorter).round().clamp(1.0, ROOTS) as u64);
        Self { lo, hi, roots, depth }
    }

    /// The diagonal of a cell after so many halvings.
    pub(super) fn diagonal(&self, level: u32) -> f64 {
        let size = self.hi - self.lo;
        DVec2::new(size.x / self.roots[0] as f64, size.y / self.roots[1] as f64).length() * 0.5_f64.powi(level as i32)
    }

    /// The place of a corner.
    pub(super) fn place(&self, [x, y]: [u64; 2]) -> DVec2 {
        let along = |axis: usize, at: u64| {
            let whole = (self.roots[axis] << self.depth) as f64;
            Interval::new(self.lo[axis], self.hi[axis]).at(at as f64 / whole)
        };
        DVec2::new(along(0, x), along(1, y))
    }
}
