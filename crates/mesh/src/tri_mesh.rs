//! Indexed triangle meshes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, Affine};

use crate::sums::compensated;
use crate::{AttributeError, Column, Domain, ListColumn, MeshAttributes, MeshError, MeshOrigins, Origins, carry};

/// How many triangles are checked at a time.
const CHUNK: usize = 1 << 10;

/// Triangles over shared vertices, counter-clockwise seen from outside, with attribute columns.
///
/// Every index is in range, and every column has an element for each of its elements; nothing else is promised:
/// positions may be NaN, triangles degenerate, edges non-manifold. Vertex ids are 32 bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriMesh {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    attributes: MeshAttributes,
}

impl TriMesh {
    /// A mesh without attributes.
    ///
    /// # Errors
    /// An index out of range, or more elements than 32 bits can tell apart.
    pub fn try_new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, MeshError> {
        crate::poly_mesh::check_count("vertices", positions.len())?;
        crate::poly_mesh::check_count("wedges", triangles.len().saturating_mul(3))?;
        let vertices = positions.len();
        // Whether all are in range is asked without a way out, many corners at a time; which one is not, only then.
        let beyond = |corners: &[u32]| corners.iter().fold(0, |most, &corner| most.max(corner)) as usize >= vertices;
        let strange = triangles.chunks(CHUNK).enumerate().filter(|(_, part)| beyond(part.as_flattened()));
        let strange = strange.flat_map(|(chunk, part)| (chunk * CHUNK..).zip(part));
        for (face, corners) in strange {
            if let Some(&found) = corners.iter().find(|&&corner| corner as usize >= positions.len()) {
                return Err(MeshError::IndexOutOfRange {
                    face: face as u64,
                    found: u64::from(found),
                    vertices: positions.len() as u64,
                });
            }
        }
        let attributes = MeshAttributes::new(positions.len(), triangles.len(), triangles.len() * 3);
        Ok(Self { positions, triangles, attributes })
    }

    /// A mesh with attributes.
    ///
    /// # Errors
    /// As [`TriMesh::try_new`], or columns of the wrong length.
    pub fn with_attributes(
        positions: Vec<DVec3>,
        triangles: Vec<[u32; 3]>,
        attributes: MeshAttributes,
    ) -> Result<Self, MeshError> {
        let mut mesh = Self::try_new(positions, triangles)?;
        mesh.attributes.check_lengths(&attributes)?;
        mesh.attributes = attributes;
        Ok(mesh)
    }

    /// The positions of the vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// The positions of the vertices, to be moved.
    pub fn positions_mut(&mut self) -> &mut [DVec3] {
        &mut self.positions
    }

    /// The vertices of each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
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

    /// Adds a column of lists.
    ///
    /// # Errors
    /// It has another number of elements, or its name is taken.
    pub fn insert_list(&mut self, domain: Domain, list: ListColumn) -> Result<(), AttributeError> {
        self.attributes.of_mut(domain).insert_list(list)
    }

    /// Takes a column out.
    pub fn remove_attribute(&mut self, domain: Domain, name: &str) -> Option<Column> {
        self.attributes.of_mut(domain).remove(name)
    }

    /// Takes a column of lists out.
    pub fn remove_list(&mut self, domain: Domain, name: &str) -> Option<ListColumn> {
        self.attributes.of_mut(domain).remove_list(name)
    }

