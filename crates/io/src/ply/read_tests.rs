//! Files made by hand, and shapes that survive every encoding.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Diagnostic, Place, Severity};
use shapeloom_mesh::{Blend, COLOR, Column, Domain, NORMAL, TEXCOORD, TransformRule, Values};
use shapeloom_shape::{Geometry, Kind, Shape};

use super::FORMAT;
use crate::options::{Encoding, WriteOptions};
use crate::{ReadContext, ReadError, ReadShape, WriteContext, read, write};

fn read_text(text: &str) -> Result<ReadShape, ReadError> {
    read(text.as_bytes(), &FORMAT, &ReadContext::named("x.ply"))
}

fn written(shape: &Shape, encoding: Encoding) -> (Vec<u8>, Vec<String>) {
    let mut out = Vec::new();
    let context = WriteContext { options: WriteOptions { encoding, ..WriteOptions::default() }, ..Default::default() };
    let report = write(shape, &FORMAT, &context, &mut out).unwrap();
    (out, report.losses.iter().map(|loss| loss.what.clone()).collect())
}

/// Written in every encoding and read again: the same shape, and nothing is lost.
fn survives(shape: &Shape) {
    for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian] {
        let (bytes, losses) = written(shape, encoding);
        assert!(losses.is_empty(), "{losses:?}");
        let again = read(&bytes, &FORMAT, &ReadContext::default()).unwrap();
        assert!(again.losses.is_empty());
        assert_eq!(&again.shape, shape, "{encoding:?}");
    }
}

/// A file with everything: a table before the vertices and one without properties, names of all kinds, faces of two sizes.
const EVERYTHING: &str = "ply\rformat ascii 1.0\rcomment first\robj_info made by hand\rcomment  third \r\
    element camera 2\rproperty float view_0\rproperty float view_1\rproperty list int double lens\rproperty char id\r\
    element vertex 4\rproperty double x\rproperty float y\rproperty int z\rproperty float nx\rproperty float ny\r\
    property float nz\rproperty double u\rproperty double v\rproperty ushort red\rproperty ushort green\r\
    property ushort blue\rproperty short f_0\rproperty short f_1\rproperty list uchar ushort near\rproperty double quality\r\
    element nothing 4000000000\r\
    element face 3\rproperty uchar flags\rproperty list uchar uint vertex_index\rproperty list uchar float texcoord\r\
    property float red\rproperty float green\rproperty float blue\rproperty float alpha\rproperty list char char l\r\
    end_header\r\
    0 1 2 0.25 1e300 -3\r0.5 0.25 0 9\r\
    0 0.1 0 0 0 1 0 0.1 1 2 65535 -1 7 2 1 2 nan\r0.1 0 0 0 0 1 1 0 1 2 3 4 5 0 0.1\r\
    0 1 0 0 1 0 1 1 4 5 6 7 8 1 9 -0\r1 1 -5 1 0 0 0 1 7 8 9 -9 10 0 1e-310\r\
    1 3 0 1 2 6 0 0.5 1 0.5 1 1 0.2 0.4 0.6 0.8 0\r2 2 0 1 0 0 0 0 0 0\r\
    255 4 3 2 1 0 8 1 2 3 4 5 6 7 8 1 0 0.04045 0.001 2 -1 1\r";

