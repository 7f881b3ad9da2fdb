//! TIFF heights, against files laid down by hand and by the encoder of the `tiff` crate.

use std::io::Cursor;

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Diagnostic, Exec};
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Representation, Units};
use tiff::encoder::colortype::{ColorType, Gray8, Gray16, Gray32Float, Gray64Float, GrayI16, GrayI32, RGB8};
use tiff::encoder::{Compression, TiffEncoder, TiffValue};
use tiff::tags::Tag;

use super::FORMAT;
use crate::{HeightEncoding, ReadContext, ReadError, ReadOptions, ReadShape};

pub(super) fn read_with(input: &[u8], options: ReadOptions) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(8 << 20);
    crate::read(input, &FORMAT, &ReadContext { options, exec, ..ReadContext::named("x.tif") })
}

fn plain(input: &[u8]) -> ReadShape {
    read_with(input, ReadOptions::new()).unwrap_or_else(|error| panic!("{error}"))
}

/// The heights with the northern row first, as pictures have them.
pub(super) fn rows(read: &ReadShape) -> Vec<f64> {
    let field = HeightField::from_geometry(&read.shape.parts[0].geometry).unwrap();
    field.heights().chunks(field.columns() as usize).rev().flatten().copied().collect()
}

pub(super) fn codes(read: &ReadShape) -> Vec<&'static str> {
    read.findings.iter().map(|finding| finding.code).collect()
}

pub(super) type Tags<'a> = &'a [(u16, &'a [f64])];

/// A file of the encoder, 3 × 2, with tags of doubles.
pub(super) fn encoded<C: ColorType>(
    data: &[C::Inner],
    compression: Compression,
    tags: Tags<'_>,
    no_data: Option<&str>,
) -> Vec<u8>
where
    [C::Inner]: TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression);
    let mut image = encoder.new_image::<C>(3, 2).unwrap();
    for (tag, values) in tags {
        image.encoder().write_tag(Tag::Unknown(*tag), *values).unwrap();
    }
    if let Some(text) = no_data {
        image.encoder().write_tag(Tag::GdalNodata, text).unwrap();
    }
    image.write_data(data).unwrap();
    bytes.into_inner()
}

#[test]
fn every_kind_of_number_is_read_exactly() {
    let high = |height| ReadOptions { height, ..ReadOptions::new() };
    for compression in [Compression::Uncompressed, Compression::Lzw, Compression::Deflate(Default::default())] {
        let small = encoded::<Gray8>(&[0, 1, 2, 253, 254, 255], compression, &[], None);
        assert_eq!(rows(&read_with(&small, high(255.0)).unwrap()), [0.0, 1.0, 2.0, 253.0, 254.0, 255.0]);
        let deep = encoded::<Gray16>(&[0, 1, 256, 65535, 77, 9], compression, &[], None);
        assert_eq!(rows(&read_with(&deep, high(65535.0)).unwrap()), [0.0, 1.0, 256.0, 65535.0, 77.0, 9.0]);
        let signed = encoded::<GrayI16>(&[-32768, -1, 0, 1, 2, 32767], compression, &[], None);
        assert_eq!(rows(&plain(&signed)), [-32768.0, -1.0, 0.0, 1.0, 2.0, 32767.0]);
        let long = encoded::<GrayI32>(&[i32::MIN, -1, 0, 1, 2, i32::MAX], compression, &[], None);
        assert_eq!(rows(&plain(&long))[5], f64::from(i32::MAX));
        let single = encoded::<Gray32Float>(&[0.1, -2.5, 1e38, 0.0, 1.0, 2.0], compression, &[], None);
        assert_eq!(rows(&plain(&single))[..3], [f64::from(0.1f32), -2.5, f64::from(1e38f32)]);
        let double = encoded::<Gray64Float>(&[0.1, -2.5, 1e300, 0.0, 1.0, 2.0], compression, &[], None);
        assert_eq!(rows(&plain(&double))[..3], [0.1, -2.5, 1e300]);
    }
}

