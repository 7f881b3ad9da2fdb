//! A few neighbouring slabs at hand.

use shapeloom_core::ConvertError;

use crate::Slabs;

/// Up to four neighbouring slabs. Those that the source has in memory are not copied.
pub(crate) struct SlabWindow<'a, S: ?Sized> {
    slabs: &'a S,
    buffers: [Vec<f32>; 4],
    held: [Option<u32>; 4],
}

impl<'a, S: Slabs + ?Sized> SlabWindow<'a, S> {
    pub(crate) fn new(slabs: &'a S) -> Self {
        Self { slabs, buffers: Default::default(), held: [None; 4] }
    }

    /// Makes sure that slab `k` is at hand until another one is loaded that is a multiple of four away.
    pub(crate) fn load(&mut self, k: u32) -> Result<(), ConvertError> {
        let at = k as usize % 4;
        if self.held[at] != Some(k) {
            self.held[at] = None;
            let slab = self.slabs.slab(k, &mut self.buffers[at])?;
            assert_eq!(slab.len(), self.slabs.lattice().slab_len(), "a slab has as many samples as the lattice says");
            let (found, len) = (slab.as_ptr(), slab.len());
            if found == self.buffers[at].as_ptr() && len == self.buffers[at].len() {
                self.held[at] = Some(k);
            }
        }
        Ok(())
    }

    /// Slab `k`, which was loaded. `spare` stays empty where the source has its samples in memory.
    pub(crate) fn get<'b>(&'b self, k: u32, spare: &'b mut Vec<f32>) -> Result<&'b [f32], ConvertError> {
        match self.held[k as usize % 4] == Some(k) {
            true => Ok(&self.buffers[k as usize % 4]),
            false => self.slabs.slab(k, spare),
        }
    }
}
