//! Lists of segments, and graphs.

use serde_json::{Value, json};
use shapeloom_core::glam::DVec3;
use shapeloom_core::{Deviation, Exec};
use shapeloom_mesh::{Column, GeometricGraph, Polyline, Values};
use shapeloom_shape::{Kind, Part, Representation, Shape, UpAxis};

use super::super::base64;
use super::{from_glb, to_glb};
use crate::{ReadContext, ReadError, ReadShape, format_by_id, read};

/// Points (0, 0, 0) to (n - 1, 0, 0) and byte indices over them.
fn lines(points: u8, mode: u64, indices: Option<&[u8]>, exec: Exec) -> Result<ReadShape, ReadError> {
    let positions = (0..points).flat_map(|i| [f32::from(i), 0.0, 0.0]).flat_map(f32::to_le_bytes);
    let bytes: Vec<u8> = positions.chain(indices.unwrap_or(&[]).iter().copied()).collect();
    let mut encoded = Vec::new();
    base64::encode(&bytes, &mut encoded).unwrap();
    let start = usize::from(points) * 12;
    let view = |start: usize, end: usize| json!({"buffer": 0, "byteOffset": start, "byteLength": end - start});
    let document = json!({
        "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0}, "mode": mode, "indices": indices.map_or(Value::Null, |_| json!(1))
        }]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": indices.map_or(1, <[u8]>::len), "type": "SCALAR"}
        ],
        "bufferViews": [view(0, start), view(start, bytes.len())],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{}", String::from_utf8(encoded).unwrap())
        }]
    });
    let mut document = document;
    if indices.is_none() {
        document["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    }
    let context = ReadContext { exec, ..ReadContext::default() };
    read(document.to_string().as_bytes(), format_by_id("gltf").unwrap(), &context)
}

fn at(shape: &Shape) -> (Vec<f64>, bool) {
    let line = Polyline::from_geometry(&shape.parts[0].geometry).unwrap();
    (line.points().iter().map(|point| point.x).collect(), line.is_closed())
}

#[test]
fn a_chain_of_segments_is_a_polyline_and_anything_else_a_graph() {
    let read = |points, mode, indices| lines(points, mode, indices, Exec::default()).unwrap();
    assert_eq!(at(&read(4, 1, Some(&[2, 0, 0, 3])).shape), (vec![2.0, 0.0, 3.0], false));
    assert_eq!(at(&read(3, 1, Some(&[0, 1, 1, 2, 2, 0])).shape), (vec![0.0, 1.0, 2.0], true));
    assert_eq!(at(&read(2, 1, None).shape), (vec![0.0, 1.0], false));
    assert_eq!(at(&read(3, 2, None).shape), (vec![0.0, 1.0, 2.0], true));
    assert_eq!(at(&read(3, 3, Some(&[0, 2])).shape), (vec![0.0, 2.0], false));
    let forked = read(4, 1, Some(&[0, 1, 2, 1, 1, 3, 0]));
    assert_eq!(forked.shape.parts.len(), 1);
    let graph = GeometricGraph::from_geometry(&forked.shape.parts[0].geometry).unwrap();
    assert_eq!((graph.positions().len(), graph.edges()), (4, &[[0, 1], [2, 1], [1, 3]][..]));
    assert_eq!(forked.findings.iter().next().unwrap().code, "W-gltf-corners");
    let apart = read(4, 1, None);
    assert_eq!(apart.shape.parts[0].geometry.kind(), Kind::GeometricGraph);
    assert!(apart.findings.is_empty());
}

#[test]
fn many_short_segments_take_little_memory() {
    let indices: Vec<u8> = (0..60_000).map(|i| if i % 2 == 0 { 0 } else { 1 + (i / 2 % 2) as u8 }).collect();
    let shape = lines(3, 1, Some(&indices), Exec::default().with_memory(4 << 20)).unwrap().shape;
    assert_eq!(GeometricGraph::from_geometry(&shape.parts[0].geometry).unwrap().edges().len(), 30_000);
}

#[test]
fn graphs_survive() {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.5, 0.5, 2.0), DVec3::ONE];
    let mut graph = GeometricGraph::try_new(positions, vec![[0, 3], [1, 3], [3, 2], [2, 2]]).unwrap();
    graph
        .insert_vertex_attribute(Column::try_new("heat", 1, Values::F32(vec![1.0, 2.0, 3.0, 4.0, 5.0])).unwrap())
        .unwrap();
    let shape = Shape { up: Some(UpAxis::Y), ..Shape::new(Part::new(graph.clone()).named("fork")) };
    let (file, report) = to_glb(&shape).unwrap();
    assert!(report.losses.is_empty() && report.deviation == Deviation::Exact);
    let back = from_glb(&file).shape;
    assert_eq!(GeometricGraph::from_geometry(&back.parts[0].geometry).unwrap(), &graph);
    let (document, buffers, _) = ::gltf::import_slice(&file).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.mode(), ::gltf::mesh::Mode::Lines);
    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    assert_eq!(reader.read_indices().unwrap().into_u32().collect::<Vec<_>>(), graph.edges().as_flattened());
    let lone = Shape::new(Part::new(GeometricGraph::try_new(vec![DVec3::ZERO], vec![]).unwrap()));
    let (_, report) = to_glb(&lone).unwrap();
    assert_eq!(report.losses[0].what, "1 points of the geometric-graph of part 0");
}
