//! Real glTF files, where the collection is there: the counts that are known of them, and every position and triangle as
//! the `gltf` crate reads it.

use std::path::Path;
use std::sync::Arc;

use gltf::mesh::Mode;
use shapeloom::core::Diagnostic;
use shapeloom::core::glam::{DMat4, DVec3};
use shapeloom::io::{ReadContext, ReadError, ReadShape, detect, read};
use shapeloom::shape::{Geometry, Part, Shape};

use crate::malformed_gltf::Folder;
use crate::support::shared_data;

fn ours(path: &Path) -> Result<ReadShape, ReadError> {
    let file = std::fs::read(path).expect("a file of the collection");
    let name = path.display().to_string();
    let folder = path.parent().expect("a folder").to_owned();
    let context = ReadContext { siblings: Some(Arc::new(Folder(folder))), ..ReadContext::named(name.as_str()) };
    read(&file, detect(&file, Some(&name)).expect("glTF"), &context)
}

fn positions(geometry: &Geometry) -> &[DVec3] {
    match geometry {
        Geometry::TriMesh(mesh) => mesh.positions(),
        Geometry::Polyline(line) => line.points(),
        Geometry::GeometricGraph(graph) => graph.positions(),
        Geometry::PointCloud(cloud) => cloud.positions(),
        other => panic!("a {} in a glTF file", other.kind()),
    }
}

/// The files with the facts that are known of them.
pub fn files() -> Vec<(String, String)> {
    let Some(table) = shared_data("MANIFEST.tsv") else { return Vec::new() };
    let table = std::fs::read_to_string(table).expect("the table of the collection");
    let rows = table.lines().map(|line| line.split('\t').collect::<Vec<_>>());
    let ours = rows.filter(|row| row[0].starts_with("gltf/") && row[5].starts_with("nodes"));
    ours.map(|row| (row[0].to_owned(), row[5].to_owned())).collect()
}

/// The number after these words.
fn number(facts: &str, words: &str) -> usize {
    let rest = facts.split(words).nth(1).unwrap_or_else(|| panic!("no {words} in {facts}"));
    rest.split_whitespace().next().and_then(|word| word.parse().ok()).unwrap_or_else(|| panic!("{facts}"))
}

/// Its nodes are no tree: four of them have the same child.
const SHARED_NODE: &str = "cube_att.gltf";

fn known(shared: bool) -> &'static [&'static str] {
    if shared { &["W-gltf-parents"] } else { &[] }
}

/// Its buffer is not in the collection.
pub const WITHOUT_BUFFER: &str = "SimpleSparseAccessor.gltf";

#[test]
fn real_files_have_their_known_counts() {
    for (name, facts) in files() {
        let path = shared_data(&name).expect("what the table names is there");
        if name.ends_with(WITHOUT_BUFFER) {
            let error = ours(&path).expect_err("its buffer is not there");
            assert_eq!(error.code(), "E-sibling-missing", "{error}");
            assert!(error.to_string().contains("/buffers/0/uri: found \"SimpleSparseAccessor.bin\""), "{error}");
            continue;
        }
        let found = ours(&path).unwrap_or_else(|error| panic!("{error}"));
        let shared = name.ends_with(SHARED_NODE);
        assert_eq!(found.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), known(shared), "{name}");
        let mut seen: Vec<&Arc<Geometry>> = Vec::new();
        for part in &found.shape.parts {
            if seen.iter().all(|known| !Arc::ptr_eq(known, &part.geometry)) {
                seen.push(&part.geometry);
            }
        }
        assert_eq!(seen.len(), number(&facts, "primitives "), "{name}: {facts}");
        let vertices: usize = seen.iter().map(|geometry| positions(geometry).len()).sum();
        assert_eq!(vertices, number(&facts, "POSITION total "), "{name}: {facts}");
        let corners = seen.iter().map(|geometry| match &***geometry {
            Geometry::TriMesh(mesh) => mesh.triangles().len() * 3,
            _ => 0,
        });
        let indices = number(&facts, "indices total ");
        assert!(indices == 0 || corners.sum::<usize>() == indices, "{name}: {facts}");
    }
}

