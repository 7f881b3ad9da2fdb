//! Reading legacy VTK.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_voxels::{Quantity, Samples};

use super::NO_TITLE;
use crate::memory::Memory;
use crate::text::{NumberFault, Scanner, in_lines, line_place, lossy, quoted};
use crate::volumes::{
    Coding, Frame, Packing, Payload, Room, Scalar, check_spacing, grid_shape, quantity_of, text_samples,
};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let mut header = Header { data: usize::MAX, ..Header::default() };
    let read = volume(input, &mut header, context, &mut memory, &mut findings);
    let binary = header.binary;
    let data = header.data as u64;
    let in_text = |place: &Place| !binary || matches!(place, Place::Byte(at) if *at < data);
    let mut read = read.map_err(|error| match error {
        ReadError::Input(fault) if in_text(&fault.place) => ReadError::Input(in_lines(input, fault)),
        other => other,
    })?;
    read.findings = findings.with_places(|place| if in_text(&place) { line_place(input, place) } else { place });
    Ok(read)
}

/// What stands before the samples.
#[derive(Clone, Debug, Default)]
struct Header {
    binary: bool,
    /// The numbers of points, with where they stand.
    dimensions: Option<([u64; 3], u64)>,
    origin: Option<DVec3>,
    spacing: Option<(DVec3, u64)>,
    /// Whether data are of cells, and how many of them.
    attributes: Option<(bool, u64, u64)>,
    /// Where the samples begin.
    data: usize,
}

/// The type of an array.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Type {
    Bit,
    Number(Scalar),
}

fn type_of(word: &[u8]) -> Option<Type> {
    Some(Type::Number(match word.to_ascii_lowercase().as_slice() {
        b"bit" => return Some(Type::Bit),
        b"unsigned_char" => Scalar::U8,
        b"char" | b"signed_char" => Scalar::I8,
        b"unsigned_short" => Scalar::U16,
        b"short" => Scalar::I16,
        b"unsigned_int" => Scalar::U32,
        b"int" => Scalar::I32,
        b"unsigned_long" | b"vtktypeuint64" => Scalar::U64,
        b"long" | b"vtktypeint64" | b"vtkidtype" => Scalar::I64,
        b"float" => Scalar::F32,
        b"double" => Scalar::F64,
        _ => return None,
    }))
}

fn unread(fault: Box<Fault>) -> Box<Fault> {
    fault.category(Category::Unsupported)
}

/// A whole number of a line.
fn count(scan: &mut Scanner<'_>, within: &str) -> Result<u64, Box<Fault>> {
    let (place, found) = (scan.place(), scan.found());
    scan.count().map_err(|_| Fault::new("E-vtk-count", place, found, "a whole number in digits alone").within(within))
}

fn three(scan: &mut Scanner<'_>, within: &str) -> Result<DVec3, Box<Fault>> {
    let mut numbers = [0.0; 3];
    for number in &mut numbers {
        let (place, found) = (scan.place(), scan.found());
        *number = match scan.number() {
            Ok(value) => value,
            Err(NumberFault::NotFinite) => {
                scan.word();
                f64::NAN
            }
            Err(fault) => return Err(Fault::new("E-vtk-number", place, found, fault.to_string()).within(within)),
        };
    }
    Ok(DVec3::from(numbers))
}

