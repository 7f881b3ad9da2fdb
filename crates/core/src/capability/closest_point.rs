//! Closest-point queries.

use glam::{DVec2, DVec3};

use crate::{Exec, Stop, parallel};

/// The point of a shape that is closest to a query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// The closest point.
    pub point: DVec3,
    /// The squared distance to it.
    pub distance_squared: f64,
    /// The element that it lies on.
    pub element: u32,
    /// Coordinates on the element: for a triangle the barycentric weights of its second and third corner.
    pub parameters: DVec2,
}

/// A shape that knows its closest point to any place.
///
/// Laws, tested on every implementor: no sampled point of the shape is closer than the answer, the answer lies on its
/// element, and batches agree with single queries to the bit.
pub trait ClosestPoint: Send + Sync {
    /// The closest point within `max_distance`; between equal distances the one on the smallest element. None when
    /// nothing is that near or the query is not finite.
    fn closest_within(&self, query: DVec3, max_distance: f64) -> Option<Closest>;

    /// The closest point; none for an empty shape or a query that is not finite.
    fn closest(&self, query: DVec3) -> Option<Closest> {
        self.closest_within(query, f64::INFINITY)
    }

    /// The closest point to each query, in parallel.
    ///
    /// # Errors
    /// The reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    fn closest_points(&self, queries: &[DVec3], out: &mut [Option<Closest>], exec: &Exec) -> Result<(), Stop> {
        assert_eq!(queries.len(), out.len(), "slices of one length");
        parallel::fill_chunks(exec, out, 256, |first, part| {
            for (&query, closest) in queries[first..].iter().zip(part) {
                *closest = self.closest(query);
            }
            Ok(())
        })
    }
}
