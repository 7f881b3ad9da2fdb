//! Real height maps beside the workspace, where they are there, against what other programs say of them.

use image::{DynamicImage, GenericImageView};
use shapeloom::core::Diagnostic;
use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::io::{HeightEncoding, ReadOptions};
use shapeloom::mesh::HeightField;
use shapeloom::shape::{Representation, Units};

use crate::collection::read_file_with;
use crate::support::shared_data;

/// A field of the collection, read with white at its own number.
fn field(name: &str, options: ReadOptions) -> Option<HeightField> {
    let path = shared_data(&format!("images/{name}"))?;
    let read = read_file_with(&path, options).unwrap_or_else(|error| panic!("{error}"));
    Some(HeightField::from_geometry(&read.shape.parts[0].geometry).expect("a height field").clone())
}

fn high(height: f64) -> ReadOptions {
    ReadOptions { height, ..ReadOptions::new() }
}

/// The picture as the `image` crate decodes it.
fn picture(name: &str) -> DynamicImage {
    let path = shared_data(&format!("images/{name}")).expect("it was read before");
    image::open(path).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The height at a pixel, rows counted from the top.
fn at(field: &HeightField, x: u32, y: u32) -> Option<f64> {
    field.sample(x, field.rows() - 1 - y).map(|sample| sample.z)
}

#[test]
fn grey_pictures_are_what_another_decoder_says() {
    for (name, full) in [
        ("B.pgm", 255.0),
        ("moon.png", 255.0),
        ("phantom.png", 255.0),
        ("palette_gray.png", 255.0),
        ("horse.png", 255.0),
        ("chessboard_GRAY_U16.tif", 65535.0),
        ("chessboard_GRAY_U16B.tif", 65535.0),
    ] {
        let Some(field) = field(name, high(full)) else { continue };
        let other = picture(name);
        assert_eq!((field.columns(), field.rows()), other.dimensions(), "{name}");
        let deep = other.to_luma_alpha16();
        for (x, y, pixel) in deep.enumerate_pixels() {
            // Bytes become words by the factor 257.
            let value = f64::from(pixel.0[0]) / if full == 255.0 { 257.0 } else { 1.0 };
            assert_eq!(at(&field, x, y), (pixel.0[1] > 0).then_some(value), "{name} {x} {y}");
        }
    }
}

#[test]
fn both_byte_orders_are_the_same_board() {
    let fields = ["chessboard_GRAY_U16.tif", "chessboard_GRAY_U16B.tif"].map(|name| field(name, high(65535.0)));
    assert_eq!(fields[0], fields[1]);
    if let Some(board) = &fields[0] {
        assert!(board.heights().contains(&0.0) && board.heights().contains(&255.0));
    }
}

/// The formulas of the tiles' makers, computed from the file by another program.
#[test]
fn terrain_tiles_have_their_known_heights() {
    for (name, encoding, first, low, high, mean) in [
        ("mapbox.png", HeightEncoding::Mapbox, 1758.6, 704.6, 3497.3, 2_004.965_071_105_957_6),
        (
            "terrarium.png",
            HeightEncoding::Terrarium,
            869.128_906_25,
            852.117_187_5,
            2_475.066_406_25,
            1_359.034_128_844_738,
        ),
    ] {
        let options = ReadOptions { encoding, spacing: 30.0, ..ReadOptions::new() };
        let Some(field) = field(name, options) else { continue };
        assert_eq!((field.columns(), field.rows(), field.spacing()), (256, 256, DVec2::splat(30.0)));
        let close = |found: f64, known: f64| assert!((found - known).abs() < 1e-9, "{name}: {found} {known}");
        close(at(&field, 0, 0).expect("a height"), first);
        close(field.heights().iter().copied().fold(f64::MAX, f64::min), low);
        close(field.heights().iter().copied().fold(f64::MIN, f64::max), high);
        close(field.heights().iter().sum::<f64>() / 65536.0, mean);
        let path = shared_data(&format!("images/{name}")).expect("it was read before");
        let error = read_file_with(&path, ReadOptions::new()).expect_err("colours are no heights");
        assert_eq!(error.code(), "E-heights-channels");
    }
}

/// Samples, holes and tags as other programs print them.
#[test]
fn floating_tiffs_have_their_places_and_holes() {
    if let Some(field) = field("float_nan.tif", ReadOptions::new()) {
        assert_eq!((field.columns(), field.rows(), field.spacing()), (3, 2, DVec2::splat(100.0)));
        assert_eq!(field.heights().iter().filter(|height| height.is_nan()).count(), 1);
        let known = field.heights().iter().filter(|height| !height.is_nan());
        let (low, high) = known.fold((f64::MAX, f64::MIN), |(low, high), height| (low.min(*height), high.max(*height)));
        assert_eq!((low, high), (f64::from(-1.88f32), f64::from(1.41f32)));
    }
    let Some(path) = shared_data("images/float_raster_with_nodata.tif") else { return };
    let read = read_file_with(&path, ReadOptions::new()).expect("it is read");
    let field = HeightField::from_geometry(&read.shape.parts[0].geometry).expect("a height field");
    assert_eq!((field.columns(), field.rows(), field.spacing()), (13, 12, DVec2::splat(500.0)));
    assert_eq!(read.shape.units, Some(Units::METERS));
    // The tie point is the corner of the first pixel, of which the sample is the middle; the last row is the first here.
    let corner = DVec3::new(6_301_612.204_093_784, 3_314_112.230_617_760_7, 0.0);
    let wanted = corner + DVec3::new(250.0, -250.0 - 11.0 * 500.0, 0.0);
    assert!((field.placement().translation - wanted).length() < 1e-9);
    assert_eq!(field.heights().iter().filter(|height| height.is_nan()).count(), 58);
    assert!(field.heights().iter().all(|height| height.is_nan() || (0.0..=0.25).contains(height)));
}
