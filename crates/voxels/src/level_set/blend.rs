//! Two level sets made one.

use shapeloom_core::{ConvertError, Exec};

use super::{distance_grid, signed_values};
use crate::sparse_bricks::{BRICK, Filled};
use crate::{Quantity, SparseBricks, VoxelError, VoxelGrid};

/// How two level sets become one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Blend {
    /// Inside either: the smaller value. Outside the result it is the distance if both were; inside a bound.
    Union,
    /// Inside both: the larger value. Inside the result it is the distance if both were; outside a bound.
    Intersection,
    /// Inside the first and not the second: the larger of the first and the second negated.
    Difference,
    /// Inside either, with a fillet: the quadratic polynomial minimum, which is smaller than the plain one by at most a
    /// quarter of the radius, where the values differ by less than the radius. The surface is smooth where the two
    /// meet.
    SmoothUnion {
        /// The values' difference up to which they blend, in model units; above 0.
        radius: f32,
    },
    /// Between the two, linear in the values: the first at 0, the second at 1. Where both are distances the surface
    /// moves from one to the other; topology may change on the way, and parts that do not overlap fade instead of
    /// moving.
    Morph {
        /// How far, from 0 to 1.
        fraction: f32,
    },
}

impl Blend {
    /// One value of two.
    pub fn value(self, a: f32, b: f32) -> f32 {
        match self {
            Self::Union => a.min(b),
            Self::Intersection => a.max(b),
            Self::Difference => a.max(-b),
            Self::SmoothUnion { radius } => {
                let overlap = ((radius - (a - b).abs()) / radius).max(0.0);
                a.min(b) - overlap * overlap * radius * 0.25
            }
            Self::Morph { fraction } => a * (1.0 - fraction) + b * fraction,
        }
    }

    fn check(self) -> Result<(), VoxelError> {
        match self {
            Self::SmoothUnion { radius } if !(radius > 0.0 && radius.is_finite()) => {
                Err(VoxelError::Overflow { what: "a blending radius", found: f64::from(radius) })
            }
            Self::Morph { fraction } if !(0.0..=1.0).contains(&fraction) => {
                Err(VoxelError::Overflow { what: "a fraction outside of 0 to 1", found: f64::from(fraction) })
            }
            _ => Ok(()),
        }
    }
}

/// Two grids on one lattice, sample by sample. Samples of another quantity than signed distances count from their iso
/// value, negative inside. The signs are those of the sets exactly (but for smooth union and morphing, which have sets
/// of their own).
///
/// # Errors
/// Grids on different lattices, a radius that is not positive, a fraction outside of 0 to 1, too little memory, or the
/// reason to stop.
pub fn blend(a: &VoxelGrid, b: &VoxelGrid, how: Blend, exec: &Exec) -> Result<VoxelGrid, ConvertError> {
    exec.check()?;
    how.check()?;
    let lattice = *a.lattice();
    if lattice != *b.lattice() {
        return Err(VoxelError::Lattices(Box::new([lattice, *b.lattice()])).into());
    }
    let _memory = exec.reserve_elements(lattice.samples(), 2 * size_of::<f32>())?;
    let mut values = signed_values(a, exec)?;
    let others = signed_values(b, exec)?;
    for (part, others) in values.chunks_mut(4096).zip(others.chunks(4096)) {
        exec.check()?;
        part.iter_mut().zip(others).for_each(|(value, &other)| *value = how.value(*value, other));
    }
    distance_grid(lattice, values)
}

/// Two narrow bands on one lattice, sample by sample; a sample is active where it is less than the background, the half
/// width, which is the smaller one's of the two. [`redistance_band`](super::redistance_band) makes distances of the
/// values again.
///
/// # Errors
/// As [`blend`], and bricks whose background is not positive: they are no bands.
pub fn blend_bands(a: &SparseBricks, b: &SparseBricks, how: Blend, exec: &Exec) -> Result<SparseBricks, ConvertError> {
    exec.check()?;
    how.check()?;
    let lattice = *a.lattice();
    if lattice != *b.lattice() {
        return Err(VoxelError::Lattices(Box::new([lattice, *b.lattice()])).into());
    }
    let half_width = a.background().min(b.background());
    if half_width.is_nan() || half_width <= 0.0 {
        return Err(VoxelError::Overflow { what: "a half width", found: f64::from(half_width) }.into());
    }
    let mut result = SparseBricks::try_new(lattice, half_width, Quantity::SignedDistance)?;
    // Of what is in no brick of either all samples are outside of both, unless the second is turned over.
    let mut keys: Vec<u64> = a.keys().iter().chain(b.keys()).copied().collect();
    keys.sort_unstable();
    keys.dedup();
    let _memory = exec.reserve_elements(keys.len() as u64, 2 * SparseBricks::BRICK_BYTES)?;
    for key in keys {
        exec.check()?;
        let (a, b) = (a.filled(key), b.filled(key));
        let mut filled = Filled { key, values: [half_width; BRICK], mask: [0; 8] };
        for at in 0..BRICK {
            let value = how.value(a.values[at], b.values[at]).clamp(-half_width, half_width);
            filled.values[at] = value;
            filled.mask[at / 64] |= u64::from(value.abs() < half_width) << (at % 64);
        }
        result.push(filled);
    }
    Ok(result)
}
