//! Malformed PLY: typed errors that name the place, within the memory budget, never a panic.

use shapeloom::core::{Diagnostic, Exec, Place};
use shapeloom::io::{
    Encoding, ReadContext, ReadError, ReadShape, WriteContext, WriteOptions, format_by_id, read, write,
};
use shapeloom::shape::Geometry;

use crate::support::{Dice, shared_data};

/// What a file of a few bytes may take.
const BUDGET: u64 = 1 << 20;

fn attempt(bytes: &[u8]) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(BUDGET + 40 * bytes.len() as u64);
    let context = ReadContext { exec, ..ReadContext::named("x.ply") };
    let found = read(bytes, format_by_id("ply").expect("a format"), &context);
    assert_eq!(context.exec.memory_taken(), 0, "what was reserved returns");
    found
}

/// The error of a file, as code and place.
fn refused(bytes: &[u8]) -> (&'static str, Place) {
    match attempt(bytes) {
        Ok(_) => panic!("it was read: {}", String::from_utf8_lossy(bytes)),
        Err(error) => {
            assert!(error.to_string().starts_with("x.ply: "), "{error}");
            (error.code(), error.fault().expect("a fault of the input").place.clone())
        }
    }
}

const HEAD: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 4\nproperty list uchar int vertex_indices\nend_header\n";
const BODY: &str = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

fn tetrahedron() -> String {
    HEAD.to_owned() + BODY
}

/// The same in binary.
fn binary(encoding: Encoding) -> Vec<u8> {
    let shape = attempt(tetrahedron().as_bytes()).expect("a sound file").shape;
    let mut bytes = Vec::new();
    let context = WriteContext { options: WriteOptions { encoding, ..WriteOptions::default() }, ..Default::default() };
    write(&shape, format_by_id("ply").expect("a format"), &context, &mut bytes).expect("it can be written");
    bytes
}

fn with(from: &str, to: &str) -> (&'static str, Place) {
    let text = tetrahedron();
    assert!(text.contains(from));
    refused(text.replacen(from, to, 1).as_bytes())
}

fn line(number: u64) -> Place {
    Place::line(number)
}

#[test]
fn every_class_of_fault_is_told_with_its_line() {
    assert_eq!(refused(b""), ("E-ply-magic", Place::Byte(0)));
    assert_eq!(with("ply", "plx"), ("E-ply-magic", line(1)));
    assert_eq!(with("format ascii 1.0\n", ""), ("E-ply-format", line(2)));
    assert_eq!(with("ascii", "text"), ("E-ply-format", line(2)));
    assert_eq!(with("vertex 4", "vertex -1"), ("E-ply-count", line(3)));
    assert_eq!(with("vertex 4", "vertex 18446744073709551620"), ("E-ply-count", line(3)));
    assert_eq!(with("vertex 4", "vertex 4294967295"), ("E-ply-limit", line(3)));
    assert_eq!(with("vertex 4", "vertex 4000000000"), ("E-ply-claim", line(3)));
    assert_eq!(with("face 4", "face 4000000000"), ("E-ply-claim", line(7)));
    assert_eq!(with("element vertex 4\n", ""), ("E-ply-header", line(3)));
    assert_eq!(with("float y", "float x"), ("E-ply-duplicate", line(5)));
    assert_eq!(with("float y", "float w"), ("E-ply-header", line(3)));
    assert_eq!(with("float y", "quad y"), ("E-ply-type", line(5)));
    assert_eq!(with("list uchar", "list float"), ("E-ply-type", line(8)));
    assert_eq!(with("0 0 1\n", "0 0 1 9 9\n"), ("E-ply-row", line(13)));
    assert_eq!(with("0 0 1\n", "0 0\n"), ("E-ply-row", line(13)));
    assert_eq!(with("0 0 1\n", "0 0 x\n"), ("E-ply-number", line(13)));
    assert_eq!(with("0 0 1\n", "0 0 nan\n"), ("E-ply-finite", line(13)));
    assert_eq!(with("0 0 1\n", "0 0 -inf\n"), ("E-ply-finite", line(13)));
    assert_eq!(with("0 0 1\n", "0 0 1e400\n"), ("E-ply-finite", line(13)));
    assert_eq!(with("3 1 2 3", "3 1 2 -2"), ("E-ply-index", line(17)));
    assert_eq!(with("3 1 2 3", "3 1 2 4"), ("E-ply-index", line(17)));
    assert_eq!(with("3 1 2 3", "3 1 2 4294967297"), ("E-ply-index", line(17)));
    assert_eq!(with("3 1 2 3", "-3 1 2 3"), ("E-ply-count", line(17)));
    assert_eq!(with("3 1 2 3", "4 1 2 3"), ("E-ply-row", line(17)));
    assert_eq!(with("3 1 2 3\n", ""), ("E-ply-truncated", line(16)));
    let longer = attempt(tetrahedron().replace("format ascii 1.0", "format ascii 2.0").as_bytes()).expect("it is read");
    assert_eq!(longer.findings.iter().next().map(|one| one.code), Some("W-ply-version"));
}

