//! Reading TIFF.

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_shape::Units;
use tiff::decoder::{Decoder, DecodingResult, Limits};
use tiff::tags::Tag;
use tiff::{ColorType, TiffError, TiffFormatError};

use super::geo::Geo;
use super::pieces::Pieces;
use super::source::{Source, Stopped};
use super::words::{color_words, unsupported_words};
use crate::heights::{
    Channels, DEGREES, NorthFirst, Pixels, check_options, check_size, guess_spacing, no_height, no_voxel_size, part_of,
    picture_scale, room, shape_of,
};
use crate::memory::Memory;
use crate::volumes::{Plane, Scalar, read_stack};
use crate::{Fault, HeightEncoding, ReadContext, ReadError, ReadShape};

/// LZW gives at most about 1365 bytes for one, deflate 1032.
pub(super) const MOST_FROM_A_BYTE: u64 = 1400;
/// After how many numbers the caller is asked whether to go on: one strip may hold the whole image.
const POLLED: usize = 1 << 14;

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    check_options(&context.options)?;
    if context.options.stack {
        return read_stack(input, context, planes);
    }
    no_voxel_size(context)?;
    let mut findings = Findings::default();
    let mut memory = Memory::new(&context.exec);
    let stopped = Stopped::default();
    let (decoder, limits) = open(input, context, &stopped, &mut memory)?;
    let image = image(decoder, limits, input.len(), context, &stopped, &mut memory, &mut findings)?;
    if image.decoder.more_images() {
        let message = "the file has several images: the first was read";
        findings.push("W-tiff-images", Severity::Note, Place::Whole, message);
    }
    let shape = placed(image.raw, &image.kind, image.size, &image.geo, context, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape) })
}

/// Every image of a file as a slice of a volume.
fn planes(
    input: &[u8],
    context: &ReadContext,
    findings: &mut Findings,
    take: &mut dyn FnMut(Plane) -> Result<(), ReadError>,
) -> Result<(), ReadError> {
    let mut held = Memory::new(&context.exec);
    let stopped = Stopped::default();
    let (mut decoder, limits) = open(input, context, &stopped, &mut held)?;
    for number in 0u32.. {
        let mut memory = Memory::new(&context.exec);
        let named = |error: ReadError| match error {
            ReadError::Input(mut fault) if number > 0 => {
                let within = fault.within.take().unwrap_or_default();
                ReadError::Input(fault.within(within.replacen("image 0", &format!("image {number}"), 1)))
            }
            other => other,
        };
        let found = image(decoder, limits.clone(), input.len(), context, &stopped, &mut memory, findings);
        let Image { mut raw, kind, size: (columns, rows), decoder: rest, .. } = found.map_err(named)?;
        let scalar = match (kind.unsigned && context.options.encoding == HeightEncoding::Grey, kind.bits) {
            (true, 8) => Scalar::U8,
            (true, 16) => Scalar::U16,
            _ => Scalar::F32,
        };
        if kind.inverted {
            raw.iter_mut().for_each(|value| *value = f64::from(kind.full()) - *value);
        }
        take(Plane { columns, rows, scalar, values: raw })?;
        decoder = rest;
        if !decoder.more_images() {
            break;
        }
        decoder.inner().end_at(u64::MAX);
        let next = decoder.next_image().map_err(told);
        stopped.check()?;
        next?;
    }
    Ok(())
}

/// The decoder of a file, with the limits that it keeps.
fn open<'a>(
    input: &'a [u8],
    context: &'a ReadContext,
    stopped: &'a Stopped,
    memory: &mut Memory<'_>,
) -> Result<(Decoder<Source<'a>>, Limits), ReadError> {
    if input.len() < 8 {
        let place = Place::Byte(input.len() as u64);
        return Err(Fault::new("E-tiff-truncated", place, "the end of the file", "a header of 8 bytes").into());
    }
    // Tags are read as far as they are there.
    let mut limits = Limits::default();
    limits.ifd_value_size = input.len();
    memory.take(input.len(), 2)?;
    let source = Source::new(input, &context.exec, stopped);
    let decoder = Decoder::new(source).map_err(|error| match error {
        // Before this the limits cannot be set.
        TiffError::LimitsExceeded => {
            Fault::new("E-tiff-limit", Place::Whole, "a tag of more than 1 MiB", "smaller ones")
                .category(Category::OverLimit)
                .within("image 0")
        }
        other => told(other),
    });
    stopped.check()?;
    Ok((decoder?.with_limits(limits.clone()), limits))
}

