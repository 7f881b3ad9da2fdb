//! Faces oriented alike, with the judge's topology report as oracle.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::judge::Topology;
use shapeloom::mesh::structures::StructureError;
use shapeloom::mesh::{OrientFaces, PolyMesh, TriMesh, Weld};
use shapeloom::shape::Geometry;

use crate::collection::{facts, read_file};
use crate::support::{Dice, shared_data};

/// The sides on each edge: the face, and whether it passes from the smaller vertex to the larger.
fn sides(mesh: &PolyMesh) -> std::collections::BTreeMap<[u32; 2], Vec<(u32, bool)>> {
    let mut sides = std::collections::BTreeMap::<_, Vec<_>>::new();
    for (face, corners) in mesh.faces().enumerate() {
        for (i, &a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if a != b {
                sides.entry([a.min(b), a.max(b)]).or_default().push((face as u32, a < b));
            }
        }
    }
    sides
}

/// Whether going along a ring of faces, from one to the next over any edge that has just these two, can turn it over.
fn turns_over(mesh: &PolyMesh, ring: &[u32]) -> bool {
    let sides = sides(mesh);
    // Which relations are possible after each step: as started, or turned over.
    let mut possible = [true, false];
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let mut after = [false; 2];
        for pair in sides.values().filter(|sides| sides.len() == 2) {
            let faces = [pair[0].0, pair[1].0];
            if faces == [a, b] || faces == [b, a] {
                let differ = usize::from(pair[0].1 == pair[1].1);
                after[differ] |= possible[0];
                after[1 - differ] |= possible[1];
            }
        }
        possible = after;
    }
    possible[1]
}

/// Orients a mesh and holds the result, or the refusal, against the judge. Returns whether it had an orientation.
fn judged(mesh: &PolyMesh) -> bool {
    let before = Topology::of(mesh, &Exec::default()).expect("memory enough");
    match OrientFaces::new().convert(mesh) {
        Ok(done) => {
            let after = Topology::of(&done.value, &Exec::default()).expect("memory enough");
            assert!(before.orientation_witness.is_empty(), "the judge knows a ring");
            assert_eq!(after.inconsistent_edges, [[0; 2]; 0]);
            assert_eq!(after.edges, before.edges);
            for (old, new) in mesh.faces().zip(done.value.faces()) {
                let mut turned = old.to_vec();
                turned[1..].reverse();
                assert!(new == old || new == turned);
            }
            // Turning fewer faces of a part is not possible: the rest of it would be turned instead.
            for component in 0..before.components.len() as u32 {
                let part: Vec<usize> =
                    (0..mesh.face_count()).filter(|&face| before.face_components[face] == component).collect();
                let turned = part.iter().filter(|&&face| mesh.face(face) != done.value.face(face)).count();
                let unclear = part.iter().filter(|&&face| is_its_own_turn(mesh.face(face))).count();
                assert!(2 * turned <= part.len() + 2 * unclear);
            }
            true
        }
        Err(error) => {
            assert_eq!(error.diagnostic().code(), "E-structure-one-sided");
            assert!(!before.orientation_witness.is_empty(), "the judge knows none");
            let source = std::error::Error::source(&error).and_then(|source| source.downcast_ref::<StructureError>());
            let Some(StructureError::NotOrientable { faces, .. }) = source else { panic!("{error}") };
            let different: std::collections::BTreeSet<_> = faces.iter().collect();
            assert_eq!(different.len(), faces.len(), "a face twice in {faces:?}");
            assert!(turns_over(mesh, faces), "{faces:?} does not turn over");
            false
        }
    }
}

fn is_its_own_turn(corners: &[u32]) -> bool {
    let mut turned = corners.to_vec();
    turned[1..].reverse();
    turned == corners
}

#[test]
fn random_faces_are_oriented_or_shown_to_be_one_sided() {
    let mut dice = Dice(11);
    let mut count = [0; 2];
    for round in 0..3000 {
        let mut faces: Vec<Vec<u32>> = Vec::new();
        // Strips of four-gons, closed with a twist or without, on vertices that they may share.
        let vertices = 8 + dice.next() % 24;
        for _ in 0..dice.next() % 3 {
            let length = 3 + dice.next() % 5;
            let twist = dice.next() % 2;
            let start = dice.next() % vertices;
            let at = |i: u64, side: u64| {
                let side = if i == length { side ^ twist } else { side };
                ((start + 2 * (i % length) + side) % vertices) as u32
            };
            faces.extend((0..length).map(|i| vec![at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)]));
        }
        for _ in 0..1 + dice.next() % 6 {
            let corners = if round % 3 == 0 { 3 + dice.next() % 3 } else { 3 };
            faces.push((0..corners).map(|_| (dice.next() % vertices) as u32).collect());
        }
        for corners in &mut faces {
            if dice.next().is_multiple_of(3) {
                corners[1..].reverse();
            }
        }
        let positions = (0..vertices).map(|_| DVec3::new(dice.unit(), dice.unit(), dice.unit())).collect();
        let mesh = PolyMesh::from_faces(positions, &faces).expect("indices in range");
        count[usize::from(judged(&mesh))] += 1;
    }
    assert!(count.iter().all(|&count| count > 100), "{count:?}");
}

#[test]
fn the_collection_is_oriented_or_shown_to_be_one_sided() {
    let Some(_) = shared_data("MANIFEST.md") else { return };
    let (mut oriented, mut one_sided) = (0, 0);
    for facts in facts(&["obj/", "off/", "ply/", "stl/", "synthetic/"]) {
        let Ok(read) = read_file(&facts.path) else { continue };
        for part in read.shape.parts {
            let mesh = match &*part.geometry {
                Geometry::PolyMesh(mesh) => mesh.clone(),
                Geometry::TriMesh(mesh) => mesh.clone().into(),
                _ => continue,
            };
            if mesh.face_count() == 0 || mesh.face_count() > 40_000 || mesh.first_non_finite().is_some() {
                continue;
            }
            // Some faces turned over, so that there is something to do.
            let turned: Vec<Vec<u32>> = (0..mesh.face_count())
                .map(|face| {
                    let mut corners = mesh.face(face).to_vec();
                    if face % 5 == 1 {
                        corners[1..].reverse();
                    }
                    corners
                })
                .collect();
            let mesh = PolyMesh::from_faces(mesh.positions().to_vec(), &turned).expect("indices in range");
            if judged(&mesh) { oriented += 1 } else { one_sided += 1 }
        }
    }
    assert!(oriented > 40 && one_sided > 0, "{oriented} {one_sided}");
}

/// Immersed in space, the bottle crosses itself; its faces are closed, and none of them can be the outside.
#[test]
fn a_klein_bottle_is_refused_with_a_ring() {
    let (columns, rows) = (24u32, 10u32);
    let at = |i: u32, j: u32| {
        let (i, j) = if i == columns { (0, (rows - j % rows) % rows) } else { (i, j % rows) };
        j * columns + i
    };
    let mut triangles = Vec::new();
    for i in 0..columns {
        for j in 0..rows {
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    let positions = (0..columns * rows).map(|i| DVec3::new(f64::from(i), f64::from(i % 7), 0.0)).collect();
    let bottle = TriMesh::try_new(positions, triangles).expect("indices in range");
    assert!(!judged(&bottle.clone().into()));
    let soup = Weld::new().convert(&bottle).expect("finite").value;
    assert_eq!(OrientFaces::new().convert(&soup).unwrap_err().diagnostic().category().phrase(), "not supported");
}
