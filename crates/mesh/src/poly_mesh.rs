//! Indexed polygon meshes.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::sums::compensated;
use crate::{
    AttributeError, Column, Domain, ListColumn, MeshAttributes, MeshError, MeshOrigins, Origins, TriMesh, carry,
    newell_vector,
};

/// Polygons of three and more corners over shared vertices, counter-clockwise seen from outside, with attribute columns.
///
/// Polygons have one outline and may be concave or not flat. Every index is in range; nothing else is promised.
#[derive(Clone, Debug, PartialEq)]
pub struct PolyMesh {
    positions: Vec<DVec3>,
    starts: Vec<u32>,
    corners: Vec<u32>,
    attributes: MeshAttributes,
}

pub(crate) fn check_count(kind: &'static str, found: usize) -> Result<(), MeshError> {
    if found < u32::MAX as usize { Ok(()) } else { Err(MeshError::TooMany { kind, found: found as u64 }) }
}

impl PolyMesh {
    /// A mesh without attributes: face `i` has the vertices `corners[starts[i]..starts[i + 1]]`.
    ///
    /// # Errors
    /// An index out of range, a face of fewer than three corners, starts that do not rise from 0 to the number of
    /// corners, or more elements than 32 bits can tell apart.
    pub fn try_new(positions: Vec<DVec3>, starts: Vec<u32>, corners: Vec<u32>) -> Result<Self, MeshError> {
        check_count("vertices", positions.len())?;
        check_count("wedges", corners.len())?;
        if starts.first() != Some(&0) || starts.last().map(|&last| last as usize) != Some(corners.len()) {
            return Err(MeshError::FaceStarts { face: starts.len().saturating_sub(2) as u64 });
        }
        for (face, bounds) in starts.windows(2).enumerate() {
            let face = face as u64;
            let Some(count) = bounds[1].checked_sub(bounds[0]) else {
                return Err(MeshError::FaceStarts { face });
            };
            if count < 3 {
                return Err(MeshError::TooFewCorners { face, found: u64::from(count) });
            }
            // Starts that overshoot and come back are caught by a later face; slicing must not panic before that.
            let part = corners.get(bounds[0] as usize..bounds[1] as usize).ok_or(MeshError::FaceStarts { face })?;
            if let Some(&found) = part.iter().find(|&&corner| corner as usize >= positions.len()) {
                let (found, vertices) = (u64::from(found), positions.len() as u64);
                return Err(MeshError::IndexOutOfRange { face, found, vertices });
            }
        }
        let attributes = MeshAttributes::new(positions.len(), starts.len() - 1, corners.len());
        Ok(Self { positions, starts, corners, attributes })
    }

    /// A mesh with attributes.
    ///
    /// # Errors
    /// As [`PolyMesh::try_new`], and for attributes of another number of elements.
    pub fn with_attributes(
        positions: Vec<DVec3>,
        starts: Vec<u32>,
        corners: Vec<u32>,
        attributes: MeshAttributes,
    ) -> Result<Self, MeshError> {
        let mut mesh = Self::try_new(positions, starts, corners)?;
        mesh.attributes.check_lengths(&attributes)?;
        mesh.attributes = attributes;
        Ok(mesh)
    }

    /// A mesh from a list of faces.
    ///
    /// # Errors
    /// As [`PolyMesh::try_new`].
    pub fn from_faces<F: AsRef<[u32]>>(positions: Vec<DVec3>, faces: &[F]) -> Result<Self, MeshError> {
        let mut starts = vec![0];
        let mut corners = Vec::new();
        for face in faces {
            corners.extend_from_slice(face.as_ref());
            check_count("wedges", corners.len())?;
            starts.push(corners.len() as u32);
        }
        Self::try_new(positions, starts, corners)
    }

    /// The positions of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions of the vertices, to be moved.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.positions
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    /// The vertices of all faces, one after the other.
    pub fn wedge_vertices(&self) -> &[u32] {
        &self.corners
    }

    /// Where each face's wedges start, and at last where they end: one more than there are faces.
    pub fn face_starts(&self) -> &[u32] {
        &self.starts
    }

