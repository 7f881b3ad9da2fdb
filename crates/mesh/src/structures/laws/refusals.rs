//! Every mesh gives a structure or an error that names what is really at fault, within the budget and until stopped.

use shapeloom_core::{CancelFlag, Exec, Stop};

use super::meshes::{Dice, Mesh, random, random_patch, special, torus};
use super::truth::Truth;
use crate::MeshError;
use crate::structures::{IndexedPolygons, StructureError, StructureKind};

fn assert_at_fault(mesh: &Mesh, truth: &Truth, error: &StructureError) {
    let told = format!("{}: {error}", mesh.name);
    match error {
        StructureError::Mesh(MeshError::NotTriangle { face, found }) => {
            assert_eq!(truth.faces.iter().position(|face| face.len() != 3), Some(*face as usize), "{told}");
            assert_eq!(truth.faces[*face as usize].len() as u64, *found, "{told}");
        }
        StructureError::RepeatedCorner { face, vertex, count } => {
            let repeating = truth.repeating();
            assert_eq!((repeating[0], repeating.len()), (*face, *count), "{told}");
            let times = truth.faces[*face as usize].iter().filter(|&corner| corner == vertex).count();
            assert!(times > 1, "{told}");
        }
        StructureError::NonManifoldEdge { vertices, faces, count } => {
            assert_eq!((truth.crowded()[0], truth.crowded().len()), (*vertices, *count), "{told}");
            let sides = truth.edges[vertices].iter().map(|&(face, _)| face);
            assert!(truth.repeating().is_empty() && sides.eq(faces.iter().copied()), "{told}");
        }
        StructureError::Orientation { vertices, faces, count } => {
            assert_eq!((truth.turned()[0], truth.turned().len()), (*vertices, *count), "{told}");
            let sides = truth.edges[vertices].iter().map(|&(face, _)| face);
            assert!(truth.repeating().is_empty() && truth.crowded().is_empty() && sides.eq(*faces), "{told}");
        }
        StructureError::NonManifoldVertex { vertex, fans, count } => {
            let pinched = truth.pinched();
            assert_eq!((pinched[0], pinched.len()), ((*vertex, *fans), *count), "{told}");
            assert!(truth.repeating().is_empty() && truth.crowded().is_empty() && truth.turned().is_empty(), "{told}");
        }
        other => panic!("{}: {other:?}", mesh.name),
    }
}

fn assert_held_or_refused(mesh: &Mesh) {
    let truth = Truth::new(&mesh.faces, mesh.vertices);
    for kind in StructureKind::ALL {
        match kind.build(&mesh.faces, &Exec::default()) {
            Ok(_) => assert!(truth.fits(kind), "{} holds {}", kind.name(), mesh.name),
            Err(error) => {
                assert!(!truth.fits(kind), "{} refuses {}: {error}", kind.name(), mesh.name);
                assert_at_fault(mesh, &truth, &error);
            }
        }
    }
}

#[test]
fn errors_name_what_is_at_fault() {
    special().iter().for_each(assert_held_or_refused);
    let mut dice = Dice(11);
    for _ in 0..4000 {
        assert_held_or_refused(&random(&mut dice));
    }
    for _ in 0..300 {
        assert_held_or_refused(&random_patch(&mut dice));
    }
}

#[test]
fn a_small_budget_and_a_cancelled_build_are_typed_errors() {
    let faces = IndexedPolygons::from_faces(10_000, &super::meshes::in_triangles(&torus(100, 100))).unwrap();
    for kind in StructureKind::ALL {
        let small = Exec::default().with_memory(100_000);
        let error = kind.build(&faces, &small).map(|_| ()).unwrap_err();
        assert!(matches!(error, StructureError::OverBudget(_)), "{kind}: {error}");
        assert_eq!(small.memory_taken(), 0, "{kind}");
        let flag = CancelFlag::default();
        flag.cancel();
        let error = kind.build(&faces, &Exec::default().with_cancel(&flag)).map(|_| ()).unwrap_err();
        assert_eq!(error, StructureError::Stop(Stop::Cancelled), "{kind}");
    }
}

/// Stopped at every poll in turn, a build gives the reason to stop, and in the end the structure.
#[test]
fn builds_can_be_stopped_anywhere() {
    use std::sync::Arc;
    use std::sync::atomic::{AtomicUsize, Ordering};
    let faces = IndexedPolygons::from_faces(2500, &super::meshes::in_triangles(&torus(50, 50))).unwrap();
    for kind in StructureKind::ALL {
        let mut stopped = 0;
        for last in 0..1000 {
            let left = Arc::new(AtomicUsize::new(last));
            let watch = move || {
                let gone = left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1));
                gone.is_err().then_some(Stop::Cancelled)
            };
            let exec = Exec::default().with_threads(shapeloom_core::Threads::Sequential).with_watch(watch);
            match kind.build(&faces, &exec).map(|_| ()) {
                Ok(()) => break,
                Err(error) => assert_eq!(error, StructureError::Stop(Stop::Cancelled), "{kind}"),
            }
            stopped += 1;
        }
        assert!((1..1000).contains(&stopped), "{kind}: {stopped}");
    }
}
