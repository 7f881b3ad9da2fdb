//! Angles and areas that are asked for.

use shapeloom_core::Convert;
use shapeloom_core::glam::{DVec2, DVec3};

use super::{Dice, count_of, edges, flat, is_sound, raised};
use crate::{
    Column, ConstrainedDelaunay, DelaunayTriangulation, Domain, GeometricGraph, KeptTriangles, PlanarRegion,
    PointCloud, TriMesh, TriangulateRegion, Values,
};

/// The smallest angle in degrees and the largest area, from the mesh alone.
fn worst(mesh: &TriMesh) -> (f64, f64) {
    let mut worst = (180.0f64, 0.0f64);
    for triangle in 0..mesh.triangles().len() {
        let corners = mesh.corners(triangle);
        for k in 0..3 {
            let (u, v) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
            worst.0 = worst.0.min(u.cross(v).length().atan2(u.dot(v)).to_degrees());
            worst.1 = worst.1.max(u.cross(v).length() / 2.0);
        }
    }
    worst
}

fn plate() -> PlanarRegion {
    let circle = |center: DVec2, radius: f64, count: u32| -> Vec<DVec3> {
        let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(count);
        (0..count).map(|k| (center + DVec2::from_angle(angle(k)) * radius).extend(0.0)).collect()
    };
    let outline = [(0.0, 0.0), (10.0, 0.0), (10.0, 3.0), (4.0, 3.0), (4.0, 8.0), (0.0, 8.0)];
    let outline: Vec<DVec3> = outline.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let loops = [outline, circle(DVec2::new(8.0, 1.5), 1.0, 24), circle(DVec2::new(2.0, 6.0), 1.2, 40)];
    PlanarRegion::try_new(&loops).unwrap()
}

#[test]
fn the_angle_wanted_is_reached_and_the_area_stays() {
    let plain = TriangulateRegion::new().convert(&plate()).unwrap().value;
    for (angle, area) in [(20.0, 0.0), (28.0, 0.0), (30.0, 0.05), (0.0, 0.01), (33.0, 0.0)] {
        let refine = TriangulateRegion { angle, max_area: area, ..TriangulateRegion::new() };
        let converted = refine.convert(&plate()).unwrap();
        let mesh = &converted.value;
        let boundary = is_sound(mesh);
        let (least, largest) = worst(mesh);
        assert!(
            least >= angle - 1e-9 && (area == 0.0 || largest <= area * (1.0 + 1e-12)),
            "{angle}: {least} {largest}"
        );
        assert!((mesh.area() - plain.area()).abs() < 1e-12 * plain.area(), "{angle}");
        assert_eq!(converted.report.find("refinement_complete"), Some(1.0));
        assert!((converted.report.find("smallest_angle").unwrap() - least).abs() < 1e-9);
        let added = mesh.positions().len() - plain.positions().len();
        assert_eq!(converted.report.find("vertices_added"), Some(added as f64), "{angle}");
        // A region with two holes: V - E + F = -1; so 2 E = 3 F + boundary.
        assert_eq!(2 * (mesh.positions().len() + 1), mesh.triangles().len() + boundary, "{angle}");
        assert_eq!(mesh.positions()[..plain.positions().len()], *plain.positions());
        assert!(added < 4000, "{angle}: {added}");
    }
}

/// Vertices are added on edges only where that is allowed; what may not be split stays an edge.
#[test]
fn edges_are_split_only_when_that_is_allowed() {
    let refine = TriangulateRegion { angle: 25.0, max_area: 0.3, split_edges: false, ..TriangulateRegion::new() };
    let converted = refine.convert(&plate()).unwrap();
    let all = edges(&converted.value);
    for [a, b] in plate().sides() {
        assert!(all.contains_key(&[a.min(b), a.max(b)]), "{a} {b}");
    }
    assert_eq!(converted.report.find("edges_split"), Some(0.0));
    assert_eq!(
        count_of(&converted.report.findings, "W-refine-blocked") > 0,
        converted.report.find("refinement_complete") == Some(0.0)
    );
    assert_eq!(is_sound(&converted.value), plate().sides().len());
    let split = TriangulateRegion { split_edges: true, ..refine }.convert(&plate()).unwrap();
    assert!(split.report.find("edges_split").unwrap() > 0.0 && is_sound(&split.value) > plate().sides().len());
}

