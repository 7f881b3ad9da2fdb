//! ESRI ASCII grids, read and written.

use shapeloom_core::glam::{DMat3, DVec2, DVec3};
use shapeloom_core::{Affine, Deviation, Diagnostic, Exec, Place, Report};
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Part, Representation, Shape, Units, UpAxis};

use super::FORMAT;
use crate::{ReadContext, ReadError, ReadShape, Sniff, WriteContext, WriteError};

fn asc(input: &str) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(1 << 20);
    crate::read(input.as_bytes(), &FORMAT, &ReadContext { exec, ..ReadContext::named("x.asc") })
}

fn field(shape: &Shape) -> HeightField {
    HeightField::from_geometry(&shape.parts[0].placed()).unwrap().clone()
}

fn written(shape: &Shape) -> (String, Report) {
    let mut bytes = Vec::new();
    let report = crate::write(shape, &FORMAT, &WriteContext::default(), &mut bytes).unwrap();
    (String::from_utf8(bytes).unwrap(), report)
}

fn bits(field: &HeightField) -> Vec<u64> {
    field.heights().iter().map(|height| height.to_bits()).collect()
}

const GRID: &str = "ncols 3\nNROWS 2\nxllcorner 100\nyllcorner 5e6\ncellsize 10\nNODATA_value -1\n1 2 3\n4 -1\n6\n";

#[test]
fn the_first_row_is_north_and_samples_are_the_middles_of_cells() {
    let read = asc(GRID).unwrap();
    assert_eq!(read.shape.up, Some(UpAxis::Z));
    let field = field(&read.shape);
    assert_eq!(field.sample(0, 1), Some(DVec3::new(105.0, 5_000_015.0, 1.0)));
    assert_eq!(field.sample(2, 0), Some(DVec3::new(125.0, 5_000_005.0, 6.0)));
    assert_eq!(field.sample(1, 0), None);
    let center = asc(&GRID.replace("corner", "center")).unwrap();
    let center = HeightField::from_geometry(&center.shape.parts[0].geometry).unwrap().clone();
    assert_eq!(center.sample(0, 0), Some(DVec3::new(100.0, 5e6, 4.0)));
    let oblong = asc(&GRID.replace("cellsize 10", "dx 10\ndy 20")).unwrap();
    let oblong = HeightField::from_geometry(&oblong.shape.parts[0].geometry).unwrap().clone();
    assert_eq!(oblong.sample(0, 1), Some(DVec3::new(105.0, 5_000_030.0, 1.0)));
}

#[test]
fn grids_come_back_to_the_bit() {
    let heights = [0.1, -0.0, 1e300, f64::NAN, -9999.0, 5e-324, 1.0 / 3.0, 2549.0, -1.5];
    // The middles of the second have no corner that they follow from.
    for (spacing, place) in [
        (DVec2::splat(30.0), DVec3::new(557_820.0, 5_108_010.0, 0.0)),
        (DVec2::new(0.1, 1.0 / 3.0), DVec3::new(1.0 / 3.0, 1e-20, 0.0)),
    ] {
        let field = HeightField::try_new(3, 3, spacing, heights.to_vec()).unwrap();
        let field = field.placed(Affine::from_translation(place));
        let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(field.clone())) };
        let (text, report) = written(&shape);
        assert_eq!((report.deviation, report.losses.len()), (Deviation::Exact, 0), "{:?}", report.losses);
        assert!(text.contains("NODATA_value -99999\n"), "{text}");
        let again = asc(&text).unwrap();
        let found = self::field(&again.shape);
        assert_eq!((bits(&found), found.spacing()), (bits(&field), field.spacing()));
        assert_eq!(found.placement(), field.placement());
        assert_eq!(written(&again.shape).0, text);
    }
}

