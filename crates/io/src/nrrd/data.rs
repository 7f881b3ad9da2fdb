//! How samples are written, and samples out of one file after another.

use shapeloom_core::{Findings, Place};
use shapeloom_voxels::Samples;

use super::fields::{Field, Fields};
use super::files::DataFiles;
use crate::memory::Memory;
use crate::text::{Scanner, parse_count, quoted};
use crate::volumes::{
    Coding, Intake, MOST_FROM_A_BYTE, Packing, Payload, Room, Scalar, open_beside, text_samples_into,
};
use crate::{Fault, ReadContext, ReadError};

/// How samples are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Raw,
    Gzip,
    Text,
}

/// What the header says of every file of samples.
pub(super) struct Data {
    pub(super) encoding: Encoding,
    pub(super) scalar: Scalar,
    pub(super) big: bool,
    lines: u64,
    /// How many bytes are passed over; none for all but the last ones.
    bytes: Option<u64>,
}

impl Data {
    pub(super) fn new(encoding: Encoding, scalar: Scalar, big: bool, fields: &Fields<'_>) -> Result<Self, Box<Fault>> {
        let lines = skip(fields, "line skip")?.ok_or_else(|| negative(fields, "line skip"))?;
        let bytes = skip(fields, "byte skip")?;
        if bytes.is_none() && encoding != Encoding::Raw {
            return Err(negative(fields, "byte skip"));
        }
        Ok(Self { encoding, scalar, big, lines, bytes })
    }

    /// A file of so many samples.
    fn open(
        &self,
        name: &str,
        count: u64,
        field: &Field<'_>,
        context: &ReadContext,
        memory: &mut Memory<'_>,
    ) -> Result<Payload<'static>, ReadError> {
        // Of packed samples, of lines and of what comes before the last ones nothing is known.
        let exact = self.encoding == Encoding::Raw && self.lines == 0;
        let unpacked = count.saturating_mul(self.scalar.size() as u64);
        let wanted = self.bytes.filter(|_| exact).map_or(u64::MAX, |bytes| unpacked.saturating_add(bytes));
        open_beside(name, wanted, field.place(), "data file", context, memory)
    }

    /// Passes over lines; returns how many bytes are to be passed over, and what a size is checked against.
    pub(super) fn room(
        &self,
        payload: &mut Payload<'_>,
        count: u64,
        context: &ReadContext,
    ) -> Result<(u64, Room), ReadError> {
        payload.skip_lines(self.lines, context)?;
        let unpacked = count.saturating_mul(self.scalar.size() as u64);
        // The last bytes of the file.
        let skip = self.bytes.unwrap_or_else(|| payload.len().saturating_sub(unpacked));
        let (bytes, most_from_a_byte, size) = match self.encoding {
            Encoding::Raw => (payload.len().saturating_sub(skip), 1, self.scalar.size()),
            Encoding::Gzip => (payload.len(), MOST_FROM_A_BYTE, self.scalar.size()),
            // A digit and a blank each, but for the last.
            Encoding::Text => (payload.len() + 1, 1, 2),
        };
        let stored_size = self.scalar.stored_size() as u64;
        Ok((skip, Room { bytes, most_from_a_byte, size: size as u64, stored_size }))
    }

    /// As many samples more.
    pub(super) fn samples(
        &self,
        payload: &Payload<'_>,
        intake: &mut Intake,
        (count, skip): (u64, u64),
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<(), ReadError> {
        let packing = match self.encoding {
            Encoding::Text => {
                let text = &payload.bytes[..];
                let mut scan = Scanner::new(text, usize::try_from(skip).unwrap_or(usize::MAX));
                let all = intake.taken() + count;
                return text_samples_into(intake, &mut scan, text, all, self.scalar, context)
                    .map_err(|error| payload.moved(error));
            }
            Encoding::Gzip => Packing::Gzip,
            Encoding::Raw => Packing::Plain,
        };
        let coding = Coding { packing, scalar: self.scalar, big: self.big, skip };
        payload.samples_into(intake, count, &coding, context, memory, findings)
    }

    /// The one file of samples.
    pub(super) fn open_one(
        &self,
        files: &DataFiles<'_>,
        count: u64,
        field: &Field<'_>,
        context: &ReadContext,
        memory: &mut Memory<'_>,
    ) -> Result<Payload<'static>, ReadError> {
        self.open(&files.name(0), count, field, context, memory)
    }

    /// The samples of several files, one after another, each held by itself. `check` looks at the size when the first one is there;
    /// room is taken as files turn out to hold what they should.
    pub(super) fn samples_of_files(
        &self,
        (field, files): (&Field<'_>, &DataFiles<'_>),
        count: u64,
        check: impl Fn(&Room, &Payload<'_>) -> Result<(), Box<Fault>>,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Samples, ReadError> {
        let each = count / files.count().max(1);
        let mut intake = Intake::with_room(0, self.scalar, memory)?;
        for index in 0..files.count() {
            let name = files.name(index);
            let mut held = Memory::new(&context.exec);
            let mut payload = self.open(&name, each, field, context, &mut held)?;
            let (skip, room) = self.room(&mut payload, each, context)?;
            let most = u128::from(room.bytes) * u128::from(room.most_from_a_byte) / u128::from(room.size.max(1));
            if u128::from(each) > most {
                let found = format!("{} bytes", room.bytes);
                let expected = format!("{each} samples of type {}", self.scalar.name());
                return Err(Fault::new("E-volume-truncated", Place::Whole, found, expected).within(name).into());
            }
            if index == 0 {
                check(&Room { bytes: room.bytes.saturating_mul(files.count()), ..room }, &payload)?;
            }
            intake.more(usize::try_from(each).unwrap_or(usize::MAX), memory)?;
            self.samples(&payload, &mut intake, (each, skip), context, &mut held, findings)?;
        }
        Ok(intake.finish(findings))
    }
}

/// How many lines or bytes are passed over; none for -1.
fn skip(fields: &Fields<'_>, name: &str) -> Result<Option<u64>, Box<Fault>> {
    let Some(field) = fields.find(name) else { return Ok(Some(0)) };
    if field.value == b"-1" {
        return Ok(None);
    }
    let wrong = |_| field.fault("E-nrrd-count", quoted(field.value), "a whole number in digits alone");
    parse_count(field.value).map(Some).map_err(wrong)
}

fn negative(fields: &Fields<'_>, name: &str) -> Box<Fault> {
    let place = fields.find(name).map_or(Place::Whole, |field| field.place());
    Fault::new("E-nrrd-count", place, "\"-1\"", "a number from 0: only raw samples may be the last bytes").within(name)
}
