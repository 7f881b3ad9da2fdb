//! Points without edges.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::predicates::{in_circle, orient2d};
use shapeloom_core::{Convert, Exec, Threads};

use super::{Dice, count_of, edges, flat, is_sound, raised, twice_area};
use crate::{Column, DelaunayTriangulation, Domain, MeshError, PointCloud, ProjectionPlane, TriMesh, Values};

fn triangulated(points: &[DVec2]) -> TriMesh {
    DelaunayTriangulation::new().convert(&PointCloud::new(raised(points))).unwrap().value
}

/// Point sets of every kind that is awkward.
pub(in crate::plane) fn sets() -> Vec<(&'static str, Vec<DVec2>)> {
    let mut dice = Dice(3);
    let mut many = |count: usize, f: &mut dyn FnMut(&mut Dice) -> DVec2| (0..count).map(|_| f(&mut dice)).collect();
    let unit = 2f64.powi(-50);
    vec![
        ("random", many(300, &mut |dice| DVec2::new(dice.unit(), dice.unit()))),
        ("whole numbers", many(300, &mut |dice| DVec2::new(dice.whole(500), dice.whole(500)))),
        ("grid", (0..256).map(|k| DVec2::new(f64::from(k % 16), f64::from(k / 16))).collect()),
        ("few places", many(300, &mut |dice| DVec2::new(dice.whole(5), dice.whole(5)))),
        (
            "clusters",
            many(300, &mut |dice| {
                let center = DVec2::new(dice.whole(2), dice.whole(2));
                center + DVec2::new(dice.unit(), dice.unit()) * 1e-9
            }),
        ),
        (
            "nearly on a line",
            many(200, &mut |dice| {
                let along = dice.unit();
                DVec2::new(0.5 + along, 0.5 + along + dice.whole(2) * unit)
            }),
        ),
        ("on a line but for one", {
            let line = (0..150).map(|k| DVec2::new(f64::from(k), 2.0 * f64::from(k)));
            line.chain([DVec2::new(40.0, 3.0)]).collect()
        }),
        (
            "on a circle",
            // Pythagorean: 65² = 16² + 63² = 33² + 56² = 25² + 60² = 39² + 52².
            [(16, 63), (33, 56), (25, 60), (39, 52), (0, 65)]
                .into_iter()
                .flat_map(|(a, b)| [(a, b), (b, a)])
                .flat_map(|(a, b)| [(a, b), (-a, b), (a, -b), (-a, -b)])
                .map(|(a, b)| DVec2::new(f64::from(a), f64::from(b)))
                .collect(),
        ),
        ("far away", many(200, &mut |dice| DVec2::new(5e6 + dice.unit(), -5e6 + dice.unit()))),
    ]
}

/// The definition of the Delaunay triangulation, by brute force, and what follows from Euler's formula.
#[test]
fn no_point_lies_within_the_circle_of_a_triangle() {
    for (name, points) in sets() {
        let mesh = triangulated(&points);
        let at = flat(&mesh);
        let hull = is_sound(&mesh);
        let mut distinct: Vec<_> = points.iter().map(|p| [p.x.to_bits(), p.y.to_bits()]).collect();
        distinct.sort_unstable();
        distinct.dedup();
        let count = distinct.len();
        assert_eq!(at.len(), count, "{name}");
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| at[vertex as usize]);
            assert!(at.iter().all(|&p| in_circle(a, b, c, p).is_le()), "{name}: {triangle:?}");
        }
        // The border is the convex hull, points on its sides included.
        let all = edges(&mesh);
        for (&[a, b], apexes) in all.iter().filter(|(_, apexes)| apexes.len() == 1) {
            let [p, q, apex] = [a, b, apexes[0]].map(|vertex| at[vertex as usize]);
            let side = orient2d(p, q, apex);
            assert!(at.iter().all(|&other| orient2d(p, q, other) == side || orient2d(p, q, other).is_eq()), "{name}");
        }
        assert_eq!(all.len(), 3 * count - 3 - hull, "{name}");
        assert_eq!(mesh.triangles().len(), 2 * count - 2 - hull, "{name}");
    }
}

