//! A part of a mesh as a mesh.

use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{MeshError, MeshOrigins, Origins, PolyMesh, TriMesh, carry};
use shapeloom_shape::Geometry;

/// The mesh of some vertices and faces of another, in their order, with all attributes; none of other geometries.
/// `new_of_old` says for each kept vertex which of `vertices` it is. Cost: linear in what is kept.
///
/// # Errors
/// A face with a vertex that is not kept.
pub(crate) fn cut(
    geometry: &Geometry,
    vertices: Vec<u32>,
    faces: Vec<u32>,
    new_of_old: &[u32],
) -> Result<Option<Geometry>, MeshError> {
    let gather = |points: &[DVec3]| -> Vec<DVec3> { vertices.iter().map(|&vertex| points[vertex as usize]).collect() };
    Ok(match geometry {
        Geometry::TriMesh(mesh) => {
            let positions = gather(mesh.positions());
            let corners = |&face: &u32| mesh.triangles()[face as usize].map(|corner| new_of_old[corner as usize]);
            let triangles = faces.iter().map(corners).collect();
            let wedges = faces.iter().flat_map(|&face| 3 * face..3 * face + 3).collect();
            let (attributes, _) = carry(mesh.attributes(), &origins(vertices, faces, wedges));
            Some(TriMesh::with_attributes(positions, triangles, attributes)?.into())
        }
        Geometry::PolyMesh(mesh) => {
            let positions = gather(mesh.positions());
            let mut starts = Vec::with_capacity(faces.len() + 1);
            starts.push(0);
            let mut wedges = Vec::new();
            for &face in &faces {
                wedges.extend(mesh.wedges(face as usize).map(|wedge| wedge as u32));
                starts.push(wedges.len() as u32);
            }
            let old = mesh.wedge_vertices();
            let corners = wedges.iter().map(|&wedge| new_of_old[old[wedge as usize] as usize]).collect();
            let (attributes, _) = carry(mesh.attributes(), &origins(vertices, faces, wedges));
            Some(PolyMesh::with_attributes(positions, starts, corners, attributes)?.into())
        }
        _ => None,
    })
}

fn origins(vertices: Vec<u32>, faces: Vec<u32>, wedges: Vec<u32>) -> MeshOrigins {
    MeshOrigins { vertex: Origins::Copies(vertices), face: Origins::Copies(faces), wedge: Origins::Copies(wedges) }
}
