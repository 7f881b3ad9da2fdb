//! Surfaces moved along their normals.

use shapeloom_core::{
    Bounds, Convert, ConvertError, Converted, Deviation, Exec, FromTolerance, Options, Report, options,
};
use shapeloom_isosurface::sample_range;

use super::{as_distances, check_scale, distance_grid};
use crate::{Quantity, VoxelError, VoxelGrid};

options! {
    /// The solid grown or shrunk by a distance, as a grid of signed distances.
    ///
    /// A positive distance grows, a negative one shrinks: the distance is taken from every sample. The result is as
    /// good as the samples are distances: of another kind of grid, or where samples are not finite, they are made so
    /// first, as `redistance` does. Growing rounds convex edges off, shrinking rounds concave ones; away from the old
    /// surface on the side where it is concave the result's values are no distances any more, but bounds of them. Parts
    /// that shrink to nothing are gone, and the deviation is an estimate. Cost: linear.
    pub struct OffsetLevelSet("offset-level-set") {
        required {
            /// How far the surface moves outward, in model units; inward if negative.
            distance: f64 [Bounds::FINITE],
        }
        optional {}
    }
}

impl FromTolerance<VoxelGrid> for OffsetLevelSet {
    /// By no distance: a tolerance is no wish to move a surface.
    fn from_tolerance(_: &VoxelGrid, _: f64) -> Self {
        Self::new(0.0)
    }
}

impl Convert<VoxelGrid> for OffsetLevelSet {
    type Output = VoxelGrid;

    fn convert_with(&self, source: &VoxelGrid, exec: &Exec) -> Result<Converted<VoxelGrid>, ConvertError> {
        self.validate()?;
        exec.check()?;
        let lattice = *source.lattice();
        check_scale(&lattice)?;
        if self.distance.abs() > f64::from(f32::MAX) / 4.0 {
            return Err(VoxelError::Overflow { what: "an offset", found: self.distance }.into());
        }
        let _memory = exec.reserve_elements(lattice.samples(), size_of::<f32>())?;
        let mut values = as_distances(source, exec)?;
        for part in values.chunks_mut(4096) {
            exec.check()?;
            for value in part {
                let moved = (f64::from(*value) - self.distance) as f32;
                // Sums of large numbers stay numbers.
                *value = moved.clamp(f32::MIN, f32::MAX);
            }
        }
        let as_it_was = source.quantity() == Quantity::SignedDistance && sample_range(source, exec)?.not_finite == 0;
        let (deviation, basis) = match (self.distance, as_it_was) {
            (0.0, true) => (Deviation::Exact, "nothing moves"),
            (0.0, false) => (
                Deviation::Estimated(lattice.cell_diagonal()),
                "the diagonal of a cell: the samples were made distances",
            ),
            _ => (Deviation::Estimated(self.distance.abs()), "how far the surface moves, where it does not vanish"),
        };
        exec.progress(1.0);
        Ok(Converted::new(distance_grid(lattice, values)?, Report::new(Self::NAME, deviation, basis)))
    }
}
