//! What the reader makes of statements, wherever the text is cut.

use std::sync::Arc;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Limits, Place};
use shapeloom_mesh::{COLOR, Domain, GROUP, MATERIAL, NORMAL, PolyMesh, SMOOTHING, TEXCOORD, TriMesh, Values};
use shapeloom_shape::{Geometry, Representation, Shape};

use super::read::read_cut;
use crate::{
    Fault, ReadContext, ReadOptions, ReadShape, SiblingError, SiblingName, SiblingOutputs, Siblings, WriteContext,
    format_by_id, read, write,
};

fn obj(text: &str) -> ReadShape {
    read(text.as_bytes(), format_by_id("obj").unwrap(), &ReadContext::named("x.obj")).unwrap()
}

fn fault(text: &str) -> Fault {
    let error = read(text.as_bytes(), format_by_id("obj").unwrap(), &ReadContext::named("x.obj")).unwrap_err();
    error.fault().unwrap().clone()
}

fn geometry<T: Representation>(shape: &Shape, part: usize) -> &T {
    T::from_geometry(&shape.parts[part].geometry).unwrap()
}

fn codes(read: &ReadShape) -> Vec<&'static str> {
    read.findings.iter().map(|finding| finding.code).collect()
}

/// Statements of every kind, absolute and relative indices, comments, continued lines.
const MIXED: &str = "# a scene\r\no cube\rv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\ng side front\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/3/1\nf -4//-1 -2//-1 \\\n -1//-1\n\
    o roof # not a comment\nv 5 0 0\nv 6 0 0\nv 6 1 1\nv 5 1 1\nv 5 2 0\nusemtl blue\ns off\ng\nf -5 -4 -3 -2 -1\nusemtl red\n\
    f 5 6 7\no wire\nv 0 0 9\nv 1 0 9\nv 1 1 9\nl -3 -2 -1 -3\no net\nl 1 2\nl 2 3 4\no dots\np 1 -1\np 3\n";

#[test]
fn every_statement_is_understood() {
    let read = obj(MIXED);
    let names: Vec<&str> = read.shape.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["cube", "roof # not a comment", "wire", "net", "dots"]);
    let cube: &TriMesh = geometry(&read.shape, 0);
    assert_eq!(cube.triangles(), [[0, 1, 2], [0, 2, 3]]);
    let text = |column: &shapeloom_mesh::Column, at| column.text(at).unwrap().to_owned();
    assert_eq!(text(cube.attribute(Domain::Face, GROUP).unwrap(), 1), "side front");
    assert_eq!(cube.attribute(Domain::Face, SMOOTHING).unwrap().values(), &Values::U32(vec![1, 1]));
    assert_eq!(cube.attribute(Domain::Vertex, NORMAL).unwrap().vector(3), DVec3::Z);
    // The second triangle has no texture coordinates, so that corners at a vertex differ.
    assert_eq!(cube.attribute(Domain::Wedge, TEXCOORD).unwrap().number(2, 1), 1.0);
    let colors = cube.attribute(Domain::Vertex, COLOR).unwrap().values();
    assert_eq!(colors, &Values::U8(vec![255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]));
    let roof: &PolyMesh = geometry(&read.shape, 1);
    assert!(roof.attributes().vertex.is_empty() && roof.attributes().wedge.is_empty());
    assert_eq!((roof.positions().len(), roof.face(0), roof.face(1)), (5, &[0, 1, 2, 3, 4][..], &[0, 1, 2][..]));
    let materials = roof.attribute(Domain::Face, MATERIAL).unwrap();
    assert_eq!((text(materials, 0), text(materials, 1)), ("blue".to_owned(), "red".to_owned()));
    let known: Vec<&str> = read.shape.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(
        (known, read.shape.parts[0].material, read.shape.parts[1].material),
        (vec!["red", "blue"], Some(0), None)
    );
    let Geometry::Polyline(wire) = &*read.shape.parts[2].geometry else { panic!("one line is a polyline") };
    assert_eq!((wire.points().len(), wire.is_closed()), (3, true));
    let Geometry::GeometricGraph(net) = &*read.shape.parts[3].geometry else { panic!("several lines are a graph") };
    assert_eq!((net.positions().len(), net.edges()), (4, &[[0, 1], [1, 2], [2, 3]][..]));
    assert_eq!(net.vertex_attributes().get(COLOR).unwrap().vector(1), DVec3::new(0.0, 255.0, 0.0));
    let Geometry::PointCloud(dots) = &*read.shape.parts[4].geometry else { panic!("points are a cloud") };
    assert_eq!(dots.positions(), [DVec3::ZERO, DVec3::new(1.0, 1.0, 9.0), DVec3::new(1.0, 1.0, 0.0)]);
    assert!(read.losses.iter().any(|loss| loss.what.contains("4 vertices shared")), "{:?}", read.losses);
}

