//! What fuzzing calls, shared with the mutation loop of the ordinary tests.

use shapeloom::core::{Exec, Threads};
use shapeloom::io::{ReadContext, ReadOptions, ScalarType, WriteContext, WriteError, format_by_id, read, write};
use shapeloom::shape::{Geometry, Shape};

/// Reads an input as a format, under a budget of 64 MB and 40 times its size. What is read must be writable in the same
/// format where that has a writer, and what was written must be readable. Returns whether the input was read.
pub fn read_as(id: &str, input: &[u8]) -> bool {
    let format = format_by_id(id).expect("a format of the table");
    let exec = Exec::default().with_memory((64 << 20) + 40 * input.len() as u64).with_threads(Threads::Sequential);
    // What has no header needs one from outside.
    let options = match id {
        "raw" => ReadOptions { dimensions: "5x4x3".into(), scalar: ScalarType::I16, ..ReadOptions::new() },
        _ => ReadOptions::new(),
    };
    let context = ReadContext { exec, options, ..ReadContext::named("fuzz") };
    let shape = match read(input, format, &context) {
        Ok(read) => {
            assert!(read.findings.iter().all(|finding| !finding.message.is_empty() && finding.count > 0));
            read.shape
        }
        Err(error) => {
            assert!(error.to_string().starts_with("fuzz") || error.fault().is_none(), "{error}");
            return false;
        }
    };
    assert_eq!(context.exec.memory_taken(), 0, "{id}: reservations are returned");
    let holds = shape.parts.iter().all(|part| format.holds(part.geometry.kind()));
    if format.writes.is_some() && holds {
        let mut bytes = Vec::new();
        match write(&shape, format, &WriteContext::default(), &mut bytes) {
            Ok(_) => {}
            // Numbers that the format does not have.
            Err(WriteError::NotFinite { .. } | WriteError::TooLarge { .. }) => return true,
            Err(error) => panic!("{id}: what was read is not written: {error}"),
        }
        match read(&bytes, format, &ReadContext::named("again")) {
            Ok(again) => {
                assert_eq!(faces(&again.shape), faces(&shape), "{id}: faces after writing and reading");
                grids_are_the_same(id, &again.shape, &shape);
            }
            Err(error) => panic!("{id}: what was written is not read: {error}"),
        }
    }
    true
}

/// The number of faces of all parts.
fn faces(shape: &Shape) -> usize {
    let of = |geometry: &Geometry| match geometry {
        Geometry::TriMesh(mesh) => mesh.triangles().len(),
        Geometry::PolyMesh(mesh) => mesh.face_count(),
        _ => 0,
    };
    shape.parts.iter().map(|part| of(&part.geometry)).sum()
}

/// What is read of a volume comes back to the bit; directions up to what their lengths are rounded.
fn grids_are_the_same(id: &str, again: &Shape, shape: &Shape) {
    for (again, shape) in again.parts.iter().zip(&shape.parts) {
        if let (Geometry::VoxelGrid(again), Geometry::VoxelGrid(grid)) = (&*again.geometry, &*shape.geometry) {
            assert_eq!(again.lattice().dimensions(), grid.lattice().dimensions(), "{id}");
            let bits = |at: u64| (again.samples().get(at).to_bits(), grid.samples().get(at).to_bits());
            assert!((0..grid.lattice().samples()).map(bits).all(|(again, grid)| again == grid), "{id}");
        }
    }
}
