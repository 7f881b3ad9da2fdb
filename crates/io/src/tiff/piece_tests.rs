//! Tags that lie about strips, tiles and samples: where strips are, how many rows and bytes they have, and what is no number.

use std::io::Cursor;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use shapeloom_core::{Category, Diagnostic, Exec, Stop};
use tiff::encoder::colortype::{Gray8, Gray16};
use tiff::encoder::{Compression, TiffEncoder};

use super::FORMAT;
use super::tests::{by_hand, codes, encoded, read_with, rows};
use crate::{ReadContext, ReadError, ReadOptions, ReadShape};

const BITS: u16 = 258;
const COMPRESSION: u16 = 259;
const INTERPRETATION: u16 = 262;
const OFFSETS: u16 = 273;
const CHANNELS: u16 = 277;
const ROWS: u16 = 278;
const LENGTHS: u16 = 279;
const PLANES: u16 = 284;
const FORMATS: u16 = 339;

/// Where the entry of a tag is, in a file in low bytes first.
fn entry(bytes: &[u8], tag: u16) -> usize {
    let start = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]) as usize;
    let count = usize::from(u16::from_le_bytes([bytes[start], bytes[start + 1]]));
    let at = (0..count).map(|entry| start + 2 + 12 * entry).find(|at| bytes[*at..*at + 2] == tag.to_le_bytes());
    at.unwrap_or_else(|| panic!("no tag {tag}"))
}

/// The same file with another single number for a tag.
fn patched(bytes: &[u8], tag: u16, value: u32) -> Vec<u8> {
    let at = entry(bytes, tag);
    let mut bytes = bytes.to_vec();
    bytes[at + 2..at + 8].copy_from_slice(&[4, 0, 1, 0, 0, 0]);
    bytes[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
    bytes
}

/// The single number of a tag, of two or four bytes with zeros behind.
fn number(bytes: &[u8], tag: u16) -> u32 {
    let at = entry(bytes, tag) + 8;
    u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
}

fn white(bytes: &[u8]) -> Result<ReadShape, ReadError> {
    read_with(bytes, ReadOptions { height: 65535.0, ..ReadOptions::new() })
}

fn plain() -> Vec<u8> {
    by_hand(false, 16, 1, &[1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0])
}

#[test]
fn strips_that_are_not_there_are_malformed_and_named() {
    let whole = plain();
    let end = whole.len() as u32;
    for (tag, value, named) in [
        (OFFSETS, 0, "strip 0, StripOffsets"),
        (OFFSETS, 7, "strip 0, StripOffsets"),
        (OFFSETS, end, "strip 0, StripOffsets"),
        (OFFSETS, end - 11, "strip 0, StripOffsets"),
        (OFFSETS, 1 << 30, "strip 0, StripOffsets"),
        (OFFSETS, u32::MAX, "strip 0, StripOffsets"),
        (LENGTHS, 0, "strip 0, StripByteCounts"),
        (LENGTHS, 11, "strip 0, StripByteCounts"),
        (ROWS, 0, "RowsPerStrip"),
        (ROWS, 1, "RowsPerStrip"),
    ] {
        let error = white(&patched(&whole, tag, value)).unwrap_err();
        assert_eq!((error.code(), error.category()), ("E-tiff-strip", Category::Malformed), "{tag} {value}: {error}");
        assert!(error.to_string().contains(named) && error.advice().is_some(), "{tag} {value}: {error}");
    }
}

#[test]
fn generous_numbers_are_read() {
    let whole = plain();
    let heights = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    for (tag, value, code) in [
        (ROWS, 2, None),
        (ROWS, 3, None),
        (ROWS, u32::MAX, None),
        (LENGTHS, 13, Some("W-tiff-strip")),
        (LENGTHS, u32::MAX, Some("W-tiff-strip")),
    ] {
        let read = white(&patched(&whole, tag, value)).unwrap_or_else(|error| panic!("{tag} {value}: {error}"));
        assert_eq!((rows(&read), codes(&read).first().copied()), (heights.to_vec(), code), "{tag} {value}");
    }
    // The length of a buffer, within the file.
    let mut padded = patched(&whole, LENGTHS, 40);
    padded.extend([9; 28]);
    let read = white(&padded).unwrap();
    assert_eq!((rows(&read), codes(&read).len()), (heights.to_vec(), 0));
}

#[test]
fn compressed_strips_are_checked_too() {
    for compression in [Compression::Lzw, Compression::Deflate(Default::default()), Compression::Packbits] {
        let mut whole = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut whole).unwrap().with_compression(compression);
        let mut image = encoder.new_image::<Gray16>(3, 2).unwrap();
        image.rows_per_strip(2).unwrap();
        image.write_data(&[1, 2, 3, 4, 5, 6]).unwrap();
        let whole = whole.into_inner();
        let length = number(&whole, LENGTHS);
        for (tag, value) in [(LENGTHS, 0), (OFFSETS, 0), (OFFSETS, whole.len() as u32), (ROWS, 1)] {
            let error = white(&patched(&whole, tag, value)).unwrap_err();
            assert_eq!(error.code(), "E-tiff-strip", "{tag} {value}: {error}");
        }
        let cut = white(&patched(&whole, LENGTHS, length / 2)).unwrap_err();
        assert!(cut.category() == Category::Malformed && cut.to_string().contains("image 0, strip 0"), "{cut}");
        let more = white(&patched(&whole, LENGTHS, whole.len() as u32 + 1)).unwrap();
        assert_eq!((rows(&more)[5], codes(&more)), (6.0, vec!["W-tiff-strip"]));
        let small = white(&patched(&whole, LENGTHS, length + 1)).unwrap();
        assert_eq!(rows(&small)[5], 6.0);
    }
}