#[test]
fn everything_has_its_place() {
    let ReadShape { shape, findings, losses } = read_text(EVERYTHING).unwrap();
    assert!(losses.is_empty());
    assert_eq!(shape.comments, ["first", "obj_info made by hand", " third "]);
    let tables: Vec<(&str, usize)> =
        shape.tables.iter().map(|table| (table.name.as_str(), table.columns.len())).collect();
    assert_eq!(tables, [("camera", 2), ("nothing", 4_000_000_000)]);
    let camera = &shape.tables[0].columns;
    assert_eq!(
        (camera.get("view").unwrap().width(), camera.get("id").unwrap().values()),
        (2, &Values::I8(vec![-3, 9]))
    );
    assert_eq!(
        (camera.list("lens").unwrap().starts(), camera.list("lens").unwrap().values()),
        (&[0, 2, 2][..], &Values::F64(vec![0.25, 1e300]))
    );
    let Geometry::PolyMesh(mesh) = &*shape.parts[0].geometry else { panic!("polygons") };
    assert_eq!(mesh.positions()[0], DVec3::new(0.0, f64::from(0.1f32), 0.0));
    assert_eq!(mesh.positions()[3], DVec3::new(1.0, 1.0, -5.0));
    let vertex = |name: &str| mesh.attribute(Domain::Vertex, name).unwrap();
    let normal = vertex(NORMAL);
    assert_eq!(
        (normal.blend(), normal.transform(), normal.vector(3)),
        (Blend::Direction, TransformRule::Normal, DVec3::X)
    );
    assert_eq!(vertex(TEXCOORD).values(), &Values::F64(vec![0.0, 0.1, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0]));
    assert_eq!(vertex(COLOR).values(), &Values::U16(vec![1, 2, 65535, 1, 2, 3, 4, 5, 6, 7, 8, 9]));
    assert_eq!(vertex("f").values(), &Values::I16(vec![-1, 7, 4, 5, 7, 8, -9, 10]));
    assert_eq!((vertex("f").blend(), vertex("quality").blend()), (Blend::Copy, Blend::Linear));
    assert!(vertex("quality").number(0, 0).is_nan() && vertex("quality").number(3, 0) == 1e-310);
    assert_eq!(mesh.attributes().vertex.list("near").unwrap().values(), &Values::U16(vec![1, 2, 9]));
    // The face of two corners is gone, with its colour and list.
    assert_eq!((mesh.face_count(), mesh.face(1)), (2, &[3, 2, 1, 0][..]));
    let face = |name: &str| mesh.attribute(Domain::Face, name).unwrap();
    assert_eq!(face("flags").values(), &Values::U8(vec![1, 255]));
    assert_eq!(mesh.attributes().face.list("l").unwrap().values(), &Values::I8(vec![-1, 1]));
    let color: Vec<f64> = (0..8).map(|i| face(COLOR).number(i / 4, i % 4)).collect();
    // Values of the curve of IEC 61966-2-1 by another program; alpha is no colour.
    for (found, wanted) in color.iter().zip([0.033_104_8, 0.132_868_3, 0.318_546_8, 0.8, 1.0, 0.0, 0.003_130_8, 0.001])
    {
        assert!((found - wanted).abs() < 1e-6, "{color:?}");
    }
    let wedge = mesh.attribute(Domain::Wedge, TEXCOORD).unwrap();
    assert_eq!((wedge.len(), wedge.number(1, 1), wedge.number(6, 1)), (7, 0.5, 8.0));
    let only = findings.iter().next().unwrap();
    assert_eq!((only.code, only.count, &only.places[..]), ("W-ply-skipped", 1, &[Place::line(45)][..]));
    assert_eq!(EVERYTHING.split('\r').nth(44).unwrap(), "2 2 0 1 0 0 0 0 0 0");
}

#[test]
fn everything_survives_every_encoding() {
    let mut shape = read_text(&EVERYTHING.replace("nan", "inf")).unwrap().shape;
    // Texture coordinates and normals may come back narrower, if that loses nothing: these do not.
    assert!(shape.parts.len() == 1 && shape.tables.len() == 2);
    survives(&shape);
    // In the order of the columns in their sets, whatever the order in the file was.
    shape.comments = vec![String::new(), "obj_info ".into(), " a\tb ".into(), "obj_info".into()];
    survives(&shape);
    let (bytes, _) = written(&shape, Encoding::Binary);
    let head = String::from_utf8_lossy(&bytes);
    for line in [
        "comment\nobj_info \ncomment  a\tb \ncomment obj_info\n",
        "property double x\n",
        "property ushort blue\n",
        "property float alpha\n",
        "property short f_1\n",
        "property list uchar ushort near\n",
        "property list uchar float texcoord\n",
        "element nothing 4000000000\n",
        "property list uchar double lens\n",
    ] {
        assert!(head.contains(line), "{line}");
    }
}