/// Tags laid down by hand: 3 × 2 samples, in either byte order.
pub(super) fn by_hand(big: bool, depth: u16, format: u16, data: &[u8]) -> Vec<u8> {
    let word = |value: u16| if big { value.to_be_bytes() } else { value.to_le_bytes() };
    let long = |value: u32| if big { value.to_be_bytes() } else { value.to_le_bytes() };
    let mut bytes = if big { b"MM\0*\0\0\0\x08".to_vec() } else { b"II*\0\x08\0\0\0".to_vec() };
    let tags: [(u16, u32); 10] = [
        (256, 3),
        (257, 2),
        (258, depth.into()),
        (259, 1),
        (262, 1),
        (273, 8 + 2 + 10 * 12 + 4),
        (277, 1),
        (278, 2),
        (279, data.len() as u32),
        (339, format.into()),
    ];
    bytes.extend(word(10));
    for (tag, value) in tags {
        bytes.extend(word(tag));
        // Long numbers, one each.
        bytes.extend(word(4));
        bytes.extend(long(1));
        bytes.extend(long(value));
    }
    bytes.extend(long(0));
    bytes.extend(data);
    bytes
}

#[test]
fn both_byte_orders_say_the_same() {
    let words = [1u16, 2, 3, 40_000, 5, 65535];
    let options = ReadOptions { height: 65535.0, ..ReadOptions::new() };
    let read = |big, data: Vec<u8>| rows(&read_with(&by_hand(big, 16, 1, &data), options.clone()).unwrap());
    let wanted = words.map(f64::from);
    assert_eq!(read(true, words.iter().flat_map(|word| word.to_be_bytes()).collect()), wanted);
    assert_eq!(read(false, words.iter().flat_map(|word| word.to_le_bytes()).collect()), wanted);
    let singles = [0.5f32, -1.0, f32::NAN, 3e-40, 1e38, 7.0];
    let big: Vec<u8> = singles.iter().flat_map(|single| single.to_be_bytes()).collect();
    let found = plain(&by_hand(true, 32, 3, &big));
    assert!(rows(&found)[2].is_nan() && rows(&found)[3] == f64::from(3e-40f32));
    assert_eq!(codes(&found), ["W-heights-spacing", "W-heights-holes"]);
    let infinite: Vec<u8> = [1.0f32, 2.0, f32::INFINITY, 3.0, 4.0, 5.0].iter().flat_map(|n| n.to_le_bytes()).collect();
    let infinite = by_hand(false, 32, 3, &infinite);
    assert_eq!(read_with(&infinite, ReadOptions::new()).unwrap_err().code(), "E-heights-finite");
    let dropped = read_with(&infinite, ReadOptions { drop_non_finite: true, ..ReadOptions::new() }).unwrap();
    assert!(rows(&dropped)[2].is_nan());
}