#[test]
fn a_number_for_holes_that_is_none_is_said() {
    let with = |text: &str| {
        let file = encoded::<Gray8>(&[1, 2, 3, 4, 5, 6], Compression::Uncompressed, &[], Some(text));
        let read = read_with(&file, ReadOptions::new()).unwrap();
        let said = read.findings.iter().find(|finding| finding.code == "W-tiff-nodata");
        said.map(|finding| finding.message.to_string())
    };
    assert!(with("nothing").unwrap().contains("\"nothing\""));
    assert!(with("1,5").unwrap().contains("\"1,5\""));
    for sound in ["3", " -9999 ", "nan", "-inf", "1e30"] {
        assert_eq!(with(sound), None, "{sound}");
    }
}

/// Whatever a tag says, a message has no names of types in it.
#[test]
fn kinds_that_are_not_read_are_told_in_words() {
    let told = |tag, value| white(&patched(&plain(), tag, value)).err().map(|error| error.to_string());
    let odd = told(BITS, 33).unwrap();
    assert!(odd.contains("found one channel of 33 bits, expected 8, 16, 32 or 64 bits"), "{odd}");
    assert!(told(COMPRESSION, 50_000).unwrap().contains("Zstandard"));
    assert!(told(COMPRESSION, 4242).unwrap().contains("number 4242"));
    assert!(told(INTERPRETATION, 8).unwrap().contains("L*a*b*"));
    let mut count = 0;
    for tag in [BITS, COMPRESSION, INTERPRETATION, OFFSETS, CHANNELS, ROWS, LENGTHS, FORMATS] {
        for value in (0..70).chain([32773, 32946, 34712, 34892, 50_000, 65_535, u32::MAX]) {
            let Some(text) = told(tag, value) else { continue };
            count += 1;
            let leaks = ["{", "Some(", "Unknown(", "Gray", "Multiband", "WhiteIsZero", "RGB(", "Void", "[", "Palette("];
            assert!(!leaks.iter().any(|leak| text.contains(leak)), "{tag} {value}: {text}");
        }
    }
    assert!(count > 100, "{count}");
    // Five channels side by side, and three in planes.
    let five = encoded_channels(5, 1);
    assert!(told_of(&five).contains("found 5 channels of 8 bits, expected one channel"), "{}", told_of(&five));
    let planes = encoded_channels(3, 2);
    assert!(told_of(&planes).contains("found 3 channels in planes"), "{}", told_of(&planes));
}

fn told_of(bytes: &[u8]) -> String {
    white(bytes).err().map(|error| error.to_string()).unwrap_or_default()
}

/// 2 × 2 pixels of so many channels of 8 bits.
fn encoded_channels(channels: u16, planes: u32) -> Vec<u8> {
    let long = |value: u32| value.to_le_bytes();
    let strips = if planes == 2 { u32::from(channels) } else { 1 };
    let (bits_at, data_at) = (8 + 2 + 9 * 12 + 4, 8 + 2 + 9 * 12 + 4 + 2 * u32::from(channels));
    let lists = data_at + 4 * u32::from(channels);
    let (offsets, lengths) = if strips == 1 { (data_at, 4 * u32::from(channels)) } else { (lists, lists + 4 * strips) };
    let interpretation = if channels == 3 { 2 } else { 1 };
    let tags: [(u16, u16, u32, u32); 9] = [
        (256, 4, 1, 2),
        (257, 4, 1, 2),
        (BITS, 3, channels.into(), bits_at),
        (INTERPRETATION, 4, 1, interpretation),
        (OFFSETS, 4, strips, offsets),
        (CHANNELS, 4, 1, channels.into()),
        (ROWS, 4, 1, 2),
        (LENGTHS, 4, strips, lengths),
        (PLANES, 4, 1, planes),
    ];
    let mut bytes = b"II*\0\x08\0\0\0\x09\0".to_vec();
    for (tag, kind, count, value) in tags {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(long(count));
        bytes.extend(long(value));
    }
    bytes.extend(long(0));
    (0..channels).for_each(|_| bytes.extend(8u16.to_le_bytes()));
    bytes.extend((0..4 * channels).map(|at| at as u8));
    (0..strips).for_each(|strip| bytes.extend(long(data_at + 4 * strip)));
    (0..strips).for_each(|_| bytes.extend(long(4)));
    bytes
}

/// One strip has the whole image; the caller is asked in it, and its answer heeded wherever it comes.
#[test]
fn a_single_strip_can_be_stopped() {
    let side = 1200;
    for compression in [Compression::Uncompressed, Compression::Deflate(Default::default())] {
        let mut bytes = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression);
        let mut image = encoder.new_image::<Gray16>(side, side).unwrap();
        image.rows_per_strip(side).unwrap();
        image.write_data(&vec![7; (side * side) as usize]).unwrap();
        let bytes = bytes.into_inner();
        let asked = Arc::new(AtomicU32::new(0));
        let read = |stop_at: u32| {
            asked.store(0, Ordering::Relaxed);
            let asked = Arc::clone(&asked);
            let watch = move || (asked.fetch_add(1, Ordering::Relaxed) >= stop_at).then_some(Stop::Cancelled);
            let exec = Exec::default().with_watch(watch);
            crate::read(&bytes, &FORMAT, &ReadContext { exec, ..ReadContext::named("x.tif") })
        };
        assert!(read(u32::MAX).is_ok());
        let all = asked.load(Ordering::Relaxed);
        // Rows are asked for once more where they become a field.
        assert!(all > side + side * side / (1 << 14), "{all}");
        for stop_at in (0..all).step_by(97).chain([1, 2, 3, all - 1]) {
            assert!(matches!(read(stop_at), Err(ReadError::Stop(Stop::Cancelled))), "{stop_at} of {all}");
        }
    }
}
