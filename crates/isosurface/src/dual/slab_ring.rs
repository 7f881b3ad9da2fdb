//! The few slabs that are looked at together.

use shapeloom_core::ConvertError;

use crate::{LatticeError, Slabs};

/// How many slabs are kept.
pub(super) const KEPT: usize = 4;

/// The last slabs that were asked for. Those that lie in memory anyway are not copied.
#[derive(Default)]
pub(super) struct SlabRing {
    buffers: [Vec<f32>; KEPT],
    buffered: [bool; KEPT],
}

impl SlabRing {
    /// Fetches slab `k` and shows it.
    pub(super) fn fetch<S: Slabs + ?Sized, T>(
        &mut self,
        slabs: &S,
        k: u32,
        look: impl FnOnce(&[f32]) -> T,
    ) -> Result<T, ConvertError> {
        let place = k as usize % KEPT;
        let buffer = &mut self.buffers[place];
        let (seen, at) = {
            let slab = slabs.slab(k, buffer)?;
            let (expected, found) = (slabs.lattice().slab_len() as u64, slab.len() as u64);
            if expected != found {
                return Err(LatticeError::SampleCount { expected, found }.into());
            }
            (look(slab), slab.as_ptr())
        };
        self.buffered[place] = at == buffer.as_ptr();
        Ok(seen)
    }

    /// Slabs that were fetched; those in memory are asked for again, which costs nothing.
    pub(super) fn views<'a, S: Slabs + ?Sized>(
        &'a self,
        slabs: &'a S,
        spare: &'a mut [Vec<f32>; KEPT],
        wanted: [Option<u32>; KEPT],
    ) -> Result<[Option<&'a [f32]>; KEPT], ConvertError> {
        let mut views = [None; KEPT];
        for ((view, spare), k) in views.iter_mut().zip(spare).zip(wanted) {
            let Some(k) = k else { continue };
            let place = k as usize % KEPT;
            *view = Some(if self.buffered[place] { self.buffers[place].as_slice() } else { slabs.slab(k, spare)? });
        }
        Ok(views)
    }
}
