//! STL files as no program should write them.

use shapeloom::core::{Category, Diagnostic, Exec, Limits, Place};
use shapeloom::io::{ReadContext, ReadError, ReadShape, format_by_id, read};
use shapeloom::shape::Geometry;

use crate::collection::expected;
use crate::support::{Dice, shared_data};

/// Read under a budget of 64 MB and 40 times the input.
fn stl(input: &[u8]) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory((64 << 20) + 40 * input.len() as u64);
    let context = ReadContext { exec, ..ReadContext::named("x.stl") };
    read(input, format_by_id("stl").expect("STL is a format"), &context)
}

/// The code and place of the error.
fn refused(input: &[u8]) -> (&'static str, Place) {
    let error = stl(input).expect_err(&String::from_utf8_lossy(&input[..input.len().min(80)]));
    (error.code(), error.fault().map_or(Place::Whole, |fault| fault.place.clone()))
}

/// The codes, places and numbers of the findings of a file that is read.
fn remarked(input: &[u8]) -> Vec<(&'static str, Place, u64)> {
    let read = stl(input).unwrap_or_else(|error| panic!("{error}"));
    read.findings.iter().map(|finding| (finding.code, finding.places[0].clone(), finding.count)).collect()
}

/// A binary file that claims `count` facets and has these, each of a normal and three corners.
fn binary(count: u32, facets: &[[f32; 12]]) -> Vec<u8> {
    let mut file = vec![b' '; 80];
    file.extend_from_slice(&count.to_le_bytes());
    for facet in facets {
        file.extend(facet.iter().flat_map(|number| number.to_le_bytes()));
        file.extend_from_slice(&[0; 2]);
    }
    file
}

const FACET: [f32; 12] = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
const TEXT: &str = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n";

#[test]
fn each_defect_of_text_is_told_with_its_line() {
    let with = |from: &str, to: &str| TEXT.replacen(from, to, 1).into_bytes();
    for (input, code, line) in [
        (with("vertex 0 1 0\n", ""), "E-stl-row", 6),
        (with("vertex 0 1 0\n", "vertex 0 1 0\nvertex 1 1 0\n"), "E-stl-row", 7),
        (with("outer loop\n", ""), "E-stl-row", 3),
        (with("normal", "normals"), "E-stl-row", 2),
        (with("endfacet\n", ""), "E-stl-row", 8),
        (with("facet normal", "color 1 1 1\nfacet normal"), "E-stl-row", 2),
        (with("vertex 1 0 0", "vertex 1,0 0 0"), "E-stl-number", 5),
        (with("vertex 1 0 0", "vertex 1 0x 0"), "E-stl-number", 5),
        (with("vertex 1 0 0", "vertex 1 0"), "E-stl-number", 6),
        (with("vertex 1 0 0", "vertex 1 nan 0"), "E-stl-finite", 5),
        (with("vertex 1 0 0", "vertex 1 0 -1e999"), "E-stl-finite", 5),
        (TEXT.as_bytes()[..60].to_vec(), "E-stl-truncated", 5),
        (TEXT.as_bytes()[..64].to_vec(), "E-stl-truncated", 6),
        (with("endfacet\nendsolid x\n", ""), "E-stl-truncated", 8),
        (format!("{TEXT}{}", TEXT.replacen("solid x\n", "", 1)).into_bytes(), "E-stl-row", 10),
    ] {
        assert_eq!(refused(&input), (code, Place::line(line)), "{}", String::from_utf8_lossy(&input));
    }
    assert!(
        stl(&with("vertex 1 0 0", "vertex 1,0 0 0")).expect_err("a comma").advice().expect("advice").contains("comma")
    );
    for (input, code, line) in [
        (with("endsolid x\n", ""), "W-stl-open", 8),
        (with("solid x\n", ""), "W-stl-solid", 1),
        (with("endsolid x\n", TEXT), "W-stl-nested", 9),
        (format!("{TEXT}endsolid\n").into_bytes(), "W-stl-end", 10),
        (format!("{TEXT}\n\nthat was all\n").into_bytes(), "W-stl-trailing", 12),
        (with("0 0 1", "0 nan 1"), "W-stl-normal", 2),
        (with("0 0 1", "a b c"), "W-stl-normal", 2),
        (with("0 0 1", "0 0"), "W-stl-normal", 2),
        (with("1 0 0", "0 0 -0"), "W-stl-degenerate", 2),
        (b"solid\nendsolid\n".to_vec(), "W-stl-empty", 1),
    ] {
        assert_eq!(remarked(&input), [(code, Place::line(line), 1)], "{}", String::from_utf8_lossy(&input));
    }
}

