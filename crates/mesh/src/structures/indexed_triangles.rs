//! Triangles as lists of vertices.

use std::ops::Range;

use crate::poly_mesh::check_count;
use crate::{MeshError, TriMesh};

use super::face_list::FaceList;

/// Triangles over shared vertices and nothing else: the connectivity of a [`TriMesh`].
///
/// 12 bytes a triangle. It holds any triangles whatever, and answers everything but the corners of a triangle by looking at all
/// triangles. The number of an edge is `3f + i` for its first side: from corner `i` of triangle `f` to the next.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IndexedTriangles {
    vertex_count: u32,
    triangles: Vec<[u32; 3]>,
}

impl IndexedTriangles {
    /// Triangles over `vertex_count` vertices.
    ///
    /// # Errors
    /// A vertex out of range, or more corners than 32 bits can tell apart.
    pub fn try_new(vertex_count: u32, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        check_count("vertices", vertex_count as usize)?;
        check_count("wedges", triangles.len().saturating_mul(3))?;
        for (face, corners) in triangles.iter().enumerate() {
            if let Some(&found) = corners.iter().find(|&&corner| corner >= vertex_count) {
                let (face, found, vertices) = (face as u64, u64::from(found), u64::from(vertex_count));
                return Err(MeshError::IndexOutOfRange { face, found, vertices });
            }
        }
        Ok(Self { vertex_count, triangles })
    }

    /// The vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    pub(crate) fn trusted(vertex_count: u32, triangles: Vec<[u32; 3]>) -> Self {
        Self { vertex_count, triangles }
    }

    pub(crate) fn triangles_mut(&mut self) -> &mut Vec<[u32; 3]> {
        &mut self.triangles
    }

    pub(crate) fn push_vertex(&mut self) -> u32 {
        self.vertex_count += 1;
        self.vertex_count - 1
    }

    pub(crate) fn into_triangles(self) -> Vec<[u32; 3]> {
        self.triangles
    }
}

/// The connectivity of a mesh.
impl From<&TriMesh> for IndexedTriangles {
    fn from(mesh: &TriMesh) -> Self {
        Self { vertex_count: mesh.positions().len() as u32, triangles: mesh.triangles().to_vec() }
    }
}

impl FaceList for IndexedTriangles {
    fn vertex_total(&self) -> usize {
        self.vertex_count as usize
    }

    fn face_total(&self) -> usize {
        self.triangles.len()
    }

    fn all_corners(&self) -> &[u32] {
        self.triangles.as_flattened()
    }

    fn corner_range(&self, face: u32) -> Range<usize> {
        face as usize * 3..face as usize * 3 + 3
    }

    fn face_of(&self, corner: u32) -> u32 {
        corner / 3
    }

    fn after(&self, corner: u32) -> u32 {
        if corner % 3 == 2 { corner - 2 } else { corner + 1 }
    }
}

super::scan::answer_by_scanning!(IndexedTriangles, "indexed triangles");
