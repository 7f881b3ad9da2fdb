//! Malformed glTF: the fault has its code and its place, as a JSON pointer, a line or a byte; nothing is believed that the
//! bytes do not show, and memory stays small.

use std::fs::File;
use std::io::Read;
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value, json};
use shapeloom::core::{Category, Diagnostic, Exec, Place, Severity};
use shapeloom::io::{
    ReadContext, ReadError, ReadShape, SiblingError, SiblingName, Siblings, detect, format_by_id, read,
};

use crate::support::shared_data;

/// Three corners and the indices 0 1 2, 44 bytes.
const TRIANGLE: &str = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";

pub struct Folder(pub PathBuf);

impl Siblings for Folder {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let file = File::open(self.0.join(name.as_str())).map_err(|_| SiblingError::Missing)?;
        let mut bytes = Vec::new();
        file.take(max_bytes).read_to_end(&mut bytes).map_err(|error| SiblingError::Io(error.to_string()))?;
        Ok(bytes)
    }
}

fn triangle(change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": 44, "uri": format!("data:application/octet-stream;base64,{TRIANGLE}")}]
    });
    change(&mut document);
    document.to_string().into_bytes()
}

fn with(pointer: &'static str, value: Value) -> Vec<u8> {
    triangle(|document| {
        let (parent, key) = pointer.rsplit_once('/').expect("a pointer");
        document.pointer_mut(parent).expect("it leads somewhere")[key] = value;
    })
}

fn nodes(nodes: Value) -> Vec<u8> {
    triangle(|document| document["nodes"] = nodes)
}

/// A chain of nodes of which the last has the mesh.
fn chain(length: usize) -> Vec<u8> {
    let mut list: Vec<Value> = (1..length).map(|child| json!({"children": [child]})).collect();
    list.push(json!({"mesh": 0}));
    nodes(list.into())
}

fn glb(json: &[u8], bin: &[u8]) -> Vec<u8> {
    let mut json = json.to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let total = 12 + 8 + json.len() + 8 + bin.len();
    let word = |value: usize| (value as u32).to_le_bytes();
    [b"glTF", &word(2)[..], &word(total), &word(json.len()), b"JSON", &json, &word(bin.len()), b"BIN\0", bin].concat()
}

fn binary(change: impl FnOnce(&mut Vec<u8>)) -> Vec<u8> {
    let document = triangle(|document| document["buffers"] = json!([{"byteLength": 44}]));
    let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes);
    let bin = [floats.as_flattened(), &[0, 0, 1, 0, 2, 0, 0, 0]].concat();
    let mut file = glb(&document, &bin);
    change(&mut file);
    file
}

fn attempt(name: &str, file: &[u8], memory: u64) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(memory);
    let folder = std::env::temp_dir().join("shapeloom-no-such-folder");
    let context =
        ReadContext { exec: exec.clone(), siblings: Some(Arc::new(Folder(folder))), ..ReadContext::named(name) };
    let result = detect(file, Some(name)).map_or_else(
        |_| read(file, format_by_id("gltf").expect("a format"), &context),
        |format| read(file, format, &context),
    );
    assert_eq!(exec.memory_taken(), 0, "{name} keeps memory");
    result
}

