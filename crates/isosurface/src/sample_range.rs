//! From where to where samples run.

use shapeloom_core::{ConvertError, Exec};

use crate::Slabs;

/// From where to where samples run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleRange {
    /// The smallest and the largest finite sample; none if there is none.
    pub finite: Option<[f32; 2]>,
    /// How many samples are NaN or infinite.
    pub not_finite: u64,
}

/// From where to where the samples run, and how many are NaN or infinite. Cost: one pass.
///
/// # Errors
/// A slab cannot be had, or the reason to stop.
pub fn sample_range<S: Slabs + ?Sized>(slabs: &S, exec: &Exec) -> Result<SampleRange, ConvertError> {
    let mut buffer = Vec::new();
    let mut range = SampleRange { finite: None, not_finite: 0 };
    for k in 0..slabs.lattice().dimensions()[2] {
        exec.check()?;
        for &sample in slabs.slab(k, &mut buffer)? {
            if sample.is_finite() {
                let [low, high] = range.finite.unwrap_or([sample; 2]);
                range.finite = Some([low.min(sample), high.max(sample)]);
            } else {
                range.not_finite += 1;
            }
        }
    }
    Ok(range)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lattice;
    use shapeloom_core::CancelFlag;
    use shapeloom_core::glam::DVec3;

    struct Given(Lattice, Vec<f32>);

    impl Slabs for Given {
        fn lattice(&self) -> &Lattice {
            &self.0
        }

        fn slab<'a>(&'a self, k: u32, _: &'a mut Vec<f32>) -> Result<&'a [f32], ConvertError> {
            Ok(&self.1[2 * k as usize..][..2])
        }
    }

    #[test]
    fn finite_samples_give_the_range_and_others_are_counted() {
        let of = |samples: &[f32]| {
            let lattice = Lattice::along_axes([2, 1, 2], DVec3::ZERO, DVec3::ONE).unwrap();
            sample_range(&Given(lattice, samples.to_vec()), &Exec::default()).unwrap()
        };
        let (nan, far) = (f32::NAN, f32::INFINITY);
        for (samples, finite, not_finite) in [
            ([3.0, -1.0, 2.0, 7.0], Some([-1.0, 7.0]), 0),
            ([nan, 5.0, -far, far], Some([5.0, 5.0]), 3),
            ([nan, nan, far, -far], None, 4),
        ] {
            assert_eq!(of(&samples), SampleRange { finite, not_finite });
        }
    }

    #[test]
    fn a_caller_who_stops_is_heard() {
        let lattice = Lattice::along_axes([2, 1, 2], DVec3::ZERO, DVec3::ONE).unwrap();
        let flag = CancelFlag::default();
        flag.cancel();
        let exec = Exec::default().with_cancel(&flag);
        assert!(sample_range(&Given(lattice, vec![0.0; 4]), &exec).is_err());
    }
}
