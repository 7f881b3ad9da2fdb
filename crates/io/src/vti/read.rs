//! Reading VTI.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Category, Findings, Loss, Place};

use super::blocks::{Layout, Stored};
use super::xml::{Array, Document, Element};
use crate::memory::Memory;
use crate::text::{Scanner, line_at, parse_count, quoted};
use crate::volumes::{Frame, Room, Scalar, check_spacing, decode_base64, grid_shape, quantity_of, text_samples};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let document = Document::read(input, context, &mut memory);
    // XML is text, what is appended is not.
    let text =
        document.as_ref().ok().and_then(|document| document.appended_bytes).map_or(input.len(), |(from, _)| from);
    let lines = |place: Place| match place {
        Place::Byte(at) if at < text as u64 && !input.is_empty() => Place::line(line_at(input, at as usize)),
        place => place,
    };
    let read = document.and_then(|document| volume(input, &document, context, &mut memory, &mut findings));
    let mut read = read.map_err(|error| match error {
        ReadError::Input(mut fault) => {
            fault.place = lines(fault.place);
            ReadError::Input(fault)
        }
        other => other,
    })?;
    read.findings = findings.with_places(lines);
    Ok(read)
}

fn unread(fault: Box<Fault>) -> Box<Fault> {
    fault.category(Category::Unsupported)
}

fn scalar_of(name: &str) -> Option<Scalar> {
    Some(match name {
        "Int8" => Scalar::I8,
        "UInt8" => Scalar::U8,
        "Int16" => Scalar::I16,
        "UInt16" => Scalar::U16,
        "Int32" => Scalar::I32,
        "UInt32" => Scalar::U32,
        "Int64" => Scalar::I64,
        "UInt64" => Scalar::U64,
        "Float32" => Scalar::F32,
        "Float64" => Scalar::F64,
        _ => return None,
    })
}

fn layout(file: &Element) -> Result<Layout, Box<Fault>> {
    let big = match file.get("byte_order") {
        None | Some("LittleEndian") => false,
        Some("BigEndian") => true,
        Some(other) => {
            return Err(file.fault("E-vti-value", "byte_order", quoted(other.as_bytes()), "LittleEndian or BigEndian"));
        }
    };
    let count_size = match file.get("header_type") {
        None | Some("UInt32") => 4,
        Some("UInt64") => 8,
        Some(other) => {
            return Err(file.fault("E-vti-value", "header_type", quoted(other.as_bytes()), "UInt32 or UInt64"));
        }
    };
    let compressed = match file.get("compressor") {
        None | Some("") => false,
        Some("vtkZLibDataCompressor") => true,
        Some(other) => {
            let found = quoted(other.as_bytes());
            return Err(unread(file.fault("E-vti-feature", "compressor", found, "none, or vtkZLibDataCompressor")));
        }
    };
    Ok(Layout { big, count_size, compressed })
}

/// The first and the last index along each axis.
fn extent(element: &Element, name: &str) -> Result<[[i64; 2]; 3], Box<Fault>> {
    let text = element.require(name)?;
    let wrong = || element.fault("E-vti-number", name, quoted(text.as_bytes()), "six whole numbers");
    let mut numbers = text.split_ascii_whitespace().map(|word| word.parse::<i64>().ok());
    let mut extent = [[0; 2]; 3];
    for number in extent.as_flattened_mut() {
        let found = numbers.next().flatten().filter(|number| number.unsigned_abs() < 1 << 53);
        *number = found.ok_or_else(wrong)?;
    }
    if numbers.next().is_some() {
        return Err(wrong());
    }
    for [first, last] in extent {
        if last < first {
            let found = format!("from {first} to {last}");
            return Err(element.fault("E-volume-size", name, found, "at least one sample in each direction"));
        }
    }
    Ok(extent)
}

