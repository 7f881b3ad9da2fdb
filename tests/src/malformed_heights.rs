//! Height fields as no program should write them.

use shapeloom::io::ReadOptions;

use crate::collection::expected;
use crate::entry::read_as;
use crate::support::{Dice, data, run_on, shared_data};

/// The collection of malformed files, where it is there: what it says, where it says.
#[test]
fn the_collection_comes_out_as_expected() {
    // Without the height of white it is guessed, and that is said.
    let options = ReadOptions { height: 1.0, ..ReadOptions::new() };
    for case in expected("image") {
        case.check_with(options.clone(), |kind| match kind {
            "UnexpectedEof" => &["E-pgm-truncated", "E-png-truncated"],
            "InvalidCount" => &["E-pgm-count"],
            "InvalidValue" => &["E-pgm-maxval", "E-pgm-value"],
            "Checksum" => &["E-png-checksum"],
            "LimitExceeded" => &["E-heights-limit"],
            _ => &[],
        });
    }
    assert!(shared_data("malformed/image/valid_2x2.pgm").is_none() || expected("image").len() == 9);
}

/// Chunks of a file with their sums made right again, so that damage reaches the decoder.
fn mended(bytes: &mut [u8]) {
    let mut at = 8;
    while let Some(length) = bytes.get(at..at + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let Some(sum) = bytes.get(at + 4..at + 8 + length).map(crc32fast::hash) else { return };
        if let Some(place) = bytes.get_mut(at + 8 + length..at + 12 + length) {
            place.copy_from_slice(&sum.to_be_bytes());
        }
        at += 12 + length;
    }
}

#[test]
fn damage_under_sound_checksums_never_panics() {
    let mut inputs = Vec::new();
    let picture = image::DynamicImage::ImageRgba8(image::RgbaImage::from_fn(13, 11, |x, y| {
        image::Rgba([(x * 19) as u8, (x * 19) as u8, (x * 19) as u8, if y == 4 { 0 } else { 255 }])
    }));
    for picture in [image::DynamicImage::ImageLuma16(picture.to_luma16()), picture] {
        let mut bytes = std::io::Cursor::new(Vec::new());
        picture.write_to(&mut bytes, image::ImageFormat::Png).expect("a picture");
        inputs.push(bytes.into_inner());
    }
    let mut dice = Dice(77);
    let mut read = 0;
    for round in 0..6000 {
        let mut broken = inputs[round % inputs.len()].clone();
        for _ in 0..1 + dice.next() % 3 {
            let at = 8 + dice.next() as usize % (broken.len() - 8);
            broken[at] =
                if dice.next().is_multiple_of(2) { dice.next() as u8 } else { broken[at] ^ 1 << (dice.next() % 8) };
        }
        mended(&mut broken);
        read += usize::from(read_as("png", &broken));
    }
    assert!((60..6000).contains(&read), "{read}");
}

/// A real file of tags and compressed strips, damaged.
#[test]
fn damaged_tiffs_never_panic() {
    let mut inputs = Vec::new();
    for name in ["float_raster_with_nodata.tif", "float_nan.tif"] {
        let Some(path) = shared_data(&format!("images/{name}")) else { continue };
        inputs.push(std::fs::read(path).expect("a file of the collection"));
    }
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture =
        image::DynamicImage::ImageLuma16(image::ImageBuffer::from_fn(13, 11, |x, y| image::Luma([(x * y) as u16])));
    picture.write_to(&mut bytes, image::ImageFormat::Tiff).expect("a picture");
    inputs.push(bytes.into_inner());
    let mut dice = Dice(78);
    let mut read = 0;
    for round in 0..6000 {
        let mut broken = inputs[round % inputs.len()].clone();
        for _ in 0..1 + dice.next() % 4 {
            let at = dice.next() as usize % broken.len();
            match dice.next() % 3 {
                0 => broken[at] = dice.next() as u8,
                1 => broken[at] ^= 1 << (dice.next() % 8),
                _ => broken[at] = [0, 1, 0x7f, 0x80, 0xff][dice.next() as usize % 5],
            }
        }
        read += usize::from(read_as("tiff", &broken));
    }
    assert!((60..6000).contains(&read), "{read}");
}

/// The elevation model cut off and damaged, through the program.
#[test]
fn damaged_elevation_models_are_refused_with_a_place() {
    let whole = std::fs::read(data("mount_st_helens.dem")).expect("data/mount_st_helens.dem is in the repository");
    for end in [0, 1, 500, 1024, 1500, 400_000, 990_000] {
        let outcome = run_on(&whole[..end], &["info", "-", "--from", "dem"]);
        assert!(outcome.code == 3 && outcome.err.contains("byte"), "{end}: {} {}", outcome.code, outcome.err);
    }
    let mut dice = Dice(79);
    for _ in 0..40 {
        let mut broken = whole.clone();
        for _ in 0..1 + dice.next() % 4 {
            let at = dice.next() as usize % if dice.next().is_multiple_of(2) { 4096 } else { broken.len() };
            broken[at] = b"0123456789-.D \n\0\xff"[dice.next() as usize % 17];
        }
        let outcome = run_on(&broken, &["info", "-", "--from", "dem"]);
        assert!([0, 3, 4, 7].contains(&outcome.code), "{} {}", outcome.code, outcome.err);
    }
}

/// What lies about its strips is malformed; what is merely of another kind is not. Numbers stay short.
#[test]
fn lies_kinds_and_options_have_their_exit_codes() {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let picture =
        image::DynamicImage::ImageLuma16(image::ImageBuffer::from_fn(4, 3, |x, y| image::Luma([(x + y) as u16])));
    picture.write_to(&mut bytes, image::ImageFormat::Tiff).expect("a picture");
    let whole = bytes.into_inner();
    let start = u32::from_le_bytes([whole[4], whole[5], whole[6], whole[7]]) as usize;
    let patched = |tag: u16, value: u32| {
        let mut bytes = whole.clone();
        let at = (start + 2..).step_by(12).find(|at| bytes[*at..*at + 2] == tag.to_le_bytes()).expect("the tag");
        bytes[at + 2..at + 8].copy_from_slice(&[4, 0, 1, 0, 0, 0]);
        bytes[at + 8..at + 12].copy_from_slice(&value.to_le_bytes());
        run_on(&bytes, &["info", "-", "--from", "tiff", "--set", "height=1"])
    };
    for (tag, value, code, word) in [
        (278, 1, 3, "RowsPerStrip"),
        (279, 1, 3, "StripByteCounts"),
        (273, 0, 3, "StripOffsets"),
        (273, 1 << 30, 3, "StripOffsets"),
        (258, 33, 4, "33 bits"),
        (278, u32::MAX, 0, ""),
    ] {
        let outcome = patched(tag, value);
        assert!(outcome.code == code && outcome.err.contains(word), "{tag} {value}: {} {}", outcome.code, outcome.err);
    }
    let high = run_on(&whole, &["info", "-", "--from", "tiff", "--set", "height=1e300", "--set", "exaggeration=1e300"]);
    assert!(high.code == 3 && high.err.lines().all(|line| line.len() < 200), "{}", high.err);
    let high = run_on(&whole, &["info", "-", "--from", "tiff", "--set", "height=1e300"]);
    let words = high.err.clone() + &String::from_utf8_lossy(&high.out);
    assert!(!words.contains(&"0".repeat(60)), "{words}");
    let typo = run_on(&whole, &["info", "-", "--from", "tiff", "--set", "encoding=typo"]);
    assert!(typo.code == 2 && typo.err.contains("mapbox") && typo.err.contains("to read tiff"), "{}", typo.err);
}