/// A node's primitives, then those below it, in the order in which parts are read.
fn visit(node: &gltf::Node<'_>, above: DMat4, buffers: &[gltf::buffer::Data], parts: &mut std::slice::Iter<'_, Part>) {
    let local = DMat4::from_cols_array(
        &node
            .transform()
            .matrix()
            .as_flattened()
            .iter()
            .map(|&x| f64::from(x))
            .collect::<Vec<_>>()
            .try_into()
            .expect("16 numbers"),
    );
    let placement = above * local;
    for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
        let part = parts.next().expect("a part for every primitive");
        let (found, wanted) = (part.placement.to_matrix().to_cols_array(), placement.to_cols_array());
        for (found, wanted) in found.iter().zip(wanted) {
            // The other reader's matrices are in single precision.
            assert!((found - wanted).abs() <= 1e-6 * wanted.abs().max(1.0), "{found} {wanted}");
        }
        compare(&primitive, buffers, &part.geometry);
    }
    node.children().for_each(|child| visit(&child, placement, buffers, parts));
}

fn compare(primitive: &gltf::Primitive<'_>, buffers: &[gltf::buffer::Data], geometry: &Geometry) {
    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    let theirs: Vec<DVec3> =
        reader.read_positions().expect("positions").map(|point| DVec3::from_array(point.map(f64::from))).collect();
    assert_eq!(positions(geometry), theirs);
    let count = theirs.len() as u32;
    let indices: Vec<u32> = reader.read_indices().map_or((0..count).collect(), |indices| indices.into_u32().collect());
    match (primitive.mode(), geometry) {
        (Mode::Triangles, Geometry::TriMesh(mesh)) => assert_eq!(mesh.triangles().as_flattened(), indices),
        (Mode::TriangleStrip, Geometry::TriMesh(mesh)) => {
            // By the specification: (i, i + (1 + i % 2), i + (2 - i % 2)).
            let corner = |i: usize| [i, i + 1 + i % 2, i + 2 - i % 2].map(|at| indices[at]);
            same_turned(mesh.triangles(), (0..indices.len() - 2).map(corner));
        }
        (Mode::TriangleFan, Geometry::TriMesh(mesh)) => {
            // By the specification: (i + 1, i + 2, 0).
            let corner = |i: usize| [i + 1, i + 2, 0].map(|at| indices[at]);
            same_turned(mesh.triangles(), (0..indices.len() - 2).map(corner));
        }
        (Mode::Lines, Geometry::GeometricGraph(graph)) => assert_eq!(graph.edges().as_flattened(), indices),
        (Mode::Lines, Geometry::Polyline(line)) => assert_eq!(line.segments().count(), indices.len() / 2),
        (Mode::LineStrip, Geometry::Polyline(line)) => assert!(!line.is_closed()),
        (Mode::LineLoop, Geometry::Polyline(line)) => assert!(line.is_closed()),
        (Mode::Points, Geometry::PointCloud(_)) => {}
        (mode, geometry) => panic!("{mode:?} was read as a {}", geometry.kind()),
    }
}

/// The same triangles in order, whichever corner comes first.
fn same_turned(found: &[[u32; 3]], wanted: impl ExactSizeIterator<Item = [u32; 3]>) {
    assert_eq!(found.len(), wanted.len());
    for (&[a, b, c], wanted) in found.iter().zip(wanted) {
        assert!([[a, b, c], [b, c, a], [c, a, b]].contains(&wanted), "{:?} {wanted:?}", [a, b, c]);
    }
}

#[test]
fn another_reader_finds_the_same_positions_and_triangles() {
    let mut seen = 0;
    for (name, _) in files().into_iter().filter(|(name, _)| !name.ends_with(WITHOUT_BUFFER)) {
        let path = shared_data(&name).expect("what the table names is there");
        let Shape { parts, .. } = ours(&path).unwrap_or_else(|error| panic!("{error}")).shape;
        let file = std::fs::read(&path).expect("a file of the collection");
        let theirs = gltf::Gltf::from_slice_without_validation(&file).expect("glTF");
        let buffers = gltf::import_buffers(&theirs.document, path.parent(), theirs.blob.clone()).expect("its buffers");
        let scene = theirs.default_scene().or_else(|| theirs.scenes().next()).expect("a scene");
        let mut left = parts.iter();
        scene.nodes().for_each(|node| visit(&node, DMat4::IDENTITY, &buffers, &mut left));
        assert_eq!(left.len(), 0, "{name} has parts that the other reader does not find");
        seen += 1;
    }
    assert!(seen == 0 || seen >= 14, "{seen}");
}
