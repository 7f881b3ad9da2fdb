//! Numbers of a file made samples.

use shapeloom_core::{Findings, Place, Severity, Words};
use shapeloom_voxels::Samples;

use super::Scalar;
use crate::ReadError;
use crate::memory::{Memory, make_room};

/// Samples that arrive piece by piece. What is neither `u8` nor `u16` becomes single precision; what that changes, and
/// what is not finite, is counted.
pub(crate) struct Intake {
    scalar: Scalar,
    samples: Samples,
    taken: u64,
    rounded: Tally,
    largest_error: f64,
    not_finite: Tally,
}

/// How many samples, and which is the first.
#[derive(Default)]
struct Tally {
    count: u64,
    first: u64,
}

impl Tally {
    #[inline]
    fn add(&mut self, index: u64) {
        if self.count == 0 {
            self.first = index;
        }
        self.count += 1;
    }

    fn place(&self) -> Place {
        Place::Element { kind: "sample", index: self.first }
    }
}

impl Intake {
    /// Room for as many samples, which the file was seen to have room for.
    pub(crate) fn with_room(count: u64, scalar: Scalar, memory: &mut Memory<'_>) -> Result<Self, ReadError> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        memory.take(count, scalar.stored_size())?;
        let samples = match scalar {
            Scalar::U8 => Samples::U8(Vec::with_capacity(count)),
            Scalar::U16 => Samples::U16(Vec::with_capacity(count)),
            _ => Samples::F32(Vec::with_capacity(count)),
        };
        Ok(Self {
            scalar,
            samples,
            taken: 0,
            rounded: Tally::default(),
            largest_error: 0.0,
            not_finite: Tally::default(),
        })
    }

    /// Room for more samples.
    pub(crate) fn more(&mut self, count: usize, memory: &mut Memory<'_>) -> Result<(), ReadError> {
        match &mut self.samples {
            Samples::U8(values) => make_room(memory, values, count)?,
            Samples::U16(values) => make_room(memory, values, count)?,
            Samples::F32(values) => make_room(memory, values, count)?,
            Samples::Bits(_) => {}
        }
        Ok(())
    }

    /// How many samples there are so far.
    pub(crate) fn taken(&self) -> u64 {
        self.taken
    }

    /// Whole numbers of the file, one after another.
    pub(crate) fn bytes(&mut self, bytes: &[u8], big: bool) {
        match self.scalar {
            Scalar::U8 => {
                if let Samples::U8(values) = &mut self.samples {
                    values.extend_from_slice(bytes);
                }
                self.taken += bytes.len() as u64;
            }
            Scalar::U16 => {
                let numbers = numbers(bytes, big, u16::from_le_bytes, u16::from_be_bytes);
                if let Samples::U16(values) = &mut self.samples {
                    values.extend(numbers);
                }
                self.taken += (bytes.len() / 2) as u64;
            }
            Scalar::I8 => bytes.iter().for_each(|&byte| self.exact(f32::from(byte as i8))),
            Scalar::I16 => numbers(bytes, big, i16::from_le_bytes, i16::from_be_bytes)
                .for_each(|value| self.exact(f32::from(value))),
            Scalar::I32 => numbers(bytes, big, i32::from_le_bytes, i32::from_be_bytes)
                .for_each(|value| self.wide(value as f32, i128::from(value))),
            Scalar::U32 => numbers(bytes, big, u32::from_le_bytes, u32::from_be_bytes)
                .for_each(|value| self.wide(value as f32, i128::from(value))),
            Scalar::I64 => numbers(bytes, big, i64::from_le_bytes, i64::from_be_bytes)
                .for_each(|value| self.wide(value as f32, i128::from(value))),
            Scalar::U64 => numbers(bytes, big, u64::from_le_bytes, u64::from_be_bytes)
                .for_each(|value| self.wide(value as f32, i128::from(value))),
            Scalar::F32 => {
                numbers(bytes, big, f32::from_le_bytes, f32::from_be_bytes).for_each(|value| self.exact(value))
            }
            Scalar::F64 => {
                numbers(bytes, big, f64::from_le_bytes, f64::from_be_bytes).for_each(|value| self.number(value))
            }
        }
    }

    /// A number from text, which is in the range of the type.
    pub(crate) fn number(&mut self, value: f64) {
        match &mut self.samples {
            Samples::U8(values) => values.push(value as u8),
            Samples::U16(values) => values.push(value as u16),
            _ => {
                let stored = value as f32;
                if stored.is_finite() {
                    self.note_error((value - f64::from(stored)).abs());
                }
                return self.exact(stored);
            }
        }
        self.taken += 1;
    }

    #[inline]
    fn exact(&mut self, value: f32) {
        if !value.is_finite() {
            self.not_finite.add(self.taken);
        }
        if let Samples::F32(values) = &mut self.samples {
            values.push(value);
        }
        self.taken += 1;
    }