/// The borders of a refined cloud and graph are their hull and edges; heights and attributes on a plane stay on it.
#[test]
fn added_vertices_lie_on_the_triangles_that_were_there() {
    let mut dice = Dice(4);
    let height = |p: DVec2| 3.0 * p.x - 2.0 * p.y + 1.0;
    let flat_points: Vec<DVec2> = (0..200).map(|_| DVec2::new(dice.unit(), dice.unit())).collect();
    let points: Vec<DVec3> = flat_points.iter().map(|&p| p.extend(height(p))).collect();
    let mut cloud = PointCloud::new(points.clone());
    let twice = flat_points.iter().map(|&p| 2.0 * height(p)).collect();
    cloud.insert_attribute(Column::try_new("twice", 1, Values::F64(twice)).unwrap()).unwrap();
    let plain = DelaunayTriangulation::new().convert(&cloud).unwrap().value;
    let refine = DelaunayTriangulation { angle: 28.0, max_area: 0.002, ..DelaunayTriangulation::new() };
    let converted = refine.convert(&cloud).unwrap();
    let mesh = &converted.value;
    is_sound(mesh);
    assert_eq!(mesh.positions()[..200], points);
    assert!(mesh.positions().len() > 400, "{}", mesh.positions().len());
    let twice = mesh.attribute(Domain::Vertex, "twice").unwrap();
    for (vertex, position) in mesh.positions().iter().enumerate() {
        let wanted = height(position.truncate());
        assert!((position.z - wanted).abs() < 1e-13 && (twice.number(vertex, 0) - 2.0 * wanted).abs() < 1e-12);
    }
    let flattened = |mesh: &TriMesh| TriMesh::try_new(raised(&flat(mesh)), mesh.triangles().to_vec()).unwrap();
    assert!((flattened(mesh).area() - flattened(&plain).area()).abs() < 1e-13);
    let (least, largest) = worst(&flattened(mesh));
    assert!(least >= 28.0 - 1e-9 && largest <= 0.002 * (1.0 + 1e-12), "{least} {largest}");
}

/// Edges that meet in 2 degrees, and in a fan of 5: refinement ends, and is as good as can be elsewhere.
#[test]
fn small_angles_of_the_input_do_not_run_away() {
    let fan: Vec<DVec3> = std::iter::once(DVec3::ZERO)
        .chain((0..9).map(|k| {
            let length = 5.0 + f64::from(k % 3);
            (DVec2::from_angle(f64::from(k * 5).to_radians()) * length).extend(0.0)
        }))
        .collect();
    let spokes = (1..10).map(|k| [0, k]).chain((1..9).map(|k| [k, k + 1])).collect();
    let needle = vec![DVec3::ZERO, DVec3::new(10.0, 0.0, 0.0), DVec3::new(10.0, 0.35, 0.0), DVec3::new(10.0, 6.0, 0.0)];
    let wedges = vec![[0, 1], [0, 2], [1, 2], [2, 3], [3, 0]];
    for (points, edges) in [(fan, spokes), (needle, wedges)] {
        let graph = GeometricGraph::try_new(points, edges).unwrap();
        for keep in [KeptTriangles::Enclosed, KeptTriangles::Everything] {
            let refine = ConstrainedDelaunay { keep, angle: 25.0, ..ConstrainedDelaunay::new() };
            let converted = refine.convert(&graph).unwrap();
            is_sound(&converted.value);
            assert!(converted.report.find("vertices_added").unwrap() < 500.0, "{:?}", converted.report);
            assert_eq!(converted.report.find("refinement_complete"), Some(1.0), "{:?}", converted.report);
            let sharp = converted.report.find("triangles_at_small_angles").unwrap();
            let mesh = &converted.value;
            let below = (0..mesh.triangles().len()).filter(|&triangle| {
                let alone = TriMesh::try_new(mesh.corners(triangle).to_vec(), vec![[0, 1, 2]]).unwrap();
                worst(&alone).0 < 25.0 - 1e-9
            });
            assert_eq!(below.count() as f64, sharp);
            assert_eq!(count_of(&converted.report.findings, "W-refine-angle") as f64, sharp);
        }
    }
}

