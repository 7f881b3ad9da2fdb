//! Small files that say the same again and again: what is made of them stays in proportion to their bytes.

use std::sync::Arc;

use serde_json::{Value, json};
use shapeloom_core::{Category, Diagnostic};

use crate::{ReadContext, ReadError, ReadShape, SiblingError, SiblingName, Siblings, format_by_id, read};

/// Points in a file of one buffer beside the document.
fn points(count: usize, nodes: Vec<Value>, primitives: Vec<Value>, accessors: usize) -> Value {
    let accessor = json!({"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3"});
    json!({
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "meshes": [{"primitives": primitives}],
        "accessors": vec![accessor; accessors],
        "bufferViews": [{"buffer": 0, "byteLength": count * 12}],
        "buffers": [{"byteLength": count * 12, "uri": "zeros.bin"}]
    })
}

struct Zeros(usize);

impl Siblings for Zeros {
    fn open(&self, _: &SiblingName, most: u64) -> Result<Vec<u8>, SiblingError> {
        Ok(vec![0; self.0.min(most as usize)])
    }
}

fn attempt(document: &Value, beside: usize) -> Result<ReadShape, ReadError> {
    let context = ReadContext { siblings: Some(Arc::new(Zeros(beside))), ..ReadContext::default() };
    read(document.to_string().as_bytes(), format_by_id("gltf").unwrap(), &context)
}

fn refused(document: &Value, beside: usize, words: &str) {
    let error = attempt(document, beside).unwrap_err();
    assert_eq!((error.code(), error.category()), ("E-gltf-limit", Category::OverLimit), "{error}");
    assert!(error.to_string().contains(words) && error.advice().is_some(), "{error}");
}

#[test]
fn nodes_times_primitives_are_bounded_by_the_length() {
    let primitive = json!({"attributes": {"POSITION": 0}, "mode": 0});
    let document = |count: usize| points(1, vec![json!({"mesh": 0}); count], vec![primitive.clone(); count], 1);
    assert_eq!(attempt(&document(128), 12).unwrap().shape.parts.len(), 16_384);
    let file = document(200);
    refused(&file, 12, &format!("more than {} parts", 16_384 + (file.to_string().len() + 12) / 32));
    // What has no positions makes no parts, however many nodes show it; nor does that take long.
    let empty = points(1, vec![json!({"mesh": 0}); 3000], vec![json!({"attributes": {}}); 3000], 1);
    assert!(attempt(&empty, 12).unwrap().shape.parts.is_empty());
}

#[test]
fn names_of_parts_are_in_proportion() {
    let primitive = json!({"attributes": {"POSITION": 0}, "mode": 0});
    let named = |length: usize| {
        points(1, vec![json!({"mesh": 0, "name": "n".repeat(length)})], vec![primitive.clone(); 10_000], 1)
    };
    assert_eq!(attempt(&named(20), 12).unwrap().shape.parts.len(), 10_000);
    refused(&named(20_000), 12, "/nodes/0: found");
}

#[test]
fn accessors_of_one_view_are_decoded_in_proportion() {
    let all = |count: usize, primitives: usize| {
        let list = (0..primitives).map(|accessor| json!({"attributes": {"POSITION": accessor}, "mode": 0})).collect();
        points(count, vec![json!({"mesh": 0})], list, primitives)
    };
    // 48 MB of positions from 1.2 MB; then 120 MB.
    assert_eq!(attempt(&all(100_000, 20), 1_200_000).unwrap().shape.parts.len(), 20);
    refused(&all(100_000, 50), 1_200_000, "/meshes/0/primitives/");
    // The same accessor under other attributes is decoded again.
    let mut colors = all(100_000, 20);
    for (number, primitive) in colors["meshes"][0]["primitives"].as_array_mut().unwrap().iter_mut().enumerate() {
        primitive["attributes"]["COLOR_0"] = json!(number);
    }
    refused(&colors, 1_200_000, "/attributes/");
    // So are points that indices name many times.
    let mut again = all(100_000, 2);
    again["meshes"][0]["primitives"] = json!([{"attributes": {"POSITION": 0}, "indices": 1, "mode": 0}]);
    again["accessors"][1] = json!({"bufferView": 0, "componentType": 5121, "count": 1_200_000, "type": "SCALAR"});
    refused(&again, 1_200_000, "/meshes/0/primitives/0: found");
}

#[test]
fn materials_that_name_one_long_picture_are_in_proportion() {
    let primitive = json!({"attributes": {"POSITION": 0}, "mode": 0});
    let mut document = points(1, vec![json!({"mesh": 0})], vec![primitive], 1);
    document["images"] = json!([{"uri": "p".repeat(50_000)}]);
    document["textures"] = json!([{"source": 0}]);
    let material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
    document["materials"] = vec![material.clone(); 100].into();
    assert_eq!(attempt(&document, 12).unwrap().shape.materials.len(), 100);
    document["materials"] = vec![material; 2000].into();
    refused(&document, 12, "/materials/");
}

#[test]
fn one_file_as_many_buffers_counts_once() {
    let mut document = points(1000, vec![], vec![], 1);
    document["meshes"] = Value::Null;
    document.as_object_mut().unwrap().remove("meshes");
    let buffer = json!({"byteLength": 1_000_000, "uri": "zeros.bin"});
    document["buffers"] = vec![buffer.clone(); 50].into();
    assert!(attempt(&document, 1_000_000).is_ok());
    document["buffers"] = vec![buffer; 70].into();
    refused(&document, 1_000_000, "/buffers/");
}
