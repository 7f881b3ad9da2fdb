//! Faces as they are read.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, OverBudget, Place};
use shapeloom_mesh::{MeshError, PolyMesh, TriMesh};
use shapeloom_shape::Geometry;

use crate::Fault;
use crate::ReadError;
use crate::memory::{Growing, Memory};

/// A list of faces of three and more corners: triangles as long as all are triangles, else polygons.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    triangles: Growing<[u32; 3]>,
    polygons: Option<Polygons>,
}

#[derive(Debug, Default)]
struct Polygons {
    /// Where each face ends.
    ends: Growing<u32>,
    corners: Growing<u32>,
}

impl Faces {
    /// An empty list with room for triangles that are known to be there.
    pub(crate) fn with_room(memory: &mut Memory<'_>, triangles: usize) -> Result<Self, OverBudget> {
        Ok(Self { triangles: Growing::with_room(memory, triangles)?, polygons: None })
    }

    /// Makes room for as many triangles in all, as long as all faces are triangles.
    pub(crate) fn reserve_triangles(&mut self, memory: &mut Memory<'_>, count: usize) -> Result<(), OverBudget> {
        if self.polygons.is_none() { self.triangles.reserve(memory, count) } else { Ok(()) }
    }

    /// Adds a triangle.
    #[inline]
    pub(crate) fn push_triangle(&mut self, memory: &mut Memory<'_>, corners: [u32; 3]) -> Result<(), ReadError> {
        match &mut self.polygons {
            None => Ok(self.triangles.push(memory, corners)?),
            Some(polygons) => polygons.push(memory, &corners),
        }
    }

    /// Adds many triangles.
    #[inline]
    pub(crate) fn extend_triangles(
        &mut self,
        memory: &mut Memory<'_>,
        mut triangles: impl ExactSizeIterator<Item = [u32; 3]>,
    ) -> Result<(), ReadError> {
        match &mut self.polygons {
            None => Ok(self.triangles.extend_exact(memory, triangles)?),
            Some(polygons) => triangles.try_for_each(|corners| polygons.push(memory, &corners)),
        }
    }

    /// Adds a face of at least three corners.
    #[inline]
    pub(crate) fn push(&mut self, memory: &mut Memory<'_>, corners: &[u32]) -> Result<(), ReadError> {
        match <[u32; 3]>::try_from(corners) {
            Ok(triangle) => self.push_triangle(memory, triangle),
            Err(_) => self.polygons(memory)?.push(memory, corners),
        }
    }

    /// Adds the faces of another list behind these.
    pub(crate) fn append(&mut self, memory: &mut Memory<'_>, other: Self) -> Result<(), ReadError> {
        if self.is_empty() {
            *self = other;
            return Ok(());
        }
        match other.polygons {
            None if self.polygons.is_none() => Ok(self.triangles.extend(memory, other.triangles.as_slice())?),
            None => {
                let polygons = self.polygons(memory)?;
                other.triangles.as_slice().iter().try_for_each(|triangle| polygons.push(memory, triangle))
            }
            Some(more) => {
                let polygons = self.polygons(memory)?;
                let before = polygons.corners.len();
                checked_corners(before + more.corners.len())?;
                polygons.corners.extend(memory, more.corners.as_slice())?;
                for &end in more.ends.as_slice() {
                    polygons.ends.push(memory, before as u32 + end)?;
                }
                Ok(())
            }
        }
    }