#[test]
fn tags_of_places_are_heeded() {
    let scale: (u16, &[f64]) = (33550, &[30.0, 20.0, 0.0]);
    let tie: (u16, &[f64]) = (33922, &[0.0, 0.0, 0.0, 500_000.0, 5e6, 0.0]);
    let data = [5, -32768, 7, 8, 9, 10];
    let read = plain(&encoded::<GrayI16>(&data, Compression::Uncompressed, &[scale, tie], Some("-32768")));
    let field = HeightField::from_geometry(&read.shape.parts[0].geometry).unwrap();
    assert_eq!(field.spacing(), DVec2::new(30.0, 20.0));
    // Middles of pixels: half a step to the east and south of the corner.
    assert_eq!(field.sample(0, 1), Some(DVec3::new(500_015.0, 4_999_990.0, 5.0)));
    assert_eq!(field.sample(2, 0), Some(DVec3::new(500_075.0, 4_999_970.0, 10.0)));
    assert_eq!(field.sample(1, 1), None);
    assert_eq!(codes(&read), ["W-heights-holes"]);
    // The tag is in decimals of another length than the samples; the place is told by another pixel.
    let data = [0.25f32, -3.4e38, 1.0, 2.0, 3.0, 4.0];
    let inner: (u16, &[f64]) = (33922, &[1.0, 1.0, 0.0, 500_030.0, 4_999_980.0, 0.0]);
    let no_data = Some("-3.39999999999999996e+38");
    let floats = plain(&encoded::<Gray32Float>(&data, Compression::Uncompressed, &[scale, inner], no_data));
    let floats = HeightField::from_geometry(&floats.shape.parts[0].geometry).unwrap().clone();
    assert_eq!((floats.placement(), floats.sample(1, 1)), (field.placement(), None));
    assert_eq!(floats.sample(0, 1), Some(DVec3::new(500_015.0, 4_999_990.0, 0.25)));
    // Samples of a file that says where it is are heights, unless an option makes them a picture.
    let said = encoded::<Gray16>(&[5, 6, 7, 8, 9, 65535], Compression::Uncompressed, &[scale], None);
    assert_eq!(rows(&plain(&said))[5], 65535.0);
    let picture = read_with(&said, ReadOptions { height: 10.0, ..ReadOptions::new() }).unwrap();
    assert_eq!((rows(&picture)[5], codes(&picture).len()), (10.0, 0));
    let heights = encoded::<GrayI16>(&[5; 6], Compression::Uncompressed, &[scale], None);
    let error = read_with(&heights, ReadOptions { height: 10.0, ..ReadOptions::new() }).unwrap_err();
    assert_eq!(error.code(), "E-heights-option");
    // A matrix from samples to places.
    let mut matrix = [0.0; 16];
    (matrix[0], matrix[5], matrix[3], matrix[7], matrix[15]) = (2.0, -3.0, 100.0, 200.0, 1.0);
    let mapped = plain(&encoded::<GrayI16>(&[5; 6], Compression::Uncompressed, &[(34264, &matrix)], None));
    let field = HeightField::from_geometry(&mapped.shape.parts[0].geometry).unwrap();
    assert_eq!(field.sample(0, 1), Some(DVec3::new(101.0, 198.5, 5.0)));
    matrix[1] = 0.5;
    let turned = plain(&encoded::<GrayI16>(&[5; 6], Compression::Uncompressed, &[(34264, &matrix)], None));
    assert!(codes(&turned).contains(&"W-tiff-grid"));
}

#[test]
fn keys_say_units_and_what_samples_are() {
    let scale = [0.5, 0.5, 0.0];
    let tie = [0.0, 0.0, 0.0, 10.0, 50.0, 0.0];
    let with = |keys: &[u16]| {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
        let mut image = encoder.new_image::<GrayI16>(3, 2).unwrap();
        image.encoder().write_tag(Tag::Unknown(33550), &scale[..]).unwrap();
        image.encoder().write_tag(Tag::Unknown(33922), &tie[..]).unwrap();
        image.encoder().write_tag(Tag::Unknown(34735), keys).unwrap();
        image.write_data(&[0, 1, 2, 3, 4, 5]).unwrap();
        plain(&bytes.into_inner())
    };
    let metres = with(&[1, 1, 0, 2, 1024, 0, 1, 1, 3076, 0, 1, 9001]);
    assert_eq!((metres.shape.units, codes(&metres).len()), (Some(Units::METERS), 0));
    assert_eq!(metres.shape.bounds().min, DVec3::new(10.25, 49.25, 0.0));
    let degrees = with(&[1, 1, 0, 2, 1024, 0, 1, 2, 1025, 0, 1, 2]);
    assert_eq!((degrees.shape.units, codes(&degrees)), (None, vec!["W-heights-degrees"]));
    // Points are where the tag says.
    assert_eq!(degrees.shape.bounds().min, DVec3::new(10.0, 49.5, 0.0));
}

