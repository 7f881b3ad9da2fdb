//! Files written, read by us and by another reader, and damaged.

mod json_files;
mod limits;
mod lines;
mod looks;
mod losses;
mod sparse;

use std::sync::Arc;

use serde_json::{Value, json};
use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Affine, AxisAngle, Category, Deviation, Diagnostic, Exec, Limits, Report, Threads};
use shapeloom_mesh::{Blend, COLOR, Column, Domain, NORMAL, PointCloud, Polyline, TEXCOORD, TriMesh, Values};
use shapeloom_shape::{Geometry, Material, Part, Representation, Shape, Units, UpAxis};

use crate::test_data::shared_data;
use crate::{
    ReadContext, ReadError, ReadShape, SiblingError, SiblingName, Siblings, WriteContext, WriteError, detect,
    format_by_id, read, write,
};

fn to_glb(shape: &Shape) -> Result<(Vec<u8>, Report), WriteError> {
    let mut out = Vec::new();
    let report = write(shape, format_by_id("glb").unwrap(), &WriteContext::default(), &mut out)?;
    Ok((out, report))
}

fn from_glb(file: &[u8]) -> ReadShape {
    read(file, format_by_id("glb").unwrap(), &ReadContext::named("x.glb")).unwrap()
}

fn mesh(shape: &Shape, part: usize) -> &TriMesh {
    TriMesh::from_geometry(&shape.parts[part].geometry).unwrap()
}

