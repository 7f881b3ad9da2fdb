//! Fields, sampled on a lattice.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{ConvertError, Field};

use crate::{Lattice, Slabs};

/// A field, sampled on a lattice as slabs are asked for.
#[derive(Clone, Copy, Debug)]
pub struct FieldSlabs<'a, F: ?Sized> {
    field: &'a F,
    lattice: Lattice,
}

impl<'a, F: Field + ?Sized> FieldSlabs<'a, F> {
    /// The field on the lattice.
    pub fn new(field: &'a F, lattice: Lattice) -> Self {
        Self { field, lattice }
    }
}

impl<F: Field + ?Sized> Slabs for FieldSlabs<'_, F> {
    fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    fn slab<'a>(&'a self, k: u32, buffer: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
        let [columns, rows, _] = self.lattice.dimensions();
        let along = self.lattice.placement().vector(DVec3::X);
        let step = |part: f64| (0..columns).map(move |i| (f64::from(i) * part) as f32).collect::<Vec<f32>>();
        let [x, y, z] = along.to_array().map(step);
        buffer.clear();
        buffer.resize(self.lattice.slab_len(), 0.0);
        for (j, row) in (0..rows).zip(buffer.chunks_mut(columns as usize)) {
            self.field.values(self.lattice.position([0, j, k]), &x, &y, &z, row);
        }
        Ok(buffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::{Affine, AxisAngle};

    struct Ramp;

    impl Field for Ramp {
        fn value(&self, point: DVec3) -> f64 {
            point.x + 10.0 * point.y + 100.0 * point.z
        }

        fn gradient(&self, _: DVec3) -> DVec3 {
            DVec3::new(1.0, 10.0, 100.0)
        }
    }

    #[test]
    fn samples_are_the_fields_values_at_their_positions() {
        let turn = Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, 3.0), 0.7).unwrap());
        let lattice = Lattice::try_new([3, 4, 2], Affine::from_translation(DVec3::new(1.0, 2.0, 3.0)) * turn).unwrap();
        let slabs = FieldSlabs::new(&Ramp, lattice);
        let mut buffer = Vec::new();
        for k in 0..2 {
            let slab = slabs.slab(k, &mut buffer).unwrap();
            for (index, &sample) in slab.iter().enumerate() {
                let [i, j, _] = lattice.coordinates(index as u64);
                let expected = Ramp.value(lattice.position([i, j, k]));
                assert!((f64::from(sample) - expected).abs() < 1e-4, "{i} {j} {k}: {sample} {expected}");
            }
        }
    }
}
