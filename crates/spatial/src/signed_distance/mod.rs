//! Signed distances to triangles.

mod field;
mod inside;

#[cfg(test)]
mod tests;

pub use inside::InsideRule;

use std::fmt;

use glam::DVec3;
use shapeloom_core::{Aabb, Closest, ClosestPoint, Exec, Reservation};

use crate::closed::is_closed;
use crate::winding::along_curve;
use crate::{BvhError, TriangleBvh, WindingTree};

/// How many of the queries before may tell the side: looking costs a few nanoseconds each, a winding number
/// microseconds.
const RECENT: usize = 32;

/// The closest point of a shape to a query, and on which side the query is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SignedClosest {
    /// The distance, negative inside.
    pub distance: f64,
    /// The closest point.
    pub closest: Closest,
}

/// The signed distance to triangles: the distance to the closest point, negative inside.
///
/// Inside is what the generalised winding number says, so meshes with holes, flipped or duplicate faces and soups have
/// an inside too; [`InsideRule`] says which winding numbers are inside. Where the mesh is closed (see
/// [`SignedDistance::is_closed`]) the sign is right wherever the winding number, a whole number there, has a proven bound
/// below 1/2; exact predicates decide the side of the nearest triangles. The bound is larger only nearer to an edge than
/// about 1e-13 of its length, or where very many edges or needles come as near; there rounding may leave the sign open.
/// Coordinates below 1e-307 of the shape's size count as rounded (see [`WindingNumber`](crate::WindingNumber)'s bound).
/// Where the mesh is not closed, the winding number passes 1/2 also away from the surface, and the sign jumps there.
///
/// It is a [`Field`](shapeloom_core::Field): on a closed mesh a true distance with Lipschitz constant 1.
///
/// Memory: about 250 bytes a triangle, reserved as long as it lives. Cost of a query: a closest point and a few
/// microseconds for the sign.
pub struct SignedDistance {
    bvh: TriangleBvh,
    winding: WindingTree,
    /// Unit normals of the triangles, zero where there is none, for gradients on the surface.
    normals: Vec<DVec3>,
    rule: InsideRule,
    closed: bool,
    _memory: Reservation,
}

impl SignedDistance {
    /// Prepares `triangles`, index triples into `positions`, with the rule [`InsideRule::Positive`].
    ///
    /// Cost: O(n log n), about two seconds for a million triangles.
    ///
    /// # Errors
    /// An index out of range, a corner that is not finite, more than `u32::MAX - 1` triangles, too little memory in the
    /// budget, or the reason to stop.
    pub fn build(positions: &[DVec3], triangles: &[[u32; 3]], exec: &Exec) -> Result<Self, BvhError> {
        let bvh = TriangleBvh::build(positions, triangles, &exec.part(0.0, 0.6))?;
        let winding = WindingTree::build(positions, triangles, &exec.part(0.6, 0.8))?;
        let memory = exec.reserve_elements(triangles.len() as u64, size_of::<DVec3>())?;
        let mut normals = vec![DVec3::ZERO; triangles.len()];
        let per_unit = winding.units().per_unit;
        shapeloom_core::parallel::fill_chunks(exec, &mut normals, 1 << 14, |first, part| {
            for (triangle, normal) in triangles[first..].iter().zip(part) {
                let [a, b, c] = triangle.map(|corner| positions[corner as usize] * per_unit);
                *normal = (b - a).cross(c - a).normalize_or_zero();
            }
            Ok::<_, BvhError>(())
        })?;
        exec.progress(0.9);
        let closed = is_closed(positions, triangles, exec)?;
        exec.progress(1.0);
        Ok(Self { bvh, winding, normals, rule: InsideRule::Positive, closed, _memory: memory })
    }

    /// Sets which winding numbers are inside.
    #[must_use]
    pub fn with_rule(self, rule: InsideRule) -> Self {
        Self { rule, ..self }
    }

    /// Which winding numbers are inside.
    pub fn rule(&self) -> InsideRule {
        self.rule
    }

    /// Whether every edge is passed as often one way as the other, equal positions counting as one: then winding
    /// numbers are whole numbers off the surface and the sign changes there only. Meshes that are not oriented alike,
    /// such as a Klein bottle, are not closed in this sense.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// The box around the triangles; empty without any.
    pub fn bounds(&self) -> Aabb {
        self.bvh.bounds()
    }

