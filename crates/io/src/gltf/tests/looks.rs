//! Materials, those of faces among them, and textures.

use serde_json::{Value, json};
use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{Column, Domain, MATERIAL, TEXCOORD, TriMesh, Values};
use shapeloom_shape::{Material, Part, Shape, UpAxis};

use super::{document, from_glb, mesh, to_glb};

/// A strip of four triangles.
fn strip(materials: &[&str]) -> TriMesh {
    let positions = (0..6).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
    let triangles = vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]];
    let mut mesh = TriMesh::try_new(positions, triangles).unwrap();
    let mut names: Vec<String> = materials.iter().map(|name| (*name).to_owned()).collect();
    names.dedup();
    let index = materials.iter().map(|name| names.iter().position(|known| known == name).unwrap() as u32).collect();
    let column = Column::try_new(MATERIAL, 1, Values::Text { names, index }).unwrap();
    mesh.insert_attribute(Domain::Face, column).unwrap();
    let uv: Vec<[f64; 2]> = (0..12).map(|i| [f64::from(i / 3), 0.5]).collect();
    mesh.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &uv)).unwrap();
    mesh
}

fn material(name: &str, texture: Option<&str>) -> Material {
    Material { name: name.into(), texture: texture.map(str::to_owned), ..Material::default() }
}

fn shape(mesh: TriMesh, materials: Vec<Material>) -> Shape {
    let part = Part { material: Some(0), ..Part::new(mesh).named("strip") };
    Shape { materials, up: Some(UpAxis::Y), ..Shape::new(part) }
}

pub(super) fn json_of(glb: &[u8]) -> Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    serde_json::from_slice(&glb[20..20 + length]).unwrap()
}

#[test]
fn faces_of_several_materials_are_primitives_of_one_mesh() {
    let source = strip(&["oak", "elm", "oak", "glass"]);
    let given = shape(source.clone(), vec![material("elm", None), material("oak", None)]);
    let (file, report) = to_glb(&given).unwrap();
    assert!(report.losses.is_empty(), "{:?}", report.losses);
    let json = json_of(&file);
    assert_eq!((json["meshes"].as_array().unwrap().len(), json["nodes"].as_array().unwrap().len()), (1, 1));
    let back = from_glb(&file).shape;
    let found: Vec<(&str, Option<u32>)> = back.parts.iter().map(|part| (part.name.as_str(), part.material)).collect();
    assert_eq!(found, [("strip", Some(1)), ("strip", Some(0)), ("strip", Some(2))]);
    let names: Vec<&str> = back.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["elm", "oak", "glass"]);
    // Every face with its material, its corners and their texture coordinates; no vertex that no face uses.
    let wanted = [vec![0, 2], vec![1], vec![3]];
    for (part, faces) in wanted.iter().enumerate() {
        let read = mesh(&back, part);
        let corners: Vec<[DVec3; 3]> = (0..read.triangles().len()).map(|face| read.corners(face)).collect();
        assert_eq!(corners, faces.iter().map(|&face| source.corners(face)).collect::<Vec<_>>());
        let uv = read.attribute(Domain::Vertex, TEXCOORD).unwrap();
        for (wedge, &vertex) in read.triangles().as_flattened().iter().enumerate() {
            assert_eq!(uv.number(vertex as usize, 0), faces[wedge / 3] as f64);
        }
        assert!((0..read.positions().len()).all(|v| read.triangles().as_flattened().contains(&(v as u32))));
    }
    let (parsed, buffers, _) = ::gltf::import_slice(&file).unwrap();
    let primitives: Vec<_> = parsed.meshes().next().unwrap().primitives().collect();
    assert_eq!(primitives.iter().map(|one| one.material().index()).collect::<Vec<_>>(), [Some(1), Some(0), Some(2)]);
    for (primitive, part) in primitives.iter().zip(&back.parts) {
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        assert_eq!(reader.read_positions().unwrap().len(), crate::placed::points_of(&part.geometry).unwrap().len());
        assert_eq!(primitive.bounding_box().min[0], part.geometry.bounds().min.x as f32);
    }
}