#[test]
fn binary_faults_are_told_with_their_byte() {
    let sound = binary(Encoding::Binary);
    let body = sound.len() - 4 * 12 - 4 * 13;
    let changed = |at: usize, bytes: &[u8]| {
        let mut copy = sound.clone();
        copy[at..at + bytes.len()].copy_from_slice(bytes);
        copy
    };
    let byte = |at: usize| Place::Byte(at as u64);
    assert_eq!(refused(&changed(body + 16, &f32::NAN.to_le_bytes())), ("E-ply-finite", byte(body + 12)));
    assert_eq!(refused(&changed(body + 48 + 26 + 5, &(-1i32).to_le_bytes())), ("E-ply-index", byte(body + 48 + 26)));
    assert_eq!(refused(&changed(body + 48 + 1, &4i32.to_le_bytes())), ("E-ply-index", byte(body + 48)));
    assert_eq!(refused(&changed(body + 48 + 39, &[200])), ("E-ply-truncated", byte(body + 48 + 39)));
    assert_eq!(refused(&sound[..body + 20]), ("E-ply-claim", line(3)));
    assert_eq!(refused(&sound[..sound.len() - 1]).0, "E-ply-truncated");
    // The vertices in one order, the faces in the other.
    let big = binary(Encoding::BinaryBigEndian);
    let mixed = [&sound[..body + 48], &big[big.len() - 52..]].concat();
    let error = attempt(&mixed).expect_err("indices in the wrong order");
    let wanted = format!("x.ply: byte {}: face 0: found 33554432, expected the index of a vertex, 0 to 3", body + 48);
    assert!(error.to_string().starts_with(&wanted), "{error}");
    // An order of bytes that is not the one the header names: nothing fits, whatever it is.
    let text = String::from_utf8_lossy(&sound[..body]).replace("little", "big");
    assert!(attempt(&[text.as_bytes(), &sound[body..]].concat()).is_err());
    let trailing = attempt(&[&sound[..], b"more"].concat()).expect("it is read");
    let only = trailing.findings.iter().next().expect("a finding");
    assert_eq!((only.code, &only.places[..]), ("W-ply-trailing", &[byte(sound.len())][..]));
}

/// Headers that promise much take neither memory nor time.
#[test]
fn promises_are_not_believed() {
    for layout in ["ascii", "binary_little_endian", "binary_big_endian"] {
        let head = |elements: &str| format!("ply\nformat {layout} 1.0\n{elements}end_header\n").into_bytes();
        // Rows of nothing are no work.
        let none = attempt(&head("element nothing 4000000000\nelement more 4294967294\n")).expect("nothing to read");
        let rows: Vec<usize> = none.shape.tables.iter().map(|table| table.columns.len()).collect();
        assert_eq!(rows, [4_000_000_000, 4_294_967_294]);
        assert_eq!(refused(&head("element thing 4000000000\nproperty double v\n")), ("E-ply-claim", line(3)));
        let lists = "element thing 4000000000\nproperty list uchar double v\n";
        assert_eq!(refused(&head(lists)), ("E-ply-claim", line(3)));
        let many: String = (0..1_000_000).map(|i| format!("property int p{i}\n")).collect();
        assert_eq!(refused(&head(&format!("element vertex 0\n{many}"))).0, "E-ply-limit");
        let many: String = (0..100_000).map(|i| format!("element e{i} 0\n")).collect();
        assert_eq!(refused(&head(&many)).0, "E-ply-limit");
        let comments = "comment x\n".repeat(200_000);
        assert_eq!(attempt(&head(&comments)).expect("comments are comments").shape.comments.len(), 200_000);
    }
    let bomb = |count: &str, value: &[u8]| {
        let head = format!(
            "ply\nformat binary_little_endian 1.0\nelement thing 1\nproperty list {count} double v\nend_header\n"
        );
        (head.len() as u64, refused(&[head.as_bytes(), value, &[0; 64]].concat()))
    };
    for (count, value, code) in [
        ("uint", &4_294_967_280u32.to_le_bytes()[..], "E-ply-truncated"),
        ("int", &i32::MAX.to_le_bytes(), "E-ply-truncated"),
        ("int", &(-1i32).to_le_bytes(), "E-ply-count"),
        ("char", &[0x80], "E-ply-count"),
        ("ushort", &[255; 2], "E-ply-truncated"),
        ("uchar", &[9], "E-ply-truncated"),
    ] {
        let (at, found) = bomb(count, value);
        assert_eq!(found, (code, Place::Byte(at)), "{count}");
    }
    // Rows of one byte each are believed, and take a few bytes each.
    let head = "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty char x\nproperty char y\nproperty char z\n\
                element face 1000000\nproperty list uchar int vertex_indices\nproperty list uchar int a\nend_header\n";
    let found = attempt(&[head.as_bytes(), &vec![0; 2_000_000]].concat()).expect("empty faces");
    let skipped = found.findings.iter().find(|one| one.code == "W-ply-skipped").expect("a finding");
    assert_eq!((skipped.count, skipped.places.len()), (1_000_000, 16));
}

