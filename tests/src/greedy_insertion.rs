//! Height fields to triangles by whole ways: which converter a tolerance chooses, and what it keeps.

use shapeloom::convert::{Job, Wish, convert_shape, plan};
use shapeloom::core::glam::{DVec2, DVec3};
use shapeloom::core::{Affine, Deviation, Exec};
use shapeloom::judge::Topology;
use shapeloom::mesh::HeightField;
use shapeloom::shape::{Geometry, Kind, Part, Shape};

fn terrain() -> HeightField {
    let heights = (0..90 * 70).map(|k| {
        let (x, y) = (f64::from(k % 90) * 0.1, f64::from(k / 90) * 0.1);
        let lake = DVec2::new(x - 5.0, y - 3.0).length() < 1.3;
        if lake { f64::NAN } else { (x * 1.1).sin() * (y * 0.8).cos() + 0.2 * (3.0 * x + y).sin() }
    });
    HeightField::try_new(90, 70, DVec2::splat(0.1), heights.collect()).expect("a grid of the right size")
}

#[test]
fn a_tolerance_chooses_the_adaptive_way_and_a_method_the_regular_one() {
    let placed = Part { placement: Affine::from_scale(DVec3::splat(3.0)), ..Part::new(terrain()) };
    let shape = Shape::new(placed);
    let tolerance = 1e-3 * shape.bounds().diagonal();
    let run = |method: Option<&str>| {
        let wish = Wish { method: method.map(str::to_owned), ..Wish::to([Kind::TriMesh]) };
        let job = Job { wish, tolerance, settings: Vec::new() };
        convert_shape(&shape, &job, &Exec::default()).expect("a sound field")
    };
    let [adaptive, regular] = [None, Some("triangulate-height-field")].map(run);
    assert_eq!(
        [adaptive.steps[0].converter, regular.steps[0].converter],
        ["greedy-insertion", "triangulate-height-field"]
    );
    assert!(adaptive.deviation.is_within(tolerance), "{:?}", adaptive.deviation);
    let figure = |name: &str| adaptive.steps[0].report.find(name).expect("a figure");
    assert!(figure("triangles") * 4.0 < figure("regular_triangles"), "{}", figure("triangles"));
    assert_eq!(Some(figure("regular_triangles")), regular.steps[0].report.find("triangles"));
    let way = plan(Kind::HeightField, &Wish::to([Kind::TriMesh])).expect("a way");
    assert_eq!(way.lossy_steps(), 1);
    // Where the tolerance cannot be reached the deviation says so.
    let job =
        Job { wish: Wish::to([Kind::TriMesh]), tolerance: 0.0, settings: vec![("max_cell_steps".into(), "1".into())] };
    let missed = convert_shape(&shape, &job, &Exec::default()).expect("a sound field");
    assert!(matches!(missed.deviation, Deviation::AtMost(bound) if bound > 0.0));
    assert_eq!(missed.steps[0].report.findings.iter().count(), 1);
}

#[test]
fn the_judge_sees_a_disk_with_the_lake_as_its_hole() {
    let shape = Shape::new(Part::new(terrain()));
    let job = Job { wish: Wish::to([Kind::TriMesh]), tolerance: 0.01, settings: Vec::new() };
    let made = convert_shape(&shape, &job, &Exec::default()).expect("a sound field");
    let Geometry::TriMesh(mesh) = made.shape.parts[0].geometry.as_ref() else { panic!("triangles") };
    let report = Topology::of(mesh, &Exec::default()).expect("a small mesh");
    assert!(report.is_manifold() && report.is_oriented());
    assert_eq!((report.components.len(), report.boundary.len(), report.euler_characteristic()), (1, 2, 0));
}