/// Found for every size of piece, so in particular for pieces of one line.
#[test]
fn where_the_text_is_cut_does_not_matter() {
    let context = ReadContext::named("x.obj");
    let whole = read_cut(MIXED.as_bytes(), usize::MAX, &context).unwrap();
    for size in (1..200).chain([500]) {
        let read = read_cut(MIXED.as_bytes(), size, &context).unwrap();
        assert_eq!((&read.shape, &read.losses), (&whole.shape, &whole.losses), "{size}");
        let findings = |read: &ReadShape| -> Vec<_> { read.findings.iter().cloned().collect() };
        assert_eq!(findings(&read), findings(&whole), "{size}");
    }
    // Faces that are passed over leave nothing behind; vertices that nothing uses stay with their object; two graphs.
    let second = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf -1/-1/-1 -2/-1/-1\nf 1//1 2//1 3//1\no b\nv 9 9 9\nv 8 8 8\n\
        v 7 7 7\nv 6 6 6\nf 4 5 6\nf -1\nl 1 2\nl 3 4\no c\nl 2 3\nl 4 1\n";
    let whole = read_cut(second.as_bytes(), usize::MAX, &context).unwrap();
    let counts: Vec<usize> = whole
        .shape
        .parts
        .iter()
        .map(|part| match &*part.geometry {
            Geometry::TriMesh(mesh) => mesh.positions().len(),
            Geometry::GeometricGraph(graph) => 10 * graph.positions().len() + graph.edges().len(),
            other => panic!("{}", other.kind()),
        })
        .collect();
    assert_eq!(counts, [3, 4, 42, 42]);
    for size in 1..150 {
        assert_eq!(read_cut(second.as_bytes(), size, &context).unwrap().shape, whole.shape, "{size}");
    }
    for broken in [
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 4\n",
        "v 0 0 0\nf -1 -1 -2\nv 1 0 0\n",
        "v 0 0 0\nvn 0 0 1\nf 1//1 1//1 1//-2\n",
        "v 0 0 0\nl 1 2\n",
        "v 0 0 0\np -2\n",
        "v 0 0 0\nv nan 0 0\n",
        "v 0 0 0\nv 1 0 0\nf 1 2\nf 1 2 2\nf 1 2 3\n",
    ] {
        let wanted = read_cut(broken.as_bytes(), usize::MAX, &context).unwrap_err();
        for size in 1..30 {
            assert_eq!(read_cut(broken.as_bytes(), size, &context).unwrap_err(), wanted, "{broken} {size}");
        }
    }
}

