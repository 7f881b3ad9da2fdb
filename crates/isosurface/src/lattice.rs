//! Lattices of samples, placed in space.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Aabb, Affine};

use crate::LatticeError;

/// A lattice of samples: how many in each direction, and where they are.
///
/// Sample `(i, j, k)` is at `placement.point((i, j, k))`: the columns of the placement's linear map are the steps between samples,
/// which give spacing and orientation together. In memory `i` runs fastest, then `j`; all samples with one `k` are a slab.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    dimensions: [u32; 3],
    placement: Affine,
}

impl Lattice {
    /// A lattice with steps in any three directions.
    ///
    /// # Errors
    /// No samples in a direction, more than 2^40 in all or 2^31 in a slab, or steps that are not finite or lie in one plane.
    pub fn try_new(dimensions: [u32; 3], placement: Affine) -> Result<Self, LatticeError> {
        if dimensions.contains(&0) {
            return Err(LatticeError::NoSamples { dimensions });
        }
        let [x, y, z] = dimensions.map(u64::from);
        let slab = x.checked_mul(y).filter(|&slab| slab <= 1 << 31);
        if slab.and_then(|slab| slab.checked_mul(z)).is_none_or(|samples| samples > 1 << 40) {
            return Err(LatticeError::TooMany { dimensions });
        }
        let far = placement.point(DVec3::from(dimensions.map(f64::from)));
        let determinant = placement.determinant();
        if !placement.is_finite() || !far.is_finite() || determinant == 0.0 || !determinant.is_finite() {
            return Err(LatticeError::Placement);
        }
        Ok(Self { dimensions, placement })
    }

    /// A lattice along the axes, with the first sample at `origin`.
    ///
    /// # Errors
    /// As [`Lattice::try_new`], and a spacing that is not positive and finite.
    pub fn along_axes(dimensions: [u32; 3], origin: DVec3, spacing: DVec3) -> Result<Self, LatticeError> {
        if let Some(axis) = (0..3).find(|&axis| !(spacing[axis] > 0.0 && spacing[axis].is_finite())) {
            return Err(LatticeError::Spacing { axis, found: spacing[axis] });
        }
        let placement = Affine { linear: DMat3::from_diagonal(spacing), translation: origin };
        Self::try_new(dimensions, placement)
    }

    /// How many samples there are in each direction.
    pub fn dimensions(&self) -> [u32; 3] {
        self.dimensions
    }

    /// The map from sample coordinates to space.
    pub fn placement(&self) -> &Affine {
        &self.placement
    }

    /// The lengths of the steps between samples.
    pub fn spacing(&self) -> DVec3 {
        let [x, y, z] = self.steps().map(DVec3::length);
        DVec3::new(x, y, z)
    }

    /// The steps between samples, as vectors.
    pub fn steps(&self) -> [DVec3; 3] {
        [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| self.placement.vector(axis))
    }

    /// How many samples there are in all.
    pub fn samples(&self) -> u64 {
        self.slab_len() as u64 * u64::from(self.dimensions[2])
    }

    /// How many samples a slab has.
    pub fn slab_len(&self) -> usize {
        self.dimensions[0] as usize * self.dimensions[1] as usize
    }

    /// The place of a sample in memory.
    pub fn index(&self, [i, j, k]: [u32; 3]) -> u64 {
        (u64::from(k) * u64::from(self.dimensions[1]) + u64::from(j)) * u64::from(self.dimensions[0]) + u64::from(i)
    }

    /// The sample at a place in memory: the inverse of [`Lattice::index`].
    pub fn coordinates(&self, index: u64) -> [u32; 3] {
        let [x, y, _] = self.dimensions.map(u64::from);
        [(index % x) as u32, (index / x % y) as u32, (index / (x * y)) as u32]
    }

    /// The position of a sample in space.
    pub fn position(&self, [i, j, k]: [u32; 3]) -> DVec3 {
        self.placement.point(DVec3::new(f64::from(i), f64::from(j), f64::from(k)))
    }

    /// The length of the longest diagonal of a cell, which is the box between eight neighbouring samples.
    pub fn cell_diagonal(&self) -> f64 {
        let [x, y, z] = self.steps();
        [x + y + z, x + y - z, x - y + z, y + z - x].map(DVec3::length).into_iter().fold(0.0, f64::max)
    }

    /// The smallest box around the samples.
    pub fn bounds(&self) -> Aabb {
        let far = self.dimensions.map(|count| f64::from(count - 1));
        Aabb::from_corners(DVec3::ZERO, DVec3::from(far)).transformed(&self.placement)
    }

    /// The image under an affine map; a map that flattens space leaves a lattice whose cells have no volume.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self { placement: *map * self.placement, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_where_the_placement_says() {
        let lattice = Lattice::along_axes([3, 4, 5], DVec3::new(1.0, 2.0, 3.0), DVec3::new(0.5, 2.0, 1.0)).unwrap();
        assert_eq!(lattice.position([2, 1, 4]), DVec3::new(2.0, 4.0, 7.0));
        assert_eq!((lattice.samples(), lattice.slab_len()), (60, 12));
        assert_eq!(lattice.bounds(), Aabb::from_corners(DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 8.0, 7.0)));
        assert_eq!(lattice.cell_diagonal(), 5.25f64.sqrt());
        for index in 0..60 {
            assert_eq!(lattice.index(lattice.coordinates(index)), index);
        }
    }

    #[test]
    fn impossible_lattices_are_refused() {
        let along = |dimensions, spacing| Lattice::along_axes(dimensions, DVec3::ZERO, spacing).unwrap_err();
        assert!(matches!(along([0, 4, 4], DVec3::ONE), LatticeError::NoSamples { .. }));
        assert!(matches!(along([u32::MAX; 3], DVec3::ONE), LatticeError::TooMany { .. }));
        assert!(matches!(along([1 << 20, 1 << 11, 1 << 20], DVec3::ONE), LatticeError::TooMany { .. }));
        for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(along([2, 2, 2], DVec3::new(1.0, bad, 1.0)), LatticeError::Spacing { axis: 1, .. }));
        }
        let flat = Affine::from_scale(DVec3::new(1.0, 1.0, 0.0));
        assert_eq!(Lattice::try_new([2, 2, 2], flat), Err(LatticeError::Placement));
    }
}
