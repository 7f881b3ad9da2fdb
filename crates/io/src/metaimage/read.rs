//! Reading MetaImage.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Place};
use shapeloom_shape::Units;

use super::header::Header;
use crate::memory::Memory;
use crate::text::{Scanner, in_lines, line_place, quoted};
use crate::volumes::{
    Coding, Frame, MOST_FROM_A_BYTE, Packing, Payload, Room, Scalar, check_spacing, grid_shape, open_beside,
    quantity_of, text_samples,
};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let header = Header::read(input, context, &mut memory, &mut findings);
    let end = header.as_ref().map_or(input.len(), |header| header.end);
    let found = header.and_then(|header| volume(input, &header, context, &mut memory, &mut findings));
    let in_header = |place: &Place| matches!(place, Place::Byte(at) if *at < end as u64 || end == input.len());
    let mut read = found.map_err(|error| match error {
        ReadError::Input(fault) if in_header(&fault.place) => ReadError::Input(in_lines(input, fault)),
        other => other,
    })?;
    read.findings = findings.with_places(|place| if in_header(&place) { line_place(input, place) } else { place });
    Ok(read)
}

fn scalar_of(word: &[u8]) -> Option<Scalar> {
    Some(match word {
        b"MET_CHAR" => Scalar::I8,
        b"MET_UCHAR" => Scalar::U8,
        b"MET_SHORT" => Scalar::I16,
        b"MET_USHORT" => Scalar::U16,
        // Four bytes whatever the machine, as the documentation has it.
        b"MET_INT" | b"MET_LONG" => Scalar::I32,
        b"MET_UINT" | b"MET_ULONG" => Scalar::U32,
        b"MET_LONG_LONG" => Scalar::I64,
        b"MET_ULONG_LONG" => Scalar::U64,
        b"MET_FLOAT" => Scalar::F32,
        b"MET_DOUBLE" => Scalar::F64,
        _ => return None,
    })
}

