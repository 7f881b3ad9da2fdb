//! Triangulation in a plane, through files and beside the other ways of this house.

use std::fs;

use shapeloom::core::glam::DVec3;
use shapeloom::core::{Convert, Exec};
use shapeloom::io::{ReadContext, detect, read};
use shapeloom::judge::Topology;
use shapeloom::mesh::{
    Domain, NORMAL, PlanarRegion, PolyMesh, RegionMethod, TriMesh, TriangulatePolygons, TriangulateRegion,
    newell_vector,
};
use shapeloom::shape::Geometry;

use crate::support::{run, shared_data};

/// An outline with a hole and an island, as lines of an OBJ file.
const OUTLINES: &str = "v 0 0 0\nv 8 0 0\nv 8 8 0\nv 0 8 0\nv 1 1 0\nv 7 1 0\nv 7 7 0\nv 1 7 0\nv 2 2 0\nv 6 2 0\nv 4 6 0\n\
                        l 1 2 3 4 1\nl 5 6 7 8 5\nl 9 10 11 9\n";

#[test]
fn outlines_of_a_file_become_a_plate() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    fs::write(at("outlines.obj"), OUTLINES).expect("a file");
    // Unasked, nothing is made up between lines, and the error says what to ask for.
    let refused = run(&["convert", &at("outlines.obj"), &at("plate.stl")]);
    assert!(refused.code == 4 && refused.err.contains("--method constrained-delaunay"), "{}", refused.err);
    let method = ["--method", "constrained-delaunay", "--set", "keep=enclosed"];
    let plain = run(&[&["convert", &at("outlines.obj"), &at("plate.stl")], &method[..]].concat());
    assert_eq!(plain.code, 0, "{}", plain.err);
    let info = run(&["info", &at("plate.stl"), "--json"]).json();
    assert_eq!(info["area"].as_f64(), Some(64.0 - 36.0 + 8.0));
    let refine = ["--set", "angle=25", "--set", "max_area=0.5", "--json"];
    let refined = run(&[&["convert", &at("outlines.obj"), &at("fine.ply")], &method[..], &refine[..]].concat());
    assert_eq!(refined.code, 0, "{}", refined.err);
    let info = run(&["info", &at("fine.ply"), "--json"]).json();
    assert!((info["area"].as_f64().expect("an area") - 36.0).abs() < 1e-9);
    assert_eq!((info["components"].as_u64(), info["boundary_loops"].as_u64()), (Some(2), Some(3)));
    assert_eq!(info["manifold"].as_bool(), Some(true));
    let figures = refined.json().to_string();
    assert!(figures.contains("smallest_angle") && figures.contains("refinement_complete"), "{figures}");
}

#[test]
fn points_of_every_format_become_terrain() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name).display().to_string();
    let points = [(0, 0, 1), (4, 0, 2), (4, 4, 3), (0, 4, 4), (2, 1, 9), (2, 1, 5)];
    let rows = |start: &str| points.map(|(x, y, z)| format!("{start}{x} {y} {z}\n")).concat();
    let ply = "ply\nformat ascii 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
    let files = [
        ("a.ply", format!("{ply}{}", rows(""))),
        ("a.obj", rows("v ")),
        ("a.off", format!("OFF\n6 0 0\n{}", rows(""))),
    ];
    for (name, words) in files {
        fs::write(at(name), words).expect("a file");
        let made = run(&["convert", &at(name), &at("terrain.glb"), "--method", "delaunay-triangulation", "--force"]);
        assert_eq!(made.code, 0, "{name}: {}", made.err);
        assert!(made.err.contains("W-plane-height") && made.err.contains("point 5"), "{}", made.err);
        let info = run(&["info", &at("terrain.glb"), "--json"]).json();
        assert_eq!((info["vertices"].as_u64(), info["triangles"].as_u64()), (Some(5), Some(4)), "{name}");
    }
    let side = ["--method", "delaunay-triangulation", "--set", "plane=xz", "--force"];
    assert_eq!(run(&[&["convert", &at("a.ply"), &at("terrain.glb")], &side[..]].concat()).code, 0);
    let wrong =
        run(&["convert", &at("a.ply"), &at("b.glb"), "--method", "delaunay-triangulation", "--set", "angle=60"]);
    assert!(wrong.code == 2 && wrong.err.contains("from 0 to 40"), "{}", wrong.err);
}

