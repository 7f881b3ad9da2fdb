//! What rounding, scaling and clamping change is said, once for each column.

use serde_json::{Value, json};
use shapeloom_core::Deviation;
use shapeloom_core::glam::DVec3;
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, TEXCOORD, TriMesh, Values};
use shapeloom_shape::{Part, Shape, UpAxis};

use super::looks::json_of;
use super::{document, from_glb, mesh, to_glb};

fn triangle(size: f64) -> TriMesh {
    TriMesh::try_new(vec![DVec3::ZERO, DVec3::X * size, DVec3::Y], vec![[0, 1, 2]]).unwrap()
}

fn shape(meshes: Vec<TriMesh>) -> Shape {
    Shape { parts: meshes.into_iter().map(Part::new).collect(), up: Some(UpAxis::Y), ..Shape::default() }
}

fn column(name: &str, width: usize, values: &[f64]) -> Column {
    Column::try_new(name, width, Values::F64(values.to_vec())).unwrap()
}

fn losses(shape: &Shape) -> Vec<String> {
    to_glb(shape).unwrap().1.losses.iter().map(|loss| format!("{}: {}", loss.what, loss.why)).collect()
}

#[test]
fn rounded_positions_are_a_loss_of_the_size_of_the_deviation() {
    let given = shape(vec![triangle(0.1), triangle(1.0)]);
    let (_, report) = to_glb(&given).unwrap();
    // A tenth in single precision is 0.100000001490116119384765625.
    let Deviation::AtMost(bound) = report.deviation else { panic!("a bound") };
    assert!((bound - 1.490_116_1e-9).abs() < 1e-15, "{bound}");
    let said = losses(&given);
    assert_eq!(said, [format!("positions: they were rounded to single precision, by at most {bound:e}")]);
    assert!(losses(&shape(vec![triangle(0.5)])).is_empty());
}

#[test]
fn each_rounded_column_is_a_loss_with_its_largest_change() {
    let (mut one, mut two) = (triangle(1.0), triangle(1.0));
    // By 1/2 of 2²⁴ and by 1 of 2²⁵, of either sign.
    one.insert_attribute(Domain::Vertex, column("heat", 1, &[0.5, 8_388_608.5, 1.0])).unwrap();
    two.insert_attribute(Domain::Vertex, column("heat", 1, &[0.5, 1.0, -33_554_431.0])).unwrap();
    two.insert_attribute(Domain::Vertex, column("cold", 2, &[0.0; 6])).unwrap();
    let given = shape(vec![one, two]);
    assert_eq!(
        losses(&given),
        ["vertex attribute \"heat\": its values were rounded to single precision, by at most 1e0"]
    );
    // v is written as 1 - v: what is very small is lost beside the 1.
    let mut small = triangle(1.0);
    let uv = [[0.0, 0.0], [1.0, 2f64.powi(-40)], [0.25, 0.25]];
    small.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &uv)).unwrap();
    let lost = format!("by at most {:e}", 2f64.powi(-40));
    let said = losses(&shape(vec![small]));
    assert!(said.len() == 1 && said[0].starts_with("wedge attribute \"texcoord\"") && said[0].ends_with(&lost));
}

#[test]
fn normals_and_numbers_without_end_are_a_loss_each() {
    let mut given = triangle(1.0);
    let normals = [DVec3::ZERO, DVec3::new(0.0, 0.0, 3.0), DVec3::new(f64::NAN, 0.0, 1.0)];
    given.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &normals)).unwrap();
    given.insert_attribute(Domain::Vertex, column("heat", 1, &[f64::INFINITY, 1e300, 0.5])).unwrap();
    let said = losses(&shape(vec![given]));
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(said[0].starts_with("vertex attribute \"heat\": 2 of its numbers are not finite"), "{said:?}");
    assert!(said[1].contains("\"normal\"") && said[1].ends_with("by at most 2e0"), "{said:?}");
    assert!(said[2].contains("\"normal\": 2 of its normals have no direction"), "{said:?}");
    // Units in single precision are as they were.
    let mut plain = triangle(1.0);
    plain.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &[DVec3::X, DVec3::Z, -DVec3::Y])).unwrap();
    assert!(losses(&shape(vec![plain])).is_empty());
}

