//! The fans of faces around vertices.

use shapeloom_core::{Exec, Stop};

use super::edges::Edges;
use crate::Faces;
use crate::union_find::DisjointSets;

/// How many fans each vertex has: corners of faces that are joined through edges at the vertex make one. 0 for a vertex
/// that no face names.
pub(super) fn fan_counts(faces: &Faces<'_>, edges: &Edges, exec: &Exec) -> Result<Vec<u32>, Stop> {
    let corners = faces.corners();
    let mut fans = DisjointSets::new(corners.len());
    for (edge, uses) in edges.iter().enumerate() {
        if edge.is_multiple_of(1 << 16) {
            exec.check()?;
        }
        let [a, b] = corners_at(faces, uses[0]);
        for &wedge in &uses[1..] {
            let [start, end] = corners_at(faces, wedge);
            // The same edge, whichever way its sides run.
            let same_way = corners[start as usize] == corners[a as usize];
            let (at_a, at_b) = if same_way { (start, end) } else { (end, start) };
            fans.join(a, at_a);
            fans.join(b, at_b);
        }
    }
    // A side between a vertex and itself parts nothing.
    for wedge in 0..corners.len() as u32 {
        let [start, end] = corners_at(faces, wedge);
        if corners[start as usize] == corners[end as usize] {
            fans.join(start, end);
        }
    }
    let mut counts = vec![0; faces.vertex_count()];
    for (wedge, &vertex) in corners.iter().enumerate() {
        counts[vertex as usize] += u32::from(fans.is_first(wedge as u32));
    }
    Ok(counts)
}

/// The wedges at both ends of the side that begins at a wedge.
fn corners_at(faces: &Faces<'_>, wedge: u32) -> [u32; 2] {
    [wedge, faces.next(wedge)]
}
