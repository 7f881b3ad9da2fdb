//! Numbers laid down in a file.

use crate::text::{push_integer, push_number, push_single};

/// A number that properties have.
pub(super) trait Written: Copy {
    fn little(self, out: &mut Vec<u8>);
    fn big(self, out: &mut Vec<u8>);
    fn text(self, out: &mut Vec<u8>);
}

macro_rules! written {
    ($($type:ty: $text:expr),*) => {
        $(impl Written for $type {
            #[inline]
            fn little(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_le_bytes());
            }

            #[inline]
            fn big(self, out: &mut Vec<u8>) {
                out.extend_from_slice(&self.to_be_bytes());
            }

            #[inline]
            fn text(self, out: &mut Vec<u8>) {
                let text: fn(Self, &mut Vec<u8>) = $text;
                text(self, out);
            }
        })*
    };
}

written!(
    i8: |value, out| push_integer(out, i64::from(value)),
    u8: |value, out| push_integer(out, i64::from(value)),
    i16: |value, out| push_integer(out, i64::from(value)),
    u16: |value, out| push_integer(out, i64::from(value)),
    i32: |value, out| push_integer(out, i64::from(value)),
    u32: |value, out| push_integer(out, i64::from(value)),
    f32: |value, out| push_single(out, value),
    f64: |value, out| push_number(out, value)
);

/// How numbers are laid down.
pub(super) trait Laid {
    /// The word of the header.
    const NAME: &'static str;

    fn put(value: impl Written, out: &mut Vec<u8>);

    /// Ends a row.
    fn end_row(_: &mut Vec<u8>) {}
}

pub(super) struct Little;
pub(super) struct Big;
pub(super) struct Ascii;

impl Laid for Little {
    const NAME: &'static str = "binary_little_endian";

    #[inline]
    fn put(value: impl Written, out: &mut Vec<u8>) {
        value.little(out);
    }
}

impl Laid for Big {
    const NAME: &'static str = "binary_big_endian";

    #[inline]
    fn put(value: impl Written, out: &mut Vec<u8>) {
        value.big(out);
    }
}

impl Laid for Ascii {
    const NAME: &'static str = "ascii";

    #[inline]
    fn put(value: impl Written, out: &mut Vec<u8>) {
        value.text(out);
        out.push(b' ');
    }

    #[inline]
    fn end_row(out: &mut Vec<u8>) {
        // A row of nothing takes no line.
        if let Some(last) = out.last_mut().filter(|last| **last == b' ') {
            *last = b'\n';
        }
    }
}
