//! OBJ files as no program should write them.

use shapeloom::core::{Category, Diagnostic, Exec, Place};
use shapeloom::io::{ReadContext, ReadError, ReadShape, format_by_id, read};

use crate::collection::expected;
use crate::support::{Dice, shared_data};

/// Read under a budget of 64 MB and 40 times the input.
fn obj(input: &[u8]) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory((64 << 20) + 40 * input.len() as u64);
    let context = ReadContext { exec, ..ReadContext::named("x.obj") };
    read(input, format_by_id("obj").expect("OBJ is a format"), &context)
}

/// The code and place of the error.
fn refused(input: &[u8]) -> (&'static str, Place) {
    let error = obj(input).expect_err(&String::from_utf8_lossy(&input[..input.len().min(80)]));
    (error.code(), error.fault().map_or(Place::Whole, |fault| fault.place.clone()))
}

/// The code and place of the first finding of a file that is read.
fn remarked(input: &[u8]) -> (&'static str, Place) {
    let read = obj(input).expect("it is read with a finding");
    let finding = read.findings.iter().next().expect("a finding");
    (finding.code, finding.places[0].clone())
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn each_defect_is_told_with_its_line() {
    let with = |rest: &str| format!("{SQUARE}{rest}").into_bytes();
    for (input, code, line) in [
        (with("f 1 2 5\n"), "E-obj-index", 5),
        (with("f 1 2 9223372036854775808\n"), "E-obj-number", 5),
        (with("f 1/ 2// 3/x/\n"), "E-obj-number", 5),
        (with("vn 0 0 1\nf 1//9 2//1 3//1\n"), "E-obj-index", 6),
        (with("f 0 1 2\n"), "E-obj-index", 5),
        (with("f -5 1 2\n"), "E-obj-index", 5),
        (b"v 0 0\n".to_vec(), "E-obj-row", 1),
        (b"v 0x1p3 0 0\n".to_vec(), "E-obj-number", 1),
        (b"v 0 0 0\nv 1e400 0 0\n".to_vec(), "E-obj-finite", 2),
        (b"v 0 0 0\r\nv inf 0 0\r\n".to_vec(), "E-obj-finite", 2),
        (b"v 0 0 0\rv 0 1,5 0\r".to_vec(), "E-obj-number", 2),
        (with("cstype bspline\ndeg 99\ncurv 0 1 1 2 3 4\nparm u 0 0 1 1\nend\n"), "E-obj-degree", 6),
        (with("cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 4 3\n"), "E-obj-truncated", 8),
        (with("cstype bezier\ndeg 1 1\nsurf 0 1 0 1 1 2 4 3\nend\n"), "E-obj-freeform", 7),
    ] {
        assert_eq!(refused(&input), (code, Place::line(line)), "{}", String::from_utf8_lossy(&input));
    }
    for (input, code, line) in [
        (with("f 1 2\nf 1 2 3\n"), "W-obj-skipped", 5),
        (with("f 1 2 3\nf 1 2 2\n"), "W-obj-degenerate", 6),
        (with("call x.obj\nf 1 2 3\n"), "W-obj-ignored", 5),
        (with("frobnicate 1 2 3\nf 1 2 3\n"), "W-obj-statement", 5),
        (b"mtllib gone.mtl\nv 0 0 0\n".to_vec(), "W-obj-library", 1),
        (b"v 1 1 1 0\n".to_vec(), "W-obj-weight", 1),
    ] {
        assert_eq!(remarked(&input), (code, Place::line(line)), "{}", String::from_utf8_lossy(&input));
    }
    assert_eq!(remarked(b""), ("W-obj-empty", Place::Byte(0)));
    assert_eq!(refused(b"\xff\xfev\0").0, "E-text-encoding");
}

#[test]
fn bombs_stay_small() {
    // A polygon of 20,000 corners, continued lines without end, a line of a megabyte, many groups, deep relative faces.
    let mut polygon = String::new();
    for i in 0..20_000 {
        let angle = f64::from(i) * std::f64::consts::TAU / 20_000.0;
        polygon += &format!("v {} {} 0\n", angle.cos(), angle.sin());
    }
    polygon += "f";
    (1..=20_000).for_each(|i| polygon += &format!(" {i}"));
    assert_eq!(obj(polygon.as_bytes()).expect("a large polygon").shape.parts.len(), 1);
    let continued = format!("{SQUARE}f 1 2 3 {}", "\\\n".repeat(1_000_000));
    assert!(obj(continued.as_bytes()).expect("one face").findings.is_empty());
    let long = format!("{SQUARE}f{}\n", " 1 2 3 4".repeat(200_000));
    assert!(obj(long.as_bytes()).is_ok());
    let groups: String = (0..50_000).map(|i| format!("g {i}\nf 1 2 3\n")).collect();
    assert!(obj(format!("{SQUARE}{groups}").as_bytes()).is_ok());
    let objects: String = (0..50_000).map(|i| format!("o {i}\nv 0 0 {i}\nv 1 0 0\nv 1 1 0\nf -1 -2 -3\n")).collect();
    assert_eq!(obj(objects.as_bytes()).expect("many objects").shape.parts.len(), 50_000);
    let lines: String = (0..50_000).map(|i| format!("o {i}\nv 0 0 {i}\nv 1 0 0\nl -1 -2\n")).collect();
    assert_eq!(obj(lines.as_bytes()).expect("many lines").shape.parts.len(), 50_000);
    let lines = format!("{SQUARE}{}", "l 1 2\n".repeat(300_000));
    assert_eq!(obj(lines.as_bytes()).expect("one graph").shape.parts.len(), 1);
    let materials: String = (0..50_000).map(|i| format!("usemtl {i}\nf 1 2 3\n")).collect();
    assert!(obj(format!("{SQUARE}{materials}").as_bytes()).is_ok());
    let libraries: String = (0..50_000).map(|i| format!("mtllib ../{i}.mtl\n")).collect();
    assert!(obj(libraries.as_bytes()).is_ok());
}

#[test]
fn cut_and_changed_bytes_never_panic() {
    let whole = format!(
        "mtllib a.mtl\no a\n{SQUARE}vt 0 0\nvn 0 0 1\ng b c\nusemtl m\ns 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//1 -3//1 \\\n-2//1\nl 1 2 3\np 1\n"
    );
    for end in 0..whole.len() {
        if let Err(error) = obj(&whole.as_bytes()[..end]) {
            assert_eq!(error.category(), Category::Malformed, "{end}: {error}");
        }
    }
    let mut dice = Dice(7);
    for _ in 0..3000 {
        let mut broken = whole.clone().into_bytes();
        for _ in 0..1 + dice.next() % 4 {
            let at = dice.next() as usize % broken.len();
            broken[at] = b"0123456789-/ \n\\#vfe.\xff\0"[dice.next() as usize % 22];
        }
        if let Err(error) = obj(&broken) {
            assert!(!error.to_string().is_empty());
        }
    }
}

/// The collection of malformed files, where it is there: what it says, where it says.
#[test]
fn the_collection_comes_out_as_expected() {
    for case in expected("obj") {
        case.check(|kind| match kind {
            "EmptyMesh" => &["W-obj-empty"],
            "IndexOutOfRange" => &["E-obj-index"],
            "InvalidNumber" => &["E-obj-number"],
            "UnexpectedToken" => &["E-obj-row"],
            "DegenerateFace" => &["W-obj-degenerate", "W-obj-skipped"],
            "ZeroWeight" => &["W-obj-weight"],
            "IgnoredStatement" => &["W-obj-ignored"],
            "MaterialNotLoaded" => &["W-obj-library"],
            "UnknownStatement" => &["W-obj-statement"],
            "DegreeTooHigh" => &["E-obj-degree"],
            "UnexpectedEof" => &["E-obj-truncated"],
            "Unsupported" => &["E-obj-freeform"],
            _ => &[],
        });
    }
    assert!(shared_data("malformed/obj/empty.obj").is_none() || expected("obj").len() == 18);
}
