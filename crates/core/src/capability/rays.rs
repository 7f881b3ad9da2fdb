//! Ray queries.

use glam::DVec2;

use crate::{Exec, Ray, Stop, parallel};

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The distance along the ray.
    pub distance: f64,
    /// The element that was met (a triangle, a patch).
    pub element: u32,
    /// Coordinates on the element: for a triangle the barycentric weights of its second and third corner.
    pub parameters: DVec2,
    /// Whether the ray meets the back of the element.
    pub back: bool,
}

/// A shape that rays can meet.
///
/// Laws, tested on every implementor: the first hit is the nearest of all hits, `any_hit` tells whether there is one,
/// every hit lies within the ray's reach, and batches agree with single queries to the bit.
pub trait Rays: Send + Sync {
    /// The nearest hit within the ray's reach; between equal distances the one with the smallest element.
    fn first_hit(&self, ray: &Ray) -> Option<Hit>;

    /// Every hit within the ray's reach, by (distance, element).
    fn all_hits(&self, ray: &Ray, hits: &mut Vec<Hit>);

    /// Whether there is a hit within the ray's reach.
    fn any_hit(&self, ray: &Ray) -> bool {
        self.first_hit(ray).is_some()
    }

    /// The first hit of each ray, in parallel.
    ///
    /// # Errors
    /// The reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    fn first_hits(&self, rays: &[Ray], out: &mut [Option<Hit>], exec: &Exec) -> Result<(), Stop> {
        assert_eq!(rays.len(), out.len(), "slices of one length");
        parallel::fill_chunks(exec, out, 256, |first, part| {
            for (ray, hit) in rays[first..].iter().zip(part) {
                *hit = self.first_hit(ray);
            }
            Ok(())
        })
    }

    /// Whether each ray has a hit, in parallel: occlusion.
    ///
    /// # Errors
    /// The reason to stop.
    ///
    /// # Panics
    /// When the slices differ in length.
    fn any_hits(&self, rays: &[Ray], out: &mut [bool], exec: &Exec) -> Result<(), Stop> {
        assert_eq!(rays.len(), out.len(), "slices of one length");
        parallel::fill_chunks(exec, out, 256, |first, part| {
            for (ray, met) in rays[first..].iter().zip(part) {
                *met = self.any_hit(ray);
            }
            Ok(())
        })
    }
}
