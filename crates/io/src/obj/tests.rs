//! Files taken apart by a small reader of their own.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Report};
use shapeloom_mesh::{
    COLOR, Column, Domain, GeometricGraph, NORMAL, PointCloud, PolyMesh, Polyline, TEXCOORD, TriMesh, Values,
};
use shapeloom_shape::{Material, Part, Shape};

use crate::{WriteContext, detect, format_by_id, write};

#[derive(Default)]
struct Obj {
    v: Vec<Vec<f64>>,
    vt: Vec<Vec<f64>>,
    vn: Vec<Vec<f64>>,
    /// The word, and for each corner its indices from 1; 0 where there is none.
    elements: Vec<(String, Vec<[usize; 3]>)>,
    objects: Vec<String>,
}

fn parse(text: &str) -> Obj {
    let mut obj = Obj::default();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let (word, rest) = line.split_once(' ').unwrap();
        let numbers = || rest.split(' ').map(|number| number.parse().unwrap()).collect();
        match word {
            "v" => obj.v.push(numbers()),
            "vt" => obj.vt.push(numbers()),
            "vn" => obj.vn.push(numbers()),
            "o" => obj.objects.push(rest.to_owned()),
            word => {
                let corner = |text: &str| {
                    let mut indices = text.split('/').map(|index| index.parse().unwrap_or(0));
                    [0; 3].map(|_: usize| indices.next().unwrap_or(0))
                };
                let corners: Vec<[usize; 3]> = rest.split(' ').map(corner).collect();
                let counts = [obj.v.len(), obj.vt.len(), obj.vn.len()];
                assert!(corners.iter().all(|corner| (0..3).all(|i| corner[i] <= counts[i]) && corner[0] > 0));
                obj.elements.push((word.to_owned(), corners));
            }
        }
    }
    obj
}

fn to_obj(shape: &Shape) -> (Obj, Report) {
    let mut out = Vec::new();
    let report = write(shape, format_by_id("obj").unwrap(), &WriteContext::default(), &mut out).unwrap();
    if !shape.parts.is_empty() {
        assert_eq!(detect(&out, None).unwrap().id, "obj");
    }
    (parse(std::str::from_utf8(&out).unwrap()), report)
}

fn square() -> TriMesh {
    let positions = vec![DVec3::new(0.1, 1e300, -0.0), DVec3::X, DVec3::new(1.0, 1.0 / 3.0, 5e-324), DVec3::Y];
    TriMesh::try_new(positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap()
}

#[test]
fn positions_keep_their_bits() {
    let (obj, report) = to_obj(&Shape::new(Part::new(square())));
    assert!(report.losses.is_empty() && obj.objects.is_empty());
    for (found, source) in obj.v.iter().zip(square().positions()) {
        let bits: Vec<u64> = found.iter().map(|number| number.to_bits()).collect();
        assert_eq!(bits, source.to_array().map(f64::to_bits));
    }
    assert_eq!(obj.elements[1], ("f".into(), vec![[1, 0, 0], [3, 0, 0], [4, 0, 0]]));
}

#[test]
fn texture_coordinates_and_normals_are_written_once() {
    let mut mesh = square();
    let uv = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.25, 1.0]];
    mesh.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &uv)).unwrap();
    mesh.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &[DVec3::Z, DVec3::Z, DVec3::X, DVec3::Z])).unwrap();
    let bytes = Values::U8([255, 0, 51].repeat(4));
    mesh.insert_attribute(Domain::Vertex, Column::try_new(COLOR, 3, bytes).unwrap()).unwrap();
    mesh.insert_attribute(Domain::Face, Column::labels("patch", vec![0, 1])).unwrap();
    let part = Part::new(mesh).named(" a\nb ");
    let second = Part { placement: Affine::from_translation(DVec3::X), ..part.clone() }.named("");
    let shape = Shape { parts: vec![part, second], materials: vec![Material::default()], ..Shape::default() };
    let (obj, report) = to_obj(&shape);
    assert_eq!((obj.v.len(), obj.vt.len(), obj.vn.len()), (8, 4, 2));
    assert_eq!(obj.v[0][3..], [1.0, 0.0, 0.2]);
    assert_eq!(obj.elements[0].1, [[1, 1, 1], [2, 2, 1], [3, 3, 2]]);
    assert_eq!(obj.elements[3].1, [[5, 1, 1], [7, 3, 2], [8, 4, 1]]);
    assert_eq!((&obj.vt[3][..], obj.v[5][0]), (&[0.25, 1.0][..], 2.0));
    assert_eq!(obj.objects, ["a_b", "part_1"]);
    let whats: Vec<&str> = report.losses.iter().map(|loss| loss.what.as_str()).collect();
    assert_eq!(
        whats,
        [
            "placements of 1 parts",
            "1 instances of shared geometries",
            "material name \"\"",
            "material \"\"",
            "face attribute \"patch\"",
            "part name \" a\\nb \"",
        ]
    );
}

#[test]
fn polygons_lines_and_points_have_their_words() {
    let points: Vec<DVec3> = (0..4).map(|i| DVec3::new(f64::from(i), 0.0, 0.0)).collect();
    let polygon = PolyMesh::from_faces(points.clone(), &[[0, 1, 2, 3]]).unwrap();
    let mut cloud = PointCloud::new(points[..2].to_vec());
    cloud.insert_attribute(Column::normals(NORMAL, &[DVec3::Z; 2])).unwrap();
    let ring = Polyline::new(points[..3].to_vec(), true);
    let graph = GeometricGraph::try_new(points.clone(), vec![[3, 1], [0, 1]]).unwrap();
    let parts = vec![Part::new(polygon), Part::new(ring), Part::new(cloud), Part::new(graph)];
    let (obj, report) = to_obj(&Shape { parts, ..Shape::default() });
    let words: Vec<(&str, Vec<usize>)> =
        obj.elements.iter().map(|(word, corners)| (word.as_str(), corners.iter().map(|c| c[0]).collect())).collect();
    let lines = [("l", vec![13, 11]), ("l", vec![10, 11])];
    assert_eq!(words[..4], [("f", vec![1, 2, 3, 4]), ("l", vec![5, 6, 7, 5]), ("p", vec![8]), ("p", vec![9])]);
    assert_eq!(words[4..], lines);
    assert_eq!(report.losses[0].what, "vertex attribute \"normal\"");
}
