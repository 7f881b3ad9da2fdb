//! OFF files as no program should write them.

use shapeloom::core::{Category, Diagnostic, Exec, Limits, Place};
use shapeloom::io::{ReadContext, ReadError, ReadShape, format_by_id, read};
use shapeloom::shape::Geometry;

use crate::collection::{expected, measured};
use crate::support::{Dice, shared_data};

/// Read under a budget of 64 MB and 40 times the input.
fn off(input: &[u8]) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory((64 << 20) + 40 * input.len() as u64);
    let context = ReadContext { exec, ..ReadContext::named("x.off") };
    read(input, format_by_id("off").expect("OFF is a format"), &context)
}

/// The code and place of the error.
fn refused(input: &[u8]) -> (&'static str, Place) {
    let error = off(input).expect_err(&String::from_utf8_lossy(&input[..input.len().min(80)]));
    (error.code(), error.fault().map_or(Place::Whole, |fault| fault.place.clone()))
}

const VERTICES: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
const FACES: &str = "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

#[test]
fn each_defect_is_told_with_its_line() {
    let body = format!("{VERTICES}{FACES}");
    let with = |header: &str| format!("{header}\n{body}").into_bytes();
    for (input, code, line) in [
        (with("OFFICE\n4 4 6"), "E-off-header", 1),
        (with("# no\nof\n4 4 6"), "E-off-header", 2),
        (with("OFF\n-4 4 6"), "E-off-count", 2),
        (with("OFF\n4 -4 6"), "E-off-count", 2),
        (with("OFF\n4.0 4 6"), "E-off-number", 2),
        (with("OFF\n4 four 6"), "E-off-number", 2),
        (with("OFF\n4 4 six"), "E-off-number", 2),
        (with("OFF\n18446744073709551616 4 6"), "E-off-number", 2),
        (with("OFF\n4294967300 4 0"), "E-off-claim", 2),
        (with("OFF\n4 18446744073709551615 0"), "E-off-claim", 2),
        (with("OFF\n4"), "E-off-row", 2),
        (with("OFF\n4 4 6 4"), "E-off-row", 2),
        (with("OFF\n3 4 6"), "E-off-row", 6),
        (with("OFF\n5 4 6"), "E-off-row", 7),
        (with("OFF\n4 5 6"), "E-off-truncated", 11),
        (with("OFF\n9 4 6"), "E-off-claim", 2),
        (with("NOFF\n4 4 6"), "E-off-row", 3),
        (with("nOFF 3 4\n4 6"), "E-off-row", 1),
        (with("nOFF 7\n4 4 6"), "E-off-dimension", 1),
        (with("4nOFF 3\n4 4 6"), "E-off-dimension", 1),
        (b"OFF".to_vec(), "E-off-truncated", 1),
        (b"OFF\n\n".to_vec(), "E-off-truncated", 3),
        (b" \n".to_vec(), "E-off-truncated", 2),
        (b"OFF\n1 0 0\n0,5 0 0\n".to_vec(), "E-off-number", 3),
        (b"OFF\n1 0 0\n0x1 0 0\n".to_vec(), "E-off-number", 3),
        (b"OFF\r\n1 0 0\r\n0 1e400 0\r\n".to_vec(), "E-off-finite", 3),
        (b"OFF\r1 0 0\r0 -Infinity 0\r".to_vec(), "E-off-finite", 3),
        (b"4OFF\n1 0 0\n1 1 1 0\n".to_vec(), "E-off-weight", 3),
        (b"4OFF\n1 0 0\n1e300 1 1 1e-300\n".to_vec(), "E-off-finite", 3),
        (b"OFF\n0 1 0\n3 0 0 0\n".to_vec(), "E-off-index", 3),
        (b"OFF\n1 1 0\n0 0 0\n3 0 0 -1\n".to_vec(), "E-off-index", 4),
        (b"OFF\n1 1 0\n0 0 0\n-3 0 0 0\n".to_vec(), "E-off-index", 4),
        (b"OFF\n1 1 0\n0 0 0\n3 0 0 0.5\n".to_vec(), "E-off-number", 4),
        (b"OFF\n1 1 0\n0 0 0\n99 0 0\n".to_vec(), "E-off-claim", 4),
    ] {
        assert_eq!(refused(&input), (code, Place::line(line)), "{}", String::from_utf8_lossy(&input));
    }
    assert_eq!(refused(b""), ("E-off-truncated", Place::Byte(0)));
    assert_eq!(refused(b"\xff\xfeO\0F\0F\0").0, "E-text-encoding");
    let limits = Limits { max_polygon: 3, max_elements: 4, ..Limits::default() };
    let context = ReadContext { limits, ..ReadContext::default() };
    let format = format_by_id("off").expect("OFF is a format");
    for (text, line) in [("OFF\n5 0 0\n0 0 0\n1 1 1\n2 2 2\n3 3 3\n4 4 4\n", 2), ("OFF\n1 1 0\n0 0 0\n4 0 0 0 0\n", 4)]
    {
        let error = read(text.as_bytes(), format, &context).expect_err("beyond a limit");
        assert_eq!((error.code(), error.category()), ("E-off-limit", Category::OverLimit));
        assert_eq!(error.fault().map(|fault| fault.place.clone()), Some(Place::line(line)));
    }
}

