//! Real glTF files written and read again.

use std::sync::Arc;

use shapeloom::core::Deviation;
use shapeloom::core::glam::DVec3;
use shapeloom::io::WriteOptions;
use shapeloom::shape::{Geometry, Shape};

use crate::collection::{read_file, through};
use crate::peer_gltf::{WITHOUT_BUFFER, files};
use crate::support::shared_data;

fn bits(points: &[DVec3]) -> Vec<[u64; 3]> {
    points.iter().map(|point| point.to_array().map(f64::to_bits)).collect()
}

/// The bits of its positions, and what joins them.
fn positions_and_links(geometry: &Geometry) -> (Vec<[u64; 3]>, Vec<u32>) {
    match geometry {
        Geometry::TriMesh(mesh) => (bits(mesh.positions()), mesh.triangles().as_flattened().to_vec()),
        Geometry::GeometricGraph(graph) => (bits(graph.positions()), graph.edges().as_flattened().to_vec()),
        Geometry::Polyline(line) => (bits(line.points()), vec![u32::from(line.is_closed())]),
        Geometry::PointCloud(cloud) => (bits(cloud.positions()), Vec::new()),
        other => panic!("a {} in a glTF file", other.kind()),
    }
}

/// Which parts share their geometry: for each part the first that has the same.
fn shared(shape: &Shape) -> Vec<usize> {
    let first = |geometry| shape.parts.iter().position(|part| Arc::ptr_eq(&part.geometry, geometry));
    shape.parts.iter().map(|part| first(&part.geometry).expect("itself")).collect()
}

#[test]
fn real_files_written_and_read_again_are_the_same_shapes() {
    let (mut seen, mut triangles) = (0, 0);
    for (name, _) in files().into_iter().filter(|(name, _)| !name.ends_with(WITHOUT_BUFFER)) {
        let path = shared_data(&name).expect("what the table names is there");
        let source = read_file(&path).unwrap_or_else(|error| panic!("{error}")).shape;
        for id in ["glb", "gltf"] {
            let (again, report) = through(&source, id, WriteOptions::new());
            let name = format!("{name} as {id}");
            assert_eq!((report.deviation, report.losses), (Deviation::Exact, Vec::new()), "{name}");
            assert_eq!(again.materials, source.materials, "{name}");
            assert_eq!((again.up, again.units), (source.up, source.units), "{name}");
            assert_eq!(again.parts.len(), source.parts.len(), "{name}");
            assert_eq!(shared(&again), shared(&source), "{name}");
            for (found, wanted) in again.parts.iter().zip(&source.parts) {
                assert_eq!((&found.name, found.material), (&wanted.name, wanted.material), "{name}");
                assert_eq!(found.placement, wanted.placement, "{name}: {}", wanted.name);
                let (found, wanted) = (&*found.geometry, &*wanted.geometry);
                assert!(positions_and_links(found) == positions_and_links(wanted), "{name}");
                // And every column.
                assert!(found == wanted, "{name}");
                triangles += if let Geometry::TriMesh(mesh) = found { mesh.triangles().len() } else { 0 };
            }
        }
        seen += 1;
    }
    assert!((seen == 0) == shared_data("MANIFEST.tsv").is_none());
    assert!(seen == 0 || (seen >= 14 && triangles > 8_000), "{seen} files, {triangles} triangles");
}
