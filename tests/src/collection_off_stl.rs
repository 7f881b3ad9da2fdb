//! Real OFF and STL files: known facts, round trips, another reader.

use std::io::Cursor;

use shapeloom::core::Deviation;
use shapeloom::core::glam::DVec3;
use shapeloom::io::{Encoding, ReadContext, WriteOptions, format_by_id, read};
use shapeloom::mesh::TriMesh;
use shapeloom::shape::{Geometry, Shape};

use crate::collection::{Facts, facts, read_file, through};
use crate::support::shared_data;

/// How many files of the collection have known facts.
const OFF_COUNT: usize = 16;
const STL_COUNT: usize = 11;

fn off_files() -> Vec<Facts> {
    let all: Vec<Facts> =
        facts(&["off/", "synthetic/"]).into_iter().filter(|known| known.name().ends_with("off")).collect();
    seen(all, OFF_COUNT)
}

/// The files of a collection that is there, as many as it has: an empty list would pass every test.
fn seen(files: Vec<Facts>, count: usize) -> Vec<Facts> {
    assert!(shared_data("MANIFEST.md").is_none() || files.len() == count, "{} files", files.len());
    files
}

fn options(encoding: Encoding) -> WriteOptions {
    WriteOptions { encoding, ..WriteOptions::new() }
}

fn only(shape: &Shape) -> &Geometry {
    assert_eq!(shape.parts.len(), 1);
    &shape.parts[0].geometry
}

fn meshes(shape: &Shape) -> Vec<&TriMesh> {
    shape
        .parts
        .iter()
        .map(|part| match &*part.geometry {
            Geometry::TriMesh(mesh) => mesh,
            other => panic!("{} is no mesh of triangles", other.kind()),
        })
        .collect()
}

/// The corners of all facets in order.
fn corners(shape: &Shape) -> Vec<[DVec3; 3]> {
    meshes(shape).iter().flat_map(|mesh| (0..mesh.triangles().len()).map(|face| mesh.corners(face))).collect()
}

#[test]
fn real_off_files_have_their_known_facts_and_survive() {
    for known in off_files() {
        let read = read_file(&known.path).unwrap_or_else(|error| panic!("{error}"));
        known.check(&read.shape);
        let (again, report) = through(&read.shape, "off", WriteOptions::new());
        assert_eq!((report.deviation, report.losses.len()), (Deviation::Exact, 0), "{}", known.name());
        assert_eq!(only(&again), only(&read.shape), "{}", known.name());
        // Single precision once, and then the same bits.
        let (single, report) = through(&read.shape, "off", options(Encoding::Binary));
        known.check(&single);
        assert!(report.deviation.value().is_some_and(|bound| bound < 1e-4 * only(&single).bounds().diagonal()));
        let (twice, report) = through(&single, "off", options(Encoding::Binary));
        assert_eq!((report.deviation, only(&twice)), (Deviation::Exact, only(&single)), "{}", known.name());
    }
}

/// The file whose count is glued to its keyword, by the values of its lines.
#[test]
fn the_file_of_odd_spaces_is_the_same_cube_as_the_one_of_comments() {
    let (Some(odd), Some(plain)) = (shared_data("off/whitespace.off"), shared_data("off/comments.off")) else { return };
    let odd = read_file(&odd).expect("it is read");
    assert_eq!(odd.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["W-off-header"]);
    assert_eq!(odd.shape, read_file(&plain).expect("it is read").shape);
    let again = through(&odd.shape, "off", WriteOptions::new()).0;
    assert_eq!(again, odd.shape);
}

#[test]
fn real_stl_files_have_their_known_facts_and_survive() {
    for known in seen(facts(&["stl/"]), STL_COUNT) {
        let read = read_file(&known.path).unwrap_or_else(|error| panic!("{error}"));
        known.check(&read.shape);
        let (text, report) = through(&read.shape, "stl", options(Encoding::Ascii));
        assert_eq!((report.deviation, report.losses.len()), (Deviation::Exact, 0), "{}", known.name());
        assert_eq!(text.parts.len(), read.shape.parts.len());
        for (found, wanted) in text.parts.iter().zip(&read.shape.parts) {
            assert_eq!((&found.geometry, &found.name), (&wanted.geometry, &wanted.name), "{}", known.name());
        }
        let (single, report) = through(&read.shape, "stl", WriteOptions::new());
        known.check(&single);
        let bound = report.deviation.value().expect("a bound");
        for (found, wanted) in corners(&single).iter().zip(corners(&read.shape)) {
            assert!((0..3).all(|corner| found[corner].distance(wanted[corner]) <= bound), "{}", known.name());
        }
        let (twice, report) = through(&single, "stl", options(Encoding::Binary));
        assert_eq!((report.deviation, only(&twice)), (Deviation::Exact, only(&single)), "{}", known.name());
    }
}