fn volume(
    input: &[u8],
    document: &Document,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<ReadShape, ReadError> {
    let missing = |name: &str| {
        let place = Place::Byte(input.len() as u64);
        Fault::new("E-vti-header", place, "the end of the file", format!("the element {name}"))
    };
    let file = document.file.as_ref().ok_or_else(|| missing("VTKFile"))?;
    if file.get("type") != Some("ImageData") {
        let found = quoted(file.get("type").unwrap_or("").as_bytes());
        return Err(unread(file.fault("E-vti-feature", "type", found, "ImageData")).into());
    }
    let layout = layout(file)?;
    let image = document.image.as_ref().ok_or_else(|| missing("ImageData"))?;
    let whole = extent(image, "WholeExtent")?;
    let piece = match document.pieces.as_slice() {
        [piece] => piece,
        [] => return Err(missing("Piece").into()),
        [_, second, ..] => {
            let found = format!("{} pieces", document.pieces.len());
            return Err(unread(second.fault("E-vti-feature", "", found, "one")).into());
        }
    };
    let own = if piece.get("Extent").is_some() { extent(piece, "Extent")? } else { whole };
    let mut sizes = own.map(|[first, last]| (last - first) as u64 + 1);
    let mut frame = frame(image)?;
    let mut first = own.map(|[first, _]| first as f64);

    let (array, losses) = choose(document).ok_or_else(|| missing("DataArray"))?;
    if array.cells {
        for axis in 0..3 {
            if sizes[axis] > 1 {
                sizes[axis] -= 1;
                first[axis] += 0.5;
            }
        }
    }
    frame = frame.moved(DVec3::from(first));
    let element = &array.element;
    if let Some(text) = element.get("NumberOfComponents")
        && text.trim() != "1"
    {
        let found = format!("{} values a sample", quoted(text.as_bytes()));
        return Err(unread(element.fault("E-vti-dimension", "NumberOfComponents", found, "one")).into());
    }
    let kind = element.require("type")?;
    let scalar = scalar_of(kind).ok_or_else(|| {
        let fault = element.fault("E-vti-type", "type", quoted(kind.as_bytes()), "Int8 to UInt64, Float32 or Float64");
        if kind == "Bit" || kind == "String" { unread(fault) } else { fault }
    })?;
    let count = sizes.iter().fold(1u64, |product, size| product.saturating_mul(*size));
    let (from, to) = array.content;
    let inside = &input[from.min(input.len())..to.min(input.len())];
    let place = Place::Byte(image.at);
    let check = |bytes: u64, ratio: u64, size: usize| {
        let room = Room { bytes, most_from_a_byte: ratio, size: size as u64, stored_size: scalar.stored_size() as u64 };
        crate::volumes::check_size(sizes, &room, place.clone(), "ImageData, WholeExtent", context)
    };
    let name = element.get("Name").unwrap_or_default();
    let within = format!("array {}", quoted(name.as_bytes()));
    let (dimensions, samples) = match element.get("format").unwrap_or("ascii") {
        "ascii" => {
            let dimensions = check(inside.len() as u64 + 1, 1, 2)?;
            let mut scan = Scanner::new(&input[..from + inside.len()], from);
            let text = &input[..from + inside.len()];
            (dimensions, text_samples(&mut scan, text, count, scalar, context, memory, findings)?)
        }
        "binary" => {
            let (bytes, used) = decode_base64(inside, &context.exec, memory)?;
            if !inside[used..].trim_ascii().is_empty() {
                let found = quoted(inside[used..].trim_ascii());
                let place = Place::Byte((from + used) as u64);
                return Err(Fault::new("E-vti-data", place, found, "base64").within(within).into());
            }
            let stored = Stored { bytes: &bytes, place: Place::Byte(element.at), alone: true, within };
            let dimensions = check(stored.most(layout), 1, scalar.size())?;
            (dimensions, stored.samples(count, scalar, layout, context, memory, findings)?)
        }
        "appended" => {
            let appended = document.appended.as_ref().ok_or_else(|| missing("AppendedData"))?;
            let Some((start, end)) = document.appended_bytes else {
                let found = "no such mark";
                return Err(appended.fault("E-vti-header", "", found, "the mark _ before the data").into());
            };
            let text = element.require("offset")?;
            let offset = parse_count(text.trim().as_bytes()).ok().and_then(|offset| usize::try_from(offset).ok());
            let data = &input[start..end];
            let data = offset.and_then(|offset| data.get(offset..)).ok_or_else(|| {
                let expected = format!("an offset within the {} bytes of the appended data", data.len());
                element.fault("E-vti-value", "offset", quoted(text.as_bytes()), expected)
            })?;
            let at = Place::Byte((end - data.len()) as u64);
            match appended.get("encoding").unwrap_or("base64") {
                "raw" => {
                    let stored = Stored { bytes: data, place: at, alone: false, within };
                    let dimensions = check(stored.most(layout), 1, scalar.size())?;
                    (dimensions, stored.samples(count, scalar, layout, context, memory, findings)?)
                }
                "base64" => {
                    let (bytes, _) = decode_base64(data, &context.exec, memory)?;
                    let stored = Stored { bytes: &bytes, place: at, alone: false, within };
                    let dimensions = check(stored.most(layout), 1, scalar.size())?;
                    (dimensions, stored.samples(count, scalar, layout, context, memory, findings)?)
                }
                other => {
                    let found = quoted(other.as_bytes());
                    return Err(unread(appended.fault("E-vti-feature", "encoding", found, "raw or base64")).into());
                }
            }
        }
        other => {
            let found = quoted(other.as_bytes());
            return Err(element.fault("E-vti-value", "format", found, "ascii, binary or appended").into());
        }
    };
    if own != whole {
        let words = own.map(|[first, last]| format!("{first} to {last}")).join(", ");
        let message = format!("the piece is {words} of a larger whole: the rest is in other files, and was not read");
        findings.push("W-vti-piece", shapeloom_core::Severity::Warning, Place::Byte(piece.at), message);
    }
    if document.cut {
        let message = "the file ends before its last tags: all samples are there, but other arrays may not be";
        let end = Place::Byte(input.len() as u64);
        findings.push("W-volume-truncated", shapeloom_core::Severity::Warning, end, message);
    }
    let lattice = frame.lattice(dimensions, place)?;
    let shape = grid_shape(lattice, samples, quantity_of(name.as_bytes()), findings)?;
    Ok(ReadShape { losses, ..ReadShape::new(shape) })
}

/// The array that is read, and what is lost with the others.
fn choose(document: &Document) -> Option<(&Array, Vec<Loss>)> {
    let name_of = |array: &Array| array.element.get("Name").unwrap_or_default().to_owned();
    let single = |array: &&Array| array.element.get("NumberOfComponents").is_none_or(|text| text.trim() == "1");
    let of = |cells: bool| {
        let active = document.data[usize::from(cells)].as_ref().and_then(|data| data.get("Scalars"));
        let mut own = document.arrays.iter().filter(move |array| array.cells == cells);
        let named = active.and_then(|active| own.clone().find(|array| array.element.get("Name") == Some(active)));
        named.or_else(|| own.clone().find(single)).or_else(|| own.next())
    };
    let chosen = of(false).or_else(|| of(true))?;
    let others = document.arrays.iter().filter(|array| !std::ptr::eq(*array, chosen));
    // Each once, and no more than anyone reads.
    let losses = others.take(100).map(|array| {
        let what =
            format!("array {} of {}", quoted(name_of(array).as_bytes()), if array.cells { "cells" } else { "points" });
        Loss::new(what, format!("a voxel grid has one: {} was read", quoted(name_of(chosen).as_bytes())))
    });
    Some((chosen, losses.collect()))
}

fn frame(image: &Element) -> Result<Frame, Box<Fault>> {
    let origin = image.numbers::<3>("Origin")?.map_or(DVec3::ZERO, DVec3::from);
    let spacing = image.numbers::<3>("Spacing")?.map_or(DVec3::ONE, DVec3::from);
    check_spacing(spacing, Place::Byte(image.at), "ImageData, Spacing")?;
    // Row by row.
    let directions = match image.numbers::<9>("Direction")? {
        Some(rows) => {
            let turned = DMat3::from_cols_array(&rows).transpose();
            [turned.x_axis, turned.y_axis, turned.z_axis]
        }
        None => [DVec3::X, DVec3::Y, DVec3::Z],
    };
    Ok(Frame::turned(origin, directions, spacing))
}