/// A sample as it was printed: four vertices promised, three listed.
#[test]
fn the_misprinted_tetrahedron_is_refused_where_its_fourth_vertex_should_be() {
    let printed = "OFF\n4 4 0\n-1 -1 -1\n1 1 -1\n1 -1 1\n3 1 2 3\n3 1 0 2\n3 3 2 0\n3 0 1 3\n";
    let error = off(printed.as_bytes()).expect_err("a vertex is missing");
    let message = error.to_string();
    assert_eq!(error.code(), "E-off-row");
    for part in ["line 6", "vertex 3", "found 4 numbers", "expected 3 (x y z)"] {
        assert!(message.contains(part), "{message}");
    }
    let advice = error.advice().expect("advice");
    assert!(advice.contains("promises 4 vertices and 3 came before"), "{advice}");

    let mended = printed.replace("1 -1 1\n", "1 -1 1\n-1 1 1\n");
    let read = off(mended.as_bytes()).expect("four vertices");
    assert!(read.findings.is_empty());
    let (vertices, faces, _, volume) = measured(&read.shape);
    assert_eq!((vertices, faces), (4, 4));
    assert!((volume + 8.0 / 3.0).abs() < 1e-14, "inside out: {volume}");
}

#[test]
fn what_is_not_finite_is_left_out_when_asked() {
    let text = "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\nnan 0 0\n0 1e999 0\n3 0 1 2\n3 0 1 3\n3 4 1 2\n";
    let mut context = ReadContext::default();
    context.options.drop_non_finite = true;
    let format = format_by_id("off").expect("OFF is a format");
    let read = read(text.as_bytes(), format, &context).expect("the rest of it");
    let Geometry::TriMesh(mesh) = &*read.shape.parts[0].geometry else { panic!("triangles") };
    assert_eq!((mesh.positions().len(), mesh.triangles()), (3, &[[0, 1, 2]][..]));
    assert_eq!(read.findings.iter().next().expect("a finding").code, "W-read-dropped");
}

#[test]
fn bombs_stay_small() {
    let mut polygon = String::from("OFF\n20000 1 0\n");
    (0..20_000).for_each(|i| polygon += &format!("{i} {} 0\n", i * i % 97));
    polygon += "20000";
    (0..20_000).for_each(|i| polygon += &format!(" {i}"));
    assert!(off(polygon.as_bytes()).is_ok());
    // Many faces of no corners; all vertices on one line; comments without end; a line of a megabyte of blanks.
    let skipped = format!("OFF\n1 300000 0\n0 0 0\n{}", "0\n".repeat(300_000));
    assert_eq!(off(skipped.as_bytes()).expect("a point").findings.iter().next().expect("a finding").count, 300_000);
    let joined = format!("OFF 100000 0 0{}", " 1 2 3".repeat(100_000));
    assert!(off(joined.as_bytes()).is_ok());
    let commented = format!("OFF\n1 0 0\n{}0 0 0\n", "#\n".repeat(300_000));
    assert!(off(commented.as_bytes()).is_ok());
    let blank = format!("OFF\n1 0 0\n{}0 0 0\n", " ".repeat(1 << 20));
    assert!(off(blank.as_bytes()).is_ok());
    let indices = format!("OFF\n1 100000 0\n0 0 0\n{}", "3 0 0 0 7\n".repeat(100_000));
    assert!(off(indices.as_bytes()).is_ok());
}

#[test]
fn cut_and_changed_bytes_never_panic() {
    let mut binary = b"STCN4OFF BINARY\n\0\0\0\x03\0\0\0\x01\0\0\0\0".to_vec();
    binary.extend([0x3f; 3 * 13 * 4]);
    binary.extend(b"\0\0\0\x03\0\0\0\0\0\0\0\x01\0\0\0\x02\0\0\0\x04?\0\0\0?\0\0\0?\0\0\0?\0\0\0");
    assert!(off(&binary).is_ok(), "{:?}", off(&binary));
    let text = format!("# made\nSTCNOFF\n4 4 6\n{}3 0 1 2 # x\n3 0 1 3 7\n4 0 1 2 3 .5 .5 .5\n0\n", {
        let rest = "0 0 1 255 0 0 .5 .5\n";
        VERTICES.replace('\n', &format!(" {rest}"))
    });
    assert!(off(text.as_bytes()).is_ok());
    let mut dice = Dice(11);
    for whole in [binary, text.into_bytes()] {
        for end in 0..whole.len() {
            if let Err(error) = off(&whole[..end]) {
                assert!(matches!(error.category(), Category::Malformed), "{end}: {error}");
            }
        }
        for _ in 0..3000 {
            let mut broken = whole.clone();
            for _ in 0..1 + dice.next() % 4 {
                let at = dice.next() as usize % broken.len();
                broken[at] = b"0123456789-.e \n\rOFCN4n#\xff\0"[dice.next() as usize % 25];
            }
            if let Err(error) = off(&broken) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}

/// The collection of malformed files, where it is there: what it says, where it says.
#[test]
fn the_collection_comes_out_as_expected() {
    for case in expected("off") {
        case.check(|kind| match kind {
            "UnexpectedEof" => &["E-off-truncated"],
            "CountExceedsInput" => &["E-off-claim"],
            "InvalidCount" => &["E-off-count"],
            "InvalidNumber" => &["E-off-number"],
            "UnexpectedToken" => &["E-off-row", "E-off-header"],
            "IndexOutOfRange" => &["E-off-index"],
            "NonFinite" => &["E-off-finite"],
            "DegenerateFace" => &["W-off-degenerate", "W-off-skipped"],
            "ZeroWeight" => &["E-off-weight"],
            _ => &[],
        });
    }
    assert!(shared_data("malformed/off/empty.off").is_none() || expected("off").len() == 18);
}
