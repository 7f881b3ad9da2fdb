//! Shapes of every kind to try things on.

use shapeloom::core::glam::{DMat3, DVec2, DVec3};
use shapeloom::core::{Aabb, Affine, Exec};
use shapeloom::implicit::{Implicit, Tree};
use shapeloom::io::{ReadContext, format_by_id, read};
use shapeloom::isosurface::Lattice;
use shapeloom::mesh::primitives::{Cylinder, Platonic, Solid, Torus};
use shapeloom::mesh::{Column, Domain, GeometricGraph, HeightField, PointCloud, PolyMesh, Polyline, TriMesh};
use shapeloom::parametric::{BezierCurve, BezierPatch, BezierSurface};
use shapeloom::shape::{Geometry, Kind};
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};

use crate::support::{Dice, data};

/// Newell's teapot from data/.
pub fn teapot() -> Geometry {
    let name = data("teapot.bpt");
    let bytes = std::fs::read(&name).expect("data/teapot.bpt is in the repository");
    let format = format_by_id("bpt").expect("BPT is a format");
    let shape = read(&bytes, format, &ReadContext::named(name)).expect("the teapot is sound").shape;
    (*shape.parts[0].geometry).clone()
}

/// A patch of degrees 3 x 2 that is bent in both directions and twisted.
pub fn bent_patch() -> BezierPatch {
    let net = (0..12).map(|k| {
        let (i, j) = (f64::from(k % 4), f64::from(k / 4));
        DVec3::new(i + 0.3 * j, j - 0.2 * i, (i * 1.3).sin() + 0.5 * i * j)
    });
    BezierPatch::try_new(3, 2, net.collect()).expect("a finite net of the right size")
}

pub fn curve() -> BezierCurve<DVec3> {
    let control = [(0.0, 0.0, 0.0), (2.0, 3.0, 0.0), (4.0, -2.0, 1.0), (5.0, 0.0, 3.0), (3.0, 1.0, 4.0)];
    BezierCurve::try_new(control.map(DVec3::from).to_vec()).expect("finite control points")
}

pub fn hills() -> HeightField {
    let heights = (0..12 * 9)
        .map(|k| {
            let (i, j) = (f64::from(k % 12), f64::from(k / 12));
            if k == 40 { f64::NAN } else { (i * 0.7).sin() * (j * 0.9).cos() }
        })
        .collect();
    HeightField::try_new(12, 9, DVec2::new(0.5, 0.4), heights).expect("a grid of the right size")
}

/// Distances to a ball that the border cuts, on a lattice that is neither cubic nor along the axes.
pub fn cut_ball() -> VoxelGrid {
    let steps = [DVec3::new(0.3, 0.1, 0.0), DVec3::new(-0.1, 0.25, 0.0), DVec3::new(0.0, 0.0, 0.4)];
    let linear = DMat3::from_cols(steps[0], steps[1], steps[2]);
    let placement = Affine { linear, translation: DVec3::new(3.0, -1.0, 2.0) };
    let lattice = Lattice::try_new([12, 10, 9], placement).expect("three directions");
    let center = lattice.position([7, 5, 3]);
    let samples = (0..lattice.samples())
        .map(|at| (lattice.position(lattice.coordinates(at)).distance(center) - 1.4) as f32)
        .collect();
    VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance)
        .expect("as many samples as the lattice has")
}

/// Random full and empty cells.
pub fn random_cells() -> VoxelGrid {
    let lattice = Lattice::along_axes([7, 6, 5], DVec3::ZERO, DVec3::ONE).expect("a lattice");
    let mut dice = Dice(4);
    let samples = (0..lattice.samples()).map(|_| u8::from(dice.unit() < 0.4)).collect();
    VoxelGrid::try_new(lattice, Samples::U8(samples), Quantity::Occupancy).expect("as many samples as the lattice has")
}

/// Three edges that meet in a vertex.
pub fn letter() -> GeometricGraph {
    let positions = vec![DVec3::ZERO, DVec3::Y, DVec3::new(1.0, 2.0, 0.0), DVec3::new(-1.0, 2.0, 0.5)];
    GeometricGraph::try_new(positions, vec![[0, 1], [1, 2], [3, 1]]).expect("edges between vertices that exist")
}

/// Points of a hilly country, some of them over the same place.
pub fn scattered() -> PointCloud {
    let mut dice = Dice(31);
    let mut points: Vec<DVec3> = (0..400)
        .map(|_| {
            let (x, y) = (4.0 * dice.unit(), 3.0 * dice.unit());
            DVec3::new(x, y, (2.0 * x).sin() * y.cos())
        })
        .collect();
    points.extend([points[3] + DVec3::Z, points[4]]);
    let mut cloud = PointCloud::new(points);
    cloud.insert_attribute(Column::labels("tag", (0..402).collect())).expect("a label for each");
    cloud
}

/// A closed line that crosses itself.
pub fn pentagram() -> Polyline {
    let corner = |k: u32| DVec2::from_angle(0.8 * std::f64::consts::PI * f64::from(k));
    Polyline::new((0..5).map(|k| corner(k).extend(1.0)).collect(), true)
}