/// Two triangles with a seam in texture coordinates, normals, colours and labels.
fn rich() -> TriMesh {
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.25), DVec3::Y];
    let mut mesh = TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
    let uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.75], [0.0, 0.0], [0.5, 0.75], [0.0, 1.0]];
    mesh.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &uv)).unwrap();
    let normal = DVec3::new(0.0, 0.6, 0.8);
    mesh.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &[DVec3::Z, DVec3::Z, normal, DVec3::ZERO])).unwrap();
    let color = Values::F32(vec![0.5, 0.25, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    mesh.insert_attribute(Domain::Vertex, Column::try_new(COLOR, 3, color).unwrap()).unwrap();
    mesh.insert_attribute(Domain::Vertex, Column::labels("region", vec![7, 8, 9, 40_000])).unwrap();
    let heat = Column::try_new("heat", 1, Values::F64(vec![0.5, -1.5, 2.0, 1e6])).unwrap();
    mesh.insert_attribute(Domain::Vertex, heat).unwrap();
    mesh
}

fn turn() -> Affine {
    Affine::from_rotation(AxisAngle::new(DVec3::new(1.0, 2.0, 3.0), 0.7).unwrap())
}

/// Parts of every kind, instances, materials, a turned and mirrored placement, z up in millimetres.
fn scene() -> Shape {
    let first = Part { material: Some(1), ..Part::new(rich()).named("first") };
    let map = Affine { linear: turn().linear * DMat3::from_diagonal(DVec3::new(2.0, -3.0, 1.0)), ..turn() };
    let second = Part { placement: map, material: Some(0), ..first.clone() }.named("zweites Teil \"ä\"");
    let points: Vec<DVec3> = (0..5).map(|i| DVec3::new(f64::from(i), f64::from(i * i), 0.5)).collect();
    let line = Part::new(Polyline::new(points.clone(), false)).named("line");
    let ring = Part {
        placement: Affine::from_translation(DVec3::new(0.1, 0.2, 0.3)),
        ..Part::new(Polyline::new(points.clone(), true))
    };
    let mut cloud = PointCloud::new(points);
    let size = Column::try_new("size", 2, Values::I8((0..10).map(|i| i - 5).collect())).unwrap();
    cloud.insert_attribute(size.with_blend(Blend::Copy)).unwrap();
    let red = Material {
        name: "red".into(),
        base_color: [0.8, 0.0, 0.1, 0.5],
        metallic: 0.25,
        roughness: 0.75,
        texture: None,
        double_sided: true,
    };
    Shape {
        parts: vec![first, second, line, ring, Part::new(cloud).named("cloud")],
        materials: vec![Material::default(), red],
        units: Some(Units::MILLIMETERS),
        up: Some(UpAxis::Z),
        ..Shape::default()
    }
}

#[test]
fn scenes_come_back_and_stay_the_same_bits() {
    let shape = scene();
    let (file, report) = to_glb(&shape).unwrap();
    assert_eq!(report.deviation, Deviation::Exact);
    assert!(report.losses.iter().all(|loss| loss.what == "vertex attribute \"normal\""), "{:?}", report.losses);
    let back = from_glb(&file);
    assert!(back.findings.is_empty() && back.losses.is_empty());
    let read = &back.shape;
    assert_eq!((read.up, read.units), (Some(UpAxis::Y), Some(Units::METERS)));
    assert_eq!(read.materials, shape.materials);
    assert!(Arc::ptr_eq(&read.parts[0].geometry, &read.parts[1].geometry));
    let root = Affine::from_linear(UpAxis::Z.rotation_to(UpAxis::Y).linear * 1e-3);
    for (part, source) in read.parts.iter().zip(&shape.parts) {
        assert_eq!(
            (&part.name, part.material, part.geometry.kind()),
            (&source.name, source.material, source.geometry.kind())
        );
        assert_eq!(part.placement, root * source.placement, "{}", part.name);
    }
    // Vertex 2 has two texture coordinates; the others agree.
    let split = mesh(read, 0);
    assert_eq!((split.positions().len(), split.triangles()), (5, &[[0, 1, 2], [0, 4, 3]][..]));
    assert_eq!(split.positions()[4], split.positions()[2]);
    let uv = split.attribute(Domain::Vertex, TEXCOORD).unwrap();
    assert_eq!([0, 1, 2, 3, 4].map(|i| uv.number(i, 1)), [0.0, 0.0, 0.75, 1.0, 0.75]);
    assert_eq!((uv.number(2, 0), uv.number(4, 0)), (1.0, 0.5));
    // The normal without direction became that of a facet.
    let normals = split.attribute(Domain::Vertex, NORMAL).unwrap();
    let [a, b, c] = split.corners(1);
    assert!((normals.vector(3) - (b - a).cross(c - a).normalize()).length() < 1e-7);
    assert!((normals.vector(2) - DVec3::new(0.0, 0.6, 0.8)).length() < 1e-7);
    let labels = split.attribute(Domain::Vertex, "region").unwrap();
    assert_eq!((labels.values(), labels.blend()), (&Values::U16(vec![7, 8, 9, 40_000, 9]), Blend::Copy));
    assert_eq!(split.attribute(Domain::Vertex, "heat").unwrap().values(), &Values::F32(vec![0.5, -1.5, 2.0, 1e6, 2.0]));
    let cloud = PointCloud::from_geometry(&read.parts[4].geometry).unwrap();
    assert_eq!(cloud.attributes().get("size").unwrap().values(), &Values::I8((0..10).map(|i| i - 5).collect()));

    let (again, second) = to_glb(read).unwrap();
    assert!(second.findings.is_empty() && second.losses.is_empty());
    assert_eq!(from_glb(&again), back);
    assert_eq!(to_glb(&from_glb(&again).shape).unwrap().0, again);
}

#[test]
fn output_does_not_depend_on_threads() {
    let alone = WriteContext { exec: Exec::default().with_threads(Threads::Sequential), ..WriteContext::default() };
    let mut file = Vec::new();
    write(&scene(), format_by_id("glb").unwrap(), &alone, &mut file).unwrap();
    assert_eq!(file, to_glb(&scene()).unwrap().0);
    assert_eq!(file.len() % 4, 0);
    assert_eq!(u32::from_le_bytes(file[8..12].try_into().unwrap()) as usize, file.len());
}

#[test]
fn another_reader_agrees() {
    let (file, _) = to_glb(&scene()).unwrap();
    let (document, buffers, _) = ::gltf::import_slice(&file).unwrap();
    let ours = from_glb(&file).shape;
    let scene = document.default_scene().unwrap();
    let root = scene.nodes().next().unwrap();
    let matrix = root.transform().matrix();
    // The image of z is y, in millimetres.
    assert_eq!(matrix[2], [0.0, 1e-3, 0.0, 0.0]);
    let nodes: Vec<_> = root.children().collect();
    assert_eq!(nodes.len(), 5);
    for (node, part) in nodes.iter().zip(&ours.parts) {
        assert_eq!(node.name().unwrap_or(""), part.name);
        let theirs = node.transform().matrix();
        let local = UpAxis::Y.rotation_to(UpAxis::Z) * Affine::from_scale(DVec3::splat(1e3)) * part.placement;
        for (a, b) in theirs.as_flattened().iter().zip(local.to_matrix().to_cols_array()) {
            assert!((f64::from(*a) - b).abs() < 1e-6);
        }
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        let positions: Vec<DVec3> =
            reader.read_positions().unwrap().map(|p| DVec3::from_array(p.map(f64::from))).collect();
        assert_eq!(positions, crate::placed::points_of(&part.geometry).unwrap());
        let bounds = primitive.bounding_box();
        assert_eq!(DVec3::from_array(bounds.min.map(f64::from)), part.geometry.bounds().min);
        let Geometry::TriMesh(mesh) = &*part.geometry else { continue };
        let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(indices, mesh.triangles().as_flattened());
        let normals = mesh.attribute(Domain::Vertex, NORMAL).unwrap();
        for (vertex, normal) in reader.read_normals().unwrap().enumerate() {
            assert_eq!(DVec3::from_array(normal.map(f64::from)), normals.vector(vertex));
        }
        let uvs = mesh.attribute(Domain::Vertex, TEXCOORD).unwrap();
        for (vertex, [u, v]) in reader.read_tex_coords(0).unwrap().into_f32().enumerate() {
            assert_eq!((f64::from(u), 1.0 - f64::from(v)), (uvs.number(vertex, 0), uvs.number(vertex, 1)));
        }
        let colors: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();
        assert_eq!(colors[0], [0.5, 0.25, 1.0]);
    }
    let red = nodes[0].mesh().unwrap().primitives().next().unwrap().material();
    assert_eq!(red.pbr_metallic_roughness().base_color_factor(), [0.8, 0.0, 0.1, 0.5]);
    assert!(red.double_sided() && red.name() == Some("red"));
}

#[test]
fn far_meshes_keep_their_accuracy_through_a_local_origin() {
    let at = DVec3::new(5e6, -4.2e6, 300.0);
    let positions: Vec<DVec3> = (0..300)
        .map(|i| at + DVec3::new((f64::from(i) * 0.37).sin(), (f64::from(i) * 0.11).cos(), f64::from(i) * 0.01))
        .collect();
    let triangles = (0..298).map(|i| [i, i + 1, i + 2]).collect();
    let part = Part::new(TriMesh::try_new(positions.clone(), triangles).unwrap());
    let shape = Shape { up: Some(UpAxis::Y), ..Shape::new(part) };
    let (file, report) = to_glb(&shape).unwrap();
    let Deviation::AtMost(bound) = report.deviation else { panic!("a bound") };
    assert!(bound > 0.0 && bound < 1e-6, "{bound}");
    let back = from_glb(&file).shape;
    let Geometry::TriMesh(mesh) = &*back.parts[0].placed() else { panic!("a mesh") };
    let worst = mesh.positions().iter().zip(&positions).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(worst <= bound && worst > bound * 0.5, "{worst} {bound}");
    // With a placement on top the origin goes into the matrix.
    let mut turned = shape.clone();
    turned.parts[0].placement = turn();
    let (file, report) = to_glb(&turned).unwrap();
    let bound = report.deviation.value().unwrap();
    let back = from_glb(&file).shape;
    let Geometry::TriMesh(mesh) = &*back.parts[0].placed() else { panic!("a mesh") };
    for (found, source) in mesh.positions().iter().zip(&positions) {
        // Beside the certified rounding of the file, turning rounds at 5e6: a few 1e-9.
        assert!(found.distance(turn().point(*source)) < bound + 1e-8);
    }
}

#[test]
fn what_does_not_fit_is_said() {
    let mut mesh = rich();
    mesh.insert_attribute(Domain::Face, Column::labels("patch", vec![1, 2])).unwrap();
    let text = Values::Text { names: vec!["oak".into()], index: vec![0; 4] };
    mesh.insert_attribute(Domain::Vertex, Column::try_new("wood", 1, text).unwrap()).unwrap();
    mesh.insert_attribute(Domain::Vertex, Column::labels("big", vec![u32::MAX; 4])).unwrap();
    mesh.insert_attribute(Domain::Vertex, Column::texcoords(TEXCOORD, &[[0.0; 2]; 4])).unwrap();
    let wide = Column::try_new("wide", 5, Values::F32(vec![0.0; 20])).unwrap();
    mesh.insert_attribute(Domain::Vertex, wide).unwrap();
    let shear = Affine::from_shear(DVec3::X, DVec3::Y);
    let sheared = Part { placement: shear, ..Part::new(mesh) };
    let empty = Part::new(PointCloud::default()).named("empty");
    let brick = Material { texture: Some("../brick.png".into()), ..Material::default() };
    let shape = Shape { parts: vec![sheared, empty], materials: vec![brick], ..Shape::default() };
    let (file, report) = to_glb(&shape).unwrap();
    let whats: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    for what in [
        "placement of part 0",
        "face attribute \"patch\"",
        "vertex attribute \"wood\"",
        "vertex attribute \"big\"",
        "vertex attribute \"texcoord\"",
        "vertex attribute \"wide\"",
        "the point-cloud of part 1, which is empty",
        "texture \"../brick.png\"",
        // Scaled and rounded, and replaced.
        "vertex attribute \"normal\"",
    ] {
        assert!(whats.contains(&what), "{what} in {whats:?}");
    }
    assert_eq!(whats.len(), 10);
    assert!(report.findings.iter().any(|finding| finding.code == "W-glb-up"));
    let back = from_glb(&file).shape;
    let points = crate::placed::points_of(&back.parts[0].geometry).unwrap();
    assert_eq!((back.parts.len(), points[2]), (1, DVec3::new(2.0, 1.0, 0.25)));
    assert!(::gltf::import_slice(&file).is_ok());
}

#[test]
fn colours_are_linear_in_the_file() {
    let mut cloud = PointCloud::new(vec![DVec3::ZERO, DVec3::X]);
    let bytes = Values::U8(vec![255, 0, 128, 255, 10, 20, 30, 51]);
    cloud.insert_attribute(Column::try_new(COLOR, 4, bytes).unwrap()).unwrap();
    let (file, report) = to_glb(&Shape::new(Part::new(cloud))).unwrap();
    assert!(report.findings.iter().any(|finding| finding.code == "W-glb-color"));
    let back = from_glb(&file).shape;
    let Geometry::PointCloud(cloud) = &*back.parts[0].geometry else { panic!("a cloud") };
    let color = cloud.attributes().get(COLOR).unwrap();
    assert_eq!((color.number(0, 0), color.number(0, 1), color.number(0, 3)), (1.0, 0.0, 1.0));
    // The middle of the sRGB bytes is about a fifth of the light; alpha is a plain fraction.
    assert!((color.number(0, 2) - 0.215_861).abs() < 1e-6 && (color.number(1, 3) - 0.2).abs() < 1e-7);
}

#[test]
fn positions_that_do_not_fit_are_named() {
    for (bad, index) in [(f64::NAN, 2), (f64::INFINITY, 1), (1e39, 0)] {
        let mut positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        positions[index].y = bad;
        let part = Part::new(TriMesh::try_new(positions, vec![[0, 1, 2]]).unwrap()).named("bad");
        let error = to_glb(&Shape { parts: vec![Part::new(rich()), part], ..Shape::default() }).unwrap_err();
        let text = error.to_string();
        assert!(text.starts_with(&format!("glb: part 1 \"bad\", vertex {index}: found")), "{text}");
    }
    let mut part = Part::new(rich());
    part.placement.translation.x = f64::NAN;
    assert_eq!(to_glb(&Shape::new(part)).unwrap_err().code(), "E-write-finite");
    assert!(to_glb(&Shape::default()).is_ok_and(|(file, _)| from_glb(&file).shape.parts.is_empty()));
}

#[test]
fn damaged_files_never_panic_and_stay_within_the_budget() {
    let (file, _) = to_glb(&scene()).unwrap();
    let whole = from_glb(&file);
    let format = format_by_id("glb").unwrap();
    let exec = Exec::default().with_memory(8 << 20);
    let context = ReadContext { exec: exec.clone(), ..ReadContext::default() };
    for end in 0..file.len() {
        let error = read(&file[..end], format, &context).unwrap_err();
        assert_eq!(error.category(), Category::Malformed, "{end}: {error}");
    }
    let mut state = 3u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize
    };
    let (mut refused, mut read_differently) = (0, 0);
    for _ in 0..6000 {
        let mut damaged = file.clone();
        for _ in 0..1 + next() % 3 {
            let at = next() % damaged.len();
            damaged[at] = if next() % 2 == 0 { next() as u8 } else { b"0123456789-.[]{},\""[next() % 18] };
        }
        match read(&damaged, format, &context) {
            Ok(read) if read == whole => {}
            Ok(_) => read_differently += 1,
            Err(error) => {
                assert!(error.fault().is_none_or(|fault| !fault.found.is_empty() && !fault.expected.is_empty()));
                refused += 1;
            }
        }
        assert_eq!(exec.memory_taken(), 0);
    }
    assert!(refused > 1000 && read_differently > 500, "{refused} {read_differently}");
}