#[test]
fn both_ways_of_writing_the_box_are_the_same_mesh() {
    let (Some(text), Some(binary)) = (shared_data("stl/stl_box_ascii.stl"), shared_data("stl/stl_box_binary.stl"))
    else {
        return;
    };
    let (text, binary) = (read_file(&text).expect("it is read"), read_file(&binary).expect("it is read"));
    assert_eq!(only(&text.shape), only(&binary.shape));
    assert_eq!(text.shape.parts[0].name, "\"Design1<stl unit=MM>\"");
}

/// stl_io welds by equal positions too, in the order in which they first come.
#[test]
fn another_reader_finds_the_same() {
    for known in seen(facts(&["stl/"]), STL_COUNT) {
        let bytes = std::fs::read(&known.path).expect("it is there");
        let read = read_file(&known.path).expect("it is read");
        // It takes files that begin with the word solid and a space for text, whatever follows, and no others; and reads
        // one solid only.
        let other = ["unit_cube.STL", "sphereWithHole.stl"].iter().any(|name| known.name().ends_with(name));
        if other || read.shape.parts.len() > 1 {
            continue;
        }
        let theirs =
            stl_io::read_stl(&mut Cursor::new(&bytes)).unwrap_or_else(|error| panic!("{}: {error}", known.name()));
        let own = meshes(&read.shape)[0];
        assert_eq!((theirs.vertices.len(), theirs.faces.len()), (own.positions().len(), own.triangles().len()));
        for (face, theirs_face) in theirs.faces.iter().enumerate() {
            let wanted = theirs_face.vertices.map(|vertex| DVec3::from_array(theirs.vertices[vertex].0.map(f64::from)));
            let found = own.corners(face).map(|corner| corner.as_vec3().as_dvec3());
            assert_eq!(found, wanted, "{} {face}", known.name());
        }
    }
}

/// What is written is read by stl_io as it was meant, in both ways.
#[test]
fn another_reader_accepts_what_is_written() {
    let format = format_by_id("stl").expect("STL is a format");
    for (_, geometry) in crate::shapes::of_kind(shapeloom::shape::Kind::TriMesh) {
        let shape = Shape::new(shapeloom::shape::Part::new(geometry));
        for encoding in [Encoding::Binary, Encoding::Ascii] {
            let context = shapeloom::io::WriteContext { options: options(encoding), ..Default::default() };
            let mut bytes = Vec::new();
            shapeloom::io::write(&shape, format, &context, &mut bytes).expect("it can be written");
            let theirs = stl_io::read_stl(&mut Cursor::new(&bytes)).expect("stl_io reads it");
            let own = corners(&shape);
            assert_eq!(theirs.faces.len(), own.len());
            for (face, wanted) in theirs.faces.iter().zip(&own) {
                let found = face.vertices.map(|vertex| theirs.vertices[vertex].0);
                assert_eq!(found, wanted.map(|corner| corner.as_vec3().to_array()));
                let normal = DVec3::from_array(face.normal.0.map(f64::from));
                let cross = (wanted[1] - wanted[0]).cross(wanted[2] - wanted[0]);
                assert!(cross.length() == 0.0 || normal.distance(cross.normalize()) < 1e-6);
            }
            let again = read(&bytes, format, &ReadContext::default()).expect("it is read again");
            let single = own.iter().map(|corners| corners.map(|corner| corner.as_vec3().as_dvec3()));
            let wanted: Vec<_> = if encoding == Encoding::Ascii { own.clone() } else { single.collect() };
            assert_eq!(corners(&again.shape), wanted);
        }
    }
}
