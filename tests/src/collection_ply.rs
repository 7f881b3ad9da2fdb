//! PLY files of the collection beside the workspace: known facts, round trips in every encoding, and another reader.

use std::path::PathBuf;

use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{DefaultElement, Ply, Property};
use shapeloom::core::glam::DVec3;
use shapeloom::io::{Encoding, ReadContext, ReadShape, WriteContext, WriteOptions, format_by_id, read, write};
use shapeloom::mesh::{Domain, NORMAL, TEXCOORD};
use shapeloom::shape::{Geometry, Part, Shape};

use crate::shapes;
use crate::support::shared_data;

const ENCODINGS: [Encoding; 3] = [Encoding::Ascii, Encoding::Binary, Encoding::BinaryBigEndian];

fn read_ply(bytes: &[u8], name: &str) -> ReadShape {
    let ply = format_by_id("ply").expect("a format");
    read(bytes, ply, &ReadContext::named(name)).unwrap_or_else(|error| panic!("{error}"))
}

fn written(shape: &Shape, encoding: Encoding) -> (Vec<u8>, Vec<String>) {
    let mut bytes = Vec::new();
    let context = WriteContext { options: WriteOptions { encoding, ..WriteOptions::default() }, ..Default::default() };
    let report = write(shape, format_by_id("ply").expect("a format"), &context, &mut bytes).expect("it can be written");
    (bytes, report.losses.iter().map(|loss| loss.what.clone()).collect())
}

/// The files, none where the collection is not there.
fn files() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for folder in ["ply", "synthetic"] {
        let Some(folder) = shared_data(folder) else { continue };
        let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
        found.extend(entries.filter(|path| path.extension().is_some_and(|extension| extension == "ply")));
    }
    found.sort();
    found
}

