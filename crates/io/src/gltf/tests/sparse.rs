//! Sparse accessors, and accessors of zeros.

use serde_json::{Value, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Diagnostic, Exec, Place};
use shapeloom_mesh::{Domain, Values};

use super::super::base64;
use super::mesh;
use crate::{ReadContext, ReadError, ReadShape, format_by_id, read};

/// Four floats a time as positions of a triangle, then `2 0 1` in bytes, and sparse lists behind them.
fn bytes() -> Vec<u8> {
    let base = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let values = [5.0f32, 6.0, 7.0, -1.0, -2.0, -3.0];
    let floats = base.iter().chain(&values).flat_map(|value| value.to_le_bytes());
    // From byte 60: indices 0 2 in bytes, then in shorts, then in words; from byte 76 whole numbers.
    let lists = [0u8, 2, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 9, 8, 2, 0, 1];
    floats.chain(lists).collect()
}

fn document(change: impl FnOnce(&mut Value)) -> Value {
    let mut encoded = Vec::new();
    base64::encode(&bytes(), &mut encoded).unwrap();
    let uri = format!("data:application/octet-stream;base64,{}", String::from_utf8(encoded).unwrap());
    let sparse = |at: u64, component: u64| {
        json!({
            "count": 2,
            "indices": {"bufferView": 1, "byteOffset": at, "componentType": component},
            "values": {"bufferView": 0, "byteOffset": 36}
        })
    };
    let mut document = json!({
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse(0, 5121)},
            {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse(2, 5123)},
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "sparse": sparse(8, 5125)},
            {"componentType": 5121, "count": 3, "type": "SCALAR", "sparse": {
                "count": 2,
                "indices": {"bufferView": 1, "componentType": 5121},
                "values": {"bufferView": 1, "byteOffset": 16}
            }},
            {"componentType": 5121, "count": 3, "type": "SCALAR"}
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": 60},
            {"buffer": 0, "byteOffset": 60, "byteLength": 21}
        ],
        "buffers": [{"byteLength": 81, "uri": uri}]
    });
    change(&mut document);
    document
}

fn attempt(change: impl FnOnce(&mut Value)) -> Result<ReadShape, ReadError> {
    let context = ReadContext { exec: Exec::default().with_memory(1 << 20), ..ReadContext::named("x.gltf") };
    read(document(change).to_string().as_bytes(), format_by_id("gltf").unwrap(), &context)
}

#[test]
fn listed_elements_replace_those_of_the_view_or_zeros() {
    let (first, last) = (DVec3::new(5.0, 6.0, 7.0), DVec3::new(-1.0, -2.0, -3.0));
    for (accessor, middle) in [(0, DVec3::X), (1, DVec3::ZERO), (2, DVec3::X)] {
        let change = |document: &mut Value| {
            document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(accessor);
        };
        let shape = attempt(change).unwrap().shape;
        assert_eq!(mesh(&shape, 0).positions(), [first, middle, last], "accessor {accessor}");
    }
}

#[test]
fn every_use_of_an_accessor_may_be_sparse() {
    let shape = attempt(|document| {
        let primitive = &mut document["meshes"][0]["primitives"][0];
        primitive["attributes"] = json!({"POSITION": 0, "NORMAL": 1, "_id": 3});
        primitive["indices"] = json!(4);
    });
    // Three zeros make a triangle of one corner, which is the mesh that the file has.
    let shape = shape.unwrap().shape;
    let read = mesh(&shape, 0);
    assert_eq!(read.triangles(), [[0, 0, 0]]);
    assert_eq!(read.attribute(Domain::Vertex, "id").unwrap().values(), &Values::U8(vec![9, 0, 8]));
    assert_eq!(read.attribute(Domain::Vertex, "normal").unwrap().vector(1), DVec3::ZERO);
    let error = attempt(|document| document["meshes"][0]["primitives"][0]["indices"] = json!(3)).unwrap_err();
    let fault = error.fault().unwrap();
    assert_eq!((fault.code, fault.found.as_str()), ("E-gltf-index", "index 9 at 0"));
}

