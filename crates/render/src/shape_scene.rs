//! Shapes as scenes.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Convert, ConvertError, Exec, Reservation};
use shapeloom_mesh::{Domain, MATERIAL, NORMAL, TriMesh, Values, VertexNormals};
use shapeloom_shape::{Material, Representation, Shape};

use crate::{Scene, SceneMesh};

/// Faces that meet at a larger angle than this, in degrees, are drawn with a crease where a mesh brings no normals: above
/// the steps of a coarse tessellation, below the edges of a box.
const CREASE: f64 = 40.0;

/// The scene of a shape whose parts are all triangle meshes, placed, in the colours of their materials, also
/// where faces name their own.
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
        let normals = corner_normals(mesh, exec)?;
        match mesh.attribute(Domain::Face, MATERIAL).map(|column| column.values()) {
            Some(Values::Text { names, index }) => {
                let named = |name: &String| shape.materials.iter().find(|material| material.name == *name);
                let colors: Vec<[f32; 3]> = names.iter().map(|name| color(named(name).or(material))).collect();
                scene.surfaces.extend(by_material(mesh, &normals, index, &colors));
            }
            _ => scene.surfaces.push(SceneMesh {
                normals: Some(normals),
                color: color(material),
                ..SceneMesh::new(mesh.positions().to_vec(), mesh.triangles().to_vec())
            }),
        }
    }
    Ok((scene, memory))
}

fn color(material: Option<&Material>) -> [f32; 3] {
    material.map_or(SceneMesh::GLAZE, |material| {
        let [red, green, blue, _] = material.base_color;
        [red, green, blue]
    })
}

/// A surface for each material: the triangles that have it, with the vertices that they use.
fn by_material(mesh: &TriMesh, normals: &[DVec3], material_of: &[u32], colors: &[[f32; 3]]) -> Vec<SceneMesh> {
    let empty = |&color: &[f32; 3]| SceneMesh { normals: Some(Vec::new()), color, ..SceneMesh::new(vec![], vec![]) };
    let mut surfaces: Vec<SceneMesh> = colors.iter().map(empty).collect();
    // For each vertex the surface that used it last, and its number there.
    let mut known = vec![(u32::MAX, 0u32); mesh.positions().len()];
    let mut order: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    order.sort_by_key(|&triangle| material_of[triangle as usize]);
    for triangle in order {
        let material = material_of[triangle as usize];
        let surface = &mut surfaces[material as usize];
        let corners = mesh.triangles()[triangle as usize].map(|vertex| {
            let slot = &mut known[vertex as usize];
            if slot.0 != material {
                *slot = (material, surface.positions.len() as u32);
                surface.positions.push(mesh.positions()[vertex as usize]);
            }
            slot.1
        });
        surface.triangles.push(corners);
        let first = 3 * triangle as usize;
        surface.normals.get_or_insert_default().extend_from_slice(&normals[first..first + 3]);
    }
    surfaces.retain(|surface| !surface.triangles.is_empty());
    surfaces
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
    use shapeloom_shape::Part;

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
    fn faces_have_the_colours_of_their_own_materials() {
        let points = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
        let mut mesh = TriMesh::try_new(points, vec![[0, 1, 2], [3, 1, 0], [0, 2, 3]]).unwrap();
        let names = vec!["red".to_owned(), "unknown".to_owned(), "unused".to_owned()];
        let column = Column::try_new(MATERIAL, 1, Values::Text { names, index: vec![0, 1, 0] }).unwrap();
        mesh.insert_attribute(Domain::Face, column).unwrap();
        let red = Material { name: "red".into(), base_color: [1.0, 0.0, 0.0, 1.0], ..Material::default() };
        let shape = Shape { materials: vec![red], ..Shape::new(Part::new(mesh)) };
        let scene = scene_of_shape(&shape, &Exec::default()).unwrap().0;
        let [first, second] = &scene.surfaces[..] else { panic!("two surfaces") };
        assert_eq!((first.color, second.color), ([1.0, 0.0, 0.0], SceneMesh::GLAZE));
        assert_eq!((first.positions.len(), &first.triangles), (4, &vec![[0, 1, 2], [0, 2, 3]]));
        assert_eq!((second.positions[0], &second.triangles), (DVec3::Z, &vec![[0, 1, 2]]));
        assert_eq!((first.normals.as_ref().unwrap()[5], second.normals.as_ref().unwrap().len()), (DVec3::X, 3));
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
