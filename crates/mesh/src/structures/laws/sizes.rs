//! What structures take in memory is what theory says.

use shapeloom_core::Exec;

use super::meshes::{in_triangles, torus};
use crate::structures::{IndexedPolygons, StructureKind};

#[test]
fn a_large_torus_takes_the_words_of_theory() {
    let (columns, rows) = (120, 100);
    let vertices = columns * rows;
    let faces = IndexedPolygons::from_faces(vertices, &in_triangles(&torus(columns, rows))).unwrap();
    for kind in StructureKind::ALL {
        let structure = kind.build(&faces, &Exec::default()).unwrap();
        let words = structure.memory_bytes() as f64 / 4.0 / f64::from(vertices);
        let theory = kind.words_per_vertex();
        assert!((words - theory).abs() <= 0.01 * theory, "{kind}: {words} words a vertex, in theory {theory}");
    }
}