#[test]
fn what_is_placed_flipped_or_turned_is_put_upright_or_refused() {
    let field = HeightField::try_new(2, 3, DVec2::new(1.0, 2.0), (0..6).map(f64::from).collect()).unwrap();
    let flip = Affine::from_translation(DVec3::new(7.0, 8.0, 9.0)) * Affine::from_scale(DVec3::new(-2.0, 1.0, 10.0));
    let part = Part { placement: flip, ..Part::new(field.clone()) };
    let shape = Shape { up: Some(UpAxis::Z), units: Some(Units::METERS), ..Shape::new(part.clone()) };
    let (text, report) = written(&shape);
    assert_eq!(report.losses.len(), 1, "the unit of length: {:?}", report.losses);
    let again = self::field(&asc(&text).unwrap().shape);
    for (column, row) in [(0, 0), (1, 0), (0, 2)] {
        assert_eq!(again.sample(1 - column, row), self::field(&shape).sample(column, row));
    }
    // What is up along y is turned first, exactly.
    let lying = shape.transformed(&UpAxis::Z.rotation_to(UpAxis::Y));
    assert_eq!(written(&Shape { up: Some(UpAxis::Y), ..lying }).0, text);
    let turned = Affine::from_linear(DMat3::from_rotation_z(0.1));
    let turned = Shape::new(Part { placement: turned, ..part.clone() });
    let error = crate::write(&turned, &FORMAT, &WriteContext::default(), &mut Vec::new()).unwrap_err();
    assert!(matches!(error, WriteError::Turned { .. }) && error.advice().is_some());
    for parts in [vec![], vec![part.clone(), part.clone()]] {
        let several = Shape { parts, ..Shape::default() };
        assert!(crate::write(&several, &FORMAT, &WriteContext::default(), &mut Vec::new()).is_err());
    }
    let far = Part { placement: Affine::from_scale(DVec3::new(1.0, 1.0, 1e308)), ..part };
    let error = crate::write(&Shape::new(far), &FORMAT, &WriteContext::default(), &mut Vec::new()).unwrap_err();
    assert_eq!(error.code(), "E-write-finite");
}

#[test]
fn holes_are_what_the_header_or_custom_says() {
    let unsaid = asc("ncols 2 nrows 2 xllcorner 0 yllcorner 0 cellsize 1\n1 2 -9999 nan\n").unwrap();
    let codes: Vec<&str> = unsaid.findings.iter().map(|finding| finding.code).collect();
    assert_eq!(codes, ["W-asc-nodata", "W-heights-holes"]);
    assert_eq!(field(&unsaid.shape).heights().iter().filter(|height| height.is_nan()).count(), 2);
    let said = asc("ncols 2 nrows 2 xllcorner 0 yllcorner 0 cellsize 1 nodata_value nan\n1 2 -9999 nan\n").unwrap();
    assert_eq!(field(&said.shape).heights()[0], -9999.0);
}

#[test]
fn heights_are_multiplied_by_the_option() {
    let options = crate::ReadOptions { exaggeration: -2.0, ..crate::ReadOptions::new() };
    let context = ReadContext { options, ..ReadContext::default() };
    let read = crate::read(GRID.as_bytes(), &FORMAT, &context).unwrap();
    assert_eq!(field(&read.shape).sample(2, 0), Some(DVec3::new(125.0, 5_000_005.0, -12.0)));
}