#[test]
fn each_defect_of_binary_files_is_told_with_its_byte() {
    let wrong = |at: usize, number: f32| {
        let mut facet = FACET;
        facet[at] = number;
        binary(2, &[FACET, facet])
    };
    let short = |bytes: usize| {
        let whole = binary(2, &[FACET; 2]);
        whole[..whole.len() - bytes].to_vec()
    };
    for (input, code, byte) in [
        (Vec::new(), "E-stl-truncated", 0),
        (b"hello".to_vec(), "E-stl-truncated", 5),
        (vec![0; 83], "E-stl-truncated", 83),
        (binary(5, &[FACET; 4]), "E-stl-truncated", 284),
        (short(1), "E-stl-truncated", 183),
        (binary(4u32.swap_bytes(), &[FACET; 4]), "E-stl-claim", 80),
        (binary(u32::MAX, &[FACET]), "E-stl-claim", 80),
        (wrong(3, f32::NAN), "E-stl-finite", 134 + 12),
        (wrong(10, f32::INFINITY), "E-stl-finite", 134 + 36),
    ] {
        assert_eq!(refused(&input), (code, Place::Byte(byte)), "{byte}");
    }
    let error = stl(&binary(4u32.swap_bytes(), &[FACET; 4])).expect_err("big endian");
    assert!(error.advice().expect("advice").contains("byte order"));
    let mut ones = FACET;
    ones[3..].fill(1.0);
    for (input, code, byte, count) in [
        (binary(1, &[FACET; 2]), "W-stl-trailing", 134, 1),
        (wrong(1, f32::NAN), "W-stl-normal", 134, 1),
        (binary(3, &[FACET, ones, ones]), "W-stl-degenerate", 134, 2),
        (binary(0, &[]), "W-stl-empty", 80, 1),
    ] {
        assert_eq!(remarked(&input), [(code, Place::Byte(byte), count)]);
    }
    let limits = Limits { max_elements: 1, ..Limits::default() };
    let context = ReadContext { limits, ..ReadContext::default() };
    let error =
        read(&binary(2, &[FACET; 2]), format_by_id("stl").expect("a format"), &context).expect_err("two facets");
    assert_eq!((error.code(), error.category()), ("E-stl-limit", Category::OverLimit));
}

#[test]
fn what_is_not_finite_is_left_out_when_asked() {
    let mut odd = FACET;
    odd[6] = f32::NAN;
    let binary = binary(200, &[[odd; 199].as_slice(), &[FACET]].concat());
    let facet = &TEXT[8..TEXT.len() - 11];
    let text = format!("solid\n{}{facet}endsolid\n", facet.replace("1 0 0", "1e999 nan 0").repeat(300));
    let mut context = ReadContext::default();
    context.options.drop_non_finite = true;
    for file in [binary, text.into_bytes()] {
        let format = format_by_id("stl").expect("STL is a format");
        let read = read(&file, format, &context).unwrap_or_else(|error| panic!("{error}"));
        let Geometry::TriMesh(mesh) = &*read.shape.parts[0].geometry else { panic!("triangles") };
        assert_eq!((mesh.positions().len(), mesh.triangles().len()), (3, 1));
        assert!(read.findings.iter().any(|finding| finding.code == "W-read-dropped"));
    }
}

#[test]
fn bombs_stay_small() {
    let solids = |count| "solid\nendsolid\n".repeat(count);
    assert_eq!(stl(solids(20_000).as_bytes()).expect("empty solids").shape.parts.len(), 20_000);
    let place = Place::line(2 * (16_384 + 750_000 / 32) + 1);
    assert_eq!(refused(solids(50_000).as_bytes()), ("E-stl-limit", place));
    let begun = "solid a\n".repeat(100_000);
    assert_eq!(stl(begun.as_bytes()).expect("one solid").shape.parts.len(), 1);
    let ended = format!("solid\n{}", "endsolid\n".repeat(100_000));
    assert_eq!(stl(ended.as_bytes()).expect("one solid").shape.parts.len(), 1);
    let words = format!("solid {}\n", "x ".repeat(1 << 20));
    assert!(stl(words.as_bytes()).is_ok());
    // All on one line, as no program writes it.
    let facet = TEXT[8..TEXT.len() - 11].replace('\n', " ");
    let read = stl(format!("solid\n{}endsolid", facet.repeat(20_000)).as_bytes()).expect("facets on one line");
    let Geometry::TriMesh(mesh) = &*read.shape.parts[0].geometry else { panic!("triangles") };
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (3, 20_000));
}

#[test]
fn cut_and_changed_bytes_never_panic() {
    let mut dice = Dice(13);
    for whole in [binary(3, &[FACET; 3]), TEXT.repeat(2).into_bytes()] {
        for end in 0..whole.len() {
            if let Err(error) = stl(&whole[..end]) {
                assert_eq!(error.category(), Category::Malformed, "{end}: {error}");
            }
        }
        for _ in 0..3000 {
            let mut broken = whole.clone();
            for _ in 0..1 + dice.next() % 4 {
                let at = dice.next() as usize % broken.len();
                broken[at] = b"0123456789-.e \n\rsolid\xff\0\x7f"[dice.next() as usize % 24];
            }
            if let Err(error) = stl(&broken) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}

/// The collection of malformed files, where it is there: what it says, where it says.
#[test]
fn the_collection_comes_out_as_expected() {
    for case in expected("stl") {
        case.check(|kind| match kind {
            "UnexpectedEof" => &["E-stl-truncated"],
            "CountExceedsInput" => &["E-stl-claim"],
            "InvalidNumber" => &["E-stl-number"],
            "UnexpectedToken" => &["E-stl-row"],
            "NonFinite" => &["E-stl-finite"],
            "DegenerateFace" => &["W-stl-degenerate"],
            "TrailingData" => &["W-stl-trailing"],
            "BadNormal" => &["W-stl-normal"],
            _ => &[],
        });
    }
    assert!(shared_data("malformed/stl/empty.stl").is_none() || expected("stl").len() == 12);
}
