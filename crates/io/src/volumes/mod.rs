//! What the formats of volumes share: numbers made samples, sizes checked before anything is made, lattices, and the way back.
//!
//! Conventions: the first axis of a file is the fastest, and `i` of the lattice; sample `(i, j, k)` is at the file's origin
//! plus `i`, `j`, `k` times the steps between samples. Directions stay as they are written: whether x is to the left or to
//! the right of a patient is said, not changed. `u8` and `u16` stay; all other numbers become single precision.

mod base64;
mod grid;
mod intake;
mod neighbor;
mod one_grid;
mod payload;
mod scalar;
mod stack;
#[cfg(test)]
mod tests;
mod text;
mod zlib;

pub(crate) use base64::decode_base64;
pub(crate) use grid::{Frame, Room, check_size, check_spacing, grid_shape, quantity_of};
pub(crate) use intake::Intake;
pub(crate) use neighbor::open_beside;
pub(crate) use one_grid::{OneGrid, plain, rounding_words, three};
pub(crate) use payload::{Coding, MOST_FROM_A_BYTE, NO_CHECKSUM, Packing, Payload};
pub(crate) use scalar::Scalar;
pub(crate) use stack::{Plane, read_stack};
pub(crate) use text::{text_samples, text_samples_into};
pub(crate) use zlib::ZlibStream;

/// Numbers with something between.
pub(crate) fn joined(numbers: &[u64], between: &str) -> String {
    numbers.iter().map(u64::to_string).collect::<Vec<_>>().join(between)
}