#[test]
fn edges_become_a_graph() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar red\nproperty uchar green\nproperty uchar blue\nelement edge 2\nproperty int vertex1\n\
        property int vertex2\nproperty float weight\nproperty list uchar int ids\nend_header\n\
        0 0 0 1 2 3\n1 0 0 4 5 6\n2 0 0 7 8 9\n3 0 0 1 1 1\n1 3 0.5 0\n3 2 0.25 2 5 6\n";
    let found = read_text(text).unwrap();
    assert!(found.findings.is_empty());
    survives(&found.shape);
    let Geometry::GeometricGraph(graph) = &*found.shape.parts[0].geometry else { panic!("a graph") };
    assert_eq!((graph.edges(), graph.positions().len()), (&[[1, 3], [3, 2]][..], 4));
    assert_eq!(graph.edge_attributes().get("weight").unwrap().values(), &Values::F32(vec![0.5, 0.25]));
    assert_eq!(graph.edge_attributes().list("ids").unwrap().values(), &Values::I32(vec![5, 6]));
    let beside = text.replace("element edge", "element face 1\nproperty list uchar int vertex_indices\nelement edge");
    let found = read_text(&beside.replace("1 3 0.5", "3 0 1 2\n1 3 0.5")).unwrap();
    assert_eq!(found.findings.iter().next().map(|one| (one.code, one.severity)), Some(("W-ply-edges", Severity::Note)));
    let [mesh, graph] = &found.shape.parts[..] else { panic!("two parts") };
    assert_eq!((mesh.geometry.kind(), graph.geometry.kind()), (Kind::TriMesh, Kind::GeometricGraph));
    let Geometry::GeometricGraph(graph) = &*graph.geometry else { panic!("a graph") };
    assert_eq!(graph.edges(), [[0, 2], [2, 1]]);
    assert_eq!(graph.vertex_attributes().get(COLOR).unwrap().values(), &Values::U8(vec![4, 5, 6, 7, 8, 9, 1, 1, 1]));
    let error = read_text(&text.replace("3 2 0.25", "4 2 0.25")).unwrap_err();
    assert_eq!(error.to_string().split(", expected").next(), Some("x.ply: line 21: edge 1: found 4"));
    assert_eq!(error.code(), "E-ply-index");
    // Edges that do not say which vertices are a table.
    let found = read_text(&text.replace("vertex1", "from")).unwrap();
    assert_eq!((found.shape.tables[0].name.as_str(), found.shape.parts[0].geometry.kind()), ("edge", Kind::PointCloud));
    survives(&found.shape);
}

#[test]
fn strips_are_triangles() {
    let text = |strips: &str, count: usize| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n\
             element tristrips {count}\nproperty list int int vertex_indices\nend_header\n\
             0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n{strips}"
        )
    };
    let found = read_text(&text("5 0 1 2 3 4\n", 1)).unwrap();
    let Geometry::TriMesh(mesh) = &*found.shape.parts[0].geometry else { panic!("triangles") };
    assert_eq!(mesh.triangles(), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
    // All face up.
    assert!((0..3).all(|face| {
        let [a, b, c] = mesh.corners(face);
        (b - a).cross(c - a).z > 0.0
    }));
    let found = read_text(&text("5 0 1 2 -1 3\n4 -1 -1 0 1\n", 2)).unwrap();
    let only = found.findings.iter().next().unwrap();
    assert_eq!((only.code, only.count, &only.places[..]), ("W-ply-strips", 2, &[Place::line(15), Place::line(16)][..]));
    let error = read_text(&text("3 0 1 5\n", 1)).unwrap_err();
    assert!(error.to_string().starts_with("x.ply: line 15: strip 0: found 5, expected"), "{error}");
}