fn document(change: impl FnOnce(&mut Value)) -> Result<ReadShape, ReadError> {
    let mut document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "buffers": [{"byteLength": 44, "uri": "data:application/octet-stream;base64,\
            AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="}]
    });
    change(&mut document);
    let text = document.to_string();
    let format = detect(text.as_bytes(), None).unwrap();
    assert_eq!(format.id, "gltf");
    let limits = Limits { max_elements: 1000, ..Limits::default() };
    read(text.as_bytes(), format, &ReadContext { limits, ..ReadContext::default() })
}

#[test]
fn every_fault_of_a_document_has_its_path() {
    let read = document(|_| {}).unwrap();
    assert_eq!(mesh(&read.shape, 0).positions(), [DVec3::ZERO, DVec3::X, DVec3::Y]);
    let cases: [(&str, Value, &str, &str); 19] = [
        ("/asset", json!(1), "E-gltf-type", "/asset"),
        ("/asset/version", json!("1.0"), "E-gltf-version", "/asset/version"),
        ("/scene", json!(4), "E-gltf-reference", "/scene"),
        ("/scenes/0/nodes/0", json!(-1), "E-gltf-type", "/scenes/0/nodes/0"),
        ("/nodes/0/mesh", json!(1), "E-gltf-reference", "/nodes/0/mesh"),
        ("/meshes/0/primitives/0/indices", json!(9), "E-gltf-reference", "/meshes/0/primitives/0/indices"),
        ("/accessors/0/count", json!(4), "E-gltf-bounds", "/accessors/0"),
        ("/accessors/0/count", json!(0), "E-gltf-count", "/accessors/0/count"),
        ("/accessors/0/count", json!(1_537_228_672_809_129_302u64), "E-gltf-bounds", "/accessors/0"),
        ("/accessors/0/type", json!("VEC2"), "E-gltf-type", "/accessors/0/type"),
        ("/accessors/0/componentType", json!(5125), "E-gltf-type", "/accessors/0/componentType"),
        ("/accessors/1/componentType", json!(5126), "E-gltf-type", "/accessors/1"),
        ("/accessors/1/componentType", json!(5125), "E-gltf-bounds", "/accessors/1"),
        ("/accessors/1/bufferView", json!(2), "E-gltf-reference", "/accessors/1/bufferView"),
        ("/bufferViews/1/byteLength", json!(6000), "E-gltf-bounds", "/bufferViews/1"),
        ("/bufferViews/1/byteOffset", json!(u64::MAX), "E-gltf-bounds", "/bufferViews/1"),
        ("/bufferViews/0/buffer", json!(1), "E-gltf-reference", "/bufferViews/0/buffer"),
        ("/buffers/0/byteLength", json!(45), "E-gltf-buffer", "/buffers/0"),
        ("/buffers/0/uri", json!("data:x;base64,A"), "E-gltf-uri", "/buffers/0/uri"),
    ];
    for (pointer, value, code, path) in cases {
        let error = document(|document| *document.pointer_mut(pointer).unwrap() = value).unwrap_err();
        let fault = error.fault().unwrap();
        assert_eq!((fault.code, fault.within.as_deref()), (code, Some(path)), "{pointer}: {error}");
    }
    let error = document(|document| document["accessors"][0]["byteOffset"] = json!(2)).unwrap_err();
    assert_eq!(error.code(), "E-gltf-bounds");
    let error = document(|document| document["bufferViews"][0]["byteStride"] = json!(11)).unwrap_err();
    assert_eq!((error.code(), error.fault().unwrap().within.as_deref()), ("E-gltf-bounds", Some("/accessors/0")));
    let error = document(|document| document["meshes"][0]["primitives"][0]["mode"] = json!(7)).unwrap_err();
    assert_eq!(error.code(), "E-gltf-mode");
    let error = document(|document| document["extensionsRequired"] = json!(["EXT_no"])).unwrap_err();
    assert_eq!((error.code(), error.category()), ("E-gltf-extension", Category::Unsupported));
    assert!(error.to_string().contains("/extensionsRequired/0: found \"EXT_no\""));
}