/// The same circles, and the area, in whole numbers of 128 bits, which share nothing with the predicates.
#[test]
fn whole_numbers_agree() {
    for name in ["whole numbers", "grid", "on a circle"] {
        let points = sets().into_iter().find(|set| set.0 == name).unwrap().1;
        let mesh = triangulated(&points);
        let at: Vec<[i128; 2]> = flat(&mesh).iter().map(|p| [p.x as i128, p.y as i128]).collect();
        for triangle in mesh.triangles() {
            let corners = triangle.map(|vertex| at[vertex as usize]);
            for d in &at {
                let [a, b, c] = corners.map(|p| [p[0] - d[0], p[1] - d[1]]);
                let square = |p: [i128; 2]| p[0] * p[0] + p[1] * p[1];
                let minor = |p: [i128; 2], q: [i128; 2]| p[0] * q[1] - p[1] * q[0];
                let within = square(a) * minor(b, c) + square(b) * minor(c, a) + square(c) * minor(a, b);
                assert!(within <= 0, "{name}");
            }
        }
        assert_eq!(twice_area(&mesh), twice_hull_area(at), "{name}");
    }
}

/// Andrew's monotone chain.
fn twice_hull_area(mut points: Vec<[i128; 2]>) -> i128 {
    points.sort_unstable();
    let turn = |a: [i128; 2], b: [i128; 2], c: [i128; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let chain = |points: &mut dyn Iterator<Item = [i128; 2]>| {
        let mut chain: Vec<[i128; 2]> = Vec::new();
        for point in points {
            while chain.len() > 1 && turn(chain[chain.len() - 2], chain[chain.len() - 1], point) <= 0 {
                chain.pop();
            }
            chain.push(point);
        }
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.pop();
    hull.extend(chain(&mut points.iter().rev().copied()));
    (2..hull.len()).map(|k| turn(hull[0], hull[k - 1], hull[k])).sum()
}

#[test]
fn triangles_are_the_same_at_any_size() {
    for (name, points) in sets() {
        let wanted = triangulated(&points);
        // About 1e-300 and 1e150; by powers of two no number is rounded.
        for exponent in [-996, -500, 498, 900] {
            let factor = 2f64.powi(exponent);
            let scaled: Vec<DVec2> = points.iter().map(|&point| point * factor).collect();
            let found = triangulated(&scaled);
            assert_eq!(found.triangles(), wanted.triangles(), "{name}, 2^{exponent}");
            assert!(found.positions().iter().zip(wanted.positions()).all(|(p, q)| *p == *q * factor));
        }
    }
}

#[test]
fn of_points_at_one_place_the_first_is_kept_and_the_others_are_told() {
    let places =
        [(0.0, 0.0, 1.0), (4.0, 0.0, 2.0), (0.0, 4.0, 3.0), (4.0, 0.0, 9.0), (0.0, 4.0, 3.0), (-0.0, 0.0, 1.0)];
    let mut cloud = PointCloud::new(places.map(DVec3::from).to_vec());
    cloud.insert_attribute(Column::labels("id", vec![0, 1, 2, 3, 4, 5])).unwrap();
    let converted = DelaunayTriangulation::new().convert(&cloud).unwrap();
    assert_eq!(converted.value.positions(), &cloud.positions()[..3]);
    assert_eq!(converted.value.attribute(Domain::Vertex, "id").unwrap().values(), &Values::U32(vec![0, 1, 2]));
    let findings = &converted.report.findings;
    assert_eq!((count_of(findings, "W-plane-height"), count_of(findings, "W-plane-duplicate")), (1, 2));
    let place = findings.iter().find(|finding| finding.code == "W-plane-height").unwrap().places[0].to_string();
    assert_eq!(place, "point 3");
    assert_eq!(converted.report.find("points"), Some(6.0));
}

#[test]
fn planes_look_along_their_axis_and_keep_every_bit() {
    let mut dice = Dice(8);
    let points: Vec<DVec3> = (0..50).map(|_| DVec3::new(dice.unit(), dice.unit(), dice.unit())).collect();
    let cloud = PointCloud::new(points.clone());
    let axes = [(ProjectionPlane::Xy, DVec3::Z), (ProjectionPlane::Xz, DVec3::Y), (ProjectionPlane::Yz, DVec3::X)];
    for (plane, axis) in axes {
        let mesh = DelaunayTriangulation { plane, ..DelaunayTriangulation::new() }.convert(&cloud).unwrap().value;
        assert_eq!(mesh.positions(), points);
        for triangle in 0..mesh.triangles().len() {
            let [a, b, c] = mesh.corners(triangle);
            assert!((b - a).cross(c - a).dot(axis) > 0.0);
        }
    }
    // A tilted plane: its triangles are those of the plane itself.
    let (u, v) = (DVec3::new(2.0, 1.0, 2.0) / 3.0, DVec3::new(-2.0, 2.0, 1.0) / 3.0);
    let flat: Vec<DVec2> = points.iter().map(|point| point.truncate()).collect();
    let tilted = flat.iter().map(|p| u * p.x + v * p.y + DVec3::splat(7.0)).collect();
    let fit = DelaunayTriangulation { plane: ProjectionPlane::Fit, ..DelaunayTriangulation::new() };
    let found = fit.convert(&PointCloud::new(tilted)).unwrap().value;
    let sorted = |mesh: &TriMesh| {
        let mut triangles: Vec<[u32; 3]> = mesh.triangles().to_vec();
        triangles.iter_mut().for_each(|triangle| triangle.sort_unstable());
        triangles.sort_unstable();
        triangles
    };
    assert_eq!(sorted(&found), sorted(&triangulated(&flat)));
}

#[test]
fn what_makes_no_triangle_is_told() {
    let line: Vec<DVec3> = (0..5000).map(|k| DVec3::new(f64::from(k), 3.0 * f64::from(k), f64::from(k % 7))).collect();
    for points in [vec![DVec3::ONE], vec![DVec3::ONE; 9], line.clone(), vec![DVec3::ZERO, DVec3::Z, DVec3::Z * 2.0]] {
        let converted = DelaunayTriangulation::new().convert(&PointCloud::new(points.clone())).unwrap();
        assert_eq!((converted.value.positions(), converted.value.triangles().len()), (&points[..], 0));
        assert_eq!(count_of(&converted.report.findings, "W-plane-collinear"), 1);
    }
    let nothing = DelaunayTriangulation::new().convert(&PointCloud::default()).unwrap();
    assert!(nothing.value.positions().is_empty() && nothing.report.findings.is_empty());
    for odd in [f64::NAN, f64::INFINITY] {
        let mut points = line.clone();
        points[70].z = odd;
        let error = DelaunayTriangulation::new().convert(&PointCloud::new(points)).unwrap_err();
        assert_eq!(error.narrow(), Some(&MeshError::NotFinite { kind: "point", index: 70 }));
    }
}

/// Coordinates that no product could hold beside the others are taken as 0, which is told; nothing moves.
#[test]
fn coordinates_that_vanish_are_told() {
    let points = [(0.0, 0.0), (1.0, 0.0), (1e-200, 1.0), (0.0, 1.0), (1e-300, 0.5)];
    let points: Vec<DVec3> = points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let converted = DelaunayTriangulation::new().convert(&PointCloud::new(points.clone())).unwrap();
    assert_eq!(count_of(&converted.report.findings, "W-plane-tiny"), 2);
    assert_eq!(count_of(&converted.report.findings, "W-plane-height"), 1);
    let kept: Vec<DVec3> = [0, 1, 2, 4].map(|k| points[k]).to_vec();
    assert_eq!((converted.value.positions(), converted.value.triangles().len()), (&kept[..], 2));
}

#[test]
fn the_caller_alone_gives_the_same_bits_as_a_pool() {
    let mut dice = Dice(12);
    let points: Vec<DVec2> = (0..20_000).map(|_| DVec2::new(dice.unit(), dice.unit())).collect();
    let cloud = PointCloud::new(raised(&points));
    let alone = Exec::default().with_threads(Threads::Sequential);
    let wanted = DelaunayTriangulation::new().convert_with(&cloud, &alone).unwrap();
    assert!(DelaunayTriangulation::new().convert(&cloud).unwrap() == wanted);
}