/// Streets that cross at different heights, meet and overlap.
pub fn crossroads() -> GeometricGraph {
    let streets = (0..12u32).flat_map(|k| {
        let (along, across) = (f64::from(k % 6), f64::from(k % 4) * 0.1);
        match k < 6 {
            true => [DVec3::new(along, -1.0, 0.0), DVec3::new(along + across, 6.0, 1.0)],
            false => [DVec3::new(-1.0, along, 0.5), DVec3::new(6.0, along - across, 0.2)],
        }
    });
    let edges = (0..12).map(|k| [2 * k, 2 * k + 1]).chain([[0, 2], [0, 1]]).collect();
    GeometricGraph::try_new(streets.collect(), edges).expect("edges between vertices that exist")
}

/// A closed polygon mesh with labels on every kind of element.
pub fn tagged_polygons() -> PolyMesh {
    let mut mesh = Cylinder { segments: 24, ..Cylinder::new() }.mesh(&Exec::default()).expect("a small cylinder").value;
    let count = |domain: Domain| mesh.attributes().of(domain).len() as u32;
    let sizes = [Domain::Vertex, Domain::Face, Domain::Wedge].map(|domain| (domain, count(domain)));
    for (domain, size) in sizes {
        mesh.insert_attribute(domain, Column::labels("tag", (0..size).collect())).expect("a label for each");
    }
    mesh
}

/// A closed triangle mesh with labels on every kind of element, and each corner of each triangle a vertex of its own.
pub fn tagged_triangles() -> TriMesh {
    let torus = Torus { segments: 20, sides: 10, ..Torus::new() }.mesh(&Exec::default()).expect("a small torus").value;
    let mut positions = Vec::new();
    for face in torus.faces() {
        for corner in [0, 1, 2, 0, 2, 3] {
            positions.push(torus.positions()[face[corner] as usize]);
        }
    }
    let count = positions.len() as u32;
    let triangles = (0..count / 3).map(|face| [3 * face, 3 * face + 1, 3 * face + 2]).collect();
    let mut mesh = TriMesh::try_new(positions, triangles).expect("a soup is a mesh");
    for (domain, size) in [(Domain::Vertex, count), (Domain::Face, count / 3), (Domain::Wedge, count)] {
        mesh.insert_attribute(domain, Column::labels("tag", (0..size).collect())).expect("a label for each");
    }
    mesh
}

/// A block with a hole and a ring, joined softly.
pub fn part() -> Implicit {
    let block = Tree::cuboid(2.0, 1.5, 1.0).difference(Tree::cylinder(0.4, 2.0));
    Implicit::new(block.smooth_union(Tree::torus(0.9, 0.2).named("ring"), 0.3)).expect("sound parameters")
}

/// A ball that its box cuts.
fn ball() -> Implicit {
    let region = Aabb::from_corners(DVec3::new(-1.0, -1.2, -1.2), DVec3::new(0.5, 1.2, 1.2));
    Implicit::new(Tree::sphere(1.0)).expect("a sound radius").within(region).expect("a sound box")
}

/// Small shapes of a kind, with what each is called.
pub fn of_kind(kind: Kind) -> Vec<(&'static str, Geometry)> {
    let cube = || Platonic::new(Solid::Dodecahedron).mesh(&Exec::default()).expect("a dodecahedron").value;
    match kind {
        Kind::PointCloud => vec![
            ("points", PointCloud::new(vec![DVec3::ZERO, DVec3::ONE]).into()),
            ("scattered points", scattered().into()),
            ("nothing", PointCloud::default().into()),
        ],
        Kind::BezierCurve => vec![("curve", curve().into())],
        Kind::BezierSurface => vec![
            ("teapot", teapot()),
            ("bent patch", BezierSurface::new(vec![bent_patch()]).into()),
            ("nothing", BezierSurface::default().into()),
        ],
        Kind::Polyline => vec![
            ("polyline", Polyline::new(vec![DVec3::ZERO, DVec3::X, DVec3::ONE], true).into()),
            ("pentagram", pentagram().into()),
            ("nothing", Polyline::default().into()),
        ],
        Kind::GeometricGraph => vec![
            ("letter Y", letter().into()),
            ("crossroads", crossroads().into()),
            ("nothing", GeometricGraph::default().into()),
        ],
        Kind::HeightField => vec![("hills", hills().into())],
        Kind::Implicit => vec![("part with a hole", part().into()), ("ball in a box", ball().into())],
        Kind::VoxelGrid => vec![("cut ball", cut_ball().into()), ("random cells", random_cells().into())],
        Kind::PolyMesh => vec![
            ("tagged cylinder", tagged_polygons().into()),
            ("dodecahedron", cube().into()),
            ("nothing", PolyMesh::default().into()),
        ],
        Kind::TriMesh => vec![("tagged soup", tagged_triangles().into()), ("nothing", TriMesh::default().into())],
        other => panic!("no shape of kind {other} to try things on: add one here"),
    }
}