#[test]
fn buffers_beside_the_input_are_opened_by_the_caller() {
    struct Folder;
    impl Siblings for Folder {
        fn open(&self, name: &SiblingName, _: u64) -> Result<Vec<u8>, SiblingError> {
            if name.as_str() != "a b.bin" {
                return Err(SiblingError::Missing);
            }
            let floats = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes);
            Ok([floats.as_flattened(), &[2, 0, 1, 0, 0, 0, 0, 0]].concat())
        }
    }
    let text = |uri: &str| {
        json!({
            "asset": {"version": "2.0"}, "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}
            ],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
            "buffers": [{"byteLength": 44, "uri": uri}]
        })
        .to_string()
    };
    let context = ReadContext { siblings: Some(Arc::new(Folder)), ..ReadContext::default() };
    let format = format_by_id("gltf").unwrap();
    let shape = read(text("a%20b.bin").as_bytes(), format, &context).unwrap().shape;
    assert_eq!(mesh(&shape, 0).triangles(), [[2, 1, 0]]);
    for (uri, code) in [("c.bin", "E-sibling-missing"), ("../a.bin", "E-sibling-path")] {
        let error = read(text(uri).as_bytes(), format, &context).unwrap_err();
        assert_eq!((error.code(), error.fault().unwrap().within.as_deref()), (code, Some("/buffers/0/uri")));
    }
    assert_eq!(
        read(text("a%20b.bin").as_bytes(), format, &ReadContext::default()).unwrap_err().category(),
        Category::Unsupported
    );
}