    /// The wedges of a face.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn wedges(&self, face: usize) -> Range<usize> {
        self.starts[face] as usize..self.starts[face + 1] as usize
    }

    /// The vertices of a face.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn face(&self, face: usize) -> &[u32] {
        &self.corners[self.wedges(face)]
    }

    /// The vertices of each face.
    pub fn faces(&self) -> impl ExactSizeIterator<Item = &[u32]> + Clone {
        (0..self.face_count()).map(|face| self.face(face))
    }

    /// The positions of the corners of a face.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn outline(&self, face: usize) -> impl ExactSizeIterator<Item = DVec3> + Clone + '_ {
        self.face(face).iter().map(|&vertex| self.positions[vertex as usize])
    }

    /// The attribute columns.
    pub fn attributes(&self) -> &MeshAttributes {
        &self.attributes
    }

    /// The column of that name on one kind of element.
    pub fn attribute(&self, domain: Domain, name: &str) -> Option<&Column> {
        self.attributes.of(domain).get(name)
    }

    /// Adds a column.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_attribute(&mut self, domain: Domain, column: Column) -> Result<(), AttributeError> {
        self.attributes.of_mut(domain).insert(column)
    }

    /// Takes a column out.
    pub fn remove_attribute(&mut self, domain: Domain, name: &str) -> Option<Column> {
        self.attributes.of_mut(domain).remove(name)
    }

    /// Adds a column of lists.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_list(&mut self, domain: Domain, list: ListColumn) -> Result<(), AttributeError> {
        self.attributes.of_mut(domain).insert_list(list)
    }

    /// The smallest box around the vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.positions.iter().copied())
    }

    /// The first vertex whose position is not finite.
    pub fn first_non_finite(&self) -> Option<usize> {
        self.positions.iter().position(|position| !position.is_finite())
    }

    /// The sum of the faces' areas: half the length of each face's Newell vector, which is the area of a flat face.
    pub fn area(&self) -> f64 {
        compensated((0..self.face_count()).map(|face| newell_vector(self.outline(face)).length() / 2.0))
    }

    /// The signed volume under the fan of triangles from the first corner of each face, to the centre of the bounding
    /// box: the volume enclosed where the mesh is closed, oriented outward and its faces flat.
    pub fn volume(&self) -> f64 {
        let center = self.bounds().center();
        compensated((0..self.face_count()).flat_map(|face| {
            let corner = move |i: usize| self.positions[self.face(face)[i] as usize] - center;
            (1..self.face(face).len() - 1).map(move |i| corner(0).dot(corner(i).cross(corner(i + 1))) / 6.0)
        }))
    }

    /// The largest distance of a face's corners from the plane through their mean across its Newell vector; zero for a
    /// flat face.
    ///
    /// # Panics
    /// When there is no such face.
    pub fn planarity(&self, face: usize) -> f64 {
        let normal = newell_vector(self.outline(face)).normalize_or_zero();
        let mean = self.outline(face).sum::<DVec3>() / self.face(face).len() as f64;
        self.outline(face).map(|corner| normal.dot(corner - mean).abs()).fold(0.0, f64::max)
    }

    /// How many triangles the faces make: corners minus two for each.
    pub fn triangle_count(&self) -> usize {
        self.corners.len() - 2 * self.face_count()
    }

    /// The image under an affine map. Attributes move by their rules; the faces are reversed when the map mirrors.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let positions = self.positions.iter().map(|&position| map.point(position)).collect();
        let attributes = MeshAttributes {
            vertex: self.attributes.vertex.transformed(map),
            face: self.attributes.face.transformed(map),
            wedge: self.attributes.wedge.transformed(map),
        };
        let moved = Self { positions, starts: self.starts.clone(), corners: self.corners.clone(), attributes };
        if map.reverses_orientation() { moved.reversed() } else { moved }
    }

    /// The same faces turned inside out; the first corner of each stays first.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let mut wedges = Vec::with_capacity(self.corners.len());
        for face in 0..self.face_count() {
            let part = self.wedges(face);
            wedges.push(part.start as u32);
            wedges.extend((part.start + 1..part.end).rev().map(|wedge| wedge as u32));
        }
        let corners = wedges.iter().map(|&wedge| self.corners[wedge as usize]).collect();
        let origins = MeshOrigins { vertex: Origins::Same, face: Origins::Same, wedge: Origins::Copies(wedges) };
        let (attributes, _) = carry(&self.attributes, &origins);
        Self { positions: self.positions.clone(), starts: self.starts.clone(), corners, attributes }
    }

    /// The memory that the mesh takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice())
            + size_of_val(self.starts.as_slice())
            + size_of_val(self.corners.as_slice())
            + self.attributes.memory_bytes()
    }
}

