//! Clusters far from a query: their dipole, quadrupole and octupole, eight at once.

use std::ops::{Add, Mul, Sub};

use super::cluster::Cluster;
use super::near::WIDTH;

/// Eight clusters by lane, in single precision: centres exactly, the rest rounded, bounds upward. Moments are divided
/// by the radius and its square, so that all have the size of the area. Lanes without a cluster hold one without area
/// far away.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node {
    pub center: [[f32; WIDTH]; 3],
    pub radius: [f32; WIDTH],
    /// Not below the area.
    pub area: [f32; WIDTH],
    /// Not below the integral of the cubed distance to the centre over the radius cubed.
    pub cube: [f32; WIDTH],
    pub dipole: [[f32; WIDTH]; 3],
    pub quadrupole: [[f32; WIDTH]; 5],
    pub octupole: [[f32; WIDTH]; 7],
}

impl Node {
    pub const EMPTY: Self = Self {
        center: [[1e18; WIDTH]; 3],
        radius: [0.0; WIDTH],
        area: [0.0; WIDTH],
        cube: [0.0; WIDTH],
        dipole: [[0.0; WIDTH]; 3],
        quadrupole: [[0.0; WIDTH]; 5],
        octupole: [[0.0; WIDTH]; 7],
    };

    pub fn of(clusters: &[Cluster]) -> Self {
        let mut node = Self::EMPTY;
        for (lane, cluster) in clusters.iter().enumerate().take(WIDTH) {
            let radius = upward(cluster.radius);
            let r = f64::from(radius);
            node.radius[lane] = radius;
            node.area[lane] = upward(cluster.area).max(LEAST_AREA);
            node.cube[lane] = upward(cluster.cube / (r * r * r));
            for (out, &x) in node.center.iter_mut().zip(cluster.center.as_ref()) {
                out[lane] = x as f32;
            }
            for (out, m) in node.dipole.iter_mut().zip(cluster.dipole) {
                out[lane] = m as f32;
            }
            for (out, m) in node.quadrupole.iter_mut().zip(cluster.quadrupole()) {
                out[lane] = (m / r) as f32;
            }
            for (out, m) in node.octupole.iter_mut().zip(cluster.octupole()) {
                out[lane] = (m / (r * r)) as f32;
            }
        }
        node
    }

    /// Solid angles of the clusters farther than the square root of `accuracy_squared` radii, and which are not.
    ///
    /// The query is given in two single-precision parts, so that differences to near centres keep all their digits.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // A lane runs through many arrays.
    pub fn far(&self, high: [f32; 3], low: [f32; 3], accuracy_squared: f32) -> ([f32; WIDTH], u32) {
        let mut angles = [0.0; WIDTH];
        let mut near = 0;
        for lane in 0..WIDTH {
            let x = (self.center[0][lane] - high[0]) - low[0];
            let y = (self.center[1][lane] - high[1]) - low[1];
            let z = (self.center[2][lane] - high[2]) - low[2];
            let squared = x * x + y * y + z * z;
            let radius = self.radius[lane];
            let is_near = squared <= accuracy_squared * (radius * radius);
            let inverse = 1.0 / squared.sqrt();
            let (x, y, z) = (x * inverse, y * inverse, z * inverse);
            let ratio = radius * inverse;
            let moments = (
                [0, 1, 2].map(|i| self.dipole[i][lane]),
                [0, 1, 2, 3, 4].map(|i| self.quadrupole[i][lane]),
                [0, 1, 2, 3, 4, 5, 6].map(|i| self.octupole[i][lane]),
            );
            let angle = inverse * inverse * expansion([x, y, z], ratio, moments);
            angles[lane] = if is_near { 0.0 } else { angle };
            near |= u32::from(is_near) << lane;
        }
        (angles, near)
    }

