//! Files taken apart by a small reader of their own.

use std::collections::BTreeMap;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Deviation, Report};
use shapeloom_mesh::{
    COLOR, Column, Domain, GeometricGraph, NORMAL, PointCloud, PolyMesh, Polyline, TEXCOORD, TriMesh, Values,
};
use shapeloom_shape::{Part, Shape, UpAxis};

use crate::{WriteContext, format_by_id, write};

/// Elements by name; each row has the values of its properties by name, lists longer than one.
type Rows = BTreeMap<String, Vec<BTreeMap<String, Vec<f64>>>>;

fn number(kind: &str, bytes: &mut &[u8]) -> f64 {
    fn take<const N: usize>(bytes: &mut &[u8]) -> [u8; N] {
        let (head, tail) = bytes.split_at(N);
        *bytes = tail;
        head.try_into().unwrap()
    }
    match kind {
        "char" => f64::from(i8::from_le_bytes(take(bytes))),
        "uchar" => f64::from(u8::from_le_bytes(take(bytes))),
        "short" => f64::from(i16::from_le_bytes(take(bytes))),
        "ushort" => f64::from(u16::from_le_bytes(take(bytes))),
        "int" => f64::from(i32::from_le_bytes(take(bytes))),
        "uint" => f64::from(u32::from_le_bytes(take(bytes))),
        "float" => f64::from(f32::from_le_bytes(take(bytes))),
        "double" => f64::from_le_bytes(take(bytes)),
        other => panic!("type {other}"),
    }
}

fn parse(file: &[u8]) -> Rows {
    let end = file.windows(11).position(|window| window == b"end_header\n").unwrap();
    let header = std::str::from_utf8(&file[..end]).unwrap();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
    let mut body = &file[end + 11..];
    let mut elements: Vec<(String, usize, Vec<Vec<String>>)> = Vec::new();
    for line in header.lines() {
        let words: Vec<String> = line.split(' ').map(str::to_owned).collect();
        match words[0].as_str() {
            "element" => elements.push((words[1].clone(), words[2].parse().unwrap(), Vec::new())),
            "property" => elements.last_mut().unwrap().2.push(words),
            _ => {}
        }
    }
    let mut rows = Rows::new();
    for (name, count, properties) in elements {
        let mut all = Vec::new();
        for _ in 0..count {
            let mut row = BTreeMap::new();
            for words in &properties {
                let values = if words[1] == "list" {
                    let count = number(&words[2], &mut body) as usize;
                    (0..count).map(|_| number(&words[3], &mut body)).collect()
                } else {
                    vec![number(&words[1], &mut body)]
                };
                assert!(row.insert(words.last().unwrap().clone(), values).is_none());
            }
            all.push(row);
        }
        rows.insert(name, all);
    }
    assert!(body.is_empty());
    rows
}

fn to_ply(shape: &Shape) -> (Rows, Report, Vec<u8>) {
    let mut out = Vec::new();
    let report = write(shape, format_by_id("ply").unwrap(), &WriteContext::default(), &mut out).unwrap();
    (parse(&out), report, out)
}

fn square() -> TriMesh {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.1), DVec3::Y];
    let mut mesh = TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let mut add = |domain: Domain, column: Column| mesh.insert_attribute(domain, column).unwrap();
    add(Domain::Vertex, Column::normals(NORMAL, &[DVec3::Z; 4]));
    add(Domain::Vertex, Column::texcoords(TEXCOORD, &[[0.0, 0.0], [1.0, 0.0], [1.0, 0.1], [0.0, 1.0]]));
    let color = Values::F32([0.0, 1.0, 0.215_861, 0.501_960_8].repeat(4));
    add(Domain::Vertex, Column::try_new(COLOR, 4, color).unwrap());
    add(Domain::Vertex, Column::try_new("stress tensor", 2, Values::I16((-4..4).collect())).unwrap());
    add(Domain::Face, Column::labels("patch", vec![7, 1 << 31]));
    add(Domain::Wedge, Column::texcoords(TEXCOORD, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|u| [u, u * 2.0])));
    mesh
}

