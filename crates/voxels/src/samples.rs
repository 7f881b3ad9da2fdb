//! The numbers of a voxel grid.

/// Samples in the order of a lattice, as wide as they need be.
#[derive(Clone, Debug, PartialEq)]
pub enum Samples {
    /// Bits: sample `i` is bit `i % 64` of word `i / 64`. Bits beyond the samples are 0.
    Bits(Vec<u64>),
    /// Whole numbers from 0 to 255.
    U8(Vec<u8>),
    /// Whole numbers from 0 to 65535.
    U16(Vec<u16>),
    /// Single precision.
    F32(Vec<f32>),
}

impl Samples {
    /// How many samples there are at most: of bits, as many as the words hold.
    pub(crate) fn room(&self) -> u64 {
        match self {
            Self::Bits(words) => words.len() as u64 * 64,
            Self::U8(values) => values.len() as u64,
            Self::U16(values) => values.len() as u64,
            Self::F32(values) => values.len() as u64,
        }
    }

    /// The name of the numbers: `bit`, `u8`, `u16`, `f32`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Bits(_) => "bit",
            Self::U8(_) => "u8",
            Self::U16(_) => "u16",
            Self::F32(_) => "f32",
        }
    }

    /// A sample as a number: bits are 0 and 1.
    ///
    /// # Panics
    /// When there is no such sample.
    pub fn get(&self, index: u64) -> f32 {
        let at = index as usize;
        match self {
            Self::Bits(words) => (words[at / 64] >> (at % 64) & 1) as f32,
            Self::U8(values) => f32::from(values[at]),
            Self::U16(values) => f32::from(values[at]),
            Self::F32(values) => values[at],
        }
    }

    /// The memory that the samples take, in bytes.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Bits(words) => size_of_val(words.as_slice()),
            Self::U8(values) => size_of_val(values.as_slice()),
            Self::U16(values) => size_of_val(values.as_slice()),
            Self::F32(values) => size_of_val(values.as_slice()),
        }
    }
}