#[test]
fn large_polygons_are_polygons() {
    let vertices: String = (0..20_000).map(|i| format!("{i} {} 0\n", i * i)).collect();
    let corners: Vec<String> = (0..20_000).map(|i| i.to_string()).collect();
    let text = HEAD.replace("vertex 4", "vertex 20000").replace("face 4", "face 1").replace("uchar int", "uint int")
        + &vertices
        + &format!("20000 {}\n", corners.join(" "));
    let shape = attempt(text.as_bytes()).expect("a polygon").shape;
    let Geometry::PolyMesh(mesh) = &*shape.parts[0].geometry else { panic!("a polygon") };
    assert_eq!(mesh.face(0).len(), 20_000);
}

/// Cut anywhere, a file is refused, or what is missing was only its last line end.
#[test]
fn files_cut_at_every_byte_are_refused() {
    let text = tetrahedron();
    for end in 0..text.len() - 2 {
        let (code, place) = refused(&text.as_bytes()[..end]);
        let fits = match code {
            "E-ply-magic" => end < 3,
            "E-ply-truncated" | "E-ply-claim" | "E-ply-row" | "E-ply-number" => end >= 3,
            _ => false,
        };
        assert!(fits && (matches!(place, Place::Line { .. }) || end == 0), "{end}: {code} {place}");
    }
    assert!(attempt(&text.as_bytes()[..text.len() - 1]).is_ok());
    for encoding in [Encoding::Binary, Encoding::BinaryBigEndian] {
        let whole = binary(encoding);
        for end in 0..whole.len() {
            let (code, _) = refused(&whole[..end]);
            assert!(["E-ply-magic", "E-ply-truncated", "E-ply-claim"].contains(&code), "{end}: {code}");
        }
    }
}

#[test]
fn flipped_bytes_never_panic() {
    let mut dice = Dice(7);
    let mut read_well = 0;
    for whole in [tetrahedron().into_bytes(), binary(Encoding::Binary), binary(Encoding::BinaryBigEndian)] {
        for _ in 0..4000 {
            let mut broken = whole.clone();
            for _ in 0..1 + dice.next() % 4 {
                let at = dice.next() as usize % broken.len();
                broken[at] = dice.next() as u8;
            }
            match attempt(&broken) {
                Ok(_) => read_well += 1,
                Err(error) => {
                    assert!(error.code().starts_with("E-ply-") || error.code().starts_with("E-text-"), "{error}")
                }
            }
        }
    }
    assert!(read_well > 100, "{read_well}");
}

/// The collection of malformed files, where it is there: each comes out as its list says, at the place that it says.
#[test]
fn files_of_the_collection_come_out_as_expected() {
    let Some(list) = shared_data("malformed/EXPECTED.tsv") else { return };
    let list = std::fs::read_to_string(list).expect("a list");
    let mut seen = 0;
    for line in list.lines().filter(|line| line.starts_with("ply\t")) {
        let cells: Vec<&str> = line.split('\t').collect();
        let [_, file, _, outcome, kinds, place, _] = cells[..] else { panic!("{line}") };
        let path = shared_data(&format!("malformed/ply/{file}")).expect("a file of the list");
        let found = attempt(&std::fs::read(path).expect("it can be read"));
        let words: Vec<&str> = kinds.split('|').flat_map(words_of).copied().collect();
        let told = match (outcome, &found) {
            ("accept", Ok(found)) => {
                assert!(found.findings.is_empty(), "{file}: {:?}", found.findings);
                assert_eq!(found.shape.parts[0].geometry.memory_bytes(), 4 * 24 + 4 * 12, "{file}");
                String::new()
            }
            ("accept+warn", Ok(found)) => {
                let finding = found.findings.iter().next().unwrap_or_else(|| panic!("{file}: no finding"));
                format!("{}: {}", finding.code, finding.places[0])
            }
            ("error", Err(error)) => format!("{}: {error}", error.code()),
            _ => panic!("{file}: {found:?}"),
        };
        if outcome != "accept" {
            let code = told.split(':').next().unwrap_or_default();
            assert!(words.iter().any(|word| code.ends_with(&format!("-ply-{word}"))), "{file}: {told}");
            let (at, element) = place.split_once(" (").unwrap_or((place, ""));
            assert!(told.contains(at) && told.contains(element.trim_end_matches(')')), "{file}: {told}");
        }
        seen += 1;
    }
    assert_eq!(seen, 19);
}

/// The words of our codes for a kind of fault.
fn words_of(kind: &str) -> &'static [&'static str] {
    match kind {
        "UnexpectedEof" => &["truncated"],
        "CountExceedsInput" => &["claim"],
        "InvalidCount" => &["count"],
        "UnexpectedToken" => &["row", "header"],
        "BadMagic" => &["magic"],
        "MissingFormat" => &["format"],
        "UnsupportedVersion" => &["version"],
        "DuplicateProperty" => &["duplicate"],
        "UnknownType" | "InvalidListType" => &["type"],
        "IndexOutOfRange" => &["index"],
        "NonFinite" => &["finite"],
        "DegenerateFace" => &["degenerate", "skipped", "strips"],
        _ => &[],
    }
}