#[test]
fn files_of_other_programs_have_their_known_sizes() {
    for (name, vertices, indices, parts) in [
        ("Box/Box.glb", 24, 36, 1),
        ("BoxInterleaved.glb", 24, 36, 1),
        ("Duck/Duck.glb", 2399, 12636, 1),
        ("cubevc.glb", 54, 144, 1),
        ("nested.glb", 72, 108, 3),
    ] {
        let Some(path) = shared_data(&format!("gltf/{name}")) else { continue };
        let file = std::fs::read(path).unwrap();
        let back = from_glb(&file);
        assert!(back.findings.is_empty(), "{name}: {:?}", back.findings);
        let count = |f: fn(&TriMesh) -> usize| (0..back.shape.parts.len()).map(|part| f(mesh(&back.shape, part))).sum();
        let found: (usize, usize) = (count(|mesh| mesh.positions().len()), count(|mesh| mesh.triangles().len() * 3));
        assert_eq!((found, back.shape.parts.len()), ((vertices, indices), parts), "{name}");
        // Written and read again, positions, triangles and attributes keep their bits.
        let (again, report) = to_glb(&back.shape).unwrap();
        assert_eq!(report.deviation, Deviation::Exact, "{name}");
        assert_eq!(from_glb(&again).shape.parts, back.shape.parts, "{name}");
        assert!(::gltf::import_slice(&again).is_ok(), "{name}");
    }
}