impl Default for PolyMesh {
    fn default() -> Self {
        Self { positions: Vec::new(), starts: vec![0], corners: Vec::new(), attributes: MeshAttributes::default() }
    }
}

/// Triangles are polygons: exact and total, attributes and all.
impl From<TriMesh> for PolyMesh {
    fn from(mesh: TriMesh) -> Self {
        let starts = (0..=mesh.triangles().len() as u32).map(|face| face * 3).collect();
        Self {
            positions: mesh.positions().to_vec(),
            starts,
            corners: mesh.triangles().as_flattened().to_vec(),
            attributes: mesh.attributes().clone(),
        }
    }
}

/// Exact where every polygon is a triangle; the error names the first that is not.
impl TryFrom<PolyMesh> for TriMesh {
    type Error = MeshError;

    fn try_from(mesh: PolyMesh) -> Result<Self, MeshError> {
        let mut triangles = Vec::with_capacity(mesh.face_count());
        for (face, corners) in mesh.faces().enumerate() {
            let found = corners.len() as u64;
            triangles.push(corners.try_into().map_err(|_| MeshError::NotTriangle { face: face as u64, found })?);
        }
        Self::with_attributes(mesh.positions, triangles, mesh.attributes)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    pub(crate) fn unit_cube() -> PolyMesh {
        let positions = Aabb::from_corners(DVec3::ZERO, DVec3::ONE).corners().to_vec();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        PolyMesh::from_faces(positions, &faces).unwrap()
    }

    #[test]
    fn a_cube_has_its_area_and_volume() {
        let cube = unit_cube();
        assert_eq!((cube.area(), cube.volume(), cube.triangle_count()), (6.0, 1.0, 12));
        assert_eq!(cube.reversed().volume(), -1.0);
        assert_eq!(cube.transformed(&Affine::from_scale(DVec3::new(1.0, -2.0, 3.0))).volume(), 6.0);
    }

    /// A cube as an indexed face set with the faces 0123 0154 1265 2376 3047 4567: a known misprint, whose faces do not
    /// agree on an outside, so that its volume is not the cube's.
    #[test]
    fn the_misprinted_cube_is_not_consistently_oriented() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let positions: Vec<DVec3> = square.into_iter().chain(square.map(|corner| corner + DVec3::Z)).collect();
        let faces = [[0, 1, 2, 3], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 6, 7]];
        let cube = PolyMesh::from_faces(positions, &faces).unwrap();
        assert!((cube.volume().abs() - 1.0).abs() > 0.1);
    }

    #[test]
    fn planarity_is_the_distance_from_the_mean_plane() {
        let h = 0.25;
        let bent =
            vec![DVec3::new(0.0, 0.0, h), DVec3::new(1.0, 0.0, -h), DVec3::new(1.0, 1.0, h), DVec3::new(0.0, 1.0, -h)];
        let mesh = PolyMesh::from_faces(bent, &[[0, 1, 2, 3]]).unwrap();
        assert!((mesh.planarity(0) - h).abs() < 1e-15);
        assert_eq!(unit_cube().planarity(0), 0.0);
    }

    #[test]
    fn malformed_faces_are_refused() {
        let points = vec![DVec3::ZERO; 4];
        assert!(matches!(
            PolyMesh::from_faces(points.clone(), &[vec![0, 1]]),
            Err(MeshError::TooFewCorners { face: 0, found: 2 })
        ));
        assert!(matches!(
            PolyMesh::from_faces(points.clone(), &[vec![0, 1, 4]]),
            Err(MeshError::IndexOutOfRange { found: 4, .. })
        ));
        assert!(PolyMesh::try_new(points.clone(), vec![0, 3, 2, 6], vec![0; 6]).is_err());
        assert!(PolyMesh::try_new(points.clone(), vec![0, 9, 6], vec![0; 6]).is_err());
        assert!(PolyMesh::try_new(points.clone(), vec![0, 3], vec![0; 6]).is_err());
        assert!(PolyMesh::try_new(points, vec![], vec![]).is_err());
    }

    #[test]
    fn triangles_become_polygons_and_back() {
        let mesh = crate::tri_mesh::tests::tetrahedron();
        assert_eq!(TriMesh::try_from(PolyMesh::from(mesh.clone())).unwrap(), mesh);
        assert!(matches!(TriMesh::try_from(unit_cube()), Err(MeshError::NotTriangle { face: 0, found: 4 })));
    }
}
