//! PNG heights, read and written, against the encoder and decoder of the `image` crate.

use image::{DynamicImage, GrayAlphaImage, GrayImage, ImageBuffer, ImageFormat, Luma, LumaA, Rgb, RgbImage, RgbaImage};
use png::{BitDepth, ColorType};
use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Affine, Deviation, Diagnostic, Exec, Place, Report};
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Part, Representation, Shape, Units, UpAxis};

use super::FORMAT;
use crate::{HeightEncoding, ReadContext, ReadError, ReadOptions, ReadShape, WriteContext};

fn read_with(input: &[u8], options: ReadOptions) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(8 << 20);
    crate::read(input, &FORMAT, &ReadContext { options, exec, ..ReadContext::named("x.png") })
}

fn read_high(input: &[u8], height: f64) -> Result<ReadShape, ReadError> {
    read_with(input, ReadOptions { height, ..ReadOptions::new() })
}

/// The heights with the northern row first, as pictures have them.
fn rows(read: &ReadShape) -> Vec<f64> {
    let field = HeightField::from_geometry(&read.shape.parts[0].geometry).unwrap();
    field.heights().chunks(field.columns() as usize).rev().flatten().copied().collect()
}

fn codes(read: &ReadShape) -> Vec<&'static str> {
    read.findings.iter().map(|finding| finding.code).collect()
}

