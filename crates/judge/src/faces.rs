//! Faces as index lists, whatever mesh they come from.

use std::ops::Range;

use shapeloom_core::{Exec, OverBudget, Reservation};
use shapeloom_mesh::{PolyMesh, TriMesh};

/// The faces of a mesh apart from its coordinates: vertex indices at wedges (the corners of faces, in the order of the
/// faces). Every index is in range, every face has three corners or more.
#[derive(Debug)]
pub struct Faces<'a> {
    vertices: usize,
    corners: &'a [u32],
    polygons: Option<Polygons<'a>>,
}

#[derive(Debug)]
struct Polygons<'a> {
    starts: &'a [u32],
    /// The face of each wedge.
    owners: Vec<u32>,
    _memory: Reservation,
}

impl<'a> Faces<'a> {
    /// Those of a triangle mesh.
    pub fn of_triangles(mesh: &'a TriMesh) -> Self {
        Self { vertices: mesh.positions().len(), corners: mesh.triangles().as_flattened(), polygons: None }
    }

    /// Those of a polygon mesh.
    ///
    /// # Errors
    /// The memory budget has no room for four bytes a corner.
    pub fn of_polygons(mesh: &'a PolyMesh, exec: &Exec) -> Result<Self, OverBudget> {
        let (starts, corners) = (mesh.face_starts(), mesh.wedge_vertices());
        let memory = exec.reserve_elements(corners.len() as u64, size_of::<u32>())?;
        let mut owners = Vec::with_capacity(corners.len());
        for (face, ends) in starts.windows(2).enumerate() {
            owners.resize(owners.len() + (ends[1] - ends[0]) as usize, face as u32);
        }
        let polygons = Some(Polygons { starts, owners, _memory: memory });
        Ok(Self { vertices: mesh.positions().len(), corners, polygons })
    }

    /// How many vertices the mesh has, named by a face or not.
    pub fn vertex_count(&self) -> usize {
        self.vertices
    }

    /// How many faces there are.
    pub fn len(&self) -> usize {
        self.polygons.as_ref().map_or(self.corners.len() / 3, |polygons| polygons.starts.len() - 1)
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    /// The vertex at each wedge.
    pub fn corners(&self) -> &'a [u32] {
        self.corners
    }

    /// The wedges of a face.
    pub fn wedges(&self, face: u32) -> Range<u32> {
        match &self.polygons {
            None => 3 * face..3 * face + 3,
            Some(polygons) => polygons.starts[face as usize]..polygons.starts[face as usize + 1],
        }
    }

    /// The vertices of a face.
    pub fn face(&self, face: u32) -> &'a [u32] {
        let wedges = self.wedges(face);
        &self.corners[wedges.start as usize..wedges.end as usize]
    }

    /// The face that a wedge belongs to.
    pub fn face_of(&self, wedge: u32) -> u32 {
        match &self.polygons {
            None => wedge / 3,
            Some(polygons) => polygons.owners[wedge as usize],
        }
    }

    /// The next wedge around the same face.
    pub fn next(&self, wedge: u32) -> u32 {
        match &self.polygons {
            None => {
                if wedge % 3 == 2 {
                    wedge - 2
                } else {
                    wedge + 1
                }
            }
            Some(polygons) => {
                let ends = self.wedges(polygons.owners[wedge as usize]);
                if wedge + 1 == ends.end { ends.start } else { wedge + 1 }
            }
        }
    }

    /// The vertices at the start and the end of the side that begins at a wedge.
    pub fn side(&self, wedge: u32) -> [u32; 2] {
        [self.corners[wedge as usize], self.corners[self.next(wedge) as usize]]
    }
}
