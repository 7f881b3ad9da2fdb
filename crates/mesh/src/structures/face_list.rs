//! What the builders of structures read: faces as lists of vertices.

use std::ops::Range;

use crate::{PolyMesh, TriMesh};

/// Faces as lists of vertices, corner after corner.
pub(crate) trait FaceList: Sync {
    /// The number of vertices, isolated ones too.
    fn vertex_total(&self) -> usize;

    /// The number of faces.
    fn face_total(&self) -> usize;

    /// The corners of all faces, one face after another.
    fn all_corners(&self) -> &[u32];

    /// Which corners are a face's.
    fn corner_range(&self, face: u32) -> Range<usize>;

    /// The face that a corner belongs to.
    fn face_of(&self, corner: u32) -> u32;

    /// The memory that it takes beside the corners, in bytes.
    fn start_bytes(&self) -> usize {
        0
    }

    /// The corners of a face.
    fn face(&self, face: u32) -> &[u32] {
        &self.all_corners()[self.corner_range(face)]
    }

    /// The corner after a corner around its face.
    fn after(&self, corner: u32) -> u32 {
        let range = self.corner_range(self.face_of(corner));
        if corner as usize + 1 == range.end { range.start as u32 } else { corner + 1 }
    }

    /// The vertices of the side that starts at a corner, in its direction.
    fn side(&self, corner: u32) -> [u32; 2] {
        let corners = self.all_corners();
        [corners[corner as usize], corners[self.after(corner) as usize]]
    }
}

/// The sides of a face: the corner that each starts at and its two vertices.
pub(crate) fn sides_of(faces: &(impl FaceList + ?Sized), face: u32) -> impl Iterator<Item = (u32, [u32; 2])> + '_ {
    let range = faces.corner_range(face);
    let corners = faces.face(face);
    (0..corners.len()).map(move |i| {
        let next = if i + 1 == corners.len() { 0 } else { i + 1 };
        ((range.start + i) as u32, [corners[i], corners[next]])
    })
}

/// The smaller vertex first.
pub(crate) fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    if a < b { [a, b] } else { [b, a] }
}

impl FaceList for TriMesh {
    fn vertex_total(&self) -> usize {
        self.positions().len()
    }

    fn face_total(&self) -> usize {
        self.triangles().len()
    }

    fn all_corners(&self) -> &[u32] {
        self.triangles().as_flattened()
    }

    fn corner_range(&self, face: u32) -> Range<usize> {
        face as usize * 3..face as usize * 3 + 3
    }

    fn face_of(&self, corner: u32) -> u32 {
        corner / 3
    }
}

impl FaceList for PolyMesh {
    fn vertex_total(&self) -> usize {
        self.positions().len()
    }

    fn face_total(&self) -> usize {
        self.face_count()
    }

    fn all_corners(&self) -> &[u32] {
        self.wedge_vertices()
    }

    fn corner_range(&self, face: u32) -> Range<usize> {
        self.wedges(face as usize)
    }

    fn face_of(&self, corner: u32) -> u32 {
        // The last face that starts at or before the corner; no face is empty.
        self.face_starts().partition_point(|&start| start <= corner) as u32 - 1
    }
}