fn name_of(path: &std::path::Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// Positions and faces of a part.
fn contents(geometry: &Geometry) -> (Vec<DVec3>, Vec<Vec<u32>>) {
    match geometry {
        Geometry::TriMesh(mesh) => {
            (mesh.positions().to_vec(), mesh.triangles().iter().map(|corners| corners.to_vec()).collect())
        }
        Geometry::PolyMesh(mesh) => (mesh.positions().to_vec(), mesh.faces().map(<[u32]>::to_vec).collect()),
        Geometry::PointCloud(cloud) => (cloud.positions().to_vec(), Vec::new()),
        Geometry::GeometricGraph(graph) => (graph.positions().to_vec(), Vec::new()),
        other => panic!("a {}", other.kind()),
    }
}

#[test]
fn files_have_their_known_facts() {
    let Some(manifest) = shared_data("MANIFEST.md") else { return };
    let manifest = std::fs::read_to_string(manifest).expect("a list of facts");
    let mut seen = 0;
    for line in manifest.lines().filter(|line| line.starts_with("| ply/") || line.starts_with("| synthetic/octa_")) {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let (file, facts) = (cells[1], cells[6]);
        if !file.ends_with(".ply") {
            continue;
        }
        let bytes = std::fs::read(shared_data(file).expect("a file of the list")).expect("it can be read");
        let found = read_ply(&bytes, file);
        let geometry = &*found.shape.parts[0].geometry;
        let (positions, faces) = contents(geometry);
        let fact = |name: &str| {
            let words = facts.split([' ', ';']);
            words.filter_map(|word| word.strip_prefix(name)?.strip_prefix('=')?.parse::<f64>().ok()).next_back()
        };
        assert_eq!(Some(positions.len() as f64), fact("V"), "{file}");
        assert_eq!(Some(faces.len() as f64), fact("F"), "{file}");
        let (area, volume) = match geometry {
            Geometry::TriMesh(mesh) => (mesh.area(), mesh.volume()),
            Geometry::PolyMesh(mesh) => (mesh.area(), mesh.volume()),
            _ => (0.0, 0.0),
        };
        // The list has six digits.
        let same = |found: f64, wanted: Option<f64>| wanted.is_none_or(|wanted| (found / wanted - 1.0).abs() < 1e-5);
        assert!(same(area, fact("area")), "{file}: {area}");
        assert!(same(volume, fact("vol")), "{file}: {volume}");
        seen += 1;
    }
    assert_eq!(seen, 18);
}

/// What is read, written and read again is the same shape: positions, faces, columns, lists, tables, comments.
#[test]
fn files_survive_every_encoding() {
    for path in files() {
        let name = name_of(&path);
        let bytes = std::fs::read(&path).expect("it can be read");
        let first = read_ply(&bytes, &name);
        assert!(first.losses.is_empty(), "{name}");
        for encoding in ENCODINGS {
            let (copy, losses) = written(&first.shape, encoding);
            assert!(losses.is_empty(), "{name}: {losses:?}");
            let again = read_ply(&copy, &name);
            assert_eq!(again.shape, first.shape, "{name} {encoding:?}");
            // The same bits, zeros with their sign too.
            assert_eq!(written(&again.shape, encoding).0, copy, "{name}");
        }
    }
}

/// Fractions of colours in a text come back as they were written there.
#[test]
fn fractions_of_colours_come_back_to_the_bit() {
    let Some(path) = shared_data("ply/float-color.ply") else { return };
    let bytes = std::fs::read(path).expect("it can be read");
    let floats = |bytes: &[u8]| -> Vec<u32> {
        let ply = peer(bytes).expect("another reader reads it");
        let colors = ply.payload["vertex"].iter().flat_map(|vertex| {
            ["red", "green", "blue", "alpha"].map(|name| match vertex[name] {
                Property::Float(value) => value.to_bits(),
                ref other => panic!("{other:?}"),
            })
        });
        colors.collect()
    };
    for encoding in ENCODINGS {
        assert_eq!(floats(&written(&read_ply(&bytes, "float-color").shape, encoding).0), floats(&bytes));
    }
}

fn peer(bytes: &[u8]) -> Option<Ply<DefaultElement>> {
    Parser::<DefaultElement>::new().read_ply(&mut &bytes[..]).ok()
}

fn number(property: &Property) -> f64 {
    match *property {
        Property::Char(value) => f64::from(value),
        Property::UChar(value) => f64::from(value),
        Property::Short(value) => f64::from(value),
        Property::UShort(value) => f64::from(value),
        Property::Int(value) => f64::from(value),
        Property::UInt(value) => f64::from(value),
        Property::Float(value) => f64::from(value),
        Property::Double(value) => value,
        _ => panic!("a list"),
    }
}

/// What another reader finds: positions and faces.
fn peer_contents(bytes: &[u8]) -> Option<(Vec<DVec3>, Vec<Vec<u32>>)> {
    let ply = peer(bytes)?;
    let rows = |name: &str| ply.payload.get(name).map_or(&[][..], Vec::as_slice);
    let positions = rows("vertex").iter().map(|row| DVec3::from_array(["x", "y", "z"].map(|axis| number(&row[axis]))));
    let corners = |row: &DefaultElement| {
        let list = row.get("vertex_indices").or_else(|| row.get("vertex_index")).expect("corners");
        list.to_u32_list().expect("indices")
    };
    Some((positions.collect(), rows("face").iter().map(corners).collect()))
}

#[test]
fn another_reader_finds_the_same() {
    let (mut read_by_both, files) = (0, files());
    for path in &files {
        let name = name_of(path);
        let bytes = std::fs::read(path).expect("it can be read");
        let shape = read_ply(&bytes, &name).shape;
        let ours = contents(&shape.parts[0].geometry);
        if let Some(theirs) = peer_contents(&bytes) {
            read_by_both += 1;
            assert_eq!(theirs, ours, "{name}");
        }
        for encoding in ENCODINGS {
            let theirs = peer_contents(&written(&shape, encoding).0);
            assert_eq!(theirs.as_ref(), Some(&ours), "{name} {encoding:?}");
        }
    }
    assert!(read_by_both + 4 >= files.len(), "{read_by_both} of {}", files.len());
}

/// Shapes made here, with every kind of column, as another reader finds them.
#[test]
fn another_reader_finds_what_is_written() {
    let mesh = shapes::tagged_triangles();
    for encoding in ENCODINGS {
        let (bytes, _) = written(&Shape::new(Part::new(mesh.clone())), encoding);
        assert_eq!(peer_contents(&bytes), Some(contents(&mesh.clone().into())), "{encoding:?}");
        let again = read_ply(&bytes, "tagged").shape;
        let Geometry::TriMesh(read_mesh) = &*again.parts[0].geometry else { panic!("triangles") };
        assert_eq!((read_mesh.positions(), read_mesh.triangles()), (mesh.positions(), mesh.triangles()));
        let ply = peer(&bytes).expect("another reader reads it");
        for (name, names) in [(NORMAL, &["nx", "ny", "nz"][..]), (TEXCOORD, &["s", "t"])] {
            let Some(column) = mesh.attribute(Domain::Vertex, name) else { continue };
            for (vertex, row) in ply.payload["vertex"].iter().enumerate() {
                for (component, name) in names.iter().enumerate() {
                    assert_eq!(number(&row[*name]), column.number(vertex, component));
                }
            }
        }
    }
}