fn volume(
    input: &[u8],
    header: &mut Header,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let mut scan = Scanner::new(input, 0);
    if !scan.rest().starts_with(b"# vtk DataFile Version") {
        let found = if input.is_empty() { "an empty file".to_owned() } else { quoted(scan.rest_of_line()) };
        return Err(Fault::new("E-vtk-magic", Place::Byte(0), found, "# vtk DataFile Version").into());
    }
    scan.next_line();
    let title = lossy(scan.rest_of_line(), scan.place(), findings).into_owned();
    memory.take(title.len(), 2)?;
    scan.next_line();
    while scan.at_line_end() && scan.next_line() {}
    let place = scan.place();
    let word = scan.word();
    header.binary = match word.to_ascii_uppercase().as_slice() {
        b"ASCII" => false,
        b"BINARY" => true,
        _ => return Err(Fault::new("E-vtk-header", place, quoted(word), "ASCII or BINARY").into()),
    };
    scan.next_line();
    let (kind, name) = loop {
        context.exec.check()?;
        while scan.at_line_end() && scan.next_line() {}
        let place = scan.place();
        if scan.rest().is_empty() {
            let missing = "DATASET, DIMENSIONS, POINT_DATA or CELL_DATA, and SCALARS";
            return Err(Fault::new("E-vtk-header", place, "the end of the file", missing).into());
        }
        let line = scan.offset() as u64;
        let word = scan.word().to_ascii_uppercase();
        match word.as_slice() {
            b"DATASET" => {
                let word = scan.word();
                if !word.eq_ignore_ascii_case(b"STRUCTURED_POINTS") {
                    return Err(unread(Fault::new("E-vtk-feature", place, quoted(word), "STRUCTURED_POINTS")).into());
                }
            }
            b"DIMENSIONS" => {
                let name = "DIMENSIONS";
                header.dimensions =
                    Some(([count(&mut scan, name)?, count(&mut scan, name)?, count(&mut scan, name)?], line));
            }
            b"ORIGIN" => {
                let origin = three(&mut scan, "ORIGIN")?;
                if !origin.is_finite() {
                    let fault = Fault::new("E-volume-grid", place, "a place that is no number", "finite numbers");
                    return Err(fault.within("ORIGIN").into());
                }
                header.origin = Some(origin);
            }
            b"SPACING" | b"ASPECT_RATIO" => {
                let spacing = three(&mut scan, "SPACING")?;
                check_spacing(spacing, place, "SPACING")?;
                header.spacing = Some((spacing, line));
            }
            b"POINT_DATA" => header.attributes = Some((false, count(&mut scan, "POINT_DATA")?, line)),
            b"CELL_DATA" => header.attributes = Some((true, count(&mut scan, "CELL_DATA")?, line)),
            b"SCALARS" => {
                let name = scan.word();
                let place = scan.place();
                let word = scan.word();
                let kind =
                    type_of(word).ok_or_else(|| Fault::new("E-vtk-type", place, quoted(word), "a type of numbers"))?;
                if !scan.at_line_end() {
                    let place = scan.place();
                    let components = count(&mut scan, "SCALARS")?;
                    if components != 1 {
                        let found = format!("{components} values a sample");
                        return Err(unread(Fault::new("E-vtk-dimension", place, found, "one")).into());
                    }
                }
                scan.next_line();
                let mut ahead = scan.clone();
                while !header.binary && ahead.at_line_end() && ahead.next_line() {}
                if ahead.word().eq_ignore_ascii_case(b"LOOKUP_TABLE") {
                    ahead.next_line();
                    scan = ahead;
                }
                break (kind, name);
            }
            b"FIELD" => {
                // Arrays of a field before the attributes are about the file as a whole.
                if header.attributes.is_none() {
                    return Err(
                        unread(Fault::new("E-vtk-feature", place, "FIELD before the data of points", "none")).into()
                    );
                }
                scan.word();
                let arrays = count(&mut scan, "FIELD")?;
                if arrays == 0 {
                    scan.next_line();
                    continue;
                }
                scan.next_line();
                while scan.at_line_end() && scan.next_line() {}
                let place = scan.place();
                let name = scan.word();
                let (components, _) = (count(&mut scan, "FIELD")?, count(&mut scan, "FIELD")?);
                let word = scan.word();
                let kind = type_of(word)
                    .ok_or_else(|| Fault::new("E-vtk-type", place.clone(), quoted(word), "a type of numbers"))?;
                if components != 1 {
                    let found = format!("{components} values a sample");
                    return Err(unread(Fault::new("E-vtk-dimension", place, found, "one")).into());
                }
                scan.next_line();
                break (kind, name);
            }
            b"VECTORS"
            | b"NORMALS"
            | b"TENSORS"
            | b"COLOR_SCALARS"
            | b"TEXTURE_COORDINATES"
            | b"LOOKUP_TABLE"
            | b"METADATA" => {
                return Err(unread(Fault::new("E-vtk-feature", place, quoted(&word), "SCALARS first")).into());
            }
            _ => return Err(Fault::new("E-vtk-header", place, quoted(&word), "a keyword of structured points").into()),
        }
        scan.next_line();
    };
    header.data = scan.offset();
    let missing = |what: &str| {
        let place = Place::Byte((header.data as u64).saturating_sub(1));
        Fault::new("E-vtk-header", place, "the samples", format!("the line {what} before them"))
    };
    let (mut sizes, sizes_at) = header.dimensions.ok_or_else(|| missing("DIMENSIONS"))?;
    let (cells, said, said_at) = header.attributes.ok_or_else(|| missing("POINT_DATA"))?;
    let (spacing, spacing_at) = header.spacing.unwrap_or((DVec3::ONE, sizes_at));
    let mut first = DVec3::ZERO;
    if cells {
        for axis in 0..3 {
            if sizes[axis] > 1 {
                sizes[axis] -= 1;
                first[axis] = 0.5;
            }
        }
    }
    let frame =
        Frame::turned(header.origin.unwrap_or(DVec3::ZERO), [DVec3::X, DVec3::Y, DVec3::Z], spacing).moved(first);
    let wanted = sizes.iter().fold(1u64, |product, size| product.saturating_mul(*size));
    let payload = Payload::attached(input, header.data);
    let scalar = if let Type::Number(scalar) = kind { scalar } else { Scalar::U8 };
    let bits = kind == Type::Bit && header.binary;
    let (bytes, size) = match (header.binary, bits) {
        (false, _) => (payload.len() + 1, 2),
        (true, true) => (payload.len().saturating_mul(8), 1),
        (true, false) => (payload.len(), scalar.size() as u64),
    };
    let room = Room { bytes, most_from_a_byte: 1, size, stored_size: scalar.stored_size() as u64 };
    let dimensions = room.check(sizes, Place::Byte(sizes_at), "DIMENSIONS", &payload, context)?;
    if said != wanted {
        let place = Place::Byte(said_at);
        return Err(Fault::new(
            "E-vtk-count",
            place,
            format!("{said} samples"),
            format!("{wanted}, as DIMENSIONS says"),
        )
        .into());
    }
    let lattice = frame.lattice(dimensions, Place::Byte(spacing_at))?;
    let samples = if bits {
        packed_bits(&payload, wanted, context, memory)?
    } else if header.binary {
        // What follows the samples are other arrays.
        let size = usize::try_from(wanted.saturating_mul(scalar.size() as u64)).unwrap_or(usize::MAX);
        let own = Payload { bytes: payload.bytes[..size.min(payload.bytes.len())].into(), ..payload };
        let coding = Coding { packing: Packing::Plain, scalar, big: true, skip: 0 };
        let samples = own.samples(wanted, &coding, context, memory, findings)?;
        scan.advance(size);
        samples
    } else {
        text_samples(&mut scan, input, wanted, scalar, context, memory, findings)?
    };
    if !bits {
        while scan.at_line_end() && scan.next_line() {}
        let word = scan.clone().word();
        if !word.is_empty() && word != b"METADATA" {
            let message = format!("found {} after the samples; the rest was not read", scan.found());
            findings.push("W-vtk-more", Severity::Warning, scan.place(), message);
        }
    }
    let quantity = if kind == Type::Bit { Quantity::Occupancy } else { quantity_of(name) };
    let mut shape = grid_shape(lattice, samples, quantity, findings)?;
    if !["", NO_TITLE].contains(&title.trim()) {
        shape.comments.push(title);
    }
    Ok(ReadShape::new(shape))
}

/// Eight bits a byte, the first in the highest.
fn packed_bits(
    payload: &Payload<'_>,
    count: u64,
    context: &ReadContext,
    memory: &mut Memory<'_>,
) -> Result<Samples, ReadError> {
    let words = usize::try_from(count.div_ceil(64)).unwrap_or(usize::MAX);
    memory.take(words, 8)?;
    let mut bits = Vec::with_capacity(words);
    let bytes = &payload.bytes[..usize::try_from(count.div_ceil(8)).unwrap_or(usize::MAX).min(payload.bytes.len())];
    for (number, chunk) in bytes.chunks(8).enumerate() {
        if number % 8192 == 0 {
            context.exec.check()?;
        }
        let word =
            chunk.iter().enumerate().fold(0u64, |word, (at, byte)| word | u64::from(byte.reverse_bits()) << (8 * at));
        bits.push(word);
    }
    if !count.is_multiple_of(64)
        && let Some(last) = bits.last_mut()
    {
        *last &= (1 << (count % 64)) - 1;
    }
    Ok(Samples::Bits(bits))
}
