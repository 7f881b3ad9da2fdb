//! Faces that repeat others.

use crate::Faces;
use crate::cycle::{canonical, key};

/// Pairs of a face and the first face that has the same vertices in the same cyclic order, either way around; by the
/// second face.
pub(super) fn duplicate_faces(faces: &Faces<'_>) -> Vec<[u32; 2]> {
    let mut keyed: Vec<(u64, u32)> = (0..faces.len() as u32).map(|face| (key(faces.face(face)), face)).collect();
    keyed.sort_unstable();
    let mut found = Vec::new();
    for run in keyed.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
        let mut cycles: Vec<(Vec<u32>, u32)> =
            run.iter().map(|&(_, face)| (canonical(faces.face(face)), face)).collect();
        cycles.sort_unstable();
        for equal in cycles.chunk_by(|a, b| a.0 == b.0) {
            found.extend(equal[1..].iter().map(|(_, face)| [equal[0].1, *face]));
        }
    }
    found.sort_unstable_by_key(|&[first, again]| [again, first]);
    found
}
