//! Files that survive writing and reading.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Affine, Exec, Options};
use shapeloom::io::{ReadContext, WriteContext, format_by_id, read, write};
use shapeloom::mesh::{Domain, NORMAL, TEXCOORD, TriMesh};
use shapeloom::shape::{Geometry, Part, Representation, Shape, UpAxis};

use crate::oracles::triangles;
use crate::shapes;
use crate::support::{data, run, shared_data};

fn written(shape: &Shape, id: &str) -> Vec<u8> {
    let mut bytes = Vec::new();
    let format = format_by_id(id).expect("a format");
    write(shape, format, &WriteContext::default(), &mut bytes).expect("it can be written");
    bytes
}

fn read_again(bytes: &[u8], id: &str) -> Shape {
    read(bytes, format_by_id(id).expect("a format"), &ReadContext::named("again")).expect("it can be read").shape
}

#[test]
fn patches_survive_bpt_to_the_bit() {
    for (_, geometry) in shapes::of_kind(shapeloom::shape::Kind::BezierSurface) {
        let shape = Shape { up: Some(UpAxis::Z), ..Shape::new(Part::new(geometry)) };
        assert_eq!(read_again(&written(&shape, "bpt"), "bpt").parts[0].geometry, shape.parts[0].geometry);
    }
}

/// The teapot from data/, converted by the program: what is in the file by an independent reader.
#[test]
fn an_independent_reader_accepts_the_teapots_glb() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("teapot.glb").display().to_string();
    let done = run(&["convert", &data("teapot.bpt"), &glb, "--tolerance", "0.5%", "--json"]);
    assert_eq!(done.code, 0, "{}", done.err);
    let counts = &done.json()["steps"][0]["report"]["figures"];
    let bytes = std::fs::read(&glb).expect("it was written");
    // Validates every index and reference, and decodes buffers.
    let (document, buffers, _) = gltf::import_slice(&bytes).expect("a valid GLB");
    let mut faces = 0;
    for primitive in document.meshes().flat_map(|mesh| mesh.primitives()) {
        assert_eq!(primitive.mode(), gltf::mesh::Mode::Triangles);
        let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()]));
        let positions: Vec<[f32; 3]> = reader.read_positions().expect("positions").collect();
        let normals: Vec<[f32; 3]> = reader.read_normals().expect("normals").collect();
        let coordinates: Vec<[f32; 2]> = reader.read_tex_coords(0).expect("coordinates").into_f32().collect();
        let indices: Vec<u32> = reader.read_indices().expect("indices").into_u32().collect();
        assert!(normals.len() == positions.len() && coordinates.len() == positions.len());
        assert!(indices.iter().all(|&index| (index as usize) < positions.len()));
        for normal in normals {
            let length = normal.iter().map(|x| f64::from(*x) * f64::from(*x)).sum::<f64>().sqrt();
            assert!((length - 1.0).abs() < 1e-5);
        }
        assert!(coordinates.iter().flatten().all(|t| (0.0..=1.0).contains(t)));
        let bounds = primitive.bounding_box();
        for axis in 0..3 {
            let along = positions.iter().map(|p| p[axis]);
            assert_eq!(along.clone().fold(f32::INFINITY, f32::min), bounds.min[axis]);
            assert_eq!(along.fold(f32::NEG_INFINITY, f32::max), bounds.max[axis]);
        }
        faces += indices.len() / 3;
    }
    assert_eq!(counts["triangles"], faces as f64);
}

/// Triangles as sets of corners, for comparison where vertices were split.
fn corners(mesh: &TriMesh) -> Vec<[DVec3; 3]> {
    triangles(mesh)
}

#[test]
fn meshes_survive_glb_with_normals_coordinates_and_placement() {
    let surface = shapes::bent_patch();
    let converter = shapeloom::parametric::TessellatePatches::new(0.05);
    let surface = shapeloom::parametric::BezierSurface::new(vec![surface]);
    let mesh = shapeloom::core::Convert::convert(&converter, &surface).expect("a bent patch").value;
    assert_eq!(converter.get("normals").expect("an option").to_string(), "true");
    let placement = Affine::from_translation(DVec3::new(1.0, 2.0, 3.0)) * Affine::from_scale(DVec3::splat(2.0));
    let part = Part { placement, ..Part::new(mesh.clone()).named("bent") };
    let shape = Shape { up: Some(UpAxis::Y), ..Shape::new(part) };
    let again = read_again(&written(&shape, "glb"), "glb");
    assert_eq!((again.parts.len(), again.parts[0].name.as_str(), again.up), (1, "bent", Some(UpAxis::Y)));
    let placed = again.parts[0].placed();
    let found = TriMesh::from_geometry(&placed).expect("triangles");
    let wanted = mesh.transformed(&placement);
    assert_eq!(found.triangles().len(), wanted.triangles().len());
    for (found, wanted) in corners(found).iter().zip(corners(&wanted)) {
        assert!((0..3).all(|k| (found[k] - wanted[k]).length() < 1e-5));
    }
    let (normals, coordinates) = (found.attribute(Domain::Vertex, NORMAL), found.attribute(Domain::Vertex, TEXCOORD));
    let (normals, coordinates) = (normals.expect("normals"), coordinates.expect("coordinates"));
    let before = (mesh.attribute(Domain::Wedge, NORMAL), mesh.attribute(Domain::Wedge, TEXCOORD));
    let (own_normals, own_coordinates) = (before.0.expect("normals"), before.1.expect("coordinates"));
    for (wedge, &vertex) in found.triangles().as_flattened().iter().enumerate() {
        assert!((normals.vector(vertex as usize) - own_normals.vector(wedge)).length() < 1e-6);
        for axis in 0..2 {
            let apart = coordinates.number(vertex as usize, axis) - own_coordinates.number(wedge, axis);
            assert!(apart.abs() < 1e-7);
        }
    }
    // What has been through single precision once stays as it is.
    assert_eq!(written(&again, "glb"), written(&read_again(&written(&again, "glb"), "glb"), "glb"));
}