#[test]
fn lists_that_do_not_rise_or_leave_the_accessor_are_refused() {
    let fault = |pointer: &str, value: Value| {
        let error = attempt(|document| *document.pointer_mut(pointer).unwrap() = value).unwrap_err();
        let fault = error.fault().unwrap().clone();
        (fault.code, fault.within.unwrap())
    };
    let indices = "/accessors/0/sparse/indices";
    // From byte 1 on the list is 2 0, from byte 2 on 0 0.
    for offset in [1, 2] {
        let found = fault(indices, json!({"bufferView": 1, "byteOffset": offset, "componentType": 5121}));
        assert_eq!(found, ("E-gltf-sparse", "/accessors/0/sparse".into()));
    }
    // Nine is no element of three, and neither is two of two.
    let large = json!({"bufferView": 1, "byteOffset": 15, "componentType": 5121});
    assert_eq!(fault(indices, large), ("E-gltf-sparse", "/accessors/0/sparse".into()));
    assert_eq!(fault("/accessors/0/count", json!(2)), ("E-gltf-sparse", "/accessors/0/sparse".into()));
    for count in [json!(0), json!(4), json!(u64::MAX)] {
        assert_eq!(fault("/accessors/0/sparse/count", count), ("E-gltf-count", "/accessors/0/sparse/count".into()));
    }
    assert_eq!(
        fault("/accessors/0/sparse/values/byteOffset", json!(37)),
        ("E-gltf-bounds", "/accessors/0/sparse/values".into())
    );
    assert_eq!(fault("/accessors/0/sparse/indices/byteOffset", json!(20)).0, "E-gltf-bounds");
    assert_eq!(
        fault("/accessors/0/sparse/indices/componentType", json!(5122)),
        ("E-gltf-type", "/accessors/0/sparse/indices/componentType".into())
    );
    assert_eq!(fault("/accessors/0/sparse/values", json!({})).1, "/accessors/0/sparse/values/bufferView");
}

#[test]
fn zeros_that_are_merely_claimed_take_no_memory() {
    for count in [200_000u64, 4_000_000_000] {
        let change = |document: &mut Value| {
            document["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(1);
            document["accessors"][1]["count"] = json!(count);
        };
        let error = attempt(change).unwrap_err();
        assert_eq!((error.code(), error.category()), ("E-gltf-limit", Category::OverLimit), "{count}");
    }
    let attribute = |document: &mut Value| {
        document["meshes"][0]["primitives"][0]["attributes"]["_id"] = json!(4);
        document["accessors"][4]["count"] = json!(4_000_000_000u64);
    };
    let error = attempt(attribute).unwrap_err();
    assert_eq!((error.code(), error.fault().unwrap().within.as_deref()), ("E-gltf-count", Some("/accessors/4/count")));
}

#[test]
fn positions_that_are_not_finite_are_named_or_dropped() {
    let poison = |document: &mut Value| {
        // Element 2 is the second of the list, at byte 48.
        let mut bytes = bytes();
        bytes[52..56].copy_from_slice(&f32::NAN.to_le_bytes());
        let mut encoded = Vec::new();
        base64::encode(&bytes, &mut encoded).unwrap();
        let encoded = String::from_utf8(encoded).unwrap();
        document["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{encoded}"));
    };
    let error = attempt(poison).unwrap_err();
    let fault = error.fault().unwrap();
    assert_eq!(
        (fault.code, fault.within.as_deref(), &fault.place),
        ("E-gltf-finite", Some("/accessors/0"), &Place::Whole)
    );
    assert!(fault.found.ends_with("as element 2, at byte 48 of its buffer"), "{error}");
    let mut context = ReadContext::default();
    context.options.drop_non_finite = true;
    let text = document(poison).to_string();
    let read = read(text.as_bytes(), format_by_id("gltf").unwrap(), &context).unwrap();
    assert_eq!((mesh(&read.shape, 0).positions().len(), mesh(&read.shape, 0).triangles().len()), (2, 0));
}