#[test]
fn every_column_is_a_property() {
    let (rows, report, file) = to_ply(&Shape::new(Part::new(square())));
    assert_eq!((report.deviation, report.find("faces")), (Deviation::Exact, Some(2.0)));
    let vertex = &rows["vertex"][2];
    let get = |name: &str| vertex[name][0];
    assert_eq!([get("x"), get("y"), get("z")], [1.0, 1.0, 0.1]);
    assert_eq!([get("nx"), get("ny"), get("nz")], [0.0, 0.0, 1.0]);
    assert_eq!([get("s"), get("t")], [1.0, 0.1]);
    assert_eq!([get("red"), get("green"), get("blue"), get("alpha")], [0.0, 255.0, 128.0, 128.0]);
    assert_eq!([get("stress_tensor_0"), get("stress_tensor_1")], [0.0, 1.0]);
    let face = &rows["face"][1];
    assert_eq!(face["vertex_indices"], [0.0, 2.0, 3.0]);
    assert_eq!(face["texcoord"], [3.0, 6.0, 4.0, 8.0, 5.0, 10.0]);
    assert_eq!(face["patch"], [f64::from(1u32 << 31)]);
    let header = String::from_utf8_lossy(&file);
    assert!(header.contains("property double x\n") && header.contains("property float nx\n"));
    assert!(header.contains("property list uchar int vertex_indices\nproperty list uchar float texcoord\n"));
    let whats: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    assert_eq!(whats, ["vertex attribute \"stress tensor\""]);
}

#[test]
fn parts_are_put_together_where_they_are() {
    let square = Part::new(square()).named("square");
    let polygon: Vec<DVec3> = (0..300).map(|i| DVec3::new(f64::from(i), f64::from(i * i), 0.0)).collect();
    let polygon = PolyMesh::from_faces(polygon, &[(0..300).collect::<Vec<u32>>()]).unwrap();
    let mirror = Affine::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    let line = Polyline::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], true);
    let parts = vec![
        Part { placement: mirror, ..square },
        Part::new(polygon),
        Part::new(line),
        Part::new(PointCloud::new(vec![DVec3::splat(9.0)])),
        Part::new(GeometricGraph::try_new(vec![DVec3::ZERO; 3], vec![[2, 0], [1, 1]]).unwrap()),
    ];
    let (rows, report, _) = to_ply(&Shape { parts, up: Some(UpAxis::Z), ..Shape::default() });
    assert_eq!((rows["vertex"].len(), rows["face"].len(), rows["edge"].len()), (311, 3, 5));
    // The mirrored face is reversed, so that its front stays in front.
    assert_eq!(rows["face"][0]["vertex_indices"], [0.0, 2.0, 1.0]);
    assert_eq!(rows["vertex"][1]["x"], [-1.0]);
    assert_eq!(rows["face"][2]["vertex_indices"][299], 303.0);
    let edge = |i: usize| [rows["edge"][i]["vertex1"][0], rows["edge"][i]["vertex2"][0]];
    assert_eq!([edge(0), edge(2)], [[304.0, 305.0], [306.0, 304.0]]);
    assert_eq!([edge(3), edge(4)], [[310.0, 308.0], [309.0, 309.0]]);
    assert_eq!(rows["vertex"][307]["z"], [9.0]);
    let whats: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    for what in [
        "5 separate parts",
        "placements of 1 parts",
        "part name \"square\"",
        "up axis (z)",
        "wedge attribute \"texcoord\"",
        "face attribute \"patch\"",
        "vertex attribute \"normal\"",
    ] {
        assert!(whats.contains(&what), "{what} in {whats:?}");
    }
}

#[test]
fn whole_numbers_keep_their_type() {
    let mut cloud = PointCloud::new(vec![DVec3::ZERO, DVec3::X]);
    cloud
        .insert_attribute(Column::try_new(COLOR, 3, Values::U16(vec![65535, 0, 257, 32896, 128, 129])).unwrap())
        .unwrap();
    let text = Values::Text { names: vec!["oak".into()], index: vec![0, 0] };
    cloud.insert_attribute(Column::try_new("wood", 1, text).unwrap()).unwrap();
    cloud.insert_attribute(Column::labels("x", vec![1, 2])).unwrap();
    let (rows, report, file) = to_ply(&Shape::new(Part::new(cloud)));
    let color = |row: usize| ["red", "green", "blue"].map(|name| rows["vertex"][row][name][0]);
    assert_eq!([color(0), color(1)], [[65535.0, 0.0, 257.0], [32896.0, 128.0, 129.0]]);
    assert!(!rows.contains_key("face"));
    assert!(String::from_utf8_lossy(&file).contains("property float x\n"));
    assert_eq!(report.losses.len(), 2, "{:?}", report.losses);
    assert!(to_ply(&Shape::default()).0["vertex"].is_empty());
}
