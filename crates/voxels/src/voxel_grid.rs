//! Dense voxel grids.

use shapeloom_core::{Aabb, Affine, ConvertError};
use shapeloom_isosurface::{Inside, Lattice, LatticeError, Slabs};

use crate::Samples;

/// What the samples of a grid are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Whether the cell around a sample is full: 0 or 1. The surface is where it is a half, the inside above.
    Occupancy,
    /// Something that is larger inside, on a scale of its own: X-ray density, for instance. Only the samples tell where
    /// the surface is.
    Density,
    /// The distance to a surface, negative inside, or a field of the same sign.
    SignedDistance,
}

impl Quantity {
    /// The name: `occupancy`, `density`, `signed-distance`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Occupancy => "occupancy",
            Self::Density => "density",
            Self::SignedDistance => "signed-distance",
        }
    }

    /// On which side of the iso value the inside is.
    pub(crate) fn inside(self) -> Inside {
        match self {
            Self::SignedDistance => Inside::Below,
            Self::Occupancy | Self::Density => Inside::Above,
        }
    }

    /// The value that the surface is at; none where only the samples can tell.
    pub(crate) fn default_iso(self) -> Option<f64> {
        match self {
            Self::SignedDistance => Some(0.0),
            Self::Occupancy => Some(0.5),
            Self::Density => None,
        }
    }
}

/// A dense grid of samples on a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelGrid {
    lattice: Lattice,
    samples: Samples,
    quantity: Quantity,
}

impl VoxelGrid {
    /// A grid of as many samples as the lattice has.
    ///
    /// # Errors
    /// Another number of samples, or bits beyond them that are not 0.
    pub fn try_new(lattice: Lattice, samples: Samples, quantity: Quantity) -> Result<Self, LatticeError> {
        let expected = lattice.samples();
        let found = match &samples {
            Samples::Bits(words) if words.len() as u64 == expected.div_ceil(64) => {
                let beyond =
                    words.last().filter(|_| !expected.is_multiple_of(64)).map_or(0, |last| last >> (expected % 64));
                expected + u64::from(64 - beyond.leading_zeros())
            }
            other => other.room(),
        };
        if found != expected {
            return Err(LatticeError::SampleCount { expected, found });
        }
        Ok(Self { lattice, samples, quantity })
    }

    /// Where the samples are.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// The samples, `i` fastest, then `j`, then `k`.
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// What the samples are.
    pub fn quantity(&self) -> Quantity {
        self.quantity
    }

    /// The same samples, read as something else.
    #[must_use]
    pub fn with_quantity(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }

    /// The sample at lattice coordinates.
    ///
    /// # Panics
    /// When they lie outside of the lattice.
    pub fn sample(&self, coordinates: [u32; 3]) -> f32 {
        let dimensions = self.lattice.dimensions();
        assert!(
            (0..3).all(|axis| coordinates[axis] < dimensions[axis]),
            "{coordinates:?} is outside of {dimensions:?}"
        );
        self.samples.get(self.lattice.index(coordinates))
    }

    /// The smallest box around all samples, full or empty.
    pub fn bounds(&self) -> Aabb {
        self.lattice.bounds()
    }

    /// The image under an affine map. Samples stay as they are: distances are those of the source's space.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        Self { lattice: self.lattice.transformed(map), ..self.clone() }
    }

    /// The memory that the grid takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.samples.memory_bytes()
    }
}

impl Slabs for VoxelGrid {
    fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    fn slab<'a>(&'a self, k: u32, buffer: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
        let len = self.lattice.slab_len();
        let start = self.lattice.index([0, 0, k]) as usize;
        let range = start..start + len;
        buffer.clear();
        match &self.samples {
            Samples::F32(values) => return Ok(&values[range]),
            Samples::U8(values) => buffer.extend(values[range].iter().map(|&value| f32::from(value))),
            Samples::U16(values) => buffer.extend(values[range].iter().map(|&value| f32::from(value))),
            Samples::Bits(_) => buffer.extend(range.map(|at| self.samples.get(at as u64))),
        }
        Ok(buffer)
    }

    fn inside(&self) -> Inside {
        self.quantity.inside()
    }

    fn default_iso(&self) -> Option<f64> {
        self.quantity.default_iso()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;

    fn lattice() -> Lattice {
        Lattice::along_axes([5, 4, 7], DVec3::ZERO, DVec3::ONE).unwrap()
    }

    #[test]
    fn samples_of_any_width_come_in_slabs() {
        let numbers: Vec<u8> = (0..140).map(|i| (i * 37 % 251) as u8).collect();
        let mut words = vec![0u64; 3];
        (0..140).filter(|&i| numbers[i] % 2 == 1).for_each(|i| words[i / 64] |= 1 << (i % 64));
        let each = [
            Samples::Bits(words),
            Samples::U8(numbers.clone()),
            Samples::U16(numbers.iter().map(|&number| u16::from(number) * 256).collect()),
            Samples::F32(numbers.iter().map(|&number| f32::from(number) + 0.5).collect()),
        ];
        let mut buffer = Vec::new();
        for samples in each {
            let grid = VoxelGrid::try_new(lattice(), samples, Quantity::Density).unwrap();
            for k in 0..7 {
                let slab = grid.slab(k, &mut buffer).unwrap().to_vec();
                for (index, &sample) in slab.iter().enumerate() {
                    let [i, j, _] = lattice().coordinates(index as u64);
                    assert_eq!(sample, grid.sample([i, j, k]));
                    let number = numbers[k as usize * 20 + index];
                    let expected = match grid.samples() {
                        Samples::Bits(_) => f32::from(number % 2),
                        Samples::U8(_) => f32::from(number),
                        Samples::U16(_) => f32::from(number) * 256.0,
                        Samples::F32(_) => f32::from(number) + 0.5,
                    };
                    assert_eq!(sample, expected);
                }
            }
        }
    }

    #[test]
    fn other_numbers_of_samples_are_refused() {
        for samples in [Samples::U8(vec![0; 139]), Samples::F32(vec![0.0; 141]), Samples::Bits(vec![0; 2])] {
            assert!(VoxelGrid::try_new(lattice(), samples, Quantity::Density).is_err());
        }
        let mut words = vec![0u64; 3];
        words[2] = 1 << 12;
        assert!(VoxelGrid::try_new(lattice(), Samples::Bits(words), Quantity::Occupancy).is_err());
    }
}
