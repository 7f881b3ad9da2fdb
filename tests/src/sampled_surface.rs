//! Surfaces of implicits, judged.

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Aabb, Convert, Exec};
use shapeloom::implicit::{Region, SampledSurface, SurfaceMethod, Tree, Unary};
use shapeloom::judge::Topology;

/// Balls with a slot; a gyroid cut off by its region, and its shell, which is thin.
#[test]
fn meshes_are_closed_manifolds() {
    let ball = |i: i32| {
        let size = 0.2 + f64::from(i % 3) * 0.05;
        Tree::sphere(size).translate(f64::from(i % 5) * 0.4, f64::from(i / 5) * 0.4, 0.1)
    };
    let balls = Tree::union_of((0..25).map(ball)).difference(Tree::cuboid(3.0, 0.3, 0.2).translate(1.0, 0.8, 0.1));
    let wave = |a: Tree, b: Tree| (a * 4.0).unary(Unary::Sine) * (b * 4.0).unary(Unary::Cosine);
    let gyroid = wave(Tree::x(), Tree::y()) + wave(Tree::y(), Tree::z()) + wave(Tree::z(), Tree::x());
    let region = Region::Box(Aabb::from_corners(DVec3::splat(-1.0), DVec3::ONE));
    for (tree, region) in [(balls, Region::Auto), (gyroid.clone(), region), (gyroid.shell(0.3), region)] {
        let field = tree.compile().expect("a program");
        for method in [SurfaceMethod::SurfaceNets, SurfaceMethod::MarchingCubes] {
            let converter = SampledSurface { region, method, ..SampledSurface::new(0.07) };
            let mesh = converter.convert(&field).expect("a mesh").value;
            let topology = Topology::of(&mesh, &Exec::default()).expect("a report");
            assert!(mesh.triangles().len() > 1000 && mesh.volume() > 0.0);
            assert_eq!(topology.boundary.edges().len(), 0, "{method:?}");
            assert!(topology.non_manifold_edges.is_empty() && topology.non_manifold_vertices.is_empty(), "{method:?}");
        }
    }
}