#[test]
fn collected_defects_are_found_where_they_are() {
    let Some(folder) = shared_data("malformed") else { return };
    let expected = std::fs::read_to_string(folder.join("EXPECTED.tsv")).unwrap();
    let mut seen = 0;
    for line in expected.lines().filter(|line| line.starts_with("gltf\t")) {
        let columns: Vec<&str> = line.split('\t').collect();
        let [name, verdict, place] = [columns[1], columns[3], columns[5]];
        let file = std::fs::read(folder.join("gltf").join(name)).unwrap();
        let result = read(&file, detect(&file, Some(name)).unwrap(), &ReadContext::named(name));
        match verdict {
            "accept" => assert!(result.is_ok_and(|read| read.findings.is_empty()), "{name}"),
            "accept+warn" => assert!(result.is_ok_and(|read| !read.findings.is_empty()), "{name}"),
            _ => {
                let error = result.unwrap_err();
                let text = error.to_string();
                let wanted = match place {
                    pointer if pointer.starts_with('/') => pointer.to_owned(),
                    _ if place == "last byte" => format!("byte {}", file.len() - 1),
                    _ => place.replace(" col ", ", column "),
                };
                assert!(text.starts_with(&format!("{name}: {wanted}")), "{text}: expected {wanted}");
            }
        }
        seen += 1;
    }
    assert!(seen >= 24);
}