/// What is expected of a file.
enum Outcome {
    /// It is read without a remark.
    Sound,
    /// It is read with this warning, whose place or words name this.
    Warning(&'static str, &'static str),
    /// It is refused with this code, at this pointer, line or byte.
    Fault(&'static str, String),
}
use Outcome::{Sound, Warning};

fn fault(code: &'static str, place: &str) -> Outcome {
    Outcome::Fault(code, place.to_owned())
}

/// Every defect of the collection, made here, under the name that it has there.
fn defects() -> Vec<(&'static str, Vec<u8>, Outcome)> {
    let comma = br#"{"asset":{"version":"2.0",},}"#.to_vec();
    let mark = [b"\xef\xbb\xbf", triangle(|_| {}).as_slice()].concat();
    let total = binary(|_| {}).len();
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": 1, "componentType": 5123},
        "values": {"bufferView": 0}
    });
    let swapped = TRIANGLE.replace("AAABAAIAAAA=", "AgABAAAAAAA=");
    let unsorted = triangle(|document| {
        document["accessors"][0]["sparse"] = sparse;
        document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{swapped}"));
    });
    let zero: Vec<f64> = vec![0.0; 16];
    vec![
        ("valid_triangle.gltf", triangle(|_| {}), Sound),
        ("empty_object.gltf", b"{}".to_vec(), fault("E-gltf-missing", "/asset")),
        (
            "required_extension_unknown.gltf",
            triangle(|document| document["extensionsRequired"] = json!(["EXT_no"])),
            fault("E-gltf-extension", "/extensionsRequired/0"),
        ),
        (
            "accessor_count_overflow.gltf",
            with("/accessors/0/count", json!(1_537_228_672_809_129_302u64)),
            fault("E-gltf-bounds", "/accessors/0"),
        ),
        ("accessor_count_zero.gltf", with("/accessors/0/count", json!(0)), fault("E-gltf-count", "/accessors/0/count")),
        (
            "view_beyond_buffer.gltf",
            with("/bufferViews/1/byteLength", json!(6000)),
            fault("E-gltf-bounds", "/bufferViews/1"),
        ),
        (
            "buffer_shorter_than_claimed.gltf",
            with("/buffers/0/byteLength", json!(4400)),
            fault("E-gltf-buffer", "/buffers/0"),
        ),
        (
            "uri_path_traversal.gltf",
            with("/buffers/0/uri", json!("../../../etc/passwd")),
            fault("E-sibling-path", "/buffers/0/uri"),
        ),
        (
            "missing_bin.gltf",
            with("/buffers/0/uri", json!("does_not_exist.bin")),
            fault("E-sibling-missing", "/buffers/0/uri"),
        ),
        ("indices_float.gltf", with("/accessors/1/componentType", json!(5126)), fault("E-gltf-type", "/accessors/1")),
        ("position_vec2.gltf", with("/accessors/0/type", json!("VEC2")), fault("E-gltf-type", "/accessors/0/type")),
        (
            "no_position.gltf",
            with("/meshes/0/primitives/0/attributes", json!({})),
            Warning("W-gltf-position", "/meshes/0/primitives/0"),
        ),
        (
            "node_cycle.gltf",
            nodes(json!([{"mesh": 0, "children": [1]}, {"children": [0]}])),
            fault("E-gltf-cycle", "/nodes/0"),
        ),
        (
            "node_two_parents.gltf",
            nodes(json!([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}])),
            fault("E-gltf-parents", "/nodes/2"),
        ),
        ("node_chain_50k.gltf", chain(50_000), Sound),
        (
            "node_matrix_singular.gltf",
            nodes(json!([{"mesh": 0, "matrix": zero}])),
            Warning("W-gltf-singular", "/nodes/0/matrix"),
        ),
        ("json_trailing_comma.gltf", comma, fault("E-gltf-json", "line 1, column 27")),
        ("json_bom.gltf", mark, Warning("W-gltf-mark", "byte 0")),
        ("sparse_indices_unsorted.gltf", unsorted, fault("E-gltf-sparse", "/accessors/0/sparse")),
        ("glb_bad_magic.glb", binary(|file| file[3] = b'X'), fault("E-glb-magic", "byte 0")),
        (
            "glb_total_too_long.glb",
            binary(|file| file[8..12].copy_from_slice(&(total as u32 + 100).to_le_bytes())),
            fault("E-glb-length", "byte 8"),
        ),
        ("glb_json_chunk_4g.glb", binary(|file| file[12..16].fill(0xff)), fault("E-glb-chunk", "byte 12")),
        (
            "glb_header_only.glb",
            binary(|file| {
                file.truncate(12);
                file[8..12].copy_from_slice(&12u32.to_le_bytes());
            }),
            fault("E-glb-truncated", "byte 12"),
        ),
        (
            "glb_truncated_bin.glb",
            binary(|file| file.truncate(total - 10)),
            fault("E-glb-truncated", &format!("byte {}", total - 11)),
        ),
    ]
}