#[test]
fn clouds_and_empty_files_are_told_apart() {
    let head = "ply\nformat ascii 1.0\nelement vertex N\nproperty float x\nproperty float y\nproperty float z\n\
                element face 0\nproperty list uchar int vertex_indices\nend_header\n";
    let found = read_text(&head.replace('N', "0")).unwrap();
    assert_eq!(
        (found.shape.parts[0].geometry.kind(), found.findings.iter().next().unwrap().code),
        (Kind::TriMesh, "W-ply-empty")
    );
    let found = read_text(&(head.replace('N', "1") + "1 2 3\nx")).unwrap();
    assert_eq!(found.shape.parts[0].geometry.kind(), Kind::TriMesh);
    let alone = head.replace('N', "1").replace("element face 0\nproperty list uchar int vertex_indices\n", "");
    assert_eq!(read_text(&(alone + "1 2 3\n")).unwrap().shape.parts[0].geometry.kind(), Kind::PointCloud);
    let only = found.findings.iter().next().unwrap();
    assert_eq!((only.code, &only.places[..]), ("W-ply-trailing", &[Place::line(11)][..]));
    let none = read_text("ply\nformat ascii 1.0\nend_header\n").unwrap();
    assert_eq!(none.shape.parts[0].geometry.kind(), Kind::TriMesh);
    let error = read_text("ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n").unwrap_err();
    assert_eq!((error.code(), error.fault().unwrap().place.clone()), ("E-ply-header", Place::line(3)));
}

#[test]
fn texture_coordinates_that_do_not_fit_stay_lists() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 1 2 3 4 5 6\n3 0 1 2 5 1 2 3 4 5\n";
    let found = read_text(text).unwrap();
    let only = found.findings.iter().next().unwrap();
    assert_eq!((only.code, &only.places[..]), ("W-ply-texcoord", &[Place::line(15)][..]));
    let Geometry::TriMesh(mesh) = &*found.shape.parts[0].geometry else { panic!("triangles") };
    assert!(mesh.attributes().wedge.is_empty() && mesh.attributes().face.list(TEXCOORD).is_some());
    survives(&found.shape);
}

#[test]
fn vertices_that_are_nowhere_are_dropped_on_request() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                element face 2\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n1 0 nan\n0 1 0\n1 1 0\n3 0 1 2\n3 0 2 3\n";
    let error = read_text(text).unwrap_err();
    assert!(error.to_string().starts_with("x.ply: line 11: vertex 1: found \"nan\", expected finite"), "{error}");
    let mut context = ReadContext::default();
    context.options.drop_non_finite = true;
    let mut binary = Vec::new();
    let kept = read(text.as_bytes(), &FORMAT, &context).unwrap();
    write(&kept.shape, &FORMAT, &WriteContext::default(), &mut binary).unwrap();
    let Geometry::TriMesh(mesh) = &*kept.shape.parts[0].geometry else { panic!("triangles") };
    assert_eq!((mesh.positions().len(), mesh.triangles()), (3, &[[0, 1, 2]][..]));
    assert!(kept.findings.iter().any(|one| one.code == "W-read-dropped"));
    let at = binary.len() - 13 - 12;
    binary[at..at + 4].copy_from_slice(&f32::INFINITY.to_le_bytes());
    let error = read(&binary, &FORMAT, &ReadContext::default()).unwrap_err();
    let wanted = format!("input: byte {at}: vertex 2: found inf, expected finite coordinates (E-ply-finite)");
    assert_eq!(error.to_string(), wanted);
}

