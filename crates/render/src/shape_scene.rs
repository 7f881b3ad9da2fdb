//! Shapes as scenes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, ConvertError, Exec, Reservation};
use shapeloom_mesh::{Domain, NORMAL, TriMesh, VertexNormals};
use shapeloom_shape::{Representation, Shape};

use crate::{Scene, SceneMesh};

/// Faces that meet at a larger angle than this, in degrees, are drawn with a crease where a mesh brings no normals: above
/// the steps of a coarse tessellation, below the edges of a box.
const CREASE: f64 = 40.0;

/// The scene of a shape whose parts are all triangle meshes, placed, in the colours of their materials.
///
/// Normals are the mesh's own, on wedges or vertices; a mesh without gets them from its faces, creased at 40 degrees.
///
/// The scene holds a copy of every instance; the reservation that comes with it is for its memory.
///
/// # Errors
/// A part of another kind: pictures are of triangles, convert first. A position that is not finite. Too little memory in
/// the budget, or the reason to stop.
pub fn scene_of_shape(shape: &Shape, exec: &Exec) -> Result<(Scene, Reservation), ConvertError> {
    let mut bytes = 0u64;
    for part in &shape.parts {
        let mesh = TriMesh::from_geometry(&part.geometry)?;
        let corners = mesh.triangles().len() * 3;
        // Positions, indices and normals; and the placed mesh while it is copied, for the largest part.
        let scene = size_of_val(mesh.positions()) + corners * (4 + size_of::<DVec3>());
        bytes = bytes.saturating_add(scene as u64);
    }
    let largest = shape.parts.iter().map(|part| part.geometry.memory_bytes() as u64).max().unwrap_or(0);
    let memory = exec.reserve(bytes)?;
    let _placing = exec.reserve(largest.saturating_mul(2))?;
    let mut scene = Scene::default();
    for part in &shape.parts {
        exec.check()?;
        let placed = part.placed();
        let mesh = TriMesh::from_geometry(&placed)?;
        let material = part.material.and_then(|index| shape.materials.get(index as usize));
        let color = material.map_or(SceneMesh::GLAZE, |material| {
            let [red, green, blue, _] = material.base_color;
            [red, green, blue]
        });
        scene.surfaces.push(SceneMesh {
            normals: Some(corner_normals(mesh, exec)?),
            color,
            ..SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec())
        });
    }
    Ok((scene, memory))
}

/// A normal for each corner of each triangle.
fn corner_normals(mesh: &TriMesh, exec: &Exec) -> Result<Vec<DVec3>, ConvertError> {
    if let Some(normals) = mesh.attribute(Domain::Wedge, NORMAL).filter(|column| column.width() == 3) {
        return Ok((0..normals.len()).map(|wedge| normals.vector(wedge)).collect());
    }
    if let Some(normals) = mesh.attribute(Domain::Vertex, NORMAL).filter(|column| column.width() == 3) {
        let corners = mesh.triangles().as_flattened();
        return Ok(corners.iter().map(|&vertex| normals.vector(vertex as usize)).collect());
    }
    let creased = VertexNormals { crease_angle: CREASE, ..VertexNormals::new() };
    let made = creased.convert_with(mesh, exec)?.value;
    let normals = made.attribute(Domain::Wedge, NORMAL);
    Ok(normals.map_or(Vec::new(), |normals| (0..normals.len()).map(|wedge| normals.vector(wedge)).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::Affine;
    use shapeloom_mesh::{Column, PolyMesh};
    use shapeloom_shape::{Material, Part};

    fn triangle() -> TriMesh {
        TriMesh::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap()
    }

    #[test]
    fn parts_are_placed_and_coloured() {
        let red = Material { base_color: [1.0, 0.0, 0.0, 0.5], ..Material::default() };
        let part = Part { placement: Affine::from_translation(DVec3::Z), material: Some(0), ..Part::new(triangle()) };
        let lost = Part { material: Some(9), ..Part::new(triangle()) };
        let shape = Shape { parts: vec![part, lost], materials: vec![red], ..Shape::default() };
        let scene = scene_of_shape(&shape, &Exec::default()).unwrap().0;
        assert_eq!(scene.surfaces[0].positions[0], DVec3::Z);
        assert_eq!((scene.surfaces[0].color, scene.surfaces[1].color), ([1.0, 0.0, 0.0], SceneMesh::GLAZE));
    }

    #[test]
    fn normals_are_the_meshs_own_or_its_facets() {
        let facets = scene_of_shape(&Shape::new(Part::new(triangle())), &Exec::default()).unwrap().0;
        assert_eq!(facets.surfaces[0].normals, Some(vec![DVec3::Z; 3]));
        let mut own = triangle();
        own.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &[DVec3::X, DVec3::Y, DVec3::Z])).unwrap();
        let scene = scene_of_shape(&Shape::new(Part::new(own)), &Exec::default()).unwrap().0;
        assert_eq!(scene.surfaces[0].normals, Some(vec![DVec3::X, DVec3::Y, DVec3::Z]));
    }

    #[test]
    fn instances_take_from_the_budget() {
        let shape = Shape { parts: vec![Part::new(triangle()); 100], ..Shape::default() };
        let exec = Exec::default().with_memory(1 << 10);
        assert_eq!(scene_of_shape(&shape, &exec).unwrap_err().category(), shapeloom_core::Category::OverLimit);
    }

    #[test]
    fn other_kinds_are_refused() {
        let error = scene_of_shape(&Shape::new(Part::new(PolyMesh::default())), &Exec::default()).unwrap_err();
        assert_eq!(error.to_string(), "found a poly-mesh, expected a tri-mesh");
    }
}