#[test]
fn faces_of_one_or_no_material_stay_one_primitive() {
    for (words, wanted) in [(["elm"; 4], Some(1)), ([""; 4], Some(0))] {
        let (file, _) = to_glb(&shape(strip(&words), vec![material("oak", None), material("elm", None)])).unwrap();
        let back = from_glb(&file).shape;
        assert_eq!((back.parts.len(), back.parts[0].material, back.materials.len()), (1, wanted, 2));
    }
    // A column of that name that is no text says nothing of materials.
    let mut mesh = TriMesh::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
    mesh.insert_attribute(Domain::Face, Column::labels(MATERIAL, vec![4])).unwrap();
    let (_, report) = to_glb(&shape(mesh, vec![material("oak", None)])).unwrap();
    assert_eq!(report.losses[0].what, "face attribute \"material\"");
}

#[test]
fn a_mesh_far_away_keeps_one_origin_for_all_materials() {
    let far = shapeloom_core::Affine::from_translation(DVec3::new(5e6, 0.3, -4e6));
    let given = shape(strip(&["oak", "elm", "oak", "oak"]).transformed(&far), vec![]);
    let (file, report) = to_glb(&given).unwrap();
    let bound = report.deviation.value().unwrap();
    assert!(bound < 1e-6, "{bound}");
    let back = from_glb(&file).shape;
    assert_eq!(back.parts[0].placement, back.parts[1].placement);
    let box_apart = back.bounds().min.distance(given.bounds().min);
    assert!(box_apart <= 2.0 * bound, "{box_apart}");
}

#[test]
fn texture_names_come_back() {
    let names = ["brick.png", "bilder/ä b#1 100%.jpg"];
    let mut materials: Vec<Material> = names.iter().map(|name| material(name, Some(name))).collect();
    materials.push(material("again", Some("brick.png")));
    let (file, report) = to_glb(&shape(strip(&["again"; 4]), materials.clone())).unwrap();
    assert!(report.losses.is_empty(), "{:?}", report.losses);
    let json = json_of(&file);
    assert_eq!(json["images"], json!([{"uri": "brick.png"}, {"uri": "bilder/%C3%A4%20b%231%20100%25.jpg"}]));
    let back = from_glb(&file);
    assert_eq!(back.shape.materials, materials);
    assert!(back.losses.is_empty(), "{:?}", back.losses);
    assert!(::gltf::Gltf::from_slice(&file).is_ok());
}

#[test]
fn textures_stay_away_where_there_are_no_coordinates() {
    let mut bare = strip(&[""; 4]);
    bare.remove_attribute(Domain::Wedge, TEXCOORD);
    let mut given = shape(bare, vec![material("wall", Some("brick.png"))]);
    given.parts.push(Part { material: Some(0), ..Part::new(strip(&[""; 4])) });
    let (file, report) = to_glb(&given).unwrap();
    assert_eq!(report.losses[0].what, "texture \"brick.png\" where a part has no texture coordinates");
    let json = json_of(&file);
    assert_eq!(json["materials"].as_array().unwrap().len(), 2);
    assert_eq!(json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"], 0);
    assert!(json["materials"][1]["pbrMetallicRoughness"].get("baseColorTexture").is_none());
    let back = from_glb(&file).shape;
    assert_eq!(back.parts.iter().map(|part| part.material).collect::<Vec<_>>(), [Some(1), Some(0)]);
}

#[test]
fn pictures_inside_the_file_and_other_textures_are_named_as_lost() {
    let read = document(|document| {
        document["images"] =
            json!([{"bufferView": 0, "mimeType": "image/png", "name": "inside"}, {"uri": "no-such.png"}]);
        document["textures"] = json!([{"source": 0}, {"source": 1}, {"source": 1}]);
        document["materials"] = json!([
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "emissiveFactor": [0, 0, 0]},
            {"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}, "normalTexture": {"index": 2}}
        ]);
    });
    let read = read.unwrap();
    let textures: Vec<Option<&str>> = read.shape.materials.iter().map(|material| material.texture.as_deref()).collect();
    assert_eq!(textures, [None, Some("no-such.png")]);
    let whats: Vec<&str> = read.losses.iter().map(|loss| loss.what.as_str()).collect();
    assert_eq!(whats, ["normal textures", "2 textures"]);
}