/// Blocks, fast ways and slow ways of the binary reader give what the reader of text gives.
#[test]
fn binary_rows_of_all_layouts_are_read_alike() {
    let mut text = String::new();
    let mut corners = 0u32;
    for face in 0..10_000u32 {
        // Long runs of triangles, then others.
        let arity = if face < 9000 { 3 } else { [3, 4, 5, 12, 1][face as usize % 5] };
        text.push_str(&format!("{} {arity}", face % 200));
        (0..arity).for_each(|corner| text.push_str(&format!(" {}", (face + corner * 7) % 5000)));
        text.push_str(&format!(" {} {}\n", face % 7, f64::from(face) / 7.0));
        corners += arity;
    }
    assert!(corners > 30_000);
    let mut vertices = String::new();
    (0..5000).for_each(|i| vertices.push_str(&format!("{} {} {} {}\n", i % 70, i / 70, i % 11, f64::from(i) / 3.0)));
    let file = format!(
        "ply\nformat ascii 1.0\nelement vertex 5000\nproperty uchar x\nproperty short y\nproperty double z\n\
         property float w\nelement face 10000\nproperty uchar before\nproperty list uchar int vertex_indices\n\
         property uchar after\nproperty double last\nend_header\n{vertices}{text}"
    );
    let shape = read_text(&file).unwrap().shape;
    let Geometry::PolyMesh(mesh) = &*shape.parts[0].geometry else { panic!("polygons") };
    assert_eq!((mesh.face_count(), mesh.positions()[171]), (9800, DVec3::new(31.0, 2.0, 6.0)));
    survives(&shape);
    // The same rows, encoded by hand with other types of lengths and indices, in both orders.
    for big in [false, true] {
        for (count, item) in
            [("uchar", "int"), ("uchar", "uint"), ("int", "ushort"), ("ushort", "double"), ("char", "short")]
        {
            let layout = if big { "binary_big_endian" } else { "binary_little_endian" };
            let (head, body) = file.split_once("end_header\n").unwrap();
            let head = head.replace("ascii", layout).replace("list uchar int", &format!("list {count} {item}"));
            let mut bytes = (head + "end_header\n").into_bytes();
            let mut put = |kind: &str, word: &str| {
                let number: f64 = word.parse().unwrap();
                let mut little = match kind {
                    "uchar" | "char" => vec![number as u8],
                    "short" | "ushort" => (number as u16).to_le_bytes().to_vec(),
                    "int" | "uint" => (number as u32).to_le_bytes().to_vec(),
                    "float" => (number as f32).to_le_bytes().to_vec(),
                    _ => number.to_le_bytes().to_vec(),
                };
                if big {
                    little.reverse();
                }
                bytes.extend(little);
            };
            for (row, line) in body.lines().enumerate() {
                let words: Vec<&str> = line.split(' ').collect();
                if row < 5000 {
                    ["uchar", "short", "double", "float"].iter().zip(&words).for_each(|(kind, word)| put(kind, word));
                    continue;
                }
                let arity: usize = words[1].parse().unwrap();
                put("uchar", words[0]);
                put(count, words[1]);
                words[2..2 + arity].iter().for_each(|word| put(item, word));
                put("uchar", words[2 + arity]);
                put("double", words[3 + arity]);
            }
            let found = read(&bytes, &FORMAT, &ReadContext::default()).unwrap();
            assert_eq!(found.shape, shape, "{layout} {count} {item}");
            // Every skipped face has its own place.
            let counts: Vec<u64> = found.findings.iter().map(|one| one.count).collect();
            assert_eq!(counts, [200, degenerate(&shape)]);
        }
    }
}

fn degenerate(shape: &Shape) -> u64 {
    let mut findings = shapeloom_core::Findings::default();
    let exec = shapeloom_core::Exec::default();
    crate::audit::degenerate_faces(&shape.parts[0].geometry, "W-test", &exec, &mut findings, |_| Place::Whole).unwrap();
    findings.iter().map(|one| one.count).sum()
}

