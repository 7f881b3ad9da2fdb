//! Distance to curves: generalised cylinders.

mod bezier;
mod segments;

use std::fmt;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Category, Diagnostic, Field, Interval};

use bezier::{Piece, closest_near, flatten};
use segments::{Segment, SegmentTree};

/// The distance to curves less a radius: the generalised cylinder about them, with round ends.
///
/// Curves are given as chains of Bézier pieces of any degree; pieces of degree 1 are segments. The value is off by at most the
/// `tolerance` with which the pieces are flattened to find the nearest place; from there Newton's method goes to the nearest point of
/// the true curve, so that it is commonly right up to rounding. Outside, where the radius is less than that of every bend, it is the
/// distance to the surface; elsewhere a bound of it.
///
/// A hierarchy of boxes over the segments answers in about the logarithm of their number.
#[derive(Clone, Debug)]
pub struct CurveDistance {
    pieces: Vec<Piece>,
    tree: SegmentTree,
    radius: f64,
}

/// The most segments that flattened curves may have.
const MOST_SEGMENTS: usize = 1 << 22;

impl CurveDistance {
    /// The cylinder of a radius about Bézier pieces, each given by its control points, flattened within `tolerance`.
    ///
    /// # Errors
    /// No pieces, a piece without points or with one that is not finite, a radius that is negative or not finite, a tolerance that is not
    /// above 0, or one that asks for more than 2²² segments.
    pub fn try_new(pieces: &[Vec<DVec3>], radius: f64, tolerance: f64) -> Result<Self, CurveError> {
        if !(radius >= 0.0 && radius.is_finite()) {
            return Err(CurveError::Radius { found: radius });
        }
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(CurveError::Tolerance { found: tolerance });
        }
        if pieces.is_empty() {
            return Err(CurveError::Empty);
        }
        let mut kept = Vec::with_capacity(pieces.len());
        let mut segments = Vec::new();
        for (index, control) in pieces.iter().enumerate() {
            if control.is_empty() || control.iter().any(|point| !point.is_finite()) {
                return Err(CurveError::Piece { index });
            }
            let piece = Piece::new(control.clone());
            let count = flatten(&piece, tolerance).filter(|count| segments.len() + count <= MOST_SEGMENTS);
            let Some(count) = count else { return Err(CurveError::TooFine { index, tolerance }) };
            for i in 0..count {
                let [from, to] = [i, i + 1].map(|at| at as f64 / count as f64);
                let (start, end) = (piece.point(from), piece.point(to));
                segments.push(Segment { start, end, piece: index as u32, from, to });
            }
            kept.push(piece);
        }
        Ok(Self { pieces: kept, tree: SegmentTree::new(segments), radius })
    }

    /// The cylinder about the segments between points, one after the other.
    ///
    /// # Errors
    /// As [`CurveDistance::try_new`].
    pub fn polyline(points: &[DVec3], radius: f64) -> Result<Self, CurveError> {
        let pieces: Vec<Vec<DVec3>> = match points {
            [] => Vec::new(),
            [point] => vec![vec![*point]],
            _ => points.windows(2).map(<[DVec3]>::to_vec).collect(),
        };
        Self::try_new(&pieces, radius, 1.0)
    }

    /// The radius.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The box of the cylinder.
    pub fn bounds(&self) -> Aabb {
        self.pieces.iter().fold(Aabb::EMPTY, |all, piece| all.union(piece.hull())).padded(self.radius)
    }

    /// The nearest point of the curves; `limit` is a distance within which one is known to lie.
    fn closest(&self, point: DVec3, limit: f64) -> DVec3 {
        let (segment, place) = self.tree.closest(point, limit);
        let Some(piece) = self.pieces.get(segment.piece as usize) else { return segment.start };
        let on_segment = segment.start + (segment.end - segment.start) * place;
        if piece.degree() < 2 {
            return on_segment;
        }
        closest_near(piece, point, segment.from, segment.to, place)
    }
}

impl Field for CurveDistance {
    fn value(&self, point: DVec3) -> f64 {
        self.closest(point, f64::INFINITY).distance(point) - self.radius
    }

    /// Each answer bounds the next: neighbours in the slices should be neighbours in space.
    fn values(&self, origin: DVec3, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        assert!(x.len() == out.len() && y.len() == out.len() && z.len() == out.len(), "slices of one length");
        let mut before: Option<DVec3> = None;
        for (i, value) in out.iter_mut().enumerate() {
            let point = origin + DVec3::new(f64::from(x[i]), f64::from(y[i]), f64::from(z[i]));
            let limit = before.map_or(f64::INFINITY, |nearest| nearest.distance(point));
            let nearest = self.closest(point, limit);
            before = Some(nearest);
            *value = (nearest.distance(point) - self.radius) as f32;
        }
    }

    /// The unit vector from the nearest point; zero on the curve itself.
    fn gradient(&self, point: DVec3) -> DVec3 {
        (point - self.closest(point, f64::INFINITY)).normalize_or_zero()
    }

    /// From the value at the centre, which changes at most by the way to a corner.
    fn range(&self, region: &Aabb) -> Interval {
        let (center, reach) = (region.center(), region.size().length() / 2.0);
        if region.is_empty() || !center.is_finite() || !reach.is_finite() {
            return Interval::ALL;
        }
        let value = self.value(center);
        let slack = 1e-12 * (reach + center.abs().max_element() + value.abs());
        Interval::new(value - reach - slack, value + reach + slack)
    }

    fn lipschitz(&self) -> Option<f64> {
        Some(1.0)
    }
}

/// Why numbers make no generalised cylinder.
#[derive(Clone, Debug, PartialEq)]
pub enum CurveError {
    /// No curve at all.
    Empty,
    /// A piece without points, or with one that is not finite.
    Piece {
        /// The piece.
        index: usize,
    },
    /// A radius that is negative or not finite.
    Radius {
        /// The radius.
        found: f64,
    },
    /// A tolerance that is not above 0.
    Tolerance {
        /// The tolerance.
        found: f64,
    },
    /// A tolerance that asks for too many segments.
    TooFine {
        /// The piece at which there were too many.
        index: usize,
        /// The tolerance.
        tolerance: f64,
    },
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("curve: found no pieces, expected at least one"),
            Self::Piece { index } => {
                write!(f, "curve: piece {index}: found no points or one that is not finite, expected finite points")
            }
            Self::Radius { found } => write!(f, "curve: found radius {found}, expected a finite number, at least 0"),
            Self::Tolerance { found } => write!(f, "curve: found tolerance {found}, expected a finite number above 0"),
            Self::TooFine { index, tolerance } => {
                write!(
                    f,
                    "curve: piece {index}: found tolerance {tolerance}, expected one within {MOST_SEGMENTS} segments"
                )
            }
        }
    }
}

impl std::error::Error for CurveError {}

impl Diagnostic for CurveError {
    fn code(&self) -> &'static str {
        match self {
            Self::Empty => "E-curve-empty",
            Self::Piece { .. } => "E-curve-piece",
            Self::Radius { .. } => "E-curve-radius",
            Self::Tolerance { .. } | Self::TooFine { .. } => "E-curve-tolerance",
        }
    }

    fn category(&self) -> Category {
        match self {
            Self::Empty | Self::Piece { .. } => Category::Malformed,
            _ => Category::Usage,
        }
    }
}

#[cfg(test)]
mod tests;