/// An image with what its numbers are.
struct Image<'a> {
    raw: Vec<f64>,
    kind: Kind,
    size: (u32, u32),
    geo: Geo,
    decoder: Decoder<Source<'a>>,
}

/// The image at which a decoder stands.
fn image<'a>(
    mut decoder: Decoder<Source<'a>>,
    mut limits: Limits,
    length: usize,
    context: &ReadContext,
    stopped: &Stopped,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<Image<'a>, ReadError> {
    let (columns, rows) = decoder.dimensions().map_err(told)?;
    let place = Place::Whole;
    let (columns, rows) = check_size(u64::from(columns), u64::from(rows), place, "image 0", length, context)?;
    let kind = Kind::of(&mut decoder)?;
    let count = columns as usize * rows as usize;
    let bytes = (count as u64).saturating_mul(kind.pixel_bytes());
    if bytes > (length as u64).saturating_mul(MOST_FROM_A_BYTE) {
        let found = format!("{columns} × {rows} samples in {} bytes", length);
        let expected = "no more than compressed data can hold";
        return Err(Fault::new("E-tiff-claim", Place::Whole, found, expected).within("image 0").into());
    }
    // No strip or tile is larger than the image, but for what tiles have beyond its borders.
    limits.decoding_buffer_size = usize::try_from(bytes).unwrap_or(usize::MAX).saturating_mul(2).max(1 << 20);
    // Numbers of bytes larger than needed do no harm: only what is needed is read.
    limits.intermediate_buffer_size = usize::MAX;
    decoder = decoder.with_limits(limits);
    let geo = Geo::read(&mut decoder);
    if let Some(text) = &geo.no_number {
        let message =
            format!("the tag GDAL_NODATA is {text}, which is no number: no samples were taken as holes by it");
        findings.push("W-tiff-nodata", Severity::Warning, Place::Whole, message);
    }
    let pieces = Pieces::check(&mut decoder, (columns, rows), kind.bits, length as u64, memory, findings)?;
    stopped.check()?;
    let raw = samples(&mut decoder, &pieces, &kind, (columns, rows), &geo, context, memory, findings);
    stopped.check()?;
    Ok(Image { raw: raw?, kind, size: (columns, rows), geo, decoder })
}

/// What the numbers of the file are.
struct Kind {
    channels: Channels,
    bits: u8,
    /// Unsigned whole numbers: what may be a picture.
    unsigned: bool,
    /// The larger the darker.
    inverted: bool,
}

impl Kind {
    fn of(decoder: &mut Decoder<Source<'_>>) -> Result<Self, Box<Fault>> {
        let color = decoder.colortype().map_err(told)?;
        let unsigned = !matches!(decoder.find_tag_unsigned_vec::<u16>(Tag::SampleFormat), Ok(Some(formats)) if formats.iter().any(|format| *format != 1));
        let number = |tag: Tag, decoder: &mut Decoder<_>| decoder.find_tag_unsigned::<u16>(tag).ok().flatten();
        let inverted = number(Tag::PhotometricInterpretation, decoder) == Some(0);
        let planar = number(Tag::PlanarConfiguration, decoder) == Some(2);
        let (channels, bits) = match color {
            ColorType::Gray(bits) => (Channels::Grey, bits),
            ColorType::Multiband { bit_depth, num_samples: 2 } | ColorType::GrayA(bit_depth) => {
                (Channels::GreyAlpha, bit_depth)
            }
            ColorType::RGB(bits) => (Channels::Rgb, bits),
            ColorType::RGBA(bits) => (Channels::Rgba, bits),
            other => return Err(unread(color_words(other), "one channel, or red, green and blue")),
        };
        let several = channels != Channels::Grey;
        let count = channels.count();
        if !several && !matches!(bits, 8 | 16 | 32 | 64) {
            return Err(unread(format!("one channel of {bits} bits"), "8, 16, 32 or 64 bits"));
        }
        if several && !matches!(bits, 8 | 16) {
            return Err(unread(format!("{count} channels of {bits} bits"), "8 or 16 bits, or one channel"));
        }
        if several && planar {
            return Err(unread(format!("{count} channels in planes"), "channels side by side, or one channel"));
        }
        if several && !unsigned {
            let found = format!("{count} channels of signed or floating numbers");
            return Err(unread(found, "unsigned numbers, or one channel"));
        }
        if inverted && (!unsigned || several || bits > 16) {
            let found = if several { "colours of which 0 is white" } else { "heights of which 0 is white" };
            return Err(unread(found.into(), "0 as the lowest"));
        }
        Ok(Self { channels, bits, unsigned, inverted })
    }