#[test]
fn every_element_of_a_long_list_is_found() {
    let indices: Vec<u8> = (0..120).filter(|i| i % 3 != 1 && i % 7 != 2).collect();
    let values = indices.iter().flat_map(|&index| [f32::from(index) + 0.5, 0.0, 0.0]).flat_map(f32::to_le_bytes);
    let bytes: Vec<u8> = values.chain(indices.iter().copied()).collect();
    let mut encoded = Vec::new();
    base64::encode(&bytes, &mut encoded).unwrap();
    let encoded = String::from_utf8(encoded).unwrap();
    let shape = attempt(|document| {
        document["meshes"][0]["primitives"][0] = json!({"attributes": {"POSITION": 0}, "mode": 0});
        document["accessors"] = json!([{"componentType": 5126, "count": 120, "type": "VEC3", "sparse": {
            "count": indices.len(),
            "indices": {"bufferView": 0, "byteOffset": 12 * indices.len(), "componentType": 5121},
            "values": {"bufferView": 0}
        }}]);
        document["bufferViews"] = json!([{"buffer": 0, "byteLength": bytes.len()}]);
        let uri = format!("data:application/octet-stream;base64,{encoded}");
        document["buffers"][0] = json!({"byteLength": bytes.len(), "uri": uri});
    });
    let shape = shape.unwrap().shape;
    let points = crate::placed::points_of(&shape.parts[0].geometry).unwrap();
    let wanted = (0..120u8).map(|i| if indices.contains(&i) { f64::from(i) + 0.5 } else { 0.0 });
    assert_eq!(points.iter().map(|point| point.x).collect::<Vec<_>>(), wanted.collect::<Vec<_>>());
}

#[test]
fn a_position_of_a_binary_file_is_named_by_its_byte() {
    let (mut file, _) = super::to_glb(&super::scene()).unwrap();
    let whole = super::from_glb(&file).shape;
    // Point 3 of the line, found by its bytes.
    let point = crate::placed::points_of(&whole.parts[2].geometry).unwrap()[3].as_vec3();
    let bytes: Vec<u8> = point.to_array().into_iter().flat_map(f32::to_le_bytes).collect();
    let at = file.windows(12).position(|window| window == bytes).unwrap();
    file[at + 8..at + 12].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let error = read(&file, format_by_id("glb").unwrap(), &ReadContext::default()).unwrap_err();
    let fault = error.fault().unwrap();
    assert_eq!((fault.code, &fault.place), ("E-gltf-finite", &Place::Byte(at as u64)), "{error}");
    assert!(fault.found.contains("as element 3, at byte "), "{error}");
}

#[test]
fn damaged_documents_never_panic_and_return_their_memory() {
    let text = document(|document| {
        document["meshes"][0]["primitives"] = json!([
            {"attributes": {"POSITION": 0, "NORMAL": 1, "_id": 3}, "indices": 4},
            {"attributes": {"POSITION": 1}, "mode": 1},
            {"attributes": {"POSITION": 2}, "mode": 2}
        ]);
        document["nodes"] = json!([{"children": [1, 2]}, {"mesh": 0}, {"mesh": 0, "scale": [1, 2, 3]}]);
    })
    .to_string();
    let mut state = 5u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let (mut sound, mut refused) = (0, 0);
    for _ in 0..4000 {
        let mut damaged = text.clone().into_bytes();
        for _ in 0..1 + next() % 3 {
            let at = next() % damaged.len();
            damaged[at] = b"0123456789-.[]{},\""[next() % 18];
        }
        let exec = Exec::default().with_memory(1 << 20);
        let context = ReadContext { exec: exec.clone(), ..ReadContext::default() };
        match read(&damaged, format_by_id("gltf").unwrap(), &context) {
            Ok(_) => sound += 1,
            Err(_) => refused += 1,
        }
        assert_eq!(exec.memory_taken(), 0);
    }
    assert!(sound > 100 && refused > 1000, "{sound} {refused}");
}
