//! The generalised winding number by its definition.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use glam::DVec3;
use shapeloom_core::{Exec, parallel};

use super::side::side;
use super::sum::Sum;
use crate::BvhError;
use crate::scaled_input::{Units, checked_bounds};

/// A winding number and how far it may be from the true one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WindingNumber {
    /// The winding number as computed.
    pub value: f64,
    /// The largest distance to the true one, proven, for triangles of any size. The shape that it speaks of is the
    /// given one, but that coordinates below 1e-307 of its size are rounded to multiples of 5e-324 of it. Infinite
    /// where nothing is known, as for queries that are not finite.
    pub bound: f64,
}

impl WindingNumber {
    pub(crate) const UNKNOWN: Self = Self { value: f64::NAN, bound: f64::INFINITY };
}

/// How far the queries may be from the shape, in its sizes; beyond, winding numbers are below 1e-16 and count as 0.
const HORIZON: f64 = (1u64 << 40) as f64;

/// Whether a query in local units is too far, or overflowed on the way to them.
pub(crate) fn beyond(local: DVec3) -> bool {
    !local.is_finite() || local.abs().max_element() >= HORIZON
}

/// The bound of an answer beyond the horizon: as if every triangle were as large as the shape and faced the query.
pub(crate) fn beyond_horizon(triangles: usize) -> WindingNumber {
    WindingNumber { value: 0.0, bound: triangles as f64 * 2f64.powi(-78) }
}

/// The generalised winding number of triangles around a query, by its definition (Jacobson, Kavan, Sorkine-Hornung
/// 2013): the sum of the solid angles of all triangles (Van Oosterom and Strackee 1983) over 4π, with compensated
/// summation. The reference that [`WindingTree`](super::WindingTree) is held against.
///
/// Around a closed mesh it is a whole number: 1 inside and 0 outside where faces look outward. Triangles whose plane
/// holds the query count 0, decided exactly, and so do triangles whose corners are exactly on a line. On the surface
/// the value is therefore the mean over a small ball: 1/2 inside a face of a closed mesh, the share of the interior
/// angle on an edge or corner. A query that is not finite has the value NaN.
///
/// The bound holds every rounding error, with the limit that [`WindingNumber::bound`] names: about 1e-15 a triangle,
/// growing with the size of a triangle over the query's distance to its border. Cost: O(n), some tens of nanoseconds a triangle.
///
/// # Errors
/// An index out of range, a corner that is not finite, more than `u32::MAX - 1` triangles, or the reason to stop.
pub fn generalized_winding_number(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    query: DVec3,
    exec: &Exec,
) -> Result<WindingNumber, BvhError> {
    let bounds = checked_bounds(positions, triangles, exec)?;
    if !query.is_finite() {
        return Ok(WindingNumber::UNKNOWN);
    }
    let units = Units::new(&bounds);
    let query = query * units.per_unit;
    if beyond(query - units.center) {
        return Ok(beyond_horizon(triangles.len()));
    }
    let parts = parallel::map_chunks(exec, triangles.len(), 1 << 13, |range| {
        let (mut sum, mut bound) = (Sum::default(), 0.0);
        for triangle in &triangles[range] {
            let corners = triangle.map(|corner| positions[corner as usize] * units.per_unit);
            let (turns, error) = turns_of(&corners, query);
            sum.add(turns);
            bound += error;
        }
        Ok::<_, BvhError>((sum, bound))
    })?;
    let (mut sum, mut bound) = (Sum::default(), 0.0);
    for (part, error) in parts {
        sum.add(part.total());
        bound += error + part.error();
    }
    Ok(WindingNumber { value: sum.total(), bound: (bound + sum.error()) * (1.0 + 1e-6) })
}

/// The solid angle of a triangle over 4π, and a bound of the rounding error; positive where the query is behind the
/// counter-clockwise side.
///
/// Van Oosterom and Strackee: tan(Ω/2) = det / den. It depends on the directions of the corners alone, so each is
/// brought to a length of about 1 first, by a power of two of its own: nothing underflows, whatever the sizes. With u =
/// 2⁻⁵³ and the corners relative to the query within u each, the determinant is wrong by at most 14 u and the
/// denominator by 56 u of |a||b||c|, so the angle of the point (den, det) by 91 u |a||b||c| over its length. Turned into
/// whole turns that is below 24 u; 2⁻⁴⁸ and 2⁻⁵¹ for the arctangent hold it.
///
/// Near the plane inside the triangle the solid angle jumps; there the side is decided exactly, from the corners and the
/// query as they are and not from their rounded differences. So the error is never more than 1/2.
pub(crate) fn turns_of(corners: &[DVec3; 3], query: DVec3) -> (f64, f64) {
    let [a, b, c] = corners.map(|corner| of_size_one(corner - query));
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let product = la * lb * lc;
    let det = a.dot(b.cross(c));
    let den = product + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    // NaN, where the query is a corner, becomes 1/2 by `min`.
    let error = (2f64.powi(-48) * product / det.hypot(den) + 2f64.powi(-51)).min(0.5);
    if det.abs() > 2f64.powi(-45) * product || den > 2f64.powi(-20) * product {
        return (det.atan2(den) / TAU, error);
    }
    let size = det.abs().atan2(den) / TAU;
    // Corners on a line lie in a plane with everything.
    match side(corners, query) {
        Ordering::Equal => (0.0, 0.0),
        Ordering::Less => (size, error),
        Ordering::Greater => (-size, error),
    }
}

/// The vector times a power of two that brings its largest coordinate to between 1 and 2; zero stays zero.
fn of_size_one(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    // Subnormal numbers have no exponent of their own.
    let v = if largest < f64::MIN_POSITIVE { v * 2f64.powi(100) } else { v };
    let largest = v.abs().max_element();
    if largest == 0.0 {
        return v;
    }
    // Clearing the fraction leaves the power of two.
    v / f64::from_bits(largest.to_bits() & 0x7ff0_0000_0000_0000)
}