/// Lines dealt out anew, left out and repeated: the same result or the same error for every size of piece.
#[test]
fn shuffled_statements_are_read_alike_wherever_they_are_cut() {
    let context = ReadContext::named("x.obj");
    let lines: Vec<&str> = MIXED.split_inclusive(['\n', '\r']).collect();
    let mut state = 1u64;
    let mut next = |bound: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % bound
    };
    let mut accepted = 0;
    for _ in 0..1500 {
        let mut text = lines[..18].concat();
        for _ in 0..next(40) {
            text += lines[next(lines.len())];
        }
        let whole = read_cut(text.as_bytes(), usize::MAX, &context);
        accepted += usize::from(whole.is_ok());
        for size in [1, 7, 30, 80] {
            match (&whole, read_cut(text.as_bytes(), size, &context)) {
                (Ok(whole), Ok(cut)) => {
                    assert_eq!(
                        (&cut.shape, &cut.losses, &cut.findings),
                        (&whole.shape, &whole.losses, &whole.findings),
                        "{text}"
                    );
                }
                (Err(whole), Err(cut)) => assert_eq!(*whole, cut, "{text}"),
                (whole, cut) => panic!("{size}: {whole:?} {cut:?} {text}"),
            }
        }
    }
    assert!((100..1400).contains(&accepted), "{accepted}");
}

