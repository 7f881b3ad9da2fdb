//! The types of properties.

use shapeloom_mesh::Values;

/// The type of a property.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Char,
    Uchar,
    Short,
    Ushort,
    Int,
    Uint,
    Float,
    Double,
}

impl Type {
    /// The customary name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Char => "char",
            Self::Uchar => "uchar",
            Self::Short => "short",
            Self::Ushort => "ushort",
            Self::Int => "int",
            Self::Uint => "uint",
            Self::Float => "float",
            Self::Double => "double",
        }
    }

    /// The type of either of its two names.
    pub fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::Char,
            b"uchar" | b"uint8" => Self::Uchar,
            b"short" | b"int16" => Self::Short,
            b"ushort" | b"uint16" => Self::Ushort,
            b"int" | b"int32" => Self::Int,
            b"uint" | b"uint32" => Self::Uint,
            b"float" | b"float32" => Self::Float,
            b"double" | b"float64" => Self::Double,
            _ => return None,
        })
    }

    /// The bytes that a number takes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::Char | Self::Uchar => 1,
            Self::Short | Self::Ushort => 2,
            Self::Int | Self::Uint | Self::Float => 4,
            Self::Double => 8,
        }
    }

    pub fn is_floating(self) -> bool {
        matches!(self, Self::Float | Self::Double)
    }

    /// The smallest and the largest whole number of this type; none for floating types.
    pub fn bounds(self) -> Option<(i64, i64)> {
        Some(match self {
            Self::Char => (i64::from(i8::MIN), i64::from(i8::MAX)),
            Self::Uchar => (0, i64::from(u8::MAX)),
            Self::Short => (i64::from(i16::MIN), i64::from(i16::MAX)),
            Self::Ushort => (0, i64::from(u16::MAX)),
            Self::Int => (i64::from(i32::MIN), i64::from(i32::MAX)),
            Self::Uint => (0, i64::from(u32::MAX)),
            Self::Float | Self::Double => return None,
        })
    }

    /// The type in which values of a column are stored; none for text.
    pub fn of_values(values: &Values) -> Option<Self> {
        Some(match values {
            Values::F32(_) => Self::Float,
            Values::F64(_) => Self::Double,
            Values::I8(_) => Self::Char,
            Values::U8(_) => Self::Uchar,
            Values::I16(_) => Self::Short,
            Values::U16(_) => Self::Ushort,
            Values::I32(_) => Self::Int,
            Values::U32(_) => Self::Uint,
            Values::Text { .. } => return None,
        })
    }

    /// An empty vector of values of this type with room for `count`, whose memory the caller has reserved.
    pub fn with_room(self, count: usize) -> Values {
        match self {
            Self::Char => Values::I8(Vec::with_capacity(count)),
            Self::Uchar => Values::U8(Vec::with_capacity(count)),
            Self::Short => Values::I16(Vec::with_capacity(count)),
            Self::Ushort => Values::U16(Vec::with_capacity(count)),
            Self::Int => Values::I32(Vec::with_capacity(count)),
            Self::Uint => Values::U32(Vec::with_capacity(count)),
            Self::Float => Values::F32(Vec::with_capacity(count)),
            Self::Double => Values::F64(Vec::with_capacity(count)),
        }
    }

    /// The narrowest floating type that holds all numbers.
    pub fn of_floats(numbers: impl IntoIterator<Item = f64>) -> Self {
        let exact = |number: f64| number.is_nan() || f64::from(number as f32) == number;
        if numbers.into_iter().all(exact) { Self::Float } else { Self::Double }
    }
}

/// What is not the index of any vertex: a negative number, a fraction, a number too large. Vertices are fewer.
pub(super) const NO_INDEX: u32 = u32::MAX;

/// A number as a property stores it.
pub(super) trait Number: Copy + Default {
    /// The number at the start of these bytes; zero where there are too few, which the caller has excluded.
    fn decode<const BIG: bool>(bytes: &[u8]) -> Self;

    /// The number as an index, [`NO_INDEX`] where it is none.
    fn index(self) -> u32;

    fn to_f64(self) -> f64;
}