#[test]
fn defects_are_told_with_their_line() {
    let with = |from: &str, to: &str| GRID.replacen(from, to, 1);
    for (text, code, line) in [
        (with("ncols 3", "ncols 3.5"), "E-asc-count", 1),
        (with("ncols 3", "ncols -3"), "E-asc-count", 1),
        (with("NROWS 2", "NROWS 99999999999999999999"), "E-asc-count", 2),
        (with("NROWS 2", "NROWS 1"), "E-heights-size", 1),
        (with("NROWS 2", "NROWS 99999"), "E-asc-claim", 1),
        (with("NROWS 2", "NROWS 4294967297"), "E-heights-limit", 1),
        (with("NROWS 2", "NROWS 3"), "E-asc-claim", 1),
        (with("1 2 3", "1 2"), "E-asc-truncated", 10),
        (with("NROWS 2\n", ""), "E-asc-header", 6),
        (with("NROWS 2", "NROWS 2\nnrows 2"), "E-asc-duplicate", 3),
        (with("NROWS 2", "NROWS 2\nheight 2"), "E-asc-header", 3),
        (with("xllcorner 100", "xllcorner 100\nxllcenter 5"), "E-asc-duplicate", 4),
        (with("xllcorner 100\n", ""), "E-asc-header", 6),
        (with("xllcorner 100", "xllcorner inf"), "E-asc-finite", 3),
        (with("xllcorner 100", "xllcorner 1,5"), "E-asc-number", 3),
        (with("cellsize 10", "cellsize 0"), "E-asc-cell", 5),
        (with("cellsize 10", "cellsize -3"), "E-asc-cell", 5),
        (with("4 -1", "4 x"), "E-asc-number", 8),
        (with("4 -1", "4 -1e999"), "E-asc-finite", 8),
        (with("4 -1", "4 -inf"), "E-asc-finite", 8),
        ("ncols 3".into(), "E-asc-header", 1),
        (String::new(), "E-asc-header", 1),
    ] {
        let error = asc(&text).unwrap_err();
        let place = error.fault().map(|fault| (fault.code, fault.place.clone()));
        assert_eq!(place, Some((code, Place::line(line))), "{text}: {error}");
        assert!(error.advice().is_some(), "{error}");
    }
    let trailing = asc(&with("\n6\n", "\n6 7\n")).unwrap();
    assert_eq!(trailing.findings.iter().next().unwrap().places, [Place::line(9)]);
    assert_eq!((FORMAT.sniff)(GRID.as_bytes()), Sniff::Certain);
    assert_eq!((FORMAT.sniff)(b"ncols\n"), Sniff::No);
}

/// What is said of an empty file, a missing word and an infinite number is about that, and its advice helps.
#[test]
fn words_and_advice_fit_the_defect() {
    let told = |text: &str| {
        let error = asc(text).unwrap_err();
        (error.to_string(), error.advice().unwrap())
    };
    for empty in ["", "\n  \n"] {
        let (text, advice) = told(empty);
        assert!(text.contains("found an empty file, expected a header") && advice.contains("complete copy"), "{text}");
    }
    let (text, advice) = told(&GRID.replace("NROWS 2\n", ""));
    assert!(text.contains("the end of the header, expected the word nrows") && advice.contains("the word nrows"));
    let (_, advice) = told(&GRID.replace("NROWS 2", "NROWS 1"));
    assert!(advice.contains("grid of at least two"), "{advice}");
    // In the header nothing can be left out; a height can become a hole, and does.
    let (_, advice) = told(&GRID.replace("xllcorner 100", "xllcorner inf"));
    assert!(!advice.contains("drop"), "{advice}");
    let infinite = GRID.replace("4 -1", "inf -1");
    assert!(told(&infinite).1.contains("--drop-non-finite"));
    let options = crate::ReadOptions { drop_non_finite: true, ..crate::ReadOptions::new() };
    let read =
        |text: &str, options| crate::read(text.as_bytes(), &FORMAT, &ReadContext { options, ..ReadContext::default() });
    assert!(read(&infinite, options).is_ok());
    // What an option made infinite is the option's fault.
    let options = crate::ReadOptions { exaggeration: 1e308, ..crate::ReadOptions::new() };
    let error = read(GRID, options).unwrap_err();
    let advice = error.advice().unwrap();
    assert!(advice.contains("exaggeration") && !advice.contains("drop"), "{advice}");
    assert!(error.to_string().contains("the height 2 times the option exaggeration = 1e308"), "{error}");
}
