//! Laws of meshing, on shapes with closed forms.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Aabb, CancelFlag, Category, Convert, Deviation, Exec, Field, Options};
use shapeloom_isosurface::{FieldSlabs, Lattice, Slabs};
use shapeloom_mesh::TriMesh;

use super::*;
use crate::{Program, Tree};

fn program(tree: Tree) -> Program {
    tree.compile().unwrap()
}

fn spread() -> Program {
    let ball = |i: i32| {
        Tree::sphere(0.2 + f64::from(i % 3) * 0.05).translate(f64::from(i % 5) * 0.4, f64::from(i / 5) * 0.4, 0.1)
    };
    let parts = Tree::union_of((0..25).map(ball));
    program(parts.difference(Tree::cuboid(3.0, 0.3, 0.2).translate(1.0, 0.8, 0.1)))
}

#[test]
fn bounds_hold_the_shape_and_little_more() {
    let shapes = [
        (Tree::sphere(1.0), DVec3::ZERO, DVec3::splat(1.0)),
        (Tree::sphere(1e-9).translate(1.0, 2.0, -3.0), DVec3::new(1.0, 2.0, -3.0), DVec3::splat(1e-9)),
        (Tree::cuboid(2.0, 4.0, 6.0).translate(5e6, -3e6, 1e6), DVec3::new(5e6, -3e6, 1e6), DVec3::new(1.0, 2.0, 3.0)),
        (Tree::sphere(1e9), DVec3::ZERO, DVec3::splat(1e9)),
        (Tree::torus(3.0, 0.5), DVec3::ZERO, DVec3::new(3.5, 3.5, 0.5)),
    ];
    for (tree, center, half) in shapes {
        let found = find_bounds(&program(tree.clone()), &Exec::default()).unwrap();
        assert!(found.is_proven(), "{tree:?}");
        let truth = Aabb::from_corners(center - half, center + half);
        assert!(found.bounds.contains(truth.min) && found.bounds.contains(truth.max), "{tree:?} {found:?}");
        let slack = 0.1 * half.max_element();
        assert!((found.bounds.min - truth.min).abs().max_element() < slack, "{tree:?} {found:?}");
        assert!((found.bounds.max - truth.max).abs().max_element() < slack, "{tree:?} {found:?}");
    }
    // Squares of its size are no numbers.
    let speck = find_bounds(&program(Tree::sphere(1e-300)), &Exec::default()).unwrap().bounds;
    assert!(speck.contains(DVec3::ZERO) && speck.diagonal() < 1e-150);
    // x⁴ - 5x² over an infinite box is anything: finite ones tell.
    let quartic = |a: Tree| a.clone().square().square() - a.square() * 5.0;
    let cubes = quartic(Tree::x()) + quartic(Tree::y()) + quartic(Tree::z()) + 10.0;
    let found = find_bounds(&program(cubes), &Exec::default()).unwrap();
    assert!(!found.is_proven() && found.bounds.max.max_element() < 2.7 && found.bounds.contains(DVec3::splat(2.0)));
}

#[test]
fn shapes_without_end_or_matter_are_told() {
    for tree in [
        Tree::plane(DVec3::X, 1.0),
        Tree::sphere(1.0).complement(),
        Tree::circle(1.0),
        Tree::x() * Tree::y() + Tree::z(),
        Tree::constant(-1.0),
        Tree::constant(f64::NAN).minimum(f64::NAN) - Tree::x().square_root(),
    ] {
        let error = SampledSurface::new(0.1).convert(&program(tree.clone())).unwrap_err();
        assert_eq!(error.diagnostic().code(), "E-implicit-unbounded", "{tree:?}");
        assert!(error.diagnostic().advice().unwrap().contains("region="));
    }
    for tree in [
        Tree::constant(1.0),
        Tree::sphere(1.0) + 2.0,
        Tree::sphere(1.0).intersection(Tree::sphere(1.0).translate(9.0, 0.0, 0.0)),
    ] {
        let made = SampledSurface::new(0.1).convert(&program(tree)).unwrap();
        assert!(made.value.triangles().is_empty() && !made.report.findings.is_empty());
    }
}

/// What is left out is never next to a change of sign, and what is not is as it is without leaving out.
#[test]
fn pruned_samples_have_the_same_sign_and_the_same_values_at_crossings() {
    let field = spread();
    let lattice =
        Lattice::along_axes([121, 100, 74], DVec3::new(-0.4, -0.4, -0.4), DVec3::new(0.0205, 0.0215, 0.0145)).unwrap();
    let exec = Exec::default();
    let pruned = PrunedField::sample(&field, lattice, &exec).unwrap();
    assert!(pruned.evaluations() < lattice.samples() * 4 / 5, "{} of {}", pruned.evaluations(), lattice.samples());
    let read = |slabs: &dyn Slabs| {
        let mut buffer = Vec::new();
        (0..74).flat_map(|k| slabs.slab(k, &mut buffer).unwrap().to_vec()).collect::<Vec<f32>>()
    };
    let (ours, all) = (read(&pruned), read(&FieldSlabs::new(&field, lattice)));
    let at = |i: usize, j: usize, k: usize| (k * 100 + j) * 121 + i;
    let mut crossings = 0;
    for k in 0..73 {
        for j in 0..99 {
            for i in 0..120 {
                let corners: [usize; 8] = std::array::from_fn(|c| at(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2)));
                assert_eq!(ours[corners[0]] < 0.0, all[corners[0]] < 0.0);
                if corners.iter().any(|&c| (all[c] < 0.0) != (all[corners[0]] < 0.0)) {
                    crossings += 1;
                    assert!(corners.iter().all(|&c| (ours[c] - all[c]).abs() < 1e-5));
                }
            }
        }
    }
    assert!(crossings > 3000, "{crossings}");
}