#[test]
fn colours_are_heights_only_by_an_encoding() {
    let data: Vec<u8> = (0..6).flat_map(|i| [1, 134, 160 + i]).collect();
    let tile = encoded::<RGB8>(&data, Compression::Uncompressed, &[], None);
    let error = read_with(&tile, ReadOptions::new()).unwrap_err();
    assert_eq!(error.code(), "E-heights-channels");
    let options = ReadOptions { encoding: HeightEncoding::Mapbox, ..ReadOptions::new() };
    let read = read_with(&tile, options).unwrap();
    for (at, height) in rows(&read).into_iter().enumerate() {
        assert!((height - at as f64 / 10.0).abs() < 1e-11);
    }
    let grey: Vec<u8> = (0..6).flat_map(|i| [40 * i; 3]).collect();
    let grey = encoded::<RGB8>(&grey, Compression::Uncompressed, &[], None);
    let read = read_with(&grey, ReadOptions { height: 255.0, ..ReadOptions::new() }).unwrap();
    assert_eq!((rows(&read)[5], codes(&read)), (200.0, vec!["W-heights-grey"]));
}

#[test]
fn tiles_are_put_together() {
    // Four tiles of 16 × 16 of a picture of 20 × 18, each full of its number: what is beyond the picture has 99.
    let (long, mut data) = (|value: u32| value.to_le_bytes(), Vec::new());
    for tile in 0..4u32 {
        for at in 0..256u32 {
            let (x, y) = (tile % 2 * 16 + at % 16, tile / 2 * 16 + at / 16);
            data.push(if x < 20 && y < 18 { (x + y) as u8 } else { 99 });
        }
    }
    let first = 8 + 2 + 10 * 12 + 4;
    let tags: [(u16, u32, u32); 10] = [
        (256, 1, 20),
        (257, 1, 18),
        (258, 1, 8),
        (259, 1, 1),
        (262, 1, 1),
        (277, 1, 1),
        (322, 1, 16),
        (323, 1, 16),
        (324, 4, first),
        (325, 4, first + 16),
    ];
    let mut bytes = b"II*\0\x08\0\0\0\x0a\0".to_vec();
    for (tag, count, value) in tags {
        bytes.extend(tag.to_le_bytes());
        bytes.extend([4, 0]);
        bytes.extend(long(count));
        bytes.extend(long(value));
    }
    bytes.extend(long(0));
    (0..4).for_each(|tile| bytes.extend(long(first + 32 + 256 * tile)));
    (0..4).for_each(|_| bytes.extend(long(256)));
    bytes.extend(data);
    let read = read_with(&bytes, ReadOptions { height: 255.0, ..ReadOptions::new() }).unwrap();
    for (at, height) in rows(&read).into_iter().enumerate() {
        assert_eq!(height, (at % 20 + at / 20) as f64, "{at}");
    }
}

#[test]
fn defects_are_refused_before_anything_is_made() {
    let sound = encoded::<Gray16>(&[0, 1, 256, 65535, 77, 9], Compression::Uncompressed, &[], None);
    for end in 0..sound.len() {
        match read_with(&sound[..end], ReadOptions::new()) {
            Ok(_) => panic!("{end}"),
            Err(error) => {
                assert!(error.code().split('-').nth(1) == Some("tiff") && error.advice().is_some(), "{end}: {error}")
            }
        }
    }
    let patched = |tag: u16, value: u32| {
        let mut bytes = by_hand(false, 16, 1, &[0; 12]);
        let at = (10..).step_by(12).find(|at| bytes[*at..*at + 2] == tag.to_le_bytes()).unwrap();
        bytes[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
        read_with(&bytes, ReadOptions::new()).err().map(|error| error.code())
    };
    assert_eq!(patched(256, 3), None);
    assert_eq!(patched(256, 1), Some("E-heights-size"));
    assert_eq!(patched(256, 100_000), Some("E-tiff-claim"));
    assert_eq!(patched(256, 4_000_000_000), Some("E-heights-limit"));
    assert_eq!(patched(258, 12), Some("E-tiff-feature"));
    assert_eq!(patched(259, 50_000), Some("E-tiff-feature"));
    assert_eq!(patched(262, 3), Some("E-tiff-feature"));
    assert!(patched(273, 1 << 30).is_some());
}