#[test]
fn columns_of_every_type_survive() {
    let mut cloud = shapeloom_mesh::PointCloud::new(vec![DVec3::new(0.1, 5e6, -1e-300), DVec3::splat(1e300)]);
    let values = [
        Values::F32(vec![f32::MIN_POSITIVE / 3.0, f32::MAX]),
        Values::F64(vec![0.5, f64::MAX]),
        Values::I8(vec![-128, 127]),
        Values::U8(vec![0, 255]),
        Values::I16(vec![i16::MIN, i16::MAX]),
        Values::U16(vec![0, u16::MAX]),
        Values::I32(vec![i32::MIN, i32::MAX]),
        Values::U32(vec![0, u32::MAX]),
    ];
    for values in values {
        let name = format!("of-{}", values.type_name());
        let blend = if matches!(values, Values::F32(_) | Values::F64(_)) { Blend::Linear } else { Blend::Copy };
        cloud.insert_attribute(Column::try_new(&name, 1, values.clone()).unwrap().with_blend(blend)).unwrap();
        let wide = Column::try_new(format!("wide-{name}"), 1, values).unwrap().gathered(&[0, 1, 1, 0]);
        let wide = Column::try_new(wide.name(), 2, wide.values().clone()).unwrap().with_blend(blend);
        cloud.insert_attribute(wide).unwrap();
    }
    let double = Column::try_new(COLOR, 3, Values::F64(vec![0.1, 0.2, 0.3, 0.4, 0.5, 7.0])).unwrap();
    cloud.insert_attribute(double).unwrap();
    let shape = Shape::new(shapeloom_shape::Part::new(cloud));
    let again = read(&written(&shape, Encoding::Ascii).0, &FORMAT, &ReadContext::default()).unwrap().shape;
    // Linear colours that no file had may differ in their last bits once, and then no more.
    let color = |shape: &Shape, i: usize| match &*shape.parts[0].geometry {
        Geometry::PointCloud(cloud) => cloud.attributes().get(COLOR).unwrap().number(i / 3, i % 3),
        _ => f64::NAN,
    };
    assert!((0..6).all(|i| (color(&shape, i) / color(&again, i) - 1.0).abs() < 1e-15));
    survives(&again);
    let Geometry::PointCloud(before) = &*shape.parts[0].geometry else { panic!("points") };
    let Geometry::PointCloud(after) = &*again.parts[0].geometry else { panic!("points") };
    assert_eq!(before.positions(), after.positions());
    for column in before.attributes().iter().filter(|column| column.name() != COLOR) {
        assert_eq!(after.attributes().get(column.name()), Some(column));
    }
}

/// Whatever is done to the bytes of a file with everything in it: an error of ours, or a shape.
#[test]
fn broken_files_of_all_elements_never_panic() {
    let shape = read_text(EVERYTHING).unwrap().shape;
    let mut state = 1u64;
    let mut dice = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let mut files = vec![EVERYTHING.as_bytes().to_vec()];
    for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian] {
        files.push(written(&shape, encoding).0);
    }
    for whole in files {
        for end in 0..whole.len() {
            let context =
                ReadContext { exec: shapeloom_core::Exec::default().with_memory(1 << 20), ..Default::default() };
            let cut = read(&whole[..end], &FORMAT, &context);
            assert!(cut.is_err() || end + 2 > whole.len(), "{end} of {}", whole.len());
        }
        for _ in 0..3000 {
            let mut broken = whole.clone();
            for _ in 0..1 + dice() % 3 {
                let at = dice() % broken.len();
                broken[at] = if dice() % 2 == 0 { dice() as u8 } else { b" 0123456789-\nab"[dice() % 15] };
            }
            let context =
                ReadContext { exec: shapeloom_core::Exec::default().with_memory(1 << 20), ..Default::default() };
            if let Ok(found) = read(&broken, &FORMAT, &context) {
                // What is read can be written.
                written_if_small(&found.shape);
            }
            assert_eq!(context.exec.memory_taken(), 0);
        }
    }
}

fn written_if_small(shape: &Shape) {
    let rows: usize =
        shape.tables.iter().filter(|table| !table.columns.is_empty()).map(|table| table.columns.len()).sum();
    if rows < 1000 {
        written(shape, Encoding::Ascii);
    }
}

