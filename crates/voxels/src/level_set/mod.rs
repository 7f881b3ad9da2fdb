//! Level sets: surfaces as zeros of sampled functions.

mod blend;
mod curvature_flow;
mod march;
mod offset;
mod pieces;
mod redistance;
mod spread;
mod surface;
#[cfg(test)]
mod tests;

pub use blend::{Blend, blend, blend_bands};
pub use curvature_flow::{CurvatureFlow, curvature_flow_band};
pub use offset::OffsetLevelSet;
pub use redistance::{Redistance, redistance_band};

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, ConvertError, Exec};
use shapeloom_isosurface::{Inside, InsideChoice, IsoValue, Lattice, Level, Slabs};

use crate::{Quantity, Samples, VoxelError, VoxelGrid};

/// The samples as distances in single precision: those of a grid of finite distances as they are, any others after
/// redistancing.
fn as_distances(source: &VoxelGrid, exec: &Exec) -> Result<Vec<f32>, ConvertError> {
    let mut values = signed_values(source, exec)?;
    if source.quantity() != Quantity::SignedDistance || values.iter().any(|value| !value.is_finite()) {
        let (level, _) = Level::settle(source, IsoValue::Auto, InsideChoice::Auto, exec)?;
        values = redistance::distances(source, level, f64::INFINITY, exec)?.values;
    }
    Ok(values)
}

/// The samples less the iso value, negative inside.
fn signed_values(source: &VoxelGrid, exec: &Exec) -> Result<Vec<f32>, ConvertError> {
    let (level, _) = Level::settle(source, IsoValue::Auto, InsideChoice::Auto, exec)?;
    let mut values = Vec::with_capacity(source.lattice().samples() as usize);
    let mut buffer = Vec::new();
    for k in 0..source.lattice().dimensions()[2] {
        exec.check()?;
        values.extend(source.slab(k, &mut buffer)?.iter().map(|&sample| match level.inside {
            Inside::Below => sample - level.iso,
            Inside::Above => level.iso - sample,
        }));
    }
    Ok(values)
}

fn distance_grid(lattice: Lattice, values: Vec<f32>) -> Result<VoxelGrid, ConvertError> {
    Ok(VoxelGrid::try_new(lattice, Samples::F32(values), Quantity::SignedDistance)?)
}

/// There must be cells, and distances must be numbers of single precision.
fn check_scale(lattice: &Lattice) -> Result<(), VoxelError> {
    let dimensions = lattice.dimensions();
    if dimensions.contains(&1) {
        return Err(VoxelError::Thin { dimensions });
    }
    let far = lattice.bounds().diagonal() + lattice.cell_diagonal();
    if far > f64::from(f32::MAX) / 4.0 || far.is_nan() {
        return Err(VoxelError::Overflow { what: "a diagonal of the lattice", found: far });
    }
    let near = lattice.spacing().min_element();
    if near < f64::from(f32::MIN_POSITIVE) * 1e8 {
        return Err(VoxelError::Overflow { what: "a spacing", found: near });
    }
    Ok(())
}

/// The position of lattice coordinates but for the translation, which distances do not see and rounding would.
fn place(placement: &Affine, at: [u32; 3]) -> DVec3 {
    placement.linear * DVec3::from(at.map(f64::from))
}