    /// The three corners of a triangle.
    ///
    /// # Panics
    /// When there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|vertex| self.positions[vertex as usize])
    }

    /// The smallest box around the vertices.
    pub fn bounds(&self) -> Aabb {
        Aabb::from_points(self.positions.iter().copied())
    }

    /// The first vertex whose position is not finite.
    pub fn first_non_finite(&self) -> Option<usize> {
        self.positions.iter().position(|position| !position.is_finite())
    }

    /// The sum of the triangles' areas.
    pub fn area(&self) -> f64 {
        compensated((0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle);
            (b - a).cross(c - a).length() / 2.0
        }))
    }

    /// The signed volume: the sum of the signed tetrahedra between each triangle and one fixed point. It is the volume
    /// enclosed where the mesh is closed and oriented outward; otherwise it depends on that point, the centre of the
    /// bounding box.
    pub fn volume(&self) -> f64 {
        let center = self.bounds().center();
        compensated((0..self.triangles.len()).map(|triangle| {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - center);
            a.dot(b.cross(c)) / 6.0
        }))
    }

    /// The values of a column at the point of a triangle with these barycentric weights, mixed by the column's rule;
    /// none if there is no such column or triangle. Face columns are constant on the triangle.
    pub fn interpolate(&self, domain: Domain, name: &str, triangle: usize, weights: [f64; 3]) -> Option<Vec<f64>> {
        let column = self.attribute(domain, name)?;
        let corners = *self.triangles.get(triangle)?;
        let first = triangle as u32 * 3;
        let (sources, weights) = match domain {
            Domain::Vertex => (corners.to_vec(), weights.to_vec()),
            Domain::Wedge => (vec![first, first + 1, first + 2], weights.to_vec()),
            Domain::Face => (vec![triangle as u32], vec![1.0]),
        };
        let mixed = column.mixed(&[0, sources.len() as u32], &sources, &weights);
        Some((0..column.width()).map(|component| mixed.number(0, component)).collect())
    }

    /// The image under an affine map. Attributes move by their rules; the faces are reversed when the map mirrors, so
    /// that the outside stays outside.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        let positions = self.positions.iter().map(|&position| map.point(position)).collect();
        let attributes = MeshAttributes {
            vertex: self.attributes.vertex.transformed(map),
            face: self.attributes.face.transformed(map),
            wedge: self.attributes.wedge.transformed(map),
        };
        let moved = Self { positions, triangles: self.triangles.clone(), attributes };
        if map.reverses_orientation() { moved.reversed() } else { moved }
    }

    /// The same triangles turned inside out: each lists its corners in the opposite order, the first one stays first.
    /// Normals and other attributes keep their values.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let triangles = self.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
        let wedges = (0..self.triangles.len() as u32).flat_map(|face| [face * 3, face * 3 + 2, face * 3 + 1]).collect();
        let origins = MeshOrigins { vertex: Origins::Same, face: Origins::Same, wedge: Origins::Copies(wedges) };
        let (attributes, _) = carry(&self.attributes, &origins);
        Self { positions: self.positions.clone(), triangles, attributes }
    }

    /// The memory that the mesh takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(self.positions.as_slice()) + size_of_val(self.triangles.as_slice()) + self.attributes.memory_bytes()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{NORMAL, Values};

    pub(crate) fn tetrahedron() -> TriMesh {
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        TriMesh::try_new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap()
    }

    #[test]
    fn area_and_volume_of_a_corner_tetrahedron() {
        let mesh = tetrahedron();
        assert!((mesh.area() - (1.5 + 3f64.sqrt() / 2.0)).abs() < 1e-15);
        assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-16);
        // Far from the origin the volume loses little.
        let far = mesh.transformed(&Affine::from_translation(DVec3::splat(5e6)));
        assert!((far.volume() - 1.0 / 6.0).abs() < 1e-9);
    }

    #[test]
    fn indices_out_of_range_are_refused() {
        let error = TriMesh::try_new(vec![DVec3::ZERO; 3], vec![[0, 1, 2], [0, 7, 1]]).unwrap_err();
        assert_eq!(error, MeshError::IndexOutOfRange { face: 1, found: 7, vertices: 3 });
    }

    #[test]
    fn mirrored_meshes_keep_their_outside() {
        let mut mesh = tetrahedron();
        mesh.insert_attribute(Domain::Wedge, Column::labels("corner", (0..12).collect())).unwrap();
        let normal = DVec3::new(1.0, 1.0, 1.0).normalize();
        mesh.insert_attribute(Domain::Face, Column::normals(NORMAL, &[-DVec3::Z, -DVec3::Y, -DVec3::X, normal]))
            .unwrap();
        let mirror = mesh.transformed(&Affine::from_scale(DVec3::new(-2.0, 1.0, 1.0)));
        assert!((mirror.volume() - 2.0 / 6.0).abs() < 1e-15);
        let corners = mirror.attribute(Domain::Wedge, "corner").unwrap();
        assert_eq!(corners.values(), &Values::U32(vec![0, 2, 1, 3, 5, 4, 6, 8, 7, 9, 11, 10]));
        for face in 0..4 {
            let normal = mirror.attribute(Domain::Face, NORMAL).unwrap().vector(face);
            let [a, b, c] = mirror.corners(face);
            assert!(normal.dot((b - a).cross(c - a)) > 0.0);
        }
    }

    #[test]
    fn attributes_interpolate_inside_a_face() {
        let mut mesh = tetrahedron();
        let heat = Column::try_new("heat", 1, Values::F32(vec![0.0, 1.0, 2.0, 4.0])).unwrap();
        mesh.insert_attribute(Domain::Vertex, heat).unwrap();
        mesh.insert_attribute(Domain::Face, Column::labels("id", vec![4, 5, 6, 7])).unwrap();
        assert_eq!(mesh.interpolate(Domain::Vertex, "heat", 3, [0.25, 0.5, 0.25]), Some(vec![2.25]));
        assert_eq!(mesh.interpolate(Domain::Face, "id", 3, [0.2, 0.3, 0.5]), Some(vec![7.0]));
        assert_eq!(mesh.interpolate(Domain::Wedge, "heat", 3, [1.0, 0.0, 0.0]), None);
        assert_eq!(mesh.interpolate(Domain::Vertex, "heat", 9, [1.0, 0.0, 0.0]), None);
    }

    #[test]
    fn columns_of_the_wrong_length_are_refused() {
        let mut mesh = tetrahedron();
        assert!(mesh.insert_attribute(Domain::Vertex, Column::labels("x", vec![1])).is_err());
        assert!(mesh.insert_attribute(Domain::Face, Column::labels("x", vec![1; 4])).is_ok());
        assert!(mesh.insert_attribute(Domain::Face, Column::labels("x", vec![1; 4])).is_err());
        assert!(TriMesh::with_attributes(vec![], vec![], MeshAttributes::new(1, 0, 0)).is_err());
    }
}