fn encoded(picture: impl Into<DynamicImage>) -> Vec<u8> {
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.into().write_to(&mut bytes, ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// Rows of packed samples of any depth.
fn packed(
    columns: u32,
    height: u32,
    color: ColorType,
    depth: BitDepth,
    palette: Option<&[u8]>,
    data: &[u8],
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns, height);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if let Some(palette) = palette {
        encoder.set_palette(palette.to_vec());
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(data).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn every_kind_of_grey_is_read_exactly() {
    let byte = |x: u32, y: u32| (x * 7 + y * 50) as u8;
    let word = |x: u32, y: u32| (x * 300 + y * 9001) as u16;
    let bytes: Vec<f64> = (0..15).map(|i| f64::from(byte(i % 5, i / 5))).collect();
    let words: Vec<f64> = (0..15).map(|i| f64::from(word(i % 5, i / 5))).collect();
    let grey = GrayImage::from_fn(5, 3, |x, y| Luma([byte(x, y)]));
    assert_eq!(rows(&read_high(&encoded(grey), 255.0).unwrap()), bytes);
    let deep = ImageBuffer::from_fn(5, 3, |x, y| Luma([word(x, y)]));
    assert_eq!(rows(&read_high(&encoded(deep), 65535.0).unwrap()), words);
    let colored = RgbImage::from_fn(5, 3, |x, y| Rgb([byte(x, y); 3]));
    let read = read_high(&encoded(colored), 255.0).unwrap();
    assert_eq!((rows(&read), codes(&read)), (bytes.clone(), vec!["W-heights-grey"]));
    let deep = ImageBuffer::from_fn(5, 3, |x, y| Rgb([word(x, y); 3]));
    assert_eq!(rows(&read_high(&encoded(DynamicImage::ImageRgb16(deep)), 65535.0).unwrap()), words);
    let holes = GrayAlphaImage::from_fn(5, 3, |x, y| LumaA([byte(x, y), if x == 2 { 0 } else { 255 }]));
    let read = read_high(&encoded(holes), 255.0).unwrap();
    for (at, (found, wanted)) in rows(&read).into_iter().zip(bytes).enumerate() {
        assert!(if at % 5 == 2 { found.is_nan() } else { found == wanted });
    }
    assert_eq!(codes(&read), ["W-heights-holes"]);
}

#[test]
fn few_bits_and_palettes_are_read_exactly() {
    // 0 1 2 3 / 3 2 1 0 in two bits.
    let two = packed(4, 2, ColorType::Grayscale, BitDepth::Two, None, &[0b0001_1011, 0b1110_0100]);
    assert_eq!(rows(&read_high(&two, 3.0).unwrap()), [0.0, 1.0, 2.0, 3.0, 3.0, 2.0, 1.0, 0.0]);
    let one = packed(3, 2, ColorType::Grayscale, BitDepth::One, None, &[0b0100_0000, 0b1010_0000]);
    assert_eq!(rows(&read_high(&one, 1.0).unwrap()), [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    let four = packed(2, 2, ColorType::Grayscale, BitDepth::Four, None, &[0x0f, 0x37]);
    assert_eq!(rows(&read_high(&four, 15.0).unwrap()), [0.0, 15.0, 3.0, 7.0]);
    let palette = [9, 9, 9, 200, 200, 200, 17, 17, 17];
    let indexed = packed(2, 2, ColorType::Indexed, BitDepth::Eight, Some(&palette), &[2, 1, 0, 1]);
    assert_eq!(rows(&read_high(&indexed, 255.0).unwrap()), [17.0, 200.0, 9.0, 200.0]);
    let colors = packed(2, 2, ColorType::Indexed, BitDepth::Eight, Some(&[9, 9, 8, 1, 1, 1]), &[1, 1, 0, 1]);
    let error = read_high(&colors, 255.0).unwrap_err();
    assert!(error.code() == "E-heights-channels" && error.to_string().contains("row 1, column 0"), "{error}");
}

#[test]
fn interlaced_pictures_are_the_same() {
    // Of Adam7 the first pass of a picture of 2 × 2 has one pixel, the sixth and the seventh have the others.
    let mut data = Vec::new();
    for pass in [&[0u8, 10][..], &[0, 20], &[0, 30, 40]] {
        data.extend_from_slice(pass);
    }
    // A stored block of deflate, in the frame of zlib.
    let mut body = vec![0x78, 1, 1, data.len() as u8, 0, !(data.len() as u8), 0xff];
    body.extend_from_slice(&data);
    let sums = data.iter().fold((1u32, 0u32), |(a, b), byte| {
        let a = (a + u32::from(*byte)) % 65521;
        (a, (b + a) % 65521)
    });
    body.extend((sums.1 << 16 | sums.0).to_be_bytes());
    let file = file(&[(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, 8, 0, 0, 0, 1]), (b"IDAT", &body), (b"IEND", &[])]);
    assert_eq!(rows(&read_high(&file, 255.0).unwrap()), [10.0, 20.0, 30.0, 40.0]);
}

/// A file of chunks with sound sums.
fn file(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
    let mut bytes = super::chunks::SIGNATURE.to_vec();
    for (kind, body) in chunks {
        bytes.extend((body.len() as u32).to_be_bytes());
        let start = bytes.len();
        bytes.extend(*kind);
        bytes.extend(*body);
        bytes.extend(crc32fast::hash(&bytes[start..]).to_be_bytes());
    }
    bytes
}

#[test]
fn what_is_guessed_is_said_and_what_is_said_is_not_guessed() {
    let ramp = encoded(GrayImage::from_fn(21, 3, |x, _| Luma([if x == 20 { 255 } else { 0 }])));
    let guessed = read_with(&ramp, ReadOptions::new()).unwrap();
    assert_eq!((rows(&guessed)[20], codes(&guessed)), (2.0, vec!["W-heights-scale"]));
    let options = ReadOptions { spacing: 0.5, ..ReadOptions::new() };
    assert_eq!(rows(&read_with(&ramp, options).unwrap())[20], 1.0);
    let options = ReadOptions { height: -120.0, spacing: 30.0, exaggeration: 2.0, ..ReadOptions::new() };
    let said = read_with(&ramp, options).unwrap();
    assert_eq!((rows(&said)[20], codes(&said).len()), (-240.0, 0));
    assert_eq!(said.shape.bounds().max, DVec3::new(600.0, 60.0, 0.0));
    for options in [
        ReadOptions { height: f64::NAN, ..ReadOptions::new() },
        ReadOptions { spacing: -1.0, ..ReadOptions::new() },
        ReadOptions { exaggeration: f64::INFINITY, ..ReadOptions::new() },
    ] {
        assert_eq!(read_with(&ramp, options).unwrap_err().code(), "E-heights-option");
    }
    let far = ReadOptions { height: 1e300, exaggeration: 1e300, ..ReadOptions::new() };
    assert_eq!(read_with(&ramp, far.clone()).unwrap_err().code(), "E-heights-finite");
    let dropped = read_with(&ramp, ReadOptions { drop_non_finite: true, ..far }).unwrap();
    assert_eq!(codes(&dropped), ["W-read-dropped", "W-heights-holes"]);
}

#[test]
fn terrain_tiles_are_read_by_their_encoding() {
    let tile = encoded(RgbaImage::from_fn(2, 2, |x, y| image::Rgba([1, 134, (x + 2 * y) as u8, 255])));
    let options = |encoding| ReadOptions { encoding, spacing: 9.0, ..ReadOptions::new() };
    let read = read_with(&tile, options(HeightEncoding::Mapbox)).unwrap();
    assert_eq!(rows(&read), [-16.0, -15.9, -15.8, -15.7]);
    let read = read_with(&tile, options(HeightEncoding::Terrarium)).unwrap();
    assert_eq!(rows(&read)[1], 256.0 + 134.0 + 1.0 / 256.0 - 32768.0);
    assert_eq!(read_with(&tile, ReadOptions::new()).unwrap_err().code(), "E-heights-channels");
    let both = ReadOptions { height: 3.0, ..options(HeightEncoding::Mapbox) };
    assert_eq!(read_with(&tile, both).unwrap_err().code(), "E-heights-option");
    let unsaid = ReadOptions { spacing: 0.0, ..options(HeightEncoding::Mapbox) };
    assert_eq!(codes(&read_with(&tile, unsaid).unwrap())[0], "W-heights-spacing");
}

fn written(shape: &Shape) -> (Vec<u8>, Report) {
    let mut bytes = Vec::new();
    let report = crate::write(shape, &FORMAT, &WriteContext::default(), &mut bytes).unwrap();
    (bytes, report)
}

fn hills() -> HeightField {
    let heights = (0..63).map(|i| f64::from(i % 9).sin() * 700.0 + f64::from(i / 9) * 31.7 - 200.0).collect();
    HeightField::try_new(9, 7, DVec2::new(30.0, 20.0), heights).unwrap()
}

#[test]
fn heights_come_back_within_half_a_step() {
    let mut with_hole = hills().heights().to_vec();
    with_hole[11] = f64::NAN;
    let holed = HeightField::try_new(9, 7, DVec2::new(30.0, 20.0), with_hole).unwrap();
    let flat = HeightField::try_new(2, 2, DVec2::ONE, vec![-3.25; 4]).unwrap();
    let tiny = HeightField::try_new(2, 2, DVec2::ONE, vec![0.0, 5e-324, 1e-323, 0.0]).unwrap();
    let offset = HeightField::try_new(2, 2, DVec2::ONE, vec![5e6, 5e6 + 1e-7, 5e6 + 1.0, 5e6]).unwrap();
    for (field, exact) in [(hills(), false), (holed, false), (flat, true), (tiny, false), (offset, false)] {
        let up = Some(UpAxis::Z);
        let shape = Shape { up, units: Some(Units::METERS), ..Shape::new(Part::new(field.clone())) };
        let (bytes, report) = written(&shape);
        assert!(report.losses.is_empty(), "{:?}", report.losses);
        let again = read_with(&bytes, ReadOptions::new()).unwrap();
        let found = HeightField::from_geometry(&again.shape.parts[0].geometry).unwrap();
        assert_eq!((found.spacing(), again.shape.units), (field.spacing(), shape.units));
        let moved = field.heights().iter().zip(found.heights()).map(|(wanted, found)| {
            assert_eq!(wanted.is_nan(), found.is_nan());
            if wanted.is_nan() { 0.0 } else { (wanted - found).abs() }
        });
        let moved = moved.fold(0.0, f64::max);
        assert!(report.deviation.is_within(f64::MAX) && moved <= report.deviation.value().unwrap(), "{moved}");
        assert_eq!(report.deviation == Deviation::Exact, exact);
        assert!(codes(&again).iter().all(|code| *code == "W-heights-holes"), "{:?}", codes(&again));
        // What has been through whole numbers once stays as it is, but for rounding.
        let picture = |bytes: &[u8]| image::load_from_memory(bytes).unwrap().to_luma_alpha16();
        assert_eq!(picture(&written(&again.shape).0), picture(&bytes));
    }
}

#[test]
fn another_decoder_sees_the_same_picture() {
    let (bytes, report) = written(&Shape::new(Part::new(hills())));
    let picture = image::load_from_memory(&bytes).unwrap().into_luma16();
    assert_eq!(picture.dimensions(), (9, 7));
    let field = hills();
    let (low, step) = (report.find("lowest").unwrap(), report.find("step").unwrap());
    for (x, y, pixel) in picture.enumerate_pixels() {
        let height = field.sample(x, 6 - y).unwrap().z;
        assert!((low + f64::from(pixel.0[0]) * step - height).abs() <= 0.5 * step * (1.0 + 1e-9));
    }
    assert!(picture.pixels().any(|pixel| pixel.0[0] == 0) && picture.pixels().any(|pixel| pixel.0[0] == 65535));
    let said: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    assert_eq!(said, ["distance of samples (30, 20)"]);
    let moved = hills().placed(Affine::from_translation(DVec3::new(7.0, 8.0, 9.0)));
    let shape = Shape { units: Some(Units::INCHES), ..Shape::new(Part::new(moved)) };
    let (bytes, report) = written(&shape);
    assert_eq!(report.losses.len(), 3, "{:?}", report.losses);
    let again = rows(&read_with(&bytes, ReadOptions::new()).unwrap());
    assert!((again[0] - (hills().sample(0, 6).unwrap().z + 9.0)).abs() < 0.02);
}

#[test]
fn defects_are_told_with_their_chunk() {
    let sound = encoded(GrayImage::from_fn(4, 4, |x, y| Luma([(x * y) as u8])));
    assert!(read_high(&sound, 1.0).is_ok());
    for end in 0..sound.len() {
        assert_eq!(read_high(&sound[..end], 1.0).unwrap_err().code(), "E-png-truncated", "{end}");
    }
    let header = |body: &[u8]| file(&[(b"IHDR", body), (b"IDAT", &[0x78, 1, 3, 0, 0, 0, 0, 1]), (b"IEND", &[])]);
    for (input, code, within) in [
        (header(&[0, 0, 0, 1, 0, 0, 0, 9, 8, 0, 0, 0, 0]), "E-heights-size", "chunk IHDR"),
        (header(&[0, 0, 9, 9, 0, 0, 9, 9, 8, 0, 0, 0, 0]), "E-png-claim", "chunk IHDR"),
        (header(&[0, 9, 9, 9, 0, 9, 9, 9, 8, 0, 0, 0, 0]), "E-heights-limit", "chunk IHDR"),
        (header(&[0, 0, 0, 9, 0, 0, 0, 9, 3, 0, 0, 0, 0]), "E-png-header", "chunk IHDR"),
        (header(&[0, 0, 0, 9, 0, 0, 0, 9, 8, 0, 1, 0, 0]), "E-png-header", "chunk IHDR"),
        (header(&[0, 0, 0, 9]), "E-png-header", "chunk IHDR"),
        (header(&[0, 0, 0, 9, 0, 0, 0, 9, 8, 0, 0, 0, 0]), "E-png-truncated", "chunk IDAT"),
        (file(&[(b"IDAT", &[]), (b"IEND", &[])]), "E-png-order", "chunk IDAT"),
        (
            file(&[(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 2, 8, 0, 0, 0, 0]), (b"IDAT", &[1, 2, 3, 4]), (b"IEND", &[])]),
            "E-png-data",
            "chunk IDAT",
        ),
    ] {
        let error = read_high(&input, 1.0).unwrap_err();
        let fault = error.fault().unwrap();
        assert_eq!((fault.code, fault.within.as_deref()), (code, Some(within)), "{error}");
        assert!(matches!(fault.place, Place::Byte(_)) && error.advice().is_some(), "{error}");
    }
    // One bit of a sum: of what is needed, and of what is not.
    let patched = |mut bytes: Vec<u8>, kind: &[u8]| {
        let at = bytes.windows(4).position(|found| found == kind).unwrap();
        let length = u32::from_be_bytes([0, 0, bytes[at - 2], bytes[at - 1]]) as usize;
        bytes[at + 4 + length] ^= 1;
        read_high(&bytes, 1.0)
    };
    for kind in [&b"IHDR"[..], b"IDAT", b"IEND"] {
        let error = patched(sound.clone(), kind).unwrap_err();
        let wanted = format!("chunk {}", String::from_utf8_lossy(kind));
        assert_eq!((error.code(), error.fault().unwrap().within.clone()), ("E-png-checksum", Some(wanted)));
    }
    let (calibrated, _) = written(&Shape::new(Part::new(hills())));
    assert_eq!(codes(&patched(calibrated, b"pCAL").unwrap()), ["W-png-checksum"]);
    let mut trailing = sound.clone();
    trailing.extend(b"more");
    assert_eq!(codes(&read_high(&trailing, 1.0).unwrap()), ["W-png-trailing"]);
}