    #[inline]
    fn wide(&mut self, stored: f32, value: i128) {
        // Single precision holds every number of 64 bits up to rounding, and 128 bits every rounded one.
        self.note_error((stored as i128 - value).unsigned_abs() as f64);
        self.exact(stored);
    }

    #[inline]
    fn note_error(&mut self, error: f64) {
        if error > 0.0 {
            self.rounded.add(self.taken);
            self.largest_error = self.largest_error.max(error);
        }
    }

    /// The samples, with what there is to say of them.
    pub(crate) fn finish(self, findings: &mut Findings) -> Samples {
        if self.rounded.count > 0 {
            let message = format!(
                "{} of {} samples of type {} were rounded to single precision, by at most {}",
                self.rounded.count,
                self.taken,
                self.scalar.name(),
                Words(self.largest_error)
            );
            let place = self.rounded.place();
            findings.push_many("W-volume-rounded", Severity::Note, place, message, self.rounded.count);
        }
        if self.not_finite.count > 0 {
            let message = format!(
                "{} of {} samples are infinite, no numbers, or beyond single precision; isosurfaces take them as outside",
                self.not_finite.count, self.taken
            );
            let place = self.not_finite.place();
            findings.push_many("W-volume-finite", Severity::Warning, place, message, self.not_finite.count);
        }
        self.samples
    }
}

/// The numbers of some bytes in one of the two orders.
fn numbers<const N: usize, T>(
    bytes: &[u8],
    big: bool,
    little_endian: fn([u8; N]) -> T,
    big_endian: fn([u8; N]) -> T,
) -> impl Iterator<Item = T> + '_
where
    T: 'static,
{
    let read = if big { big_endian } else { little_endian };
    bytes.as_chunks::<N>().0.iter().map(move |one| read(*one))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Exec;

    fn taken(scalar: Scalar, big: bool, bytes: &[u8]) -> (Samples, Findings) {
        let exec = Exec::default();
        let mut memory = Memory::new(&exec);
        let mut intake = Intake::with_room(8, scalar, &mut memory).unwrap();
        intake.bytes(bytes, big);
        assert_eq!(intake.taken(), (bytes.len() / scalar.size()) as u64);
        let mut findings = Findings::default();
        (intake.finish(&mut findings), findings)
    }

    #[test]
    fn every_type_is_read_in_both_orders() {
        let cases: [(Scalar, Vec<u8>, Samples); 7] = [
            (Scalar::U8, vec![0, 255], Samples::U8(vec![0, 255])),
            (Scalar::I8, vec![127, 128], Samples::F32(vec![127.0, -128.0])),
            (Scalar::U16, 65534u16.to_be_bytes().to_vec(), Samples::U16(vec![65534])),
            (Scalar::I16, (-2i16).to_be_bytes().to_vec(), Samples::F32(vec![-2.0])),
            (Scalar::I32, (-70_000i32).to_be_bytes().to_vec(), Samples::F32(vec![-70_000.0])),
            (Scalar::F32, 1.5f32.to_be_bytes().to_vec(), Samples::F32(vec![1.5])),
            (Scalar::F64, 0.25f64.to_be_bytes().to_vec(), Samples::F32(vec![0.25])),
        ];
        for (scalar, mut bytes, wanted) in cases {
            assert_eq!(taken(scalar, true, &bytes).0, wanted, "{scalar:?}");
            if scalar.size() > 1 {
                bytes.reverse();
            }
            let (samples, findings) = taken(scalar, false, &bytes);
            assert!(samples == wanted && findings.is_empty(), "{scalar:?}: {findings:?}");
        }
    }

    /// Errors of rounding by hand: single precision has 24 bits.
    #[test]
    fn rounding_is_told_with_its_largest_error() {
        let one = |scalar, bytes: &[u8]| {
            let (_, findings) = taken(scalar, false, bytes);
            let finding = findings.iter().next().unwrap().clone();
            assert_eq!((finding.code, finding.count), ("W-volume-rounded", 1));
            finding.message
        };
        let wide = |numbers: &[i32]| numbers.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>();
        assert!(one(Scalar::I32, &wide(&[1 << 24, (1 << 24) + 1])).ends_with("at most 1"));
        assert!(one(Scalar::I32, &wide(&[7, -(1 << 30) + 33])).ends_with("at most 31"));
        let last = u64::MAX.to_le_bytes();
        assert!(one(Scalar::U64, &last).ends_with("at most 1"));
        let (samples, findings) = taken(Scalar::F64, false, &1e300f64.to_le_bytes());
        assert_eq!(
            (samples, findings.iter().next().unwrap().code),
            (Samples::F32(vec![f32::INFINITY]), "W-volume-finite")
        );
    }
}
