//! Reading NRRD.

use shapeloom_core::{Category, Findings, Place};

use super::fields::Fields;
use super::frame::{Axes, units};
use crate::memory::Memory;
use crate::text::{Scanner, end_place, in_lines, line_place, parse_count, quoted};
use crate::volumes::{
    Coding, MOST_FROM_A_BYTE, Packing, Payload, Room, Scalar, grid_shape, open_beside, quantity_of, text_samples,
};
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

/// How samples are written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Encoding {
    Raw,
    Gzip,
    Text,
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
    let (lines, bytes) = (skip(fields, "line skip")?, skip(fields, "byte skip")?);
    let sizes = fields.require("sizes")?;
    let unpacked = axes.sizes.iter().fold(scalar.size() as u64, |product, size| product.saturating_mul(*size));
    let mut payload = match fields.find("data file") {
        Some(field) => {
            let name = std::str::from_utf8(field.value).unwrap_or("");
            if name == "LIST" || name.starts_with("LIST ") || name.contains('%') {
                let fault = field.fault("E-nrrd-feature", quoted(field.value), "the name of one file");
                return Err(fault.category(Category::Unsupported).into());
            }
            // Of packed samples, of lines and of what comes before the last ones nothing is known.
            let exact = encoding == Encoding::Raw && lines == Some(0);
            let wanted = if exact { bytes.map_or(u64::MAX, |bytes| unpacked.saturating_add(bytes)) } else { u64::MAX };
            open_beside(name, wanted, field.place(), "data file", context, memory)?
        }
        None => {
            let Some(data) = fields.data else {
                let expected = "the blank line before the samples, or the field data file";
                let fault = Fault::new("E-nrrd-header", end_place(input), "the end of the file", expected);
                return Err(fault.advice("put a blank line between the header and the samples").into());
            };
            Payload::attached(input, data)
        }
    };
    let Some(lines) = lines else {
        return Err(negative(fields, "line skip").into());
    };
    payload.skip_lines(lines, context)?;
    let skip = match (bytes, encoding) {
        (Some(bytes), _) => bytes,
        // The last bytes of the file.
        (None, Encoding::Raw) => payload.len().saturating_sub(unpacked),
        (None, _) => return Err(negative(fields, "byte skip").into()),
    };
    let room = match encoding {
        Encoding::Raw => Room {
            bytes: payload.len().saturating_sub(skip),
            most_from_a_byte: 1,
            size: scalar.size() as u64,
            stored_size: scalar.stored_size() as u64,
        },
        Encoding::Gzip => Room {
            bytes: payload.len(),
            most_from_a_byte: MOST_FROM_A_BYTE,
            size: scalar.size() as u64,
            stored_size: scalar.stored_size() as u64,
        },
        // A digit and a blank each, but for the last.
        Encoding::Text => {
            Room { bytes: payload.len() + 1, most_from_a_byte: 1, size: 2, stored_size: scalar.stored_size() as u64 }
        }
    };
    let count = axes.sizes.iter().fold(1u64, |product, size| product.saturating_mul(*size));
    let dimensions = room.check(axes.sizes, sizes.place(), "sizes", &payload, context)?;
    let lattice = frame.lattice(dimensions, frame_place(fields))?;
    let samples = match encoding {
        Encoding::Text => {
            let text = &payload.bytes[..];
            let mut scan = Scanner::new(text, usize::try_from(skip).unwrap_or(usize::MAX));
            let samples = text_samples(&mut scan, text, count, scalar, context, memory, findings);
            samples.map_err(|error| payload.moved(error))?
        }
        _ => {
            let packing = if encoding == Encoding::Gzip { Packing::Gzip } else { Packing::Plain };
            payload.samples(count, &Coding { packing, scalar, big, skip }, context, memory, findings)?
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