#[test]
fn the_limit_on_vertices_holds_and_is_told() {
    for most in [0, 1, 57] {
        let refine = TriangulateRegion { angle: 30.0, max_area: 1e-300, max_added: most, ..TriangulateRegion::new() };
        let converted = refine.convert(&plate()).unwrap();
        is_sound(&converted.value);
        assert_eq!(converted.report.find("vertices_added"), Some(f64::from(most)));
        assert_eq!(converted.report.find("refinement_complete"), Some(0.0));
        assert_eq!(count_of(&converted.report.findings, "W-refine-limit"), 1);
    }
    // Around the origin there are numbers however small, but no end to vertices.
    let letter = [(0.0, 0.0), (0.0, 1.0), (1.0, 2.0), (-1.0, 2.0)].map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let letter = GeometricGraph::try_new(letter, vec![[0, 1], [1, 2], [3, 1]]).unwrap();
    let tiny = ConstrainedDelaunay { max_area: 1e-300, max_added: 20_000, ..ConstrainedDelaunay::new() };
    is_sound(&tiny.convert(&letter).unwrap().value);
    // Wishes that cannot be granted end all the same.
    let greedy = TriangulateRegion { angle: 40.0, max_added: 3000, ..TriangulateRegion::new() };
    is_sound(&greedy.convert(&plate()).unwrap().value);
}

/// A grid that was turned: its straight borders are straight but for rounding. Triangles along them would be as flat as
/// rounding, and are left out.
#[test]
fn flat_triangles_at_the_hull_are_left_out() {
    for (offset, size) in [(0.0, 1.0), (5e6, 1.0), (0.3, 1e-9)] {
        let at = |k: u32| DVec2::from_angle(0.4).rotate(DVec2::new(f64::from(k % 12), f64::from(k / 12))) * size;
        let points: Vec<DVec2> = (0..120).map(|k| at(k) + offset).collect();
        let cloud = PointCloud::new(raised(&points));
        let plain = DelaunayTriangulation::new().convert(&cloud).unwrap().value;
        let refine = DelaunayTriangulation { angle: 30.0, ..DelaunayTriangulation::new() };
        let converted = refine.convert(&cloud).unwrap();
        is_sound(&converted.value);
        assert_eq!(converted.report.find("refinement_complete"), Some(1.0), "{offset}");
        assert!(converted.report.find("smallest_angle").unwrap() > 30.0 && plain.triangles().len() >= 198);
        let left_out = count_of(&converted.report.findings, "W-refine-flat");
        assert_eq!(converted.value.triangles().len() as u64 + left_out, plain.triangles().len() as u64, "{offset}");
        assert!((converted.value.area() - 99.0 * size * size).abs() < 1e-7 * size * size);
    }
}

#[test]
fn refined_triangles_are_the_same_at_any_size() {
    let refine = TriangulateRegion { angle: 28.0, ..TriangulateRegion::new() };
    let wanted = refine.convert(&plate()).unwrap().value;
    for exponent in [-960, -60, 498] {
        let factor = 2f64.powi(exponent);
        let loops: Vec<Vec<DVec3>> =
            plate().loops().map(|points| points.iter().map(|&p| p * factor).collect()).collect();
        let found = refine.convert(&PlanarRegion::try_new(&loops).unwrap()).unwrap().value;
        assert_eq!(found.triangles(), wanted.triangles(), "2^{exponent}");
        assert!(found.positions().iter().zip(wanted.positions()).all(|(p, q)| *p == *q * factor), "2^{exponent}");
    }
}
