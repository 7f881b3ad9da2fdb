//! Distances between shapes: Hausdorff distances bounded from both sides, mean distances, chamfer distances.
//!
//! Shapes are [`Simplices`]: triangles, segments and points. The directed distance from `a` to `b` looks at every point
//! of `a` and its distance to the nearest point of `b`. Its largest value is the directed Hausdorff distance, found by
//! branch and bound, so that no point is overlooked; its mean comes from a quadrature with proven bounds.
//!
//! Shapes of any other form, such as formulas, are compared by what they can do: [`Samples`] and
//! [`ClosestPoint`](shapeloom_core::ClosestPoint) give mean and chamfer distances by [`distances_from_samples`].
//!
//! ```
//! use shapeloom_core::Exec;
//! use shapeloom_core::glam::DVec3;
//! use shapeloom_judge::{Distances, Simplices};
//!
//! let square = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
//! let lifted: Vec<DVec3> = square.iter().map(|&corner| corner + DVec3::Z * 0.25).collect();
//! let triangles = [[0, 1, 2], [0, 2, 3]];
//! let [a, b] = [&square, &lifted].map(|positions| Simplices::new(positions, &triangles[..]));
//! let found = Distances::new().measure(&a, &b, &Exec::default())?;
//! assert!(found.hausdorff.lower() <= 0.25 && found.hausdorff.upper() >= 0.25);
//! assert!((found.a_to_b.mean.value - 0.25).abs() < 1e-12);
//! # Ok::<(), shapeloom_judge::JudgeError>(())
//! ```

mod cell;
#[cfg(test)]
mod extreme_tests;
mod foot;
mod hausdorff;
mod mean;
mod measure;
mod patchwork;
#[cfg(test)]
mod sample_tests;
mod samples;
mod side;
mod simplex_cells;
mod simplices;
mod sums;
#[cfg(test)]
mod tests;

pub use hausdorff::{DirectedHausdorff, Hausdorff, Witness};
pub use mean::{Estimate, MeanDistance};
pub use measure::{Distances, Measured};
pub use samples::{MeanDistances, Sample, Sampled, Samples, distance_from_samples, distances_from_samples};
pub use simplex_cells::SimplexCells;
pub use simplices::Simplices;