fn check(name: &str, file: &[u8], outcome: &Outcome) {
    let result = attempt(name, file, 256 << 20);
    match outcome {
        Sound => {
            let read = result.unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(read.findings.is_empty(), "{name}: {:?}", read.findings);
            assert_eq!(read.shape.parts.len(), 1, "{name}");
        }
        Warning(code, place) => {
            let read = result.unwrap_or_else(|error| panic!("{name}: {error}"));
            let finding = read.findings.iter().find(|finding| finding.code == *code);
            let finding = finding.unwrap_or_else(|| panic!("{name}: {:?}", read.findings));
            assert_eq!(finding.severity, Severity::Warning, "{name}");
            let said = format!("{}; {}", finding.places[0], finding.message);
            assert!(said.contains(place), "{name}: {said}");
        }
        Outcome::Fault(code, place) => {
            let error = result.err().unwrap_or_else(|| panic!("{name} was read"));
            let fault = error.fault().unwrap_or_else(|| panic!("{name}: {error}"));
            assert_eq!(fault.code, *code, "{name}: {error}");
            let found = match (&fault.within, &fault.place) {
                (Some(pointer), _) => pointer.clone(),
                (None, place) => place.to_string(),
            };
            assert_eq!(&found, place, "{name}: {error}");
            assert!(error.to_string().starts_with(&format!("{name}: ")), "{error}");
        }
    }
}

#[test]
fn every_defect_has_its_code_and_place() {
    for (name, file, outcome) in defects() {
        check(name, &file, &outcome);
    }
    let missing = attempt("x.gltf", &with("/buffers/0/uri", json!("does_not_exist.bin")), 1 << 20).unwrap_err();
    assert!(missing.to_string().contains("\"does_not_exist.bin\": no such file"), "{missing}");
}

/// The same defects as other hands made them, where the collection is there.
#[test]
fn the_collected_defects_come_out_the_same() {
    let Some(folder) = shared_data("malformed/gltf") else { return };
    let table = std::fs::read_to_string(folder.join("../EXPECTED.tsv")).expect("the table beside the files");
    let rows: Vec<Vec<&str>> =
        table.lines().filter(|line| line.starts_with("gltf\t")).map(|line| line.split('\t').collect()).collect();
    let defects = defects();
    assert!(rows.len() >= 24);
    for row in rows {
        let (name, verdict, place) = (row[1], row[3], row[5]);
        let Some((_, _, outcome)) = defects.iter().find(|(known, _, _)| *known == name) else {
            panic!("{name} of the collection is not made here");
        };
        let file = std::fs::read(folder.join(name)).expect("a file of the collection");
        let place = match place {
            "last byte" => format!("byte {}", file.len() - 1),
            other => other.replace(" col ", ", column "),
        };
        match outcome {
            Sound => assert_eq!(verdict, "accept", "{name}"),
            Warning(_, known) => assert_eq!((verdict, *known), ("accept+warn", place.as_str()), "{name}"),
            Outcome::Fault(..) => assert_eq!(verdict, "error", "{name}"),
        }
        match outcome {
            Outcome::Fault(code, _) => check(name, &file, &fault(code, &place)),
            other => check(name, &file, other),
        }
    }
}