#[test]
fn indices_name_what_exists() {
    let square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\n";
    for (statement, code, found) in [
        ("f 1 2 5", "E-obj-index", "vertex 5"),
        ("f 1 2 -5", "E-obj-index", "vertex -5"),
        ("f 0 1 2", "E-obj-index", "index 0"),
        ("f 1/2 2/1 3/1", "E-obj-index", "texture coordinate 2"),
        ("f 1//1 2//1 3//1", "E-obj-index", "normal 1"),
        ("f 1 2 99999999999999999999", "E-obj-number", "99999999999999999999"),
        ("f 1 2 4294967297", "E-obj-index", "4294967297"),
        ("f 1 2 3x", "E-obj-number", "x"),
        ("f 1 2 three", "E-obj-number", "three"),
        ("f 1/1/1/1 2 3", "E-obj-number", "/1"),
        ("f 1.0 2.0 3.0", "E-obj-number", ".0"),
        ("f 1,2,3", "E-obj-number", ",2,3"),
        ("l 1 9", "E-obj-index", "8 of 0-based"),
        ("p 9", "E-obj-index", "8 of 0-based"),
    ] {
        let fault = fault(&format!("{square}{statement}\n"));
        assert_eq!((fault.code, &fault.place), (code, &Place::line(6)), "{statement}: {fault}");
        assert!(fault.found.contains(found), "{statement}: {fault}");
    }
    // Faces may come before their vertices.
    assert_eq!(geometry::<TriMesh>(&obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").shape, 0).triangles(), [[0, 1, 2]]);
}

#[test]
fn numbers_that_are_none_name_their_vertex() {
    for (line, code) in [("v 1 nan 0", "E-obj-finite"), ("v 1 1e400 0", "E-obj-finite"), ("v 1 1,5 0", "E-obj-number")]
    {
        let fault = fault(&format!("v 0 0 0\nvn 0 0 1\n{line}\n"));
        assert_eq!((fault.code, &fault.place, fault.within.as_deref()), (code, &Place::line(3), Some("vertex 1")));
    }
    assert_eq!(fault("v 1 2\n").code, "E-obj-row");
    assert_eq!(fault("v 1 2 3 4 5\n").code, "E-obj-row");
    assert_eq!(fault("v 1 2 3 4 5 6 7 8 9 10\n").code, "E-obj-row");
    assert_eq!(fault("vn 1 2\n").code, "E-obj-row");
    assert_eq!(fault("v 0 0 0\nvt\n").code, "E-obj-row");
    let dropping =
        ReadContext { options: ReadOptions { drop_non_finite: true, ..ReadOptions::new() }, ..ReadContext::default() };
    let text = b"v 0 0 0\nv 1 nan 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    let read = read(text, format_by_id("obj").unwrap(), &dropping).unwrap();
    assert_eq!(geometry::<TriMesh>(&read.shape, 0).triangles(), [[0, 1, 2]]);
    assert_eq!(codes(&read), ["W-read-dropped"]);
}

#[test]
fn objects_that_share_vertices_stay_one_mesh() {
    let read = obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no a\nf 1 2 3\no b\nf 2 4 3\n");
    let mesh: &TriMesh = geometry(&read.shape, 0);
    assert_eq!((read.shape.parts.len(), mesh.positions().len()), (1, 4));
    assert_eq!(mesh.attribute(Domain::Face, "object").unwrap().text(1), Some("b"));
}

#[test]
fn vertices_alone_are_points_and_nothing_is_an_empty_mesh() {
    let read = obj("v 0 0 0\nv 1 2 3\n");
    let Geometry::PointCloud(cloud) = &*read.shape.parts[0].geometry else { panic!("points") };
    assert_eq!(cloud.positions().len(), 2);
    for nothing in ["", "\n\n", "# nothing\n", "o a\ng b\n"] {
        assert_eq!(codes(&obj(nothing)), ["W-obj-empty"], "{nothing}");
    }
}

/// Files beside an input that live in memory.
struct Folder(Vec<(&'static str, &'static str)>);

impl Siblings for Folder {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let found = self.0.iter().find(|(known, _)| *known == name.as_str()).ok_or(SiblingError::Missing)?;
        Ok(found.1.bytes().take(max_bytes as usize).collect())
    }
}

#[test]
fn materials_come_from_libraries_beside_the_file() {
    let library = "newmtl steel\nKd 0.5 0.25 1\nd 0.5\nPm 1\nPr 0.25\nNs 10\nmap_Kd -s 1 1 1 -clamp on wood grain.png\n\
        newmtl glass\nTr 0.75\nKd 1 x 1\nnewmtl unused\n";
    let folder = Folder(vec![("my lib.mtl", library), ("a.mtl", "newmtl a\n"), ("b.mtl", "newmtl b\n")]);
    let context = ReadContext { siblings: Some(Arc::new(folder)), ..ReadContext::named("x.obj") };
    let text = "mtllib my lib.mtl\nmtllib a.mtl b.mtl\nmtllib ../secret.mtl\nmtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\n\
        usemtl glass\nf 1 2 3\nusemtl steel\nf 3 2 1\nusemtl nobody\nf 1 2 3\n";
    let read = read(text.as_bytes(), format_by_id("obj").unwrap(), &context).unwrap();
    let names: Vec<&str> = read.shape.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["glass", "steel", "nobody", "unused", "a", "b"]);
    let steel = &read.shape.materials[1];
    assert_eq!((steel.base_color, steel.metallic, steel.roughness), ([0.5, 0.25, 1.0, 0.5], 1.0, 0.25));
    assert_eq!(steel.texture.as_deref(), Some("wood grain.png"));
    assert_eq!(read.shape.materials[0].base_color[3], 0.25);
    // The bad Kd, the forbidden name and the missing library; the missing texture.
    let library = read.findings.iter().find(|finding| finding.code == "W-obj-library").unwrap();
    assert_eq!((library.count, &library.places[1]), (3, &Place::line(3)));
    assert!(codes(&read).contains(&"W-obj-texture"));
    assert!(read.losses.iter().any(|loss| loss.what.contains("Ns")), "{:?}", read.losses);
}

/// Collects what is written beside an output.
#[derive(Default)]
struct Shelf(std::sync::Mutex<Vec<(String, Vec<u8>)>>);

impl SiblingOutputs for Shelf {
    fn put(&self, name: &SiblingName, bytes: Vec<u8>) -> std::io::Result<()> {
        self.0.lock().unwrap().push((name.as_str().to_owned(), bytes));
        Ok(())
    }
}

