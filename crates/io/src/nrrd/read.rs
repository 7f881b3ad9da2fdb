//! Reading NRRD.

use std::cell::Cell;

use shapeloom_core::{Category, Findings, Place};
use shapeloom_voxels::isosurface::Lattice;

use super::data::{Data, Encoding};
use super::fields::Fields;
use super::files::DataFiles;
use super::frame::{Axes, units};
use crate::memory::Memory;
use crate::text::{end_place, in_lines, line_place, quoted};
use crate::volumes::{Intake, Payload, Room, Scalar, grid_shape, quantity_of};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let fields = Fields::read(input, context, &mut memory, &mut findings);
    let header = fields.as_ref().map_or(input.len(), |fields| fields.data.unwrap_or(input.len()));
    let found = fields.and_then(|fields| volume(input, &fields, context, &mut memory, &mut findings));
    // Offsets within the header are lines, those within the samples stay.
    let in_header = |place: &Place| matches!(place, Place::Byte(at) if *at < header as u64);
    let read = found.map_err(|error| match error {
        ReadError::Input(fault) if in_header(&fault.place) => ReadError::Input(in_lines(input, fault)),
        other => other,
    })?;
    findings.extend(read.findings);
    let findings = findings.with_places(|place| if in_header(&place) { line_place(input, place) } else { place });
    Ok(ReadShape { findings, ..read })
}

fn scalar_of(word: &[u8]) -> Option<Scalar> {
    let word = word.to_ascii_lowercase();
    let words = [
        (Scalar::I8, &["signed char", "int8", "int8_t"][..]),
        (Scalar::U8, &["uchar", "unsigned char", "uint8", "uint8_t"]),
        (Scalar::I16, &["short", "short int", "signed short", "signed short int", "int16", "int16_t"]),
        (Scalar::U16, &["ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"]),
        (Scalar::I32, &["int", "signed int", "int32", "int32_t"]),
        (Scalar::U32, &["uint", "unsigned int", "uint32", "uint32_t"]),
        (
            Scalar::I64,
            &["longlong", "long long", "long long int", "signed long long", "signed long long int", "int64", "int64_t"],
        ),
        (Scalar::U64, &["ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"]),
        (Scalar::F32, &["float"]),
        (Scalar::F64, &["double"]),
    ];
    let same = |known: &&str| known.as_bytes() == word;
    words.into_iter().find(|(_, known)| known.iter().any(same)).map(|(scalar, _)| scalar)
}

fn volume(
    input: &[u8],
    fields: &Fields<'_>,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let axes = Axes::read(fields)?;
    let field = fields.require("type")?;
    let scalar = scalar_of(field.value).ok_or_else(|| {
        let fault = field.fault("E-nrrd-type", quoted(field.value), "a type of numbers: int8 to uint64, float, double");
        if field.value == b"block" { fault.category(Category::Unsupported) } else { fault }
    })?;
    let field = fields.require("encoding")?;
    let encoding = match field.value.to_ascii_lowercase().as_slice() {
        b"raw" => Encoding::Raw,
        b"gz" | b"gzip" => Encoding::Gzip,
        b"txt" | b"text" | b"ascii" => Encoding::Text,
        _ => {
            let fault = field.fault("E-nrrd-feature", quoted(field.value), "the encoding raw, gzip or ascii");
            return Err(fault.category(Category::Unsupported).into());
        }
    };
    let big = match fields.find("endian").map(|field| (field, field.value.to_ascii_lowercase())) {
        Some((_, value)) if value == b"little" => false,
        Some((_, value)) if value == b"big" => true,
        Some((field, _)) => {
            return Err(field.fault("E-nrrd-header", quoted(field.value), "little or big").into());
        }
        None if scalar.size() == 1 || encoding == Encoding::Text => false,
        None => {
            fields.require("endian").map_err(|fault| {
                fault.advice("put a line \"endian: little\" or \"endian: big\" into the header, as the samples are")
            })?;
            false
        }
    };
    let frame = axes.frame(fields)?;
    let data = Data::new(encoding, scalar, big, fields)?;
    let sizes = fields.require("sizes")?;
    let count = axes.sizes.iter().fold(1u64, |product, size| product.saturating_mul(*size));
    let lattice = |room: &Room, payload: &Payload<'_>| -> Result<Lattice, Box<Fault>> {
        let dimensions = room.check(axes.sizes, sizes.place(), "sizes", payload, context)?;
        frame.lattice(dimensions, frame_place(fields))
    };
    let files = match fields.find("data file") {
        Some(field) => Some((field, DataFiles::read(field, fields, &axes)?)),
        None => None,
    };
    let (lattice, samples) = match &files {
        Some((field, files)) if files.are_several() => {
            let found = Cell::new(None);
            let check = |room: &Room, payload: &Payload<'_>| {
                found.set(Some(lattice(room, payload)?));
                Ok(())
            };
            let samples = data.samples_of_files((field, files), count, check, context, memory, findings)?;
            let lattice = found.get().ok_or_else(|| field.fault("E-nrrd-count", "no file", "one at least"))?;
            (lattice, samples)
        }
        _ => {
            let mut payload = match (&files, fields.data) {
                (Some((field, files)), _) => data.open_one(files, count, field, context, memory)?,
                (None, Some(data)) => Payload::attached(input, data),
                (None, None) => {
                    let expected = "the blank line before the samples, or the field data file";
                    let fault = Fault::new("E-nrrd-header", end_place(input), "the end of the file", expected);
                    return Err(fault.advice("put a blank line between the header and the samples").into());
                }
            };
            let (skip, room) = data.room(&mut payload, count, context)?;
            let lattice = lattice(&room, &payload)?;
            let mut intake = Intake::with_room(count, scalar, memory)?;
            data.samples(&payload, &mut intake, (count, skip), context, memory, findings)?;
            (lattice, intake.finish(findings))
        }
    };
    let mut shape = grid_shape(lattice, samples, quantity_of(fields.quantity), findings)?;
    shape.units = units(fields);
    shape.comments = fields.comments.clone();
    Ok(ReadShape::new(shape))
}

fn frame_place(fields: &Fields<'_>) -> Place {
    let said = ["space directions", "spacings", "space origin", "sizes"].into_iter().find_map(|name| fields.find(name));
    said.map_or(Place::Whole, |field| field.place())
}
