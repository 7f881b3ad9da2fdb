//! Triangles that know nothing of one another.

use shapeloom_core::Exec;
use shapeloom_core::glam::DVec3;

use crate::poly_mesh::check_count;
use crate::{MeshError, TriMesh};

use super::face_list::FaceList;
use super::{Cost, Incidence, IndexedPolygons, IndexedTriangles, Query, StructureError};

/// Three positions a triangle and nothing else: every corner is a vertex of its own.
///
/// It is what scanners and STL files give. A large closed mesh has two triangles a vertex, so that each position stands there
/// six times. As no vertex is shared it answers none of the nine queries; to give it neighbours, make a
/// [`TriMesh`] of it and [`Weld`](crate::Weld) that.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleSoup {
    triangles: Vec<[DVec3; 3]>,
}

impl TriangleSoup {
    /// Triangles by the positions of their corners; any positions, also NaN.
    ///
    /// # Errors
    /// More corners than 32 bits can tell apart.
    pub fn try_new(triangles: Vec<[DVec3; 3]>) -> Result<Self, MeshError> {
        check_count("wedges", triangles.len().saturating_mul(3))?;
        Ok(Self { triangles })
    }

    /// A soup of triangles whose positions are not known: vertex `v` stands at `(v, 0, 0)`, so that [`Weld`](crate::Weld)
    /// finds the vertices again.
    ///
    /// # Errors
    /// A face that is no triangle, the budget, or the reason to stop.
    pub fn try_build(faces: &IndexedPolygons, exec: &Exec) -> Result<Self, StructureError> {
        exec.check()?;
        let _memory = exec.reserve_elements(faces.all_corners().len() as u64, size_of::<DVec3>() + 4)?;
        let triangles = IndexedTriangles::try_from(faces)?.into_triangles();
        let place = |vertex: u32| DVec3::X * f64::from(vertex);
        Ok(Self { triangles: triangles.into_iter().map(|corners| corners.map(place)).collect() })
    }

    /// The positions of the corners of each triangle.
    pub fn triangles(&self) -> &[[DVec3; 3]] {
        &self.triangles
    }
}

/// The positions of the corners of each triangle: what they share is lost, and so are attributes and vertices without triangles.
impl From<&TriMesh> for TriangleSoup {
    fn from(mesh: &TriMesh) -> Self {
        Self { triangles: (0..mesh.triangles().len()).map(|triangle| mesh.corners(triangle)).collect() }
    }
}

/// Each corner a vertex of its own.
impl From<&TriangleSoup> for TriMesh {
    fn from(soup: &TriangleSoup) -> Self {
        let triangles = IndexedTriangles::from(soup).into_triangles();
        Self::try_new(soup.triangles.as_flattened().to_vec(), triangles).expect("a vertex for each corner")
    }
}

/// Each corner a vertex of its own.
impl From<&TriangleSoup> for IndexedTriangles {
    fn from(soup: &TriangleSoup) -> Self {
        let corners = soup.triangles.len() as u32 * 3;
        Self::trusted(corners, (0..corners).step_by(3).map(|first| [first, first + 1, first + 2]).collect())
    }
}

/// Each corner a vertex of its own.
impl From<&TriangleSoup> for IndexedPolygons {
    fn from(soup: &TriangleSoup) -> Self {
        Self::from(IndexedTriangles::from(soup))
    }
}

impl Incidence for TriangleSoup {
    fn name(&self) -> &'static str {
        "triangle soup"
    }

    /// Three for each triangle.
    fn vertex_count(&self) -> usize {
        3 * self.triangles.len()
    }

    fn face_count(&self) -> usize {
        self.triangles.len()
    }

    fn cost(&self, _: Query) -> Cost {
        Cost::Unanswered
    }

    /// None: there is nothing but coordinates.
    fn memory_bytes(&self) -> usize {
        0
    }
}

#[cfg(test)]
mod tests {
    use shapeloom_core::Convert;

    use super::*;
    use crate::primitives::Torus;
    use crate::{TriangulatePolygons, Weld};

    /// The same mesh with its vertices in the order in which triangles name them.
    fn in_order_of_use(mesh: &TriMesh) -> TriMesh {
        let mut numbers = vec![u32::MAX; mesh.positions().len()];
        let mut positions = Vec::new();
        let triangles = mesh.triangles().iter().map(|corners| {
            corners.map(|vertex| {
                let number = &mut numbers[vertex as usize];
                if *number == u32::MAX {
                    *number = positions.len() as u32;
                    positions.push(mesh.positions()[vertex as usize]);
                }
                *number
            })
        });
        let triangles = triangles.collect();
        TriMesh::try_new(positions, triangles).unwrap()
    }

    #[test]
    fn a_mesh_comes_back_from_its_soup_by_welding() {
        let torus = Torus { segments: 24, sides: 12, ..Torus::new() }.mesh(&Exec::default()).unwrap().value;
        let torus = in_order_of_use(&TriangulatePolygons::new().convert(&torus).unwrap().value);
        let soup = TriangleSoup::from(&torus);
        assert_eq!((soup.vertex_count(), soup.face_count()), (3 * 576, 576));
        let apart = TriMesh::from(&soup);
        assert_eq!((apart.positions().len(), TriangleSoup::from(&apart)), (3 * 576, soup));
        let welded = Weld::new().convert(&apart).unwrap().value;
        assert_eq!((welded.positions(), welded.triangles()), (torus.positions(), torus.triangles()));
    }

    #[test]
    fn a_soup_without_positions_can_be_welded() {
        let faces = IndexedPolygons::from_faces(4, &[[0, 1, 2], [2, 1, 3]]).unwrap();
        let soup = TriangleSoup::try_build(&faces, &Exec::default()).unwrap();
        let welded = Weld::new().convert(&TriMesh::from(&soup)).unwrap().value;
        assert_eq!(IndexedPolygons::from(&IndexedTriangles::from(&welded)), faces);
        assert!(Query::ALL.iter().all(|&query| soup.answer(query, 0) == Err(soup.unanswered(query))));
    }
}