    /// The number of faces.
    pub(crate) fn len(&self) -> usize {
        self.polygons.as_ref().map_or(self.triangles.len(), |polygons| polygons.ends.len())
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The number of corners of all faces.
    pub(crate) fn corner_count(&self) -> usize {
        self.corners().len()
    }

    /// The corners of all faces, one after the other.
    pub(crate) fn corners(&self) -> &[u32] {
        match &self.polygons {
            None => self.triangles.as_slice().as_flattened(),
            Some(polygons) => polygons.corners.as_slice(),
        }
    }

    /// The same, to be changed: every corner of every face.
    pub(crate) fn corners_mut(&mut self) -> &mut [u32] {
        match &mut self.polygons {
            None => self.triangles.as_mut_slice().as_flattened_mut(),
            Some(polygons) => polygons.corners.as_mut_slice(),
        }
    }

    /// Where the corners of a face are.
    pub(crate) fn range(&self, face: usize) -> Range<usize> {
        match &self.polygons {
            None => 3 * face..3 * face + 3,
            Some(polygons) => {
                let ends = polygons.ends.as_slice();
                let start = face.checked_sub(1).map_or(0, |before| ends[before] as usize);
                start..ends[face] as usize
            }
        }
    }

    /// The corners of a face.
    #[cfg(test)]
    pub(crate) fn face(&self, face: usize) -> &[u32] {
        &self.corners()[self.range(face)]
    }

    /// A mesh over these vertices: of triangles if all faces are.
    pub(crate) fn into_geometry(self, positions: Vec<DVec3>) -> Result<Geometry, MeshError> {
        match self.polygons {
            None => Ok(TriMesh::try_new(positions, self.triangles.into_vec())?.into()),
            Some(polygons) => {
                let starts = std::iter::once(0).chain(polygons.ends.into_vec()).collect();
                Ok(PolyMesh::try_new(positions, starts, polygons.corners.into_vec())?.into())
            }
        }
    }

    /// The faces as polygons from now on.
    fn polygons(&mut self, memory: &mut Memory<'_>) -> Result<&mut Polygons, ReadError> {
        if self.polygons.is_none() {
            let triangles = std::mem::take(&mut self.triangles);
            let mut ends = Growing::with_room(memory, triangles.len())?;
            for end in 1..=triangles.len() {
                ends.push(memory, 3 * end as u32)?;
            }
            let corners = Growing::from_vec(triangles.into_vec().into_flattened());
            self.polygons = Some(Polygons { ends, corners });
        }
        Ok(self.polygons.get_or_insert_default())
    }
}

impl Polygons {
    #[inline]
    fn push(&mut self, memory: &mut Memory<'_>, corners: &[u32]) -> Result<(), ReadError> {
        self.corners.extend(memory, corners)?;
        let end = checked_corners(self.corners.len())?;
        Ok(self.ends.push(memory, end)?)
    }
}

fn checked_corners(count: usize) -> Result<u32, ReadError> {
    u32::try_from(count).ok().filter(|&count| count < u32::MAX).ok_or_else(|| {
        let most = format!("at most {} corners of faces", u32::MAX - 1);
        Fault::new("E-read-elements", Place::Whole, count.to_string(), most)
            .category(Category::OverLimit)
            .advice("cut the mesh into parts")
            .into()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Exec;

    #[test]
    fn triangles_stay_triangles_until_a_polygon_comes() {
        let exec = Exec::default();
        let memory = &mut Memory::new(&exec);
        let mut faces = Faces::default();
        faces.push(memory, &[0, 1, 2]).unwrap();
        let mut more = Faces::default();
        more.push(memory, &[2, 1, 3]).unwrap();
        faces.append(memory, more).unwrap();
        assert_eq!((faces.len(), faces.face(1)), (2, &[2, 1, 3][..]));
        let mut polygons = Faces::default();
        polygons.push(memory, &[0, 1, 3, 2]).unwrap();
        polygons.push(memory, &[0, 2, 3]).unwrap();
        faces.append(memory, polygons).unwrap();
        faces.push_triangle(memory, [1, 2, 3]).unwrap();
        let mut last = Faces::default();
        last.push(memory, &[3, 2, 1]).unwrap();
        faces.append(memory, last).unwrap();
        assert_eq!((faces.len(), faces.corner_count()), (6, 19));
        let sizes: Vec<usize> = (0..6).map(|face| faces.face(face).len()).collect();
        assert_eq!(sizes, [3, 3, 4, 3, 3, 3]);
        let Geometry::PolyMesh(mesh) = faces.into_geometry(vec![DVec3::ZERO; 4]).unwrap() else { panic!("polygons") };
        assert_eq!(mesh.face(2), [0, 1, 3, 2]);
        assert!(Faces::default().into_geometry(vec![]).is_ok());
    }
}