#[test]
fn what_is_written_is_read_again() {
    let library = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 0.5\nmap_Kd sky.png\n";
    let folder = Folder(vec![("x.mtl", library), ("sky.png", "")]);
    let context = ReadContext { siblings: Some(Arc::new(folder)), ..ReadContext::named("x.obj") };
    let text = format!("mtllib x.mtl\n{MIXED}");
    let format = format_by_id("obj").unwrap();
    let first = read(text.as_bytes(), format, &context).unwrap();
    let shelf = Arc::new(Shelf::default());
    let beside = WriteContext { name: "dir/copy.obj".into(), siblings: Some(shelf.clone()), ..WriteContext::default() };
    let mut written = Vec::new();
    let report = write(&first.shape, format, &beside, &mut written).unwrap();
    assert!(report.losses.is_empty(), "{:?}", report.losses);
    let (name, bytes) = shelf.0.lock().unwrap().pop().unwrap();
    assert_eq!(name, "copy.mtl");
    let copy = String::from_utf8(bytes).unwrap();
    let folder = Folder(vec![("copy.mtl", Box::leak(copy.into_boxed_str())), ("sky.png", "")]);
    let context = ReadContext { siblings: Some(Arc::new(folder)), ..ReadContext::named("copy.obj") };
    let second = read(&written, format, &context).unwrap();
    assert_eq!(second.shape, first.shape, "{}", String::from_utf8_lossy(&written));
    assert_eq!(codes(&second), ["W-obj-color", "W-obj-corner"]);
    assert_eq!(second.losses.len(), 0, "{:?}", second.losses);
    // Without a place for a library the names stay.
    let mut alone = Vec::new();
    let report = write(&first.shape, format, &WriteContext::default(), &mut alone).unwrap();
    assert_eq!(report.losses.len(), 2);
    assert!(!String::from_utf8(alone).unwrap().contains("mtllib"));
}

#[test]
fn names_in_other_encodings_are_kept_apart_and_told() {
    let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\no caf\xe9\ng a\xe8\nf 1 2 3\ng a\xe9\nf 3 2 1\n";
    let read = read(text, format_by_id("obj").unwrap(), &ReadContext::default()).unwrap();
    let groups = geometry::<TriMesh>(&read.shape, 0).attribute(Domain::Face, GROUP).unwrap();
    assert_ne!(groups.number(0, 0), groups.number(1, 0));
    assert_eq!(read.shape.parts[0].name, "caf\u{fffd}");
    let told = read.findings.iter().next().unwrap();
    assert_eq!((told.code, told.count, &told.places[0]), ("W-text-encoding", 3, &Place::line(4)));
}

#[test]
fn comments_are_named_as_lost() {
    for (text, count) in
        [("# a\nv 0 0 0\n", 1), ("v 0 0 0 # a\n", 1), ("v 0 0 0\n\n  # a", 1), ("o a # b\nv 0 0 0\n", 0)]
    {
        assert_eq!(obj(text).losses.len(), count, "{text}");
    }
}

#[test]
fn limits_and_budgets_hold() {
    let polygon = Limits { max_polygon: 4, ..Limits::default() };
    let context = ReadContext { limits: polygon, ..ReadContext::default() };
    let format = format_by_id("obj").unwrap();
    let error = read(b"v 0 0 0\nf 1 1 1 1 1\n", format, &context).unwrap_err();
    assert_eq!(error.fault().unwrap().code, "E-obj-limit");
    let few = Limits { max_elements: 2, ..Limits::default() };
    let context = ReadContext { limits: few, ..ReadContext::default() };
    assert_eq!(
        read(b"v 0 0 0\nv 0 0 0\nv 0 0 0\n", format, &context).unwrap_err().fault().unwrap().code,
        "E-obj-limit"
    );
    let many = "v 0 0 0\n".repeat(100_000);
    let context = ReadContext { exec: Exec::default().with_memory(1 << 20), ..ReadContext::default() };
    assert!(read(many.as_bytes(), format, &context).is_err());
    assert_eq!(context.exec.memory_taken(), 0);
    let objects = "o\n".repeat(70_000);
    assert_eq!(fault(&format!("v 0 0 0\n{objects}")).code, "E-obj-limit");
}