#[test]
fn pruning_and_threads_change_no_triangle() {
    let field = spread();
    for method in ["surface-nets", "marching-cubes", "marching-tetrahedra", "dual-contouring"] {
        let mut pruned = SampledSurface::new(0.025);
        pruned.set("method", method).unwrap();
        let all = SampledSurface { prune: false, ..pruned.clone() };
        let (a, b) = (pruned.convert(&field).unwrap(), all.convert(&field).unwrap());
        if method.starts_with("marching") {
            assert!(a.value.triangles() == b.value.triangles(), "{method}");
        }
        // Surface nets cut a square along its shorter diagonal, which rounding decides.
        assert_eq!(a.value.triangles().len(), b.value.triangles().len(), "{method}");
        let apart = |(p, q): (&DVec3, &DVec3)| p.distance(*q);
        let most = a.value.positions().iter().zip(b.value.positions()).map(apart).fold(0.0, f64::max);
        assert!(most < 1e-4, "{method} {most}");
        // Blocks reach beyond the lattice, so of small ones little is saved.
        assert!(a.report.find("evaluations").unwrap() < 1.3 * a.report.find("samples").unwrap());
        let exec = Exec::default().with_threads(shapeloom_core::Threads::Sequential);
        assert!(pruned.convert_with(&field, &exec).unwrap().value == a.value, "{method}");
    }
}

fn errors(tree: &Tree, cell_size: f64, method: SurfaceMethod, volume: f64, area: f64) -> (f64, f64, TriMesh) {
    let converter = SampledSurface { method, ..SampledSurface::new(cell_size) };
    let mesh = converter.convert(&program(tree.clone())).unwrap().value;
    ((mesh.volume() - volume).abs() / volume, (mesh.area() - area).abs() / area, mesh)
}

#[test]
fn measures_converge_with_the_square_of_the_cell() {
    use std::f64::consts::PI;
    let sphere = (Tree::sphere(1.0).translate(0.013, 0.021, -0.017), 4.0 / 3.0 * PI, 4.0 * PI);
    let torus = (Tree::torus(1.0, 0.4), 2.0 * PI * PI * 0.16, 4.0 * PI * PI * 0.4);
    for (tree, volume, area) in [sphere, torus] {
        for method in [
            SurfaceMethod::SurfaceNets,
            SurfaceMethod::MarchingCubes,
            SurfaceMethod::MarchingTetrahedra,
            SurfaceMethod::DualContouring,
        ] {
            let (coarse_volume, coarse_area, _) = errors(&tree, 0.1, method, volume, area);
            let (fine_volume, fine_area, mesh) = errors(&tree, 0.025, method, volume, area);
            assert!(coarse_volume < 0.02 && coarse_area < 0.02, "{method:?} {coarse_volume} {coarse_area}");
            // A quarter of the size is a sixteenth of the error; the lattice lies elsewhere, so a tenth.
            assert!(
                fine_volume < coarse_volume / 10.0 && fine_area < coarse_area / 10.0,
                "{tree:?} {method:?} {coarse_volume} {fine_volume} {coarse_area} {fine_area}"
            );
            let field = program(tree.clone());
            let off = mesh.positions().iter().map(|&p| field.value(p).abs()).filter(|&off| off > 1e-9).count();
            let most = match method {
                // On the edges where crossings are refined, not off them.
                SurfaceMethod::DualContouring => mesh.positions().len(),
                // A few are held by their cells.
                SurfaceMethod::SurfaceNets => mesh.positions().len() / 20,
                _ => 0,
            };
            assert!(off <= most, "{method:?} {off} of {}", mesh.positions().len());
        }
    }
}

#[test]
fn a_box_keeps_its_edges_by_dual_contouring() {
    let tree = Tree::cuboid(1.0, 1.4, 0.6).translate(0.013, 0.007, 0.031);
    let (volume, area, mesh) = errors(&tree, 0.09, SurfaceMethod::DualContouring, 0.84, 2.0 * (1.4 + 0.6 + 0.84));
    assert!(volume < 1e-6 && area < 1e-6, "{volume} {area}");
    let bounds = mesh.bounds();
    assert!((bounds.size() - DVec3::new(1.0, 1.4, 0.6)).abs().max_element() < 1e-6);
}