    fn pixel_bytes(&self) -> u64 {
        self.channels.count() as u64 * u64::from(self.bits) / 8
    }

    /// Whether samples are grey or colours, rather than heights as they are.
    fn is_picture(&self, geo: &Geo) -> bool {
        self.channels != Channels::Grey || (self.unsigned && self.bits <= 16 && !geo.is_said())
    }

    fn full(&self) -> u32 {
        if self.bits == 8 { 255 } else { 65535 }
    }
}

fn unread(found: String, expected: &str) -> Box<Fault> {
    Fault::new("E-tiff-feature", Place::Whole, found, expected).category(Category::Unsupported).within("image 0")
}

/// The number of each pixel, row by row; not a number for holes.
#[allow(clippy::too_many_arguments)]
fn samples(
    decoder: &mut Decoder<Source<'_>>,
    pieces: &Pieces,
    kind: &Kind,
    (columns, rows): (u32, u32),
    geo: &Geo,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    findings: &mut Findings,
) -> Result<Vec<f64>, ReadError> {
    let mut all = room(columns as usize * rows as usize, memory)?;
    all.resize(columns as usize * rows as usize, f64::NAN);
    let mut pixels = Pixels::try_new(context.options.encoding, kind.channels, kind.full(), columns)?;
    let Pieces { count, wide, high, .. } = *pieces;
    let across = if pieces.tiles { columns.div_ceil(wide.max(1)) } else { 1 };
    // One strip or tile at a time, before and after it is unpacked, and a row with what is beyond the border.
    let inside = 2u64.saturating_mul(wide.min(columns).into()).saturating_mul(high.min(rows).into());
    let bytes = inside.saturating_add(wide.into()).saturating_mul(kind.pixel_bytes());
    let _chunk = context.exec.reserve(bytes)?;
    for chunk in 0..count {
        context.exec.check()?;
        context.exec.progress(f64::from(chunk) / f64::from(count));
        let (left, top) = (u64::from(chunk % across) * u64::from(wide), u64::from(chunk / across) * u64::from(high));
        if top >= u64::from(rows) {
            break;
        }
        let (width, height) = decoder.chunk_data_dimensions(chunk);
        decoder.inner().end_at(pieces.end(chunk));
        let read = decoder.read_chunk(chunk).map_err(|error| match error {
            TiffError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => pieces.cut_off(chunk),
            other => told(other).within(format!("image 0, {} {chunk}", pieces.word())),
        })?;
        let mut place = |row: usize, column: usize, value: f64| {
            let (row, column) = (top as usize + row, left as usize + column);
            if column < columns as usize
                && let Some(slot) = all.get_mut(row * columns as usize + column)
            {
                *slot = value;
            }
        };
        let (width, height) = (width as usize, height as usize);
        if kind.channels == Channels::Grey {
            for (at, value) in values(&read, geo.no_data).take(width.saturating_mul(height)).enumerate() {
                if at % POLLED == 0 {
                    context.exec.check()?;
                }
                place(at / width.max(1), at % width.max(1), value);
            }
        } else {
            let channels = kind.channels.count();
            let mut pixel = [0u32; 4];
            let mut channel = 0;
            let numbers = width.saturating_mul(height).saturating_mul(channels);
            for (at, value) in values(&read, None).take(numbers).enumerate() {
                if at % POLLED == 0 {
                    context.exec.check()?;
                }
                pixel[channel] = value as u32;
                channel += 1;
                if channel == channels {
                    channel = 0;
                    let at = at / channels;
                    place(at / width.max(1), at % width.max(1), pixels.height(&pixel[..channels])?);
                }
            }
        }
    }
    decoder.inner().end_at(u64::MAX);
    pixels.finish(findings);
    Ok(all)
}

