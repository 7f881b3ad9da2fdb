//! Real OBJ files: known facts, round trips, another reader.

use shapeloom::core::Deviation;
use shapeloom::io::WriteOptions;
use shapeloom::shape::{Geometry, Shape};

use crate::collection::{Facts, facts, read_file, through};
use crate::support::shared_data;

/// Every file with facts; all of them, where the collection is there.
fn all() -> Vec<Facts> {
    let all = facts(&["obj/", "synthetic/", "subdiv-golden/"]);
    let all: Vec<Facts> = all.into_iter().filter(|known| known.name().ends_with("obj")).collect();
    assert_eq!(all.len(), if shared_data("MANIFEST.md").is_some() { 52 } else { 0 });
    all
}

#[test]
fn real_files_have_their_known_facts() {
    for known in &all() {
        let read = read_file(&known.path).unwrap_or_else(|error| panic!("{error}"));
        known.check(&read.shape);
    }
}

/// Number formats that no grammar of numbers has are refused at the first of them.
#[test]
fn the_file_of_odd_numbers_is_refused_at_its_first_wrong_one() {
    let Some(path) = shared_data("obj/number_formats.obj") else { return };
    let error = read_file(&path).expect_err("it holds 3.1+e2").to_string();
    assert!(error.contains("line 11") && error.contains("3.1+e2"), "{error}");
}

/// Without what a second library would be needed for.
fn plain(shape: &Shape) -> Shape {
    let mut plain = shape.clone();
    plain.materials.iter_mut().for_each(|material| {
        *material = shapeloom::shape::Material { name: material.name.clone(), ..Default::default() };
    });
    plain
}

#[test]
fn real_files_survive_writing_and_reading() {
    for known in &all() {
        let shape = read_file(&known.path).expect("it is read").shape;
        let (again, report) = through(&shape, "obj", WriteOptions::new());
        assert_eq!(report.deviation, Deviation::Exact);
        let allowed = |what: &str| what.starts_with("material") || what.contains("\"color\"");
        assert!(report.losses.iter().all(|loss| allowed(&loss.what)), "{}: {:?}", known.name(), report.losses);
        assert_eq!(again.parts.len(), shape.parts.len(), "{}", known.name());
        let (again, shape) = (plain(&again), plain(&shape));
        for (found, wanted) in again.parts.iter().zip(&shape.parts) {
            assert_eq!(found.geometry, wanted.geometry, "{} {}", known.name(), wanted.name);
            assert_eq!((&found.material, &again.materials), (&wanted.material, &shape.materials), "{}", known.name());
        }
        // What was written is a fixed point.
        assert_eq!(through(&again, "obj", WriteOptions::new()).0, again);
    }
}

/// tobj reads the same positions and faces, with polygons as they are.
#[test]
fn another_reader_finds_the_same() {
    let options = tobj::LoadOptions { single_index: false, ..Default::default() };
    for known in &all() {
        let read = read_file(&known.path).expect("it is read");
        let bytes = std::fs::read(&known.path).expect("it is there");
        let no_materials = |_: &std::path::Path| tobj::MTLLoadResult::Err(tobj::LoadError::OpenFileFailed);
        // It divides positions by their weights, which are for rational curves, and its faces hold lines too.
        if known.name().contains("w-component") || known.name().contains("testmixed") {
            continue;
        }
        // It refuses the file whose colours are not numbers.
        let Ok((models, _)) = tobj::load_obj_buf(&mut bytes.as_slice(), &options, no_materials) else {
            assert!(known.name().contains("nancolor"), "{}", known.name());
            continue;
        };
        let faces = |model: &tobj::Model| match model.mesh.face_arities.len() {
            0 => model.mesh.indices.len() / 3,
            polygons => polygons,
        };
        let own: usize = read
            .shape
            .parts
            .iter()
            .map(|part| match &*part.geometry {
                Geometry::TriMesh(mesh) => mesh.triangles().len(),
                Geometry::PolyMesh(mesh) => mesh.face_count(),
                _ => 0,
            })
            .sum();
        assert_eq!(models.iter().map(faces).sum::<usize>(), own, "{}", known.name());
        // It numbers vertices anew, by their use: corners are compared by position.
        let mut theirs = models.iter().flat_map(|model| {
            model.mesh.indices.iter().map(|&index| &model.mesh.positions[3 * index as usize..3 * index as usize + 3])
        });
        for part in &read.shape.parts {
            let (positions, corners) = match &*part.geometry {
                Geometry::TriMesh(mesh) => (mesh.positions(), mesh.triangles().as_flattened()),
                Geometry::PolyMesh(mesh) => (mesh.positions(), mesh.wedge_vertices()),
                _ => continue,
            };
            for &corner in corners {
                let wanted = theirs.next().expect("as many corners");
                for (found, wanted) in positions[corner as usize].to_array().into_iter().zip(wanted) {
                    assert!((found as f32 - wanted).abs() <= 2e-7 * wanted.abs(), "{}: {found} {wanted}", known.name());
                }
            }
        }
    }
}