#[test]
fn coordinates_of_five_million_metres_lose_nothing_in_glb() {
    let far = Affine::from_translation(DVec3::new(5e6, -4e6, 3e6));
    let mesh = shapes::tagged_triangles().transformed(&far);
    let shape = Shape { up: Some(UpAxis::Y), ..Shape::new(Part::new(mesh.clone())) };
    let again = read_again(&written(&shape, "glb"), "glb");
    let placed = again.parts[0].placed();
    let found = TriMesh::from_geometry(&placed).expect("triangles");
    for (found, wanted) in corners(found).iter().zip(corners(&mesh)) {
        assert!((0..3).all(|k| (found[k] - wanted[k]).length() < 1e-6));
    }
}

#[test]
fn made_shapes_go_through_every_writer() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for extension in ["glb", "gltf", "ply", "obj", "off", "stl"] {
        for shape in [
            "tetrahedron",
            "cube",
            "octahedron",
            "dodecahedron",
            "icosahedron",
            "sphere",
            "torus",
            "cylinder",
            "cone",
            "grid",
        ] {
            let file = folder.path().join(format!("{shape}.{extension}")).display().to_string();
            let made = run(&["make", shape, &file]);
            assert_eq!(made.code, 0, "{shape} {extension}: {}", made.err);
        }
    }
    let info = run(&["info", &folder.path().join("cube.glb").display().to_string(), "--json"]).json();
    assert!((info["volume"].as_f64().expect("a volume") - 1.0).abs() < 1e-6, "{info}");
    assert!((info["area"].as_f64().expect("an area") - 6.0).abs() < 1e-6);
    let info = run(&["info", &folder.path().join("sphere.glb").display().to_string(), "--json"]).json();
    assert!((info["volume"].as_f64().expect("a volume") / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 0.01);
}

#[test]
fn graphs_survive_gltf_and_are_told_by_info() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let shape = Shape { up: Some(UpAxis::Y), ..Shape::new(Part::new(shapes::letter())) };
    let again = read_again(&written(&shape, "gltf"), "gltf");
    assert_eq!(again.parts[0].geometry, shape.parts[0].geometry);
    let file = folder.path().join("letter.gltf");
    std::fs::write(&file, written(&shape, "gltf")).expect("a temporary file");
    let info = run(&["info", &file.display().to_string(), "--json"]).json();
    assert_eq!((&info["kind"], &info["format"]), (&"geometric-graph".into(), &"gltf".into()));
    assert_eq!((&info["vertices"], &info["edges"]), (&4.into(), &3.into()));
    let length = 1.0 + 2f64.sqrt() + (1.0f64 + 1.0 + 0.25).sqrt();
    assert!((info["parts"][0]["length"].as_f64().expect("a length") - length).abs() < 1e-12, "{info}");
    assert!(info["tables"].as_array().is_some_and(Vec::is_empty) && info["comments"].is_array());
}

/// Real files with known counts, where the collection is there.
#[test]
fn real_glbs_have_their_known_counts() {
    for (name, vertices, faces) in
        [("Box/Box.glb", 24, 12), ("Duck/Duck.glb", 2399, 4212), ("BoxInterleaved.glb", 24, 12), ("nested.glb", 72, 36)]
    {
        let Some(path) = shared_data(&format!("gltf/{name}")) else { continue };
        let info = run(&["info", &path.display().to_string(), "--json"]);
        assert_eq!(info.code, 0, "{name}: {}", info.err);
        let info = info.json();
        assert_eq!((&info["vertices"], &info["triangles"]), (&vertices.into(), &faces.into()), "{name}");
    }
}

#[test]
fn geometry_is_the_same_after_another_placement() {
    let exec = Exec::default();
    let cube = shapeloom::mesh::primitives::Platonic::new(shapeloom::mesh::primitives::Solid::Cube);
    let cube = cube.mesh(&exec).expect("a cube").value;
    let turned = Geometry::from(cube).transformed(&UpAxis::Z.rotation_to(UpAxis::Y));
    let back = turned.transformed(&UpAxis::Y.rotation_to(UpAxis::Z));
    assert_eq!(back.bounds(), back.transformed(&Affine::IDENTITY).bounds());
}