/// The numbers of a chunk as doubles, those without data as holes. Whole numbers beyond 2^53 are rounded.
fn values(read: &DecodingResult, no_data: Option<f64>) -> Box<dyn Iterator<Item = f64> + '_> {
    let or_hole = move |value: f64| if Some(value) == no_data { f64::NAN } else { value };
    match read {
        DecodingResult::U8(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::U16(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::U32(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::U64(values) => Box::new(values.iter().map(move |value| or_hole(*value as f64))),
        DecodingResult::I8(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::I16(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::I32(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(*value)))),
        DecodingResult::I64(values) => Box::new(values.iter().map(move |value| or_hole(*value as f64))),
        DecodingResult::F16(values) => Box::new(values.iter().map(move |value| or_hole(f64::from(f32::from(*value))))),
        DecodingResult::F32(values) => {
            // The tag is in decimals: the number meant is the nearest that samples can be.
            let no_data = no_data.map(|value| value as f32);
            Box::new(values.iter().map(move |value| if Some(*value) == no_data { f64::NAN } else { f64::from(*value) }))
        }
        DecodingResult::F64(values) => Box::new(values.iter().map(move |value| or_hole(*value))),
    }
}

fn placed(
    mut raw: Vec<f64>,
    kind: &Kind,
    (columns, rows): (u32, u32),
    geo: &Geo,
    context: &ReadContext,
    findings: &mut Findings,
) -> Result<shapeloom_shape::Shape, ReadError> {
    let options = &context.options;
    if let Some(odd) = geo.odd {
        let message = format!("the tags of GeoTIFF say {odd}: they were passed over");
        findings.push("W-tiff-grid", Severity::Warning, Place::Whole, message);
    }
    let known = geo.spacing.filter(|_| options.spacing == 0.0);
    let encoded = options.encoding != HeightEncoding::Grey;
    let picture = kind.is_picture(geo) || (kind.unsigned && kind.bits <= 16 && options.height != 0.0);
    let spacing = if picture && !encoded {
        let full = f64::from(kind.full());
        let distance = known.map(DVec2::max_element);
        let (height, distance) = picture_scale(full, columns, rows, distance, context, findings);
        raw.iter_mut().for_each(|value| *value = part_of(*value, full, height));
        known.unwrap_or(DVec2::splat(distance))
    } else {
        no_height(context, if encoded { "colours that encode metres" } else { "samples that are heights" })?;
        if kind.inverted {
            return Err(unread("heights of which 0 is white".into(), "0 as the lowest").into());
        }
        known.unwrap_or_else(|| DVec2::splat(guess_spacing(context, findings)))
    };
    if geo.degrees {
        let message = format!("places are in degrees: {DEGREES}");
        findings.push("W-heights-degrees", Severity::Warning, Place::Whole, message);
    }
    let corner = geo.north_west.filter(|_| known.is_some());
    let south_west = corner.map_or(DVec2::ZERO, |corner| {
        let half = if geo.points { DVec2::ZERO } else { DVec2::new(spacing.x, -spacing.y) / 2.0 };
        corner + half - DVec2::new(0.0, f64::from(rows - 1) * spacing.y)
    });
    let grid = NorthFirst { columns, rows, spacing, south_west, heights: raw };
    let mut shape = shape_of(grid.into_field(context, findings)?);
    shape.units = (geo.meters && known.is_some()).then_some(Units::METERS);
    Ok(shape)
}

pub(super) fn told(error: TiffError) -> Box<Fault> {
    let place = Place::Whole;
    let fault = match error {
        TiffError::FormatError(TiffFormatError::InconsistentSizesEncountered) => Fault::new(
            "E-tiff-strip",
            place,
            "tags of strips or tiles that contradict each other",
            "as many StripOffsets and StripByteCounts as strips by RowsPerStrip and ImageLength, or as many TileOffsets \
             and TileByteCounts as tiles",
        ),
        TiffError::FormatError(error) => Fault::new("E-tiff-data", place, error.to_string(), "a sound TIFF file"),
        TiffError::UnsupportedError(error) => {
            return unread(unsupported_words(error), "a kind of TIFF that is read");
        }
        TiffError::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => {
            Fault::new("E-tiff-truncated", place, "the end of the data", "all strips and tags")
        }
        TiffError::IoError(error) => Fault::new("E-tiff-data", place, error.to_string(), "sound compressed data"),
        // Sizes were checked: what does not fit is a number that lies.
        TiffError::LimitsExceeded | TiffError::IntSizeError => {
            Fault::new("E-tiff-claim", place, "a tag, strip or tile larger than the image", "parts within it")
        }
        TiffError::UsageError(error) => Fault::new("E-tiff-data", place, error.to_string(), "a sound TIFF file"),
    };
    fault.within("image 0")
}
