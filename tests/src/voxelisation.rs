//! Shapes to voxels and back: how far the surface between samples lies from the shape, by brute force.

use shapeloom::convert::{Wish, plan};
use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Deviation, Exec};
use shapeloom::mesh::primitives::{Cylinder, Platonic, Solid, Sphere, Torus};
use shapeloom::mesh::{PolyMesh, TriMesh, TriangulatePolygons};
use shapeloom::shape::{Geometry, Kind};
use shapeloom::spatial::{InsideRule, SignedDistance};
use shapeloom::voxels::{CellRule, MeshToDistance, VoxelGrid, VoxelizeMesh, VoxelizeMode};

use crate::oracles::{self, Pieces};
use crate::support::Dice;

fn triangles(mesh: &PolyMesh) -> TriMesh {
    TriangulatePolygons::new().convert(mesh).expect("a closed mesh").value
}

fn closed() -> Vec<(&'static str, TriMesh)> {
    let exec = Exec::default();
    let made = |mesh: Result<shapeloom::core::Converted<PolyMesh>, _>| -> TriMesh {
        let mesh: Result<_, shapeloom::core::ConvertError> = mesh;
        triangles(&mesh.expect("a small mesh").value)
    };
    vec![
        ("sphere", made(Sphere { segments: 48, bands: 24, ..Sphere::new() }.mesh(&exec))),
        ("cube", made(Platonic::new(Solid::Cube).mesh(&exec))),
        ("tetrahedron", made(Platonic::new(Solid::Tetrahedron).mesh(&exec))),
        ("torus", made(Torus { segments: 32, sides: 16, ..Torus::new() }.mesh(&exec))),
        ("cylinder", made(Cylinder { segments: 24, ..Cylinder::new() }.mesh(&exec))),
    ]
}

/// The largest distances from the zero set's places to the mesh and from the mesh's places to them, in cells.
fn both_ways(mesh: &TriMesh, grid: &VoxelGrid) -> [f64; 2] {
    let source = Pieces::of(&Geometry::from(mesh.clone())).expect("triangles");
    let surface = oracles::trilinear_surface(grid);
    let mut dice = Dice(5);
    let part = 1500.0 / surface.len() as f64;
    let there = surface.iter().filter(|_| dice.unit() < part).map(|&p| source.distance(p)).fold(0.0, f64::max);
    let samples = source.samples();
    let part = 800.0 / samples.len() as f64;
    let nearest = |p: DVec3| surface.iter().map(|q| q.distance_squared(p)).fold(f64::INFINITY, f64::min).sqrt();
    let back = samples.into_iter().filter(|_| dice.unit() < part).map(nearest).fold(0.0, f64::max);
    [there, back].map(|distance| distance / grid.lattice().spacing().x)
}

/// The zero set lies within half a cell's diagonal of a closed mesh, as is proven, and the mesh within two diagonals of it, as is
/// checked; in truth both are much less.
#[test]
fn the_zero_set_of_distances_stays_near_the_mesh() {
    for (name, mesh) in closed() {
        for resolution in [12, 25] {
            let made = MeshToDistance { resolution, ..MeshToDistance::new() }.convert(&mesh).expect("it is small");
            let [there, back] = both_ways(&mesh, &made.value);
            let Deviation::AtMost(bound) = made.report.deviation else { panic!("{name}: {:?}", made.report) };
            assert!(there <= 0.75f64.sqrt(), "{name} {resolution}: {there} cells");
            let found = back.max(there) * made.value.lattice().spacing().x;
            assert!(found <= bound, "{name} {resolution}: {found} over {bound}");
            // Places on the zero set are a quarter of a cell apart; sharp corners are cut by some tenths.
            assert!(there < 0.45 && back < 1.2, "{name} {resolution}: {there} and {back} cells");
            if name == "sphere" {
                assert!(there < 0.06, "{name} {resolution}: {there}");
            }
        }
    }
}

#[test]
fn the_surface_of_full_cells_stays_near_the_mesh() {
    for (name, mesh) in closed() {
        for rule in [CellRule::Conservative, CellRule::Center] {
            let method = VoxelizeMesh { mode: VoxelizeMode::Solid, rule, resolution: 21, ..VoxelizeMesh::new() };
            let made = method.convert(&mesh).expect("it is small");
            let Deviation::AtMost(bound) = made.report.deviation else { panic!("{name}: {:?}", made.report) };
            let [there, back] = both_ways(&mesh, &made.value).map(|cells| cells * made.value.lattice().spacing().x);
            assert!(there.max(back) <= bound, "{name}: {there} and {back} over {bound}");
        }
    }
}

/// Signs at random samples, beside those of another way to tell them: winding numbers with proven bounds, one by one.
#[test]
fn signs_are_those_of_winding_numbers_one_by_one() {
    let whole = triangles(
        &Torus { segments: 64, sides: 32, ..Torus::new() }.mesh(&Exec::default()).expect("a small torus").value,
    );
    let some = |keep: &dyn Fn(usize) -> bool| {
        let all = whole.triangles().iter().enumerate();
        let kept = all.filter(|(i, _)| keep(*i)).map(|(_, triangle)| *triangle).collect();
        TriMesh::try_new(whole.positions().to_vec(), kept).expect("indices in range")
    };
    let cases = [("closed", whole.clone()), ("open", some(&|i| i % 400 > 90)), ("sparse", some(&|i| i % 7 != 3))];
    for (name, mesh) in cases {
        let made = MeshToDistance { resolution: 48, ..MeshToDistance::new() }.convert(&mesh).expect("it is small");
        let exec = Exec::default();
        let truth = SignedDistance::build(mesh.positions(), mesh.triangles(), &exec).expect("finite");
        assert_eq!(truth.rule(), InsideRule::Positive);
        let lattice = made.value.lattice();
        let mut dice = Dice(1);
        for _ in 0..4000 {
            let at = lattice.coordinates(dice.next() % lattice.samples());
            let (found, wanted) = (made.value.sample(at), truth.distance(lattice.position(at)));
            assert!(wanted.abs() < 1e-12 || (found < 0.0) == (wanted < 0.0), "{name} at {at:?}: {found} {wanted}");
        }
    }
}

/// Patches become voxels by way of triangles where a method names them, and nothing becomes voxels unasked.
#[test]
fn patches_become_voxels_by_way_of_triangles() {
    for method in ["mesh-to-distance", "voxelize-mesh"] {
        let wish = Wish { method: Some(method.to_owned()), ..Wish::to([Kind::VoxelGrid]) };
        let names: Vec<&str> =
            plan(Kind::BezierSurface, &wish).expect("a way").steps.iter().map(|step| step.name).collect();
        assert_eq!(names, ["tessellate-patches", method]);
    }
    for kind in [Kind::BezierSurface, Kind::TriMesh, Kind::PointCloud] {
        assert!(plan(kind, &Wish::to([Kind::VoxelGrid])).is_err(), "{kind}");
    }
}
