//! Text or binary.

use shapeloom_core::Place;

use super::{FACET, HEADER, ascii, binary};
use crate::text::{plain_text, quoted};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// Many binary files begin with the word that text begins with, so the length decides first: no text is as long as the
/// bytes of its 81st to 84th character say, which would be gigabytes.
pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    if binary::length_fits(input) {
        return binary::read(input, context);
    }
    if ascii::begins(input) {
        return ascii::read(input, context);
    }
    if input.starts_with(b"\xff\xfe") || input.starts_with(b"\xfe\xff") {
        plain_text(input, &context.limits)?;
    }
    if input.len() < HEADER {
        let found = match input.len() {
            0 => "an empty file".to_owned(),
            bytes => format!("{bytes} bytes, which begin with {}", quoted(&input[..bytes.min(12)])),
        };
        let expected = format!("the word solid, or at least {HEADER} bytes and {FACET} for each facet");
        return Err(Fault::new("E-stl-truncated", Place::Byte(input.len() as u64), found, expected).into());
    }
    binary::read(input, context)
}