#[test]
fn instances_beyond_the_budget_are_refused() {
    // A few hundred nodes with a few hundred primitives each make many parts from a small file.
    let shape = |count: u32| {
        json!({
            "asset": {"version": "2.0"},
            "nodes": vec![json!({"mesh": 0}); count as usize],
            "meshes": [{"primitives": vec![json!({"attributes": {"POSITION": 0}, "mode": 0}); count as usize]}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"}],
            "bufferViews": [{"buffer": 0, "byteLength": 12}],
            "buffers": [{"byteLength": 12, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAA"}]
        })
    };
    let small = ReadContext { exec: Exec::default().with_memory(4 << 20), ..ReadContext::default() };
    let attempt = |count| read(shape(count).to_string().as_bytes(), format_by_id("gltf").unwrap(), &small);
    assert_eq!(attempt(50).unwrap().shape.parts.len(), 2500);
    assert!(matches!(attempt(400), Err(ReadError::OverBudget(_))));
    let text = json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4_000_000_000_000_000_000u64}]});
    let exec = Exec::default().with_memory(1 << 20);
    let context = ReadContext { exec, ..ReadContext::default() };
    let error = read(text.to_string().as_bytes(), format_by_id("gltf").unwrap(), &context).unwrap_err();
    assert_eq!(error.code(), "E-gltf-buffer");
}

#[test]
fn an_attribute_of_matrices_is_lost_alone() {
    for (kind, semantic) in [("MAT2", "_FRAME"), ("MAT3", "_FRAME"), ("MAT4", "_FRAME"), ("MAT4", "BONES")] {
        let read = document(|document| {
            document["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(2);
            let matrices = json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": kind});
            document["accessors"].as_array_mut().unwrap().push(matrices);
        });
        let read = read.unwrap();
        assert_eq!(mesh(&read.shape, 0).triangles(), [[0, 1, 2]]);
        let said: Vec<String> = read.losses.iter().map(ToString::to_string).collect();
        assert_eq!(said.len(), 1);
        assert!(
            said[0].contains(&format!("vertex attribute \"{semantic}\"")) && said[0].contains("matrices"),
            "{said:?}"
        );
    }
    // Where glTF says what it must be, it is an error as before.
    for semantic in ["NORMAL", "TEXCOORD_0", "COLOR_0", "POSITION"] {
        let error = document(|document| {
            document["meshes"][0]["primitives"][0]["attributes"][semantic] = json!(2);
            let matrices = json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "MAT3"});
            document["accessors"].as_array_mut().unwrap().push(matrices);
        });
        assert_eq!(error.unwrap_err().code(), "E-gltf-type");
    }
}