macro_rules! numbers {
    ($($type:ty: $index:expr),*) => {
        $(impl Number for $type {
            #[inline(always)]
            fn decode<const BIG: bool>(bytes: &[u8]) -> Self {
                match bytes.first_chunk() {
                    Some(bytes) if BIG => Self::from_be_bytes(*bytes),
                    Some(bytes) => Self::from_le_bytes(*bytes),
                    None => Self::default(),
                }
            }

            #[inline(always)]
            fn index(self) -> u32 {
                let index: fn(Self) -> u32 = $index;
                index(self)
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
        })*
    };
}

/// A number as an index, [`NO_INDEX`] where it is none.
pub(super) fn float_index(number: f64) -> u32 {
    if number >= 0.0 && number < f64::from(NO_INDEX) && number.fract() == 0.0 { number as u32 } else { NO_INDEX }
}

numbers!(
    i8: |number| u32::try_from(number).unwrap_or(NO_INDEX),
    u8: u32::from,
    i16: |number| u32::try_from(number).unwrap_or(NO_INDEX),
    u16: u32::from,
    // All bits set where it is negative, without a branch.
    i32: |number| (number | (number >> 31)) as u32,
    u32: |number| number,
    f32: |number| float_index(f64::from(number)),
    f64: float_index
);

/// Runs the same expression with a type name standing for the type of a property.
macro_rules! with_type {
    ($kind:expr, $number:ident => $body:expr) => {
        match $kind {
            $crate::ply::types::Type::Char => {
                type $number = i8;
                $body
            }
            $crate::ply::types::Type::Uchar => {
                type $number = u8;
                $body
            }
            $crate::ply::types::Type::Short => {
                type $number = i16;
                $body
            }
            $crate::ply::types::Type::Ushort => {
                type $number = u16;
                $body
            }
            $crate::ply::types::Type::Int => {
                type $number = i32;
                $body
            }
            $crate::ply::types::Type::Uint => {
                type $number = u32;
                $body
            }
            $crate::ply::types::Type::Float => {
                type $number = f32;
                $body
            }
            $crate::ply::types::Type::Double => {
                type $number = f64;
                $body
            }
        }
    };
}

/// Runs the same expression on the vector of numbers inside a `Values`; text, which no property has, gives the other.
macro_rules! with_values {
    ($values:expr, $vector:ident => $body:expr, $text:expr) => {
        match $values {
            Values::F32($vector) => $body,
            Values::F64($vector) => $body,
            Values::I8($vector) => $body,
            Values::U8($vector) => $body,
            Values::I16($vector) => $body,
            Values::U16($vector) => $body,
            Values::I32($vector) => $body,
            Values::U32($vector) => $body,
            Values::Text { .. } => $text,
        }
    };
}

pub(super) use {with_type, with_values};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_have_two_names_and_the_sizes_of_their_numbers() {
        let pairs = [
            ("char", "int8"),
            ("uchar", "uint8"),
            ("short", "int16"),
            ("ushort", "uint16"),
            ("int", "int32"),
            ("uint", "uint32"),
            ("float", "float32"),
            ("double", "float64"),
        ];
        for (short, long) in pairs {
            let kind = Type::from_name(short.as_bytes()).unwrap();
            assert_eq!((kind.name(), Type::from_name(long.as_bytes())), (short, Some(kind)));
            assert_eq!(with_type!(kind, N => size_of::<N>()), kind.size());
            assert_eq!(Type::of_values(&kind.with_room(3)), Some(kind));
            let bits = long.trim_start_matches(|c: char| c.is_alphabetic());
            assert_eq!(bits.parse(), Ok(8 * kind.size()));
        }
        assert_eq!(Type::from_name(b"int64"), None);
    }

    #[test]
    fn numbers_are_decoded_in_both_orders() {
        let bytes = [0xff, 0xfe, 0, 1, 2, 3, 4, 5, 6];
        assert_eq!(i16::decode::<true>(&bytes), -2);
        assert_eq!(i16::decode::<false>(&bytes), -257);
        assert_eq!(u32::decode::<true>(&bytes[2..]), 0x0001_0203);
        assert_eq!(f64::decode::<true>(&1.5f64.to_be_bytes()), 1.5);
        assert_eq!(u32::decode::<false>(&bytes[7..]), 0);
    }

    #[test]
    fn what_is_no_index_is_told() {
        assert_eq!([(-1i32).index(), i32::MIN.index(), (-2i32).index()], [NO_INDEX; 3]);
        assert_eq!([7i32.index(), i32::MAX.index()], [7, i32::MAX as u32]);
        assert_eq!([(-1i8).index(), (-1i16).index(), 1.5f32.index(), f64::NAN.index(), 1e10f64.index()], [NO_INDEX; 5]);
        assert_eq!([255u8.index(), 3.0f64.index(), 0xffff_fff0u32.index()], [255, 3, 0xffff_fff0]);
    }
}