#[test]
fn faces_that_were_left_out_do_not_shift_the_places_of_others() {
    let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                element face 4\nproperty list uchar int vertex_indices\nend_header\n\
                0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 1\n1 0\n3 2 2 1\n";
    let found = read_text(text).unwrap();
    let remarks: Vec<_> = found.findings.iter().map(|one| (one.code, one.count, &one.places[..])).collect();
    let (skipped, kept) = ([13, 15].map(Place::line), [14, 16].map(Place::line));
    assert_eq!(remarks, [("W-ply-skipped", 2, &skipped[..]), ("W-ply-degenerate", 2, &kept[..])]);
    // The same rows in binary, where a block of triangles is read at once: a face of two corners among them, its missing
    // bytes at the end of the file.
    let (head, _) = text.split_once("end_header\n").unwrap();
    let head = head.replace("ascii", "binary_little_endian").replace("face 4", "face 2") + "end_header\n";
    let faces = [&[3u8][..], &[0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0], &[2], &[0; 8], &[0; 4]].concat();
    let vertices: Vec<u8> =
        [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let bytes = [head.as_bytes(), &vertices, &faces].concat();
    let found = read(&bytes, &FORMAT, &ReadContext::default()).unwrap();
    let Geometry::TriMesh(mesh) = &*found.shape.parts[0].geometry else { panic!("triangles") };
    assert_eq!(mesh.triangles(), [[0, 1, 2]]);
    let places: Vec<(&str, &Place)> = found.findings.iter().map(|one| (one.code, &one.places[0])).collect();
    let at = |from_end: usize| Place::Byte((bytes.len() - from_end) as u64);
    assert_eq!(places, [("W-ply-trailing", &at(4)), ("W-ply-skipped", &at(13))]);
    // The first number that is no index, in a block of triangles.
    let mut wrong = bytes.clone();
    wrong[bytes.len() - 26 + 13] = 3;
    assert!(read(&wrong, &FORMAT, &ReadContext::default()).is_ok());
    wrong[bytes.len() - 26 + 9] = 3;
    assert_eq!(read(&wrong, &FORMAT, &ReadContext::default()).unwrap_err().code(), "E-ply-index");
}

#[test]
fn what_has_no_place_beside_others_is_named() {
    let mut graph = shapeloom_mesh::GeometricGraph::try_new(vec![DVec3::ZERO, DVec3::X], vec![[0, 1]]).unwrap();
    let color = vec![1.0, 0.0, 1.0, 0.1, 0.0, 1.0, 0.0, 0.2];
    graph.insert_vertex_attribute(Column::try_new(COLOR, 4, Values::F64(color)).unwrap()).unwrap();
    let mut shape = Shape::new(shapeloom_shape::Part::new(graph));
    // Alpha in double precision keeps its bits.
    survives(&shape);
    shape.comments.push("two\nlines".into());
    for name in ["edge", "vertex", "face", "a b", "a_b"] {
        let mut columns = shapeloom_mesh::Attributes::new(1);
        columns.insert(Column::labels("id", vec![7])).unwrap();
        shape.tables.push(shapeloom_shape::Table { name: name.into(), columns });
    }
    let (bytes, losses) = written(&shape, Encoding::Ascii);
    let wanted = ["line ends in comments", "table \"edge\"", "table \"vertex\"", "table \"a b\"", "table \"a_b\""];
    assert_eq!(losses, wanted);
    let again = read(&bytes, &FORMAT, &ReadContext::default()).unwrap().shape;
    let names: Vec<&str> = again.tables.iter().map(|table| table.name.as_str()).collect();
    assert_eq!((names, again.comments.len()), (vec!["face", "a_b"], 2));
    assert_eq!(again.parts, shape.parts);
}

#[test]
fn linear_colors_in_single_precision_survive() {
    let positions: Vec<DVec3> = (0..200).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect();
    let written_as = |colors: Vec<f32>| {
        let mut cloud = shapeloom_mesh::PointCloud::new(positions.clone());
        cloud.insert_attribute(Column::try_new(COLOR, 4, Values::F32(colors)).unwrap()).unwrap();
        let (file, losses) = written(&Shape::new(shapeloom_shape::Part::new(cloud)), Encoding::Binary);
        assert!(losses.is_empty(), "{losses:?}");
        let again = crate::read(&file, &super::FORMAT, &ReadContext::default()).unwrap().shape;
        let Geometry::PointCloud(cloud) = &*again.parts[0].geometry else { panic!("points") };
        (cloud.attributes().get(COLOR).unwrap().values().clone(), String::from_utf8_lossy(&file).into_owned())
    };
    let colors: Vec<f32> = (0..800).map(|i| (i as f32 * 0.377).fract() * if i == 9 { 7.0 } else { 1.0 }).collect();
    let (found, file) = written_as(colors.clone());
    let Values::F64(numbers) = found else { panic!("fractions") };
    assert!(file.contains("property double red"));
    assert_eq!(numbers.iter().map(|&number| number as f32).collect::<Vec<_>>(), colors);
    // What came from floats goes into floats.
    let floats = |i: usize| ((i as f64 / 801.0) as f32, i % 4 == 3);
    let linear =
        |(float, alpha): (f32, bool)| if alpha { float } else { crate::color::linear(f64::from(float)) as f32 };
    let colors: Vec<f32> = (0..800).map(floats).map(linear).collect();
    let (found, file) = written_as(colors.clone());
    let Values::F64(numbers) = found else { panic!("fractions") };
    assert!(file.contains("property float red"));
    assert_eq!(numbers.iter().map(|&number| number as f32).collect::<Vec<_>>(), colors);
    // Bytes that became light are bytes again.
    let bytes: Vec<u8> = (0..800u32).map(|i| (i * 7) as u8).collect();
    let light = bytes.iter().enumerate().map(|(at, &byte)| (byte, at % 4 == 3)).map(|(byte, alpha)| {
        let fraction = f64::from(byte) / 255.0;
        (if alpha { fraction } else { crate::color::linear(fraction) }) as f32
    });
    assert_eq!(written_as(light.collect()).0, Values::U8(bytes));
}

#[test]
fn meshes_without_faces_stay_meshes() {
    let points = vec![DVec3::ZERO, DVec3::X];
    let mesh =
        Shape::new(shapeloom_shape::Part::new(shapeloom_mesh::TriMesh::try_new(points.clone(), vec![]).unwrap()));
    let cloud = Shape::new(shapeloom_shape::Part::new(shapeloom_mesh::PointCloud::new(points)));
    for shape in [mesh, cloud] {
        for encoding in [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian] {
            let (file, losses) = written(&shape, encoding);
            let again = crate::read(&file, &super::FORMAT, &ReadContext::default()).unwrap();
            assert!(losses.is_empty() && again.findings.is_empty());
            assert_eq!(again.shape.parts[0].geometry, shape.parts[0].geometry);
        }
    }
}

/// Edges between vertices of faces stay on them, however often the file goes through.
#[test]
fn edges_beside_faces_bring_no_vertices_of_their_own() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        property uchar tag\nelement face 1\nproperty list uchar int vertex_indices\nelement edge 2\n\
        property int vertex1\nproperty int vertex2\nend_header\n0 0 0 1\n0 0 0 2\n1 0 0 3\n0 1 0 4\n3 0 2 3\n1 2\n1 3\n";
    let first = crate::read(text.as_bytes(), &super::FORMAT, &crate::ReadContext::default()).unwrap().shape;
    let mut shape = first.clone();
    for _ in 0..3 {
        let mut bytes = Vec::new();
        let report = crate::write(&shape, &super::FORMAT, &crate::WriteContext::default(), &mut bytes).unwrap();
        assert!(
            report.figures.iter().any(|figure| figure.name == "vertices" && figure.value == 4.0),
            "{:?}",
            report.figures
        );
        shape = crate::read(&bytes, &super::FORMAT, &crate::ReadContext::default()).unwrap().shape;
        assert_eq!(shape.parts, first.parts);
    }
}