    /// The same in double precision, with bounds of the solid angles' truncation and rounding, for the clusters whose
    /// truncation is at most `threshold`. `reach` is the largest coordinate of the query.
    #[inline(always)]
    #[allow(clippy::needless_range_loop)] // A lane runs through many arrays.
    pub fn far_within(&self, query: [f64; 3], reach: f64, threshold: f64) -> ([[f64; WIDTH]; 3], u32) {
        let mut out = [[0.0; WIDTH]; 3];
        let mut near = 0;
        for lane in 0..WIDTH {
            let x = f64::from(self.center[0][lane]) - query[0];
            let y = f64::from(self.center[1][lane]) - query[1];
            let z = f64::from(self.center[2][lane]) - query[2];
            let inverse = 1.0 / (x * x + y * y + z * z).sqrt();
            let (x, y, z) = (x * inverse, y * inverse, z * inverse);
            let ratio = f64::from(self.radius[lane]) * inverse;
            // Σ k ρ^(k-1) from k = 4, with the area's cubed distances: see docs/algorithms/winding_number.md.
            let gap = 1.0 - ratio;
            let cubed = ratio * ratio * ratio * f64::from(self.cube[lane]);
            let truncation = inverse * inverse * cubed * (4.0 - 3.0 * ratio) / (gap * gap) * (1.0 + 1e-9);
            let is_far = (ratio < MOST_RATIO) & (truncation <= threshold);
            let area = f64::from(self.area[lane]) * (inverse * inverse);
            let rounding = area * (ROUNDING * (1.0 + ratio * (9.0 + ratio * 64.0)) + PLACES * (1.0 + reach) * inverse);
            let moments = (
                [0, 1, 2].map(|i| f64::from(self.dipole[i][lane])),
                [0, 1, 2, 3, 4].map(|i| f64::from(self.quadrupole[i][lane])),
                [0, 1, 2, 3, 4, 5, 6].map(|i| f64::from(self.octupole[i][lane])),
            );
            let angle = inverse * inverse * expansion([x, y, z], ratio, moments);
            out[0][lane] = if is_far { angle } else { 0.0 };
            out[1][lane] = if is_far { truncation } else { 0.0 };
            out[2][lane] = if is_far { rounding } else { 0.0 };
            near |= u32::from(!is_far) << lane;
        }
        (out, near)
    }
}

/// Coefficients of the dipole, the quadrupole and the octupole.
type Moments<T> = ([T; 3], [T; 5], [T; 7]);

/// The first three terms of a cluster in a direction, times the squared distance. `ratio` is the radius over the
/// distance.
#[inline(always)]
fn expansion<T>([x, y, z]: [T; 3], ratio: T, ([dx, dy, dz], [q0, q1, q2, q3, q4], o): Moments<T>) -> T
where
    T: Copy + From<f32> + Add<Output = T> + Sub<Output = T> + Mul<Output = T>,
{
    let three = T::from(3.0);
    let [o0, o1, o2, o3, o4, o5, o6] = o;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    let dipole = dx * x + dy * y + dz * z;
    let quadrupole = q0 * (xx - zz) + q1 * (yy - zz) + (q2 * x + q4 * z) * y + q3 * (x * z);
    let octupole = x * (o0 * (three * yy - xx) + o1 * (three * zz - xx))
        + y * (o2 * (three * xx - yy) + o3 * (three * zz - yy))
        + z * (o4 * (three * xx - zz) + o5 * (three * yy - zz))
        + o6 * (x * y * z);
    dipole + ratio * (quadrupole + ratio * octupole)
}

/// Clusters nearer than their radius over this are always opened: the bound on what rounding of places does needs it.
const MOST_RATIO: f64 = 0.75;
/// Half an ulp of single precision, with room: moments are stored with it.
const ROUNDING: f64 = 1.0 / (1u64 << 23) as f64;
/// Clusters count as having this area at least, in the bounds: their moments may underflow in single precision, each by
/// half of 2⁻¹⁴⁹, which `ROUNDING` times this area holds many times.
const LEAST_AREA: f32 = 1.0 / (1u128 << 120) as f32;
/// What the rounding of places does at most, for each unit of area over the cubed distance.
const PLACES: f64 = 1.0 / (1u64 << 44) as f64;

/// The smallest `f32` that is not below.
fn upward(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) < value { near.next_up() } else { near }
}