#[test]
fn further_sets_of_coordinates_and_colours_are_written_as_the_first() {
    let mut given = triangle(1.0);
    let uv = |v: f64| Column::texcoords(TEXCOORD, &[[0.0, v], [1.0, 0.5], [0.25, 1.0]]);
    given.insert_attribute(Domain::Vertex, uv(0.25)).unwrap();
    given.insert_attribute(Domain::Wedge, uv(0.75).renamed("texcoord_1")).unwrap();
    // Beyond a gap, and no number as glTF has it.
    for name in ["texcoord_3", "texcoord_02", "texcoord_0", "texcoord_x"] {
        given.insert_attribute(Domain::Vertex, uv(0.125).renamed(name)).unwrap();
    }
    let bytes = Column::try_new(COLOR, 3, Values::U8(vec![0, 255, 128, 0, 0, 0, 255, 255, 255])).unwrap();
    given.insert_attribute(Domain::Vertex, bytes.clone()).unwrap();
    given.insert_attribute(Domain::Vertex, bytes.renamed("color_1")).unwrap();
    given.insert_attribute(Domain::Vertex, column("color_2", 4, &[0.5; 12])).unwrap();
    let (file, report) = to_glb(&shape(vec![given.clone()])).unwrap();
    assert!(report.losses.is_empty(), "{:?}", report.losses);
    let json = json_of(&file);
    let names: Vec<&String> =
        json["meshes"][0]["primitives"][0]["attributes"].as_object().unwrap().keys().collect::<Vec<_>>();
    assert_eq!(
        names,
        [
            "COLOR_0",
            "COLOR_1",
            "COLOR_2",
            "POSITION",
            "TEXCOORD_0",
            "TEXCOORD_1",
            "_texcoord_0",
            "_texcoord_02",
            "_texcoord_3",
            "_texcoord_x"
        ]
    );
    let (parsed, buffers, _) = ::gltf::import_slice(&file).unwrap();
    let primitive = parsed.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
    let theirs: Vec<[f32; 2]> = reader.read_tex_coords(1).unwrap().into_f32().collect();
    assert_eq!(theirs, [[0.0, 0.25], [1.0, 0.5], [0.25, 0.0]]);
    let linear: Vec<[f32; 3]> = reader.read_colors(1).unwrap().into_rgb_f32().collect();
    assert_eq!(linear, reader.read_colors(0).unwrap().into_rgb_f32().collect::<Vec<_>>());
    assert!((linear[0][2] - 0.215_861).abs() < 1e-6);
    // The same values again under the same names.
    let back = from_glb(&file).shape;
    for name in [TEXCOORD, "texcoord_1", "texcoord_3", "texcoord_02", "texcoord_0", "texcoord_x"] {
        let domain = if name == "texcoord_1" { Domain::Wedge } else { Domain::Vertex };
        let (found, wanted) = (mesh(&back, 0).attribute(Domain::Vertex, name).unwrap(), given.attribute(domain, name));
        let numbers = |column: &Column| -> Vec<f64> { (0..6).map(|i| column.number(i / 2, i % 2)).collect() };
        assert_eq!(numbers(found), numbers(wanted.unwrap()), "{name}");
    }
    // In the order of their names, they stay as they are.
    assert!(from_glb(&to_glb(&back).unwrap().0).shape == back);
}

#[test]
fn what_is_passed_over_in_reading_is_named_once_for_each_kind() {
    let said = |change: fn(&mut Value)| -> Vec<String> {
        document(change).unwrap().losses.into_iter().map(|loss| loss.what).collect()
    };
    assert!(said(|document| document["nodes"][0]["name"] = json!("n")).is_empty());
    assert!(said(|document| document["meshes"][0]["name"] = json!("m")).is_empty());
    let unseen = said(|document| {
        let mesh = document["meshes"][0].clone();
        document["meshes"] = json!([mesh.clone(), mesh.clone(), mesh]);
    });
    assert_eq!(unseen, ["2 meshes"]);
    let mut all = said(|document| {
        document["nodes"] = json!([
            {"mesh": 0, "name": "a", "extensions": {"EXT_b": {}, "EXT_a": {}}, "extras": 1},
            {"mesh": 0, "name": "m", "extensions": {"EXT_a": {}}, "extras": {}},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}}
        ]);
        document["scenes"][0]["nodes"] = json!([0, 1, 2]);
        let mesh = &mut document["meshes"][0];
        mesh["name"] = json!("m");
        mesh["extensions"] = json!({"EXT_m": {}});
        mesh["primitives"][0]["extensions"] = json!({"KHR_materials_variants": {}});
        mesh["primitives"][0]["extras"] = json!(null);
        document["images"] = json!([{"uri": "a.png"}]);
        document["textures"] = json!([{"source": 0}]);
        let texture = json!({"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform": {}}});
        let material = json!({
            "pbrMetallicRoughness": {"baseColorTexture": texture},
            "extensions": {"KHR_materials_unlit": {}},
            "extras": {"a": 1}
        });
        document["materials"] = json!([material.clone(), material, {"pbrMetallicRoughness": {}}]);
    });
    all.sort();
    assert_eq!(
        all,
        [
            "extension EXT_a of nodes",
            "extension EXT_b of nodes",
            "extension EXT_m of meshes",
            "extension KHR_lights_punctual of nodes",
            "extension KHR_materials_unlit of materials",
            "extension KHR_materials_variants of primitives",
            "extension KHR_texture_transform of textures of materials",
            "extras of materials",
            "extras of nodes",
            "extras of primitives",
            "mesh name \"m\"",
            "sets of texture coordinates that textures name",
        ]
    );
    let many = said(|document| {
        document["extensions"] =
            (0..1000).map(|i| (format!("EXT_{i}"), json!({}))).collect::<serde_json::Map<_, _>>().into();
    });
    assert_eq!((many.len(), many[64].as_str()), (65, "936 more extensions"));
}