/// Numbers that lie: every one is refused with a typed error, within a mebibyte.
#[test]
fn what_is_merely_claimed_is_never_allocated() {
    let small = |count: Value| {
        triangle(|document| {
            document["accessors"][0]["count"] = count;
            document["bufferViews"][0]["byteLength"] = json!(3);
            document["buffers"][0] = json!({"byteLength": 3, "uri": "data:application/octet-stream;base64,AAAA"});
        })
    };
    let strided = |stride: Value| with("/bufferViews/0/byteStride", stride);
    let mut cases = vec![
        ("4e9 vertices in 3 bytes", small(json!(4_000_000_000u64))),
        ("4e9 as a float", small(json!(4e9))),
        ("2^64 - 1 vertices", small(json!(u64::MAX))),
        ("a count below zero", small(json!(-1))),
        ("a count and a half", small(json!(1.5))),
        ("1e300 vertices", small(json!(1e300))),
        ("a count in words", small(json!("three"))),
        ("stride 0", strided(json!(0))),
        ("stride 11", strided(json!(11))),
        ("stride 252", strided(json!(252))),
        ("stride 2^64 - 1", strided(json!(u64::MAX))),
        ("stride 2^63", strided(json!(1u64 << 63))),
        ("offset 2^64 - 1", with("/accessors/0/byteOffset", json!(u64::MAX))),
        ("offset that wraps with the size", with("/accessors/0/byteOffset", json!(u64::MAX - 11))),
        ("view offset 2^64 - 36", with("/bufferViews/0/byteOffset", json!(u64::MAX - 35))),
        ("view length 2^64 - 1", with("/bufferViews/1/byteLength", json!(u64::MAX))),
        ("buffer of 2^64 - 1 bytes", with("/buffers/0/byteLength", json!(u64::MAX))),
        (
            "buffer of 4e18 bytes beside the file",
            triangle(|document| {
                document["buffers"][0] = json!({"byteLength": 4_000_000_000_000_000_000u64, "uri": "a.bin"});
            }),
        ),
        (
            "indices of 4e9 zeros",
            triangle(|document| {
                document["accessors"][1] = json!({"componentType": 5125, "count": 4_000_000_000u64, "type": "SCALAR"});
            }),
        ),
        ("a node that is not there", with("/scenes/0/nodes", json!([4_294_967_296u64]))),
        ("a mesh that is not there", with("/nodes/0/mesh", json!(u64::MAX))),
    ];
    for text in ["AAA!", "A", "AAAAA", "AA A", "AAAA\n", "====", "\u{fffd}AAA"] {
        cases.push(("base64 garbage", with("/buffers/0/uri", json!(format!("data:;base64,{text}")))));
    }
    for uri in ["data:application/octet-stream,abc", "data:", "", "file:///etc/passwd", "http://x/y.bin", "%2e%2e/x"] {
        cases.push(("addresses that are not read", with("/buffers/0/uri", json!(uri))));
    }
    for (what, file) in cases {
        let error = attempt("bomb.gltf", &file, 1 << 20).expect_err(what);
        let known = [Category::Malformed, Category::OverLimit, Category::Unsupported].contains(&error.category());
        assert!(known && error.code().starts_with("E-"), "{what}: {error}");
        if let Some(fault) = error.fault() {
            assert!(fault.within.as_deref().is_some_and(|path| path.starts_with('/')), "{what}: {error}");
        }
    }
}

#[test]
fn deep_documents_and_scenes_end_in_a_typed_error() {
    let deep = |open: &str, close: &str| {
        format!("{{\"asset\":{{\"version\":\"2.0\"}},\"extras\":{}1{}}}", open.repeat(200_000), close.repeat(200_000))
    };
    for file in [deep("[", "]"), deep("{\"a\":", "}"), "[".repeat(200_000)] {
        let error = attempt("deep.gltf", file.as_bytes(), 1 << 30).expect_err("it is too deep");
        assert_eq!(error.code(), "E-gltf-json", "{error}");
        assert!(matches!(error.fault().map(|fault| &fault.place), Some(Place::Line { line: 1, .. })));
        let small = attempt("deep.gltf", file.as_bytes(), 1 << 20).expect_err("it is too large");
        assert_eq!(small.category(), Category::OverLimit, "{small}");
    }
    let error = attempt("chain.gltf", &chain(200_000), 1 << 30).expect_err("it is too deep");
    assert_eq!((error.code(), error.category()), ("E-gltf-depth", Category::OverLimit), "{error}");
}
