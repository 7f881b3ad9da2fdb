//! The numbers of volume files.

/// A type of number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The bytes of one.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The bytes of one as a sample: what is neither `u8` nor `u16` becomes `f32`.
    pub(crate) fn stored_size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::U16 => 2,
            _ => 4,
        }
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::I64 => "i64",
            Self::U64 => "u64",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    /// From where to where whole numbers of the type go; none for floating ones.
    pub(crate) fn range(self) -> Option<(f64, f64)> {
        let bits = 8 * self.size() as i32;
        match self {
            Self::F32 | Self::F64 => None,
            Self::U8 | Self::U16 | Self::U32 | Self::U64 => Some((0.0, 2f64.powi(bits) - 1.0)),
            Self::I8 | Self::I16 | Self::I32 | Self::I64 => Some((-(2f64.powi(bits - 1)), 2f64.powi(bits - 1) - 1.0)),
        }
    }
}
