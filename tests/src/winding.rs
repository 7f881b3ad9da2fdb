//! Winding numbers and signed distances of real files: closed meshes against the judge's exact crossings of a ray, which
//! share nothing but the predicates.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{ClosestPoint, Convert, Exec};
use shapeloom::judge::{Location, Solid};
use shapeloom::mesh::{TriMesh, TriangulatePolygons};
use shapeloom::shape::Geometry;
use shapeloom::spatial::{InsideRule, SignedDistance, WindingTree, generalized_winding_number};

use crate::collection::read_file;
use crate::support::{Dice, shared_data};

/// Closed meshes without self-intersections, faces outward.
const CLOSED: [&str; 10] = [
    "off/3holes.off",
    "off/ballA.off",
    "off/fandisk_quads.off",
    "off/fertility.off",
    "obj/spot_low_resolution.obj",
    "obj/torus.obj",
    "obj/wingnut.obj",
    "ply/bob_small.ply",
    "stl/65004.stl",
    "synthetic/slab_genus_9.obj",
];

fn triangles(name: &str) -> Option<TriMesh> {
    let path = shared_data(name)?;
    let shape = read_file(&path).unwrap_or_else(|error| panic!("{name}: {error}")).shape;
    let part = shape.parts.first().unwrap_or_else(|| panic!("{name}: no part"));
    Some(match &*part.geometry {
        Geometry::TriMesh(mesh) => mesh.clone(),
        Geometry::PolyMesh(mesh) => TriangulatePolygons::new().convert(mesh).expect("triangles").value,
        _ => panic!("{name}: no mesh"),
    })
}

/// Points in the box around a mesh, half as wide again, and points beside its surface.
fn places(mesh: &TriMesh, count: usize) -> Vec<DVec3> {
    let mut dice = Dice(7);
    let bounds = mesh.bounds();
    let mut point = || DVec3::new(dice.unit(), dice.unit(), dice.unit()) - DVec3::splat(0.5);
    let around = (0..count).map(|_| bounds.center() + point() * bounds.size() * 1.5).collect::<Vec<_>>();
    let step = mesh.triangles().len() as f64 / count as f64;
    let beside = (0..count).map(|i| {
        let [a, b, c] = mesh.corners((i as f64 * step) as usize % mesh.triangles().len());
        (a + b + c) / 3.0 + point() * bounds.diagonal() * 10f64.powi(-1 - (i % 6) as i32)
    });
    around.into_iter().chain(beside).collect()
}

#[test]
fn closed_meshes_wind_as_often_as_exact_crossings_say() {
    let exec = Exec::default();
    for name in CLOSED {
        let Some(mesh) = triangles(name) else {
            return;
        };
        let distance = SignedDistance::build(mesh.positions(), mesh.triangles(), &exec).expect(name);
        assert!(distance.is_closed(), "{name}");
        let solid = Solid::new(&mesh, &exec).expect(name);
        let mut inside = 0;
        for query in places(&mesh, 250) {
            let Location::Off { winding } = solid.locate(query).expect(name) else {
                panic!("{name} {query}: on the surface");
            };
            let wanted = winding as f64;
            assert_eq!(distance.distance(query) < 0.0, winding == 1, "{name} {query}: {winding}");
            let exact = distance.winding().winding_number_exact(query);
            assert!((exact.value - wanted).abs() <= exact.bound && exact.bound < 1e-6, "{name} {query}: {exact:?}");
            let within = distance.winding().winding_number_within(query, 0.1);
            assert!((within.value - wanted).abs() <= within.bound && within.bound <= 0.1, "{name} {query}: {within:?}");
            let fast = distance.winding().winding_number(query);
            assert!((fast - wanted).abs() < 0.02, "{name} {query}: {fast}");
            inside += usize::from(winding == 1);
        }
        assert!(inside > 30, "{name}: {inside}");
    }
}

#[test]
fn shells_flips_and_bottles_have_the_winding_numbers_of_their_parts() {
    let exec = Exec::default();
    let Some(inside_out) = triangles("synthetic/cube_inside_out.obj") else {
        return;
    };
    let center = inside_out.bounds().center();
    let build = |mesh: &TriMesh| SignedDistance::build(mesh.positions(), mesh.triangles(), &exec).expect("a mesh");
    let exact = |mesh: &TriMesh, query| {
        generalized_winding_number(mesh.positions(), mesh.triangles(), query, &exec).expect("a mesh").value
    };
    assert!((exact(&inside_out, center) + 1.0).abs() < 1e-14);
    assert!(build(&inside_out).distance(center) > 0.0);
    assert!(build(&inside_out).with_rule(InsideRule::NonZero).distance(center) < 0.0);
    // One of twelve triangles flipped: from the centre two twelfths are missing.
    let flipped = triangles("synthetic/cube_one_flipped.obj").expect("a file of the collection");
    assert!((exact(&flipped, flipped.bounds().center()) - 10.0 / 12.0).abs() < 1e-14);
    assert!(!build(&flipped).is_closed() && build(&flipped).distance(flipped.bounds().center()) < 0.0);
    let nested = triangles("synthetic/nested_cubes.obj").expect("a file of the collection");
    let center = nested.bounds().center();
    assert!(exact(&nested, center).abs() < 1e-14 && build(&nested).distance(center) > 0.0);
    assert!(build(&nested).distance(center + DVec3::X * nested.bounds().size().x * 0.4) < 0.0);
    let klein = triangles("synthetic/klein_24x12.off").expect("a file of the collection");
    let bottle = build(&klein);
    assert!(!bottle.is_closed());
    for query in places(&klein, 100) {
        let (exact, found) = (exact(&klein, query), bottle.winding().winding_number_within(query, 1e-3));
        assert!(
            (found.value - exact).abs() <= found.bound + 1e-10 && found.bound <= 1e-3,
            "{query}: {found:?} {exact}"
        );
        let closest = bottle.bvh().closest(query).expect("triangles");
        let away = closest.point.distance(query);
        assert!((bottle.distance(query).abs() - away).abs() <= 1e-13 * (1.0 + away));
    }
}

/// Figures of libigl 2.6.3 (`igl.winding_number`, exact) for spot_low_resolution.obj without every third triangle.
#[test]
fn another_program_finds_the_same_numbers() {
    let Some(mesh) = triangles("obj/spot_low_resolution.obj") else {
        return;
    };
    let kept: Vec<[u32; 3]> =
        mesh.triangles().iter().copied().enumerate().filter(|(i, _)| i % 3 != 0).map(|(_, t)| t).collect();
    let tree = WindingTree::build(mesh.positions(), &kept, &Exec::default()).expect("a mesh");
    for (query, wanted) in PEER {
        let query = DVec3::from_array(query);
        assert!((tree.winding_number_exact(query).value - wanted).abs() < 1e-13, "{query}");
        let found = tree.winding_number_within(query, 1e-5);
        assert!((found.value - wanted).abs() <= found.bound && found.bound <= 1e-5, "{query}: {found:?}");
        assert!((tree.winding_number(query) - wanted).abs() < 6e-3, "{query}");
    }
}

const PEER: [([f64; 3], f64); 6] = [
    ([0.0, 0.25, 0.25], 0.6616995067863226),
    ([0.1, -0.2, 0.5], 0.6586758176365934),
    ([0.05, 0.5, -0.4], 0.6694520161242955),
    ([0.3, 0.1, 0.0], -0.008177490877068427),
    ([0.0, 0.9, -0.5], 0.036080706090286074),
    ([-0.6, 1.5, 1.0], 0.00020326017162147834),
];