#[test]
fn deviations_are_near_the_truth() {
    let field = program(Tree::sphere(1.0));
    for cell_size in [0.2, 0.05] {
        let made = SampledSurface::new(cell_size).convert(&field).unwrap();
        let Deviation::Estimated(told) = made.report.deviation else { panic!("{:?}", made.report.deviation) };
        let middle = |t: usize| 1.0 - (made.value.corners(t).into_iter().sum::<DVec3>() / 3.0).length();
        let truth = (0..made.value.triangles().len()).map(middle).fold(0.0, f64::max);
        assert!((told - truth).abs() < 1e-9 && told < cell_size * cell_size, "{told} {truth}");
    }
}

#[test]
fn normals_point_outward_and_have_length_one() {
    let field = program(Tree::torus(1.0, 0.4));
    let converter = SampledSurface { normals: true, ..SampledSurface::new(0.1) };
    let mesh = converter.convert(&field).unwrap().value;
    for (index, &point) in mesh.positions().iter().enumerate() {
        let column = mesh.attribute(shapeloom_mesh::Domain::Vertex, shapeloom_mesh::NORMAL).unwrap();
        let shapeloom_mesh::Values::F64(numbers) = column.values() else { panic!() };
        let normal = DVec3::from_slice(&numbers[3 * index..]);
        let ring = DVec3::new(point.x, point.y, 0.0).normalize();
        assert!((normal - (point - ring) / 0.4).length() < 1e-9);
    }
}

#[test]
fn a_given_region_cuts_the_shape_off() {
    let half = Region::Box(Aabb::from_corners(DVec3::new(-1.3, -1.2, 0.0), DVec3::new(1.2, 1.25, 1.4)));
    let converter = SampledSurface { region: half, ..SampledSurface::new(0.05) };
    let mesh = converter.convert(&program(Tree::sphere(1.0))).unwrap().value;
    assert!((mesh.volume() - 2.0 / 3.0 * std::f64::consts::PI).abs() < 0.01);
    assert_eq!(mesh.bounds().min.z, 0.0);
}

struct Strange(f64);

impl Field for Strange {
    fn value(&self, point: DVec3) -> f64 {
        if point.x > 0.2 { self.0 } else { point.length() - 0.7 }
    }

    fn gradient(&self, _: DVec3) -> DVec3 {
        DVec3::ZERO
    }
}

#[test]
fn bad_input_is_refused_or_told() {
    let ball = program(Tree::sphere(1.0));
    let unit = Aabb::from_corners(DVec3::splat(-1.0), DVec3::ONE);
    for strange in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for method in ["surface-nets", "marching-cubes", "marching-tetrahedra", "dual-contouring"] {
            let mut converter = SampledSurface { region: Region::Box(unit), normals: true, ..SampledSurface::new(0.1) };
            converter.set("method", method).unwrap();
            let made = converter.convert(&Strange(strange)).unwrap();
            assert_eq!(made.report.deviation, Deviation::Unknown);
            assert!(!made.report.findings.is_empty() && made.value.first_non_finite().is_none());
        }
    }
    for text in ["1,1,1,0,0,0", "0,0,0,0,1,1", "NaN,0,0,1,1,1", "0,0,0,inf,1,1", "-1e308,0,0,1e308,1,1"] {
        let mut converter = SampledSurface::new(0.1);
        converter.set("region", text).unwrap();
        assert_eq!(converter.convert(&ball).unwrap_err().diagnostic().code(), "E-implicit-region", "{text}");
    }
    assert!(SampledSurface::new(0.1).set("region", "1,2,3").is_err());
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(SampledSurface::new(size).convert(&ball).unwrap_err().category(), Category::Usage);
    }
    for size in [1e-300, 1e-12, 1e-5] {
        let error = SampledSurface::new(size).convert_with(&ball, &Exec::default().with_memory(1 << 20)).unwrap_err();
        assert_eq!(error.category(), Category::OverLimit, "{size}");
    }
    assert!(SampledSurface::new(1e300).convert(&ball).is_ok());
    let small = Exec::default().with_memory(1 << 20);
    assert_eq!(SampledSurface::new(0.01).convert_with(&ball, &small).unwrap_err().category(), Category::OverLimit);
    let flag = CancelFlag::default();
    flag.cancel();
    let error = SampledSurface::new(0.01).convert_with(&ball, &Exec::default().with_cancel(&flag)).unwrap_err();
    assert_eq!(error.category(), Category::Cancelled);
    for (tree, size) in [(Tree::sphere(1e-9).translate(5e6, 0.0, 0.0), 1e-10), (Tree::sphere(1e150), 1e149)] {
        let made = SampledSurface::new(size).convert(&program(tree));
        // Cells whose volume no number holds make no lattice.
        match made {
            Ok(made) => assert!(made.value.first_non_finite().is_none()),
            Err(error) => assert_eq!(error.category(), Category::Malformed, "{error}"),
        }
    }
}

#[test]
fn regions_come_back_from_text() {
    use shapeloom_core::OptionType;
    for text in ["auto", "-1,0,0.5,1,2,3.25"] {
        assert_eq!(Region::parse(text).unwrap().to_value().to_string(), text);
    }
}
