//! Reading PNG.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, DecodingError, Transformations};
use shapeloom_core::glam::DVec2;
use shapeloom_core::{Category, Findings, Place};
use shapeloom_shape::Units;

use super::chunks::Chunks;
use crate::heights::{
    Channels, NorthFirst, Pixels, check_options, check_size, guess_spacing, no_height, no_voxel_size, part_of,
    picture_scale, room, shape_of,
};
use crate::memory::Memory;
use crate::volumes::{Plane, Scalar, read_stack};
use crate::{Fault, HeightEncoding, ReadContext, ReadError, ReadShape};

/// Compressed data gives at most so many times its bytes (RFC 1951: 258 bytes for two bits).
const MOST_FROM_A_BYTE: u64 = 1032;

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    check_options(&context.options)?;
    if context.options.stack {
        return read_stack(input, context, plane);
    }
    no_voxel_size(context)?;
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let (chunks, (columns, rows)) = sized(input, context, &mut findings)?;
    let (raw, full) = pixels(input, &chunks, (columns, rows), context, &mut memory, &mut findings)?;
    let options = &context.options;
    let encoded = options.encoding != HeightEncoding::Grey;
    // What an option says holds before what the file says.
    let size = chunks.pixel_size.map(|size| size.0).filter(|_| options.spacing == 0.0);
    let calibration = chunks.calibration.filter(|found| !encoded && options.height == 0.0 && found.full == full);
    let (base, range, spacing) = match calibration {
        _ if encoded => {
            no_height(context, "colours that encode metres")?;
            (0.0, f64::from(full), size.unwrap_or_else(|| DVec2::splat(guess_spacing(context, &mut findings))))
        }
        Some(found) => {
            let spacing = size.unwrap_or_else(|| DVec2::splat(guess_spacing(context, &mut findings)));
            (found.base, found.range, spacing)
        }
        None => {
            let known = size.map(DVec2::max_element);
            let (height, distance) = picture_scale(f64::from(full), columns, rows, known, context, &mut findings);
            (0.0, height, size.unwrap_or(DVec2::splat(distance)))
        }
    };
    let heights = raw.into_iter().map(|value| base + part_of(value, f64::from(full), range)).collect();
    let grid = NorthFirst { columns, rows, spacing, south_west: DVec2::ZERO, heights };
    let field = grid.into_field(context, &mut findings)?;
    let mut shape = shape_of(field);
    shape.units = size.map(|_| Units::METERS);
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}

/// The chunks, and the size that is checked against them.
fn sized(input: &[u8], context: &ReadContext, findings: &mut Findings) -> Result<(Chunks, (u32, u32)), ReadError> {
    let chunks = Chunks::read(input, findings)?;
    let place = Place::Byte(chunks.header_at);
    let (columns, rows) = (u64::from(chunks.columns), u64::from(chunks.rows));
    let (columns, rows) = check_size(columns, rows, place.clone(), "chunk IHDR", input.len(), context)?;
    let bytes = (u64::from(columns) * u64::from(chunks.bits)).div_ceil(8) * u64::from(rows);
    let most = chunks.data.saturating_mul(MOST_FROM_A_BYTE);
    if bytes > most {
        let found = format!("{columns} × {rows} samples of {} bits in {} bytes", chunks.bits, chunks.data);
        let expected = "no more than compressed data can hold";
        return Err(Fault::new("E-png-claim", place, found, expected).within("chunk IHDR").into());
    }
    Ok((chunks, (columns, rows)))
}

/// The picture as a slice of a volume.
fn plane(
    input: &[u8],
    context: &ReadContext,
    findings: &mut Findings,
    take: &mut dyn FnMut(Plane) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut memory = Memory::new(&context.exec);
    let (chunks, (columns, rows)) = sized(input, context, findings)?;
    let (values, full) = pixels(input, &chunks, (columns, rows), context, &mut memory, findings)?;
    let scalar = match (context.options.encoding, full) {
        (HeightEncoding::Grey, 255) => Scalar::U8,
        (HeightEncoding::Grey, _) => Scalar::U16,
        _ => Scalar::F32,
    };
    take(Plane { columns, rows, scalar, values })
}