fn polygons(mesh: &PolyMesh, out: &mut Vec<Vec<DVec3>>) {
    out.extend(
        (0..mesh.face_count()).filter(|&face| mesh.face(face).len() > 3).map(|face| mesh.outline(face).collect()),
    );
}

/// Every polygon of the collection, cut by all three: the same area in the plane of projection, and nothing turned over.
#[test]
fn polygons_of_files_are_cut_alike_by_all_ways() {
    let mut outlines = Vec::new();
    for folder in ["obj", "off", "ply", "synthetic"] {
        let Some(folder) = shared_data(folder) else { return };
        let mut files: Vec<_> =
            fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file").path()).collect();
        files.sort();
        for path in files {
            let Ok(bytes) = fs::read(&path) else { continue };
            let name = path.display().to_string();
            let Ok(format) = detect(&bytes, Some(&name)) else { continue };
            let Ok(found) = read(&bytes, format, &ReadContext::named(name.as_str())) else { continue };
            for part in &found.shape.parts {
                if let Geometry::PolyMesh(mesh) = &*part.geometry {
                    polygons(mesh, &mut outlines);
                }
            }
        }
    }
    // Of a large mesh of small polygons some are enough; the odd ones are in small files.
    let step = outlines.len().div_ceil(6000).max(1);
    let (mut seen, mut plain) = (0, 0);
    for outline in
        outlines.iter().enumerate().filter(|(k, outline)| k % step == 0 || outline.len() > 6).map(|pair| pair.1)
    {
        if outline.iter().any(|point| !point.is_finite()) {
            continue;
        }
        seen += 1;
        let normal = newell_vector(outline.iter().copied());
        let axis = normal.abs().max_position();
        let area = |mesh: &TriMesh| {
            let areas = (0..mesh.triangles().len()).map(|triangle| {
                let [a, b, c] = mesh.corners(triangle);
                ((b - a).cross(c - a)[axis] * normal[axis].signum()).max(f64::MIN)
            });
            areas.clone().for_each(|area| assert!(area >= -1e-12 * normal.length(), "{area}: {outline:?}"));
            areas.sum::<f64>()
        };
        let region = PlanarRegion::try_new(&[outline]).expect("few points");
        let found = [RegionMethod::Delaunay, RegionMethod::Earcut].map(|method| {
            TriangulateRegion { method, ..TriangulateRegion::new() }.convert(&region).expect("finite points")
        });
        let [one, other] = [&found[0], &found[1]].map(|found| area(&found.value));
        assert!((one - other).abs() <= 1e-12 * one.abs(), "{one} {other}: {outline:?}");
        let face =
            PolyMesh::from_faces(outline.clone(), &[(0..outline.len() as u32).collect::<Vec<_>>()]).expect("a face");
        let ears = TriangulatePolygons::new().convert(&face).expect("finite points");
        let simple = ears.report.findings.is_empty() && found[0].report.findings.is_empty();
        if simple && normal.length() > 0.0 {
            plain += 1;
            assert!((area(&ears.value) - one).abs() <= 1e-9 * one, "{outline:?}");
            assert!((one - normal[axis].abs()).abs() <= 1e-9 * one, "{outline:?}");
        }
    }
    assert!(seen > 100 && plain > seen / 2, "{plain} of {seen}");
}

/// What is refined is a disk with holes to the judge as well, and its normals are one.
#[test]
fn the_judge_finds_refined_regions_sound() {
    let square = |low: f64, high: f64| {
        [(low, low), (high, low), (high, high), (low, high)].map(|(x, y)| DVec3::new(x, y, 2.0)).to_vec()
    };
    let region = PlanarRegion::try_new(&[square(0.0, 9.0), square(1.0, 3.0), square(5.0, 6.0)]).expect("few points");
    let refine = TriangulateRegion { angle: 30.0, max_area: 0.2, ..TriangulateRegion::new() };
    let mesh = refine.convert(&region).expect("squares").value;
    let topology = Topology::of(&mesh, &Exec::default()).expect("a small mesh");
    assert!(topology.is_manifold() && topology.components.len() == 1);
    assert_eq!(topology.boundary.len(), 3);
    assert!(mesh.positions().iter().all(|position| position.z == 2.0));
    assert!(mesh.attribute(Domain::Vertex, NORMAL).is_none());
}
