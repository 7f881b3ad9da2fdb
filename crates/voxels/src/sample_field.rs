//! Fields to voxels.

use shapeloom_core::{ConvertError, Converted, Deviation, Exec, Field, Report, parallel};
use shapeloom_isosurface::{FieldSlabs, Lattice, Slabs};

use crate::{Quantity, Samples, VoxelGrid};

/// Samples a field on a lattice: its values, negative inside, in single precision.
///
/// Values are those of [`Field::values`], around the start of each row. The deviation is unknown: what the field does between samples is
/// not looked at. The report says how many values are not finite (`not_finite`); such samples count as outside.
///
/// Memory: 4 bytes a sample. Cost: a value a sample, slabs in parallel; the same bits on any number of threads.
///
/// ```
/// use shapeloom_core::glam::DVec3;
/// use shapeloom_core::{Exec, Field};
/// use shapeloom_isosurface::Lattice;
/// use shapeloom_voxels::sample_field;
///
/// struct Ball;
///
/// impl Field for Ball {
///     fn value(&self, point: DVec3) -> f64 {
///         point.length() - 1.0
///     }
///
///     fn gradient(&self, point: DVec3) -> DVec3 {
///         point.normalize_or_zero()
///     }
/// }
///
/// let lattice = Lattice::along_axes([5; 3], DVec3::splat(-2.0), DVec3::ONE)?;
/// let grid = sample_field(&Ball, lattice, &Exec::default())?.value;
/// assert_eq!(grid.sample([2, 2, 2]), -1.0);
/// assert_eq!(grid.sample([4, 2, 2]), 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Too little memory in the budget, or the reason to stop.
pub fn sample_field<F: Field + ?Sized>(
    field: &F,
    lattice: Lattice,
    exec: &Exec,
) -> Result<Converted<VoxelGrid>, ConvertError> {
    let _memory = exec.reserve_elements(lattice.samples(), size_of::<f32>())?;
    let slabs = FieldSlabs::new(field, lattice);
    let mut values = vec![0f32; lattice.samples() as usize];
    let count = lattice.dimensions()[2];
    parallel::fill_chunks(exec, &mut values, lattice.slab_len(), |first, part| {
        let k = (first / lattice.slab_len()) as u32;
        let _memory = exec.reserve_elements(part.len() as u64, size_of::<f32>())?;
        let mut buffer = Vec::new();
        part.copy_from_slice(slabs.slab(k, &mut buffer)?);
        exec.progress(f64::from(k + 1) / f64::from(count));
        Ok::<_, ConvertError>(())
    })?;
    let mut report = Report::new("sample-field", Deviation::Unknown, "the field is not looked at between samples");
    report.figure("samples", lattice.samples() as f64);
    report.figure("not_finite", values.iter().filter(|value| !value.is_finite()).count() as f64);
    let grid = VoxelGrid::try_new(lattice, Samples::F32(values), Quantity::SignedDistance)?;
    Ok(Converted::new(grid, report))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::glam::DVec3;
    use shapeloom_core::{Affine, AxisAngle, Category};

    /// A torus, whose distance has a closed form.
    struct Ring;

    impl Field for Ring {
        fn value(&self, p: DVec3) -> f64 {
            (p.x.hypot(p.y) - 1.0).hypot(p.z) - 0.3
        }

        fn gradient(&self, _: DVec3) -> DVec3 {
            DVec3::ZERO
        }
    }

    #[test]
    fn samples_are_values_wherever_the_lattice_lies() {
        let turn = Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, 3.0), 0.7).unwrap());
        let placement = Affine::from_translation(DVec3::splat(-0.9)) * turn * Affine::from_scale(DVec3::splat(0.2));
        let lattice = Lattice::try_new([9, 8, 7], placement).unwrap();
        let grid = sample_field(&Ring, lattice, &Exec::default()).unwrap().value;
        for at in 0..lattice.samples() {
            let truth = Ring.value(lattice.position(lattice.coordinates(at)));
            assert!((f64::from(grid.samples().get(at)) - truth).abs() < 1e-6);
        }
        let small = Exec::default().with_memory(100);
        assert_eq!(sample_field(&Ring, lattice, &small).unwrap_err().category(), Category::OverLimit);
    }
}
