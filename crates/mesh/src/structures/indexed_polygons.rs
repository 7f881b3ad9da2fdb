//! Polygons as lists of vertices.

use std::ops::Range;

use crate::poly_mesh::check_count;
use crate::{MeshError, PolyMesh};

use super::face_list::FaceList;
use super::{IndexedTriangles, StructureError};

/// Polygons over shared vertices and nothing else: the connectivity of a [`PolyMesh`].
///
/// Four bytes a corner and four a face. It holds any faces whatever, and answers everything but the corners of a face by
/// looking at all faces. The number of an edge is that of the corner at which its first side starts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexedPolygons {
    vertex_count: u32,
    starts: Vec<u32>,
    corners: Vec<u32>,
}

impl IndexedPolygons {
    /// Faces over `vertex_count` vertices: face `i` has the vertices `corners[starts[i]..starts[i + 1]]`.
    ///
    /// # Errors
    /// A vertex out of range, a face of fewer than three corners, starts that do not rise from 0 to the number of
    /// corners, or more elements than 32 bits can tell apart.
    pub fn try_new(vertex_count: u32, starts: Vec<u32>, corners: Vec<u32>) -> Result<Self, MeshError> {
        check_count("vertices", vertex_count as usize)?;
        check_count("wedges", corners.len())?;
        if starts.first() != Some(&0) {
            return Err(MeshError::FaceStarts { face: 0 });
        }
        for (face, pair) in starts.windows(2).enumerate() {
            let face = face as u64;
            if pair[0] > pair[1] || pair[1] as usize > corners.len() {
                return Err(MeshError::FaceStarts { face });
            }
            if pair[1] - pair[0] < 3 {
                return Err(MeshError::TooFewCorners { face, found: u64::from(pair[1] - pair[0]) });
            }
            let own = &corners[pair[0] as usize..pair[1] as usize];
            if let Some(&found) = own.iter().find(|&&corner| corner >= vertex_count) {
                let (found, vertices) = (u64::from(found), u64::from(vertex_count));
                return Err(MeshError::IndexOutOfRange { face, found, vertices });
            }
        }
        if starts.last().map(|&end| end as usize) != Some(corners.len()) {
            return Err(MeshError::FaceStarts { face: starts.len() as u64 - 1 });
        }
        Ok(Self { vertex_count, starts, corners })
    }

    /// The same from one list for each face.
    ///
    /// # Errors
    /// As [`IndexedPolygons::try_new`].
    pub fn from_faces<F: AsRef<[u32]>>(vertex_count: u32, faces: &[F]) -> Result<Self, MeshError> {
        let mut starts = vec![0];
        let mut corners = Vec::new();
        for face in faces {
            corners.extend_from_slice(face.as_ref());
            check_count("wedges", corners.len())?;
            starts.push(corners.len() as u32);
        }
        Self::try_new(vertex_count, starts, corners)
    }

    /// Where each face's corners start, and the number of corners at the end.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// The corners of all faces, one face after another.
    pub fn corners(&self) -> &[u32] {
        &self.corners
    }

    pub(crate) fn trusted(vertex_count: u32, starts: Vec<u32>, corners: Vec<u32>) -> Self {
        Self { vertex_count, starts, corners }
    }
}

impl Default for IndexedPolygons {
    fn default() -> Self {
        Self { vertex_count: 0, starts: vec![0], corners: Vec::new() }
    }
}

/// The connectivity of a mesh.
impl From<&PolyMesh> for IndexedPolygons {
    fn from(mesh: &PolyMesh) -> Self {
        let vertex_count = mesh.positions().len() as u32;
        Self { vertex_count, starts: mesh.face_starts().to_vec(), corners: mesh.wedge_vertices().to_vec() }
    }
}

/// Triangles are polygons.
impl From<&IndexedTriangles> for IndexedPolygons {
    fn from(triangles: &IndexedTriangles) -> Self {
        let starts = (0..=triangles.face_total() as u32).map(|face| face * 3).collect();
        let vertex_count = triangles.vertex_total() as u32;
        Self { vertex_count, starts, corners: triangles.all_corners().to_vec() }
    }
}

/// Triangles are polygons; the corners are moved, not copied.
impl From<IndexedTriangles> for IndexedPolygons {
    fn from(triangles: IndexedTriangles) -> Self {
        let starts = (0..=triangles.face_total() as u32).map(|face| face * 3).collect();
        let vertex_count = triangles.vertex_total() as u32;
        Self { vertex_count, starts, corners: triangles.into_triangles().into_flattened() }
    }
}

/// Exact where every face is a triangle; the error names the first that is not.
impl TryFrom<&IndexedPolygons> for IndexedTriangles {
    type Error = StructureError;

    fn try_from(polygons: &IndexedPolygons) -> Result<Self, StructureError> {
        let mut triangles = Vec::with_capacity(polygons.face_total());
        for face in 0..polygons.face_total() as u32 {
            let corners = polygons.face(face);
            let wrong = |_| MeshError::NotTriangle { face: u64::from(face), found: corners.len() as u64 };
            triangles.push(corners.try_into().map_err(wrong)?);
        }
        Ok(Self::trusted(polygons.vertex_count, triangles))
    }
}

impl FaceList for IndexedPolygons {
    fn vertex_total(&self) -> usize {
        self.vertex_count as usize
    }

    fn face_total(&self) -> usize {
        self.starts.len() - 1
    }

    fn all_corners(&self) -> &[u32] {
        &self.corners
    }

    fn corner_range(&self, face: u32) -> Range<usize> {
        self.starts[face as usize] as usize..self.starts[face as usize + 1] as usize
    }

    fn start_bytes(&self) -> usize {
        size_of_val(self.starts.as_slice())
    }

    fn face_of(&self, corner: u32) -> u32 {
        // Where all faces have the same number of corners the first guess is right.
        let guess = (u64::from(corner) * self.face_total() as u64 / self.corners.len() as u64) as u32;
        if self.corner_range(guess).contains(&(corner as usize)) {
            return guess;
        }
        // The last face that starts at or before the corner; no face is empty.
        self.starts.partition_point(|&start| start <= corner) as u32 - 1
    }
}

super::scan::answer_by_scanning!(IndexedPolygons, "indexed polygons");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_make_no_mesh_are_refused() {
        let refused = |starts: &[u32], corners: &[u32]| {
            IndexedPolygons::try_new(4, starts.to_vec(), corners.to_vec()).unwrap_err()
        };
        assert_eq!(refused(&[], &[]), MeshError::FaceStarts { face: 0 });
        assert_eq!(refused(&[0, 3, 2], &[0, 1, 2]), MeshError::FaceStarts { face: 1 });
        assert_eq!(refused(&[0, 3], &[0, 1, 2, 3]), MeshError::FaceStarts { face: 1 });
        assert_eq!(refused(&[0, 3, 5], &[0, 1, 2, 3, 0]), MeshError::TooFewCorners { face: 1, found: 2 });
        assert_eq!(refused(&[0, 3], &[0, 1, 4]), MeshError::IndexOutOfRange { face: 0, found: 4, vertices: 4 });
    }

    #[test]
    fn the_face_of_each_corner_is_found() {
        let faces = IndexedPolygons::from_faces(5, &[vec![0, 1, 2], vec![0, 2, 3, 4], vec![4, 0, 1]]).unwrap();
        let of: Vec<u32> = (0..10).map(|corner| faces.face_of(corner)).collect();
        assert_eq!(of, [0, 0, 0, 1, 1, 1, 1, 2, 2, 2]);
        assert_eq!(faces.side(6), [4, 0]);
    }
}