    /// The triangles, for closest points and rays.
    pub fn bvh(&self) -> &TriangleBvh {
        &self.bvh
    }

    /// The triangles, for winding numbers.
    pub fn winding(&self) -> &WindingTree {
        &self.winding
    }

    /// The signed distance; infinite without triangles, NaN where the query is not finite.
    ///
    /// Exact up to rounding: a few ulps of the largest coordinate at hand.
    pub fn distance(&self, query: DVec3) -> f64 {
        match self.signed_closest(query) {
            Some(found) => found.distance,
            None => self.nowhere(query),
        }
    }

    /// The signed distance and the closest point; none without triangles or where the query is not finite.
    pub fn signed_closest(&self, query: DVec3) -> Option<SignedClosest> {
        self.beside(query, &[])
    }

    /// [`SignedDistance::distance`] of many points, in parallel, with the same bits. As in
    /// [`WindingTree::winding_numbers`], up to four million are sorted without asking whether to stop.
    ///
    /// # Errors
    /// Too little memory in the budget, or the reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn distances(&self, queries: &[DVec3], out: &mut [f64], exec: &Exec) -> Result<(), BvhError> {
        along_curve(self.winding.units(), queries, out, exec, |query, before| {
            self.beside(query, before).map_or_else(|| self.nowhere(query), |found| found.distance)
        })
    }

    /// [`SignedDistance::signed_closest`] of many points, in parallel, with the same bits.
    ///
    /// # Errors
    /// Too little memory in the budget, or the reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    pub fn signed_closest_points(
        &self,
        queries: &[DVec3],
        out: &mut [Option<SignedClosest>],
        exec: &Exec,
    ) -> Result<(), BvhError> {
        along_curve(self.winding.units(), queries, out, exec, |query, before| {
            let distance = |found: Option<SignedClosest>| found.map_or(f64::NAN, |found| found.distance);
            let mut known = [(DVec3::NAN, f64::NAN); RECENT];
            for (known, &(place, found)) in known.iter_mut().rev().zip(before.iter().rev()) {
                *known = (place, distance(found));
            }
            self.beside(query, &known)
        })
    }

    fn nowhere(&self, query: DVec3) -> f64 {
        if query.is_finite() { f64::INFINITY } else { f64::NAN }
    }

    /// The answer, found sooner with those of points nearby, the latest last: the distance is at most another's and the
    /// way between them; and where the mesh is closed and the balls around two points that meet no triangle overlap,
    /// both points are on one side.
    fn beside(&self, query: DVec3, before: &[(DVec3, f64)]) -> Option<SignedClosest> {
        let slack = self.slack(query);
        let near = before.last().and_then(|&(place, distance)| {
            let largest = (distance.abs() + length(query - place)) * (1.0 + 1e-9) + slack;
            self.bvh.closest_within(query, largest)
        });
        let closest = near.or_else(|| self.bvh.closest(query))?;
        let distance = match closest.distance_squared {
            squared if (1e-250..1e300).contains(&squared) => squared.sqrt(),
            _ => length(closest.point - query),
        };
        let mut recent = before.iter().rev().take(RECENT);
        let same_side = recent.find(|&&(place, other)| {
            let reach = distance + other.abs() - 4.0 * slack;
            self.closed && reach > 0.0 && length(query - place) < reach
        });
        let inside = match same_side {
            Some((_, other)) => *other < 0.0,
            None => self.is_inside(query),
        };
        Some(SignedClosest { distance: if inside { -distance } else { distance }, closest })
    }

    /// More than rounding can do to a distance from a query.
    fn slack(&self, query: DVec3) -> f64 {
        let bounds = self.bvh.bounds();
        let largest = query.abs().max(bounds.min.abs()).max(bounds.max.abs()).max_element();
        largest * 2f64.powi(-44)
    }
}

/// The length of a vector, safe against overflow and underflow of squares.
fn length(v: DVec3) -> f64 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).length() * largest } else { largest }
}

impl fmt::Debug for SignedDistance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SignedDistance")
            .field("triangles", &self.bvh.len())
            .field("bounds", &self.bounds())
            .field("rule", &self.rule)
            .field("closed", &self.closed)
            .finish_non_exhaustive()
    }
}