/// The numbers of all pixels, row by row, and the largest that they can be.
fn pixels(
    input: &[u8],
    chunks: &Chunks,
    (columns, rows): (u32, u32),
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<(Vec<f64>, u32), ReadError> {
    let place = Place::Byte(chunks.data_at);
    let told = |error: DecodingError| decoding(error, place.clone());
    let mut decoder = Decoder::new(Cursor::new(input));
    // Texts and colour profiles are no heights.
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_transformations(Transformations::EXPAND);
    // A row before and after it is unpacked, and what inflating keeps.
    memory.take(columns as usize, 32)?;
    memory.take(1, 1 << 19)?;
    let mut reader = decoder.read_info().map_err(told)?;
    let (color, depth) = reader.output_color_type();
    let channels = match color {
        ColorType::Grayscale => Channels::Grey,
        ColorType::GrayscaleAlpha => Channels::GreyAlpha,
        ColorType::Rgb => Channels::Rgb,
        ColorType::Rgba | ColorType::Indexed => Channels::Rgba,
    };
    let full = if depth == BitDepth::Sixteen { 65535 } else { 255 };
    let mut pixels = Pixels::try_new(context.options.encoding, channels, full, columns)?;
    let mut raw = room(columns as usize * rows as usize, memory)?;
    if reader.info().interlaced {
        let bytes = reader.output_buffer_size().unwrap_or(usize::MAX);
        memory.take(bytes, 1)?;
        let mut all = vec![0; bytes];
        context.exec.check()?;
        reader.next_frame(&mut all).map_err(told)?;
        for row in all.chunks(reader.output_line_size(columns).unwrap_or(1).max(1)) {
            context.exec.check()?;
            take_row(row, channels, full, &mut pixels, &mut raw)?;
        }
    } else {
        for row in 0..rows {
            context.exec.check()?;
            context.exec.progress(f64::from(row) / f64::from(rows));
            match reader.next_row().map_err(told)? {
                Some(row) => take_row(row.data(), channels, full, &mut pixels, &mut raw)?,
                None => break,
            }
        }
    }
    if raw.len() != columns as usize * rows as usize {
        let found = format!("data for {} of {rows} rows", raw.len() / columns as usize);
        return Err(Fault::new("E-png-truncated", place, found, "all of them").within("chunk IDAT").into());
    }
    pixels.finish(findings);
    Ok((raw, full))
}

fn take_row(
    row: &[u8],
    channels: Channels,
    full: u32,
    pixels: &mut Pixels,
    raw: &mut Vec<f64>,
) -> Result<(), Box<Fault>> {
    let (count, mut pixel) = (channels.count(), [0u32; 4]);
    let width = if full > 255 { 2 } else { 1 };
    for bytes in row.chunks_exact(count * width) {
        for (value, sample) in pixel.iter_mut().zip(bytes.chunks_exact(width)) {
            *value = sample.iter().fold(0, |value, byte| value << 8 | u32::from(*byte));
        }
        raw.push(pixels.height(&pixel[..count])?);
    }
    Ok(())
}

fn decoding(error: DecodingError, place: Place) -> Box<Fault> {
    let (code, found) = match error {
        DecodingError::IoError(_) => ("E-png-truncated", "the end of the data before the last row".to_owned()),
        DecodingError::LimitsExceeded => {
            let fault = Fault::new("E-png-limit", place, "rows that take too much memory", "a smaller picture");
            return fault.category(Category::OverLimit);
        }
        other => {
            // The library's error has no public kinds, and this one alone means that data ends early.
            let text = other.to_string();
            let short =
                text.contains("no more data") || text.contains("unexpected end") || text.contains("enough data");
            (if short { "E-png-truncated" } else { "E-png-data" }, text.trim_end_matches('.').to_owned())
        }
    };
    Fault::new(code, place, found, "the pixels of all rows").within("chunk IDAT")
}
