//! Which cells are full, a bit each.

use shapeloom_core::{ConvertError, Exec};
use shapeloom_isosurface::{Level, Slabs};

/// Which cells of a lattice are full, a bit each in the order of the lattice. Cells outside of it are empty.
pub(crate) struct FullCells {
    dimensions: [u32; 3],
    words: Vec<u64>,
    /// How many samples are NaN or infinite.
    pub not_finite: u64,
}

impl FullCells {
    /// The bytes that the bits of a lattice take.
    pub fn bytes(samples: u64) -> u64 {
        samples.div_ceil(64) * 8
    }

    /// The cells whose samples are inside. The caller has reserved the [`bytes`](Self::bytes).
    ///
    /// # Errors
    /// A slab cannot be had, or the reason to stop.
    pub fn of<S: Slabs + ?Sized>(slabs: &S, level: Level, exec: &Exec) -> Result<Self, ConvertError> {
        let lattice = slabs.lattice();
        let mut words = vec![0u64; lattice.samples().div_ceil(64) as usize];
        let (mut buffer, mut at, mut not_finite) = (Vec::new(), 0usize, 0u64);
        for k in 0..lattice.dimensions()[2] {
            exec.check()?;
            for &sample in slabs.slab(k, &mut buffer)? {
                if let Some(word) = words.get_mut(at / 64) {
                    *word |= u64::from(level.holds(sample)) << (at % 64);
                }
                not_finite += u64::from(!sample.is_finite());
                at += 1;
            }
        }
        Ok(Self { dimensions: lattice.dimensions(), words, not_finite })
    }

    /// Whether a cell is full; empty outside of the lattice. Coordinates may be -1.
    pub fn is_full(&self, [i, j, k]: [i64; 3]) -> bool {
        let [x, y, z] = self.dimensions.map(i64::from);
        let within = (0..x).contains(&i) && (0..y).contains(&j) && (0..z).contains(&k);
        within && {
            let at = ((k * y + j) * x + i) as usize;
            self.words[at / 64] >> (at % 64) & 1 == 1
        }
    }
}