fn volume(
    input: &[u8],
    header: &Header<'_>,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let unread = |fault: Box<Fault>| fault.category(Category::Unsupported);
    if let Some(entry) = header.find("ObjectType").filter(|entry| entry.value != b"Image") {
        return Err(unread(entry.fault("E-metaimage-feature", quoted(entry.value), "an object of type Image")).into());
    }
    let entry = header.require("NDims")?;
    if entry.count()? != 3 {
        let found = format!("{} dimensions", String::from_utf8_lossy(entry.value));
        return Err(unread(entry.fault("E-metaimage-dimension", found, "three")).into());
    }
    if let Some(entry) = header.find("ElementNumberOfChannels")
        && entry.count()? != 1
    {
        let found = format!("{} values a sample", String::from_utf8_lossy(entry.value));
        return Err(unread(entry.fault("E-metaimage-dimension", found, "one")).into());
    }
    let sizes = header.require("DimSize")?;
    let mut dimensions = [0u64; 3];
    let mut words = sizes.value.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
    for size in &mut dimensions {
        let count = words.next().and_then(|word| crate::text::parse_count(word).ok());
        let wrong = || sizes.fault("E-metaimage-count", quoted(sizes.value), "three whole numbers in digits alone");
        *size = count.ok_or_else(wrong)?;
    }
    if words.next().is_some() {
        return Err(sizes.fault("E-metaimage-count", quoted(sizes.value), "three numbers").into());
    }
    let entry = header.require("ElementType")?;
    let scalar = scalar_of(entry.value).ok_or_else(|| {
        entry.fault("E-metaimage-type", quoted(entry.value), "a type of numbers such as MET_UCHAR or MET_FLOAT")
    })?;
    let flag = |name: &str, otherwise: bool| header.find(name).map_or(Ok(otherwise), |entry| entry.is_true());
    let (big, packed) = (flag("BinaryDataByteOrderMSB", false)?, flag("CompressedData", false)?);
    // Without the key text is meant; yet no program writes text without it, as most leave the key out for bytes.
    let text = !flag("BinaryData", true)?;
    let frame = frame(header)?;

    let entry = header.require("ElementDataFile")?;
    let skip = match header.find("HeaderSize") {
        Some(entry) if entry.value == b"-1" => None,
        Some(entry) => Some(entry.count()?),
        None => Some(0),
    };
    let count = dimensions.iter().fold(1u64, |product, size| product.saturating_mul(*size));
    let unpacked = count.saturating_mul(scalar.size() as u64);
    let payload = if [&b"LOCAL"[..], b"Local", b"local"].contains(&entry.value) {
        Payload::attached(input, header.end)
    } else {
        let name = std::str::from_utf8(entry.value).unwrap_or("");
        if name.starts_with("LIST") || name.contains('%') {
            let fault = entry.fault("E-metaimage-feature", quoted(entry.value), "LOCAL, or the name of one file");
            return Err(unread(fault).into());
        }
        let exact = !packed && !text;
        let wanted = skip.filter(|_| exact).map_or(u64::MAX, |skip| unpacked.saturating_add(skip));
        open_beside(name, wanted, entry.place(), "ElementDataFile", context, memory)?
    };
    // -1: the last bytes of the file.
    let skip = skip.unwrap_or_else(|| if packed || text { 0 } else { payload.len().saturating_sub(unpacked) });
    let left = payload.len().saturating_sub(skip);
    let (bytes, most_from_a_byte, size) = match (packed, text) {
        (true, _) => (payload.len(), MOST_FROM_A_BYTE, scalar.size() as u64),
        (_, true) => (left + 1, 1, 2),
        _ => (left, 1, scalar.size() as u64),
    };
    let room = Room { bytes, most_from_a_byte, size, stored_size: scalar.stored_size() as u64 };
    let dimensions = room.check(dimensions, sizes.place(), "DimSize", &payload, context)?;
    let place = header.find("TransformMatrix").or(header.find("ElementSpacing")).unwrap_or(sizes).place();
    let lattice = frame.lattice(dimensions, place)?;
    let samples = if text {
        let mut scan = Scanner::new(&payload.bytes, usize::try_from(skip).unwrap_or(usize::MAX));
        let samples = text_samples(&mut scan, &payload.bytes, count, scalar, context, memory, findings);
        samples.map_err(|error| payload.moved(error))?
    } else {
        let packing = if packed { Packing::Zlib } else { Packing::Plain };
        payload.samples(count, &Coding { packing, scalar, big, skip }, context, memory, findings)?
    };
    let mut shape = grid_shape(lattice, samples, quantity_of(header.quantity), findings)?;
    shape.comments.clone_from(&header.comments);
    shape.units = header.find("DistanceUnits").and_then(|entry| match entry.value {
        b"um" => Units::from_meters(1e-6).ok(),
        b"mm" => Some(Units::MILLIMETERS),
        b"cm" => Units::from_meters(1e-2).ok(),
        _ => None,
    });
    Ok(ReadShape::new(shape))
}

fn frame(header: &Header<'_>) -> Result<Frame, Box<Fault>> {
    let mut spacing = DVec3::ONE;
    if let Some(entry) = header.find("ElementSpacing").or(header.find("ElementSize")) {
        spacing = entry.three()?;
        check_spacing(spacing, entry.place(), "ElementSpacing")?;
    }
    let finite = |value: DVec3, entry: &super::header::Entry<'_>| {
        let wrong = || entry.fault("E-volume-grid", quoted(entry.value), "finite numbers");
        if value.is_finite() { Ok(value) } else { Err(wrong()) }
    };
    let origin = match header.find("Offset") {
        Some(entry) => finite(entry.three()?, entry)?,
        None => DVec3::ZERO,
    };
    let mut directions = [DVec3::X, DVec3::Y, DVec3::Z];
    if let Some(entry) = header.find("TransformMatrix") {
        let numbers = entry.numbers::<9>()?;
        for (axis, direction) in directions.iter_mut().enumerate() {
            *direction = finite(DVec3::new(numbers[3 * axis], numbers[3 * axis + 1], numbers[3 * axis + 2]), entry)?;
        }
    }
    Ok(Frame::turned(origin, directions, spacing))
}
