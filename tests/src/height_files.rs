//! Height fields from files, through the program: the ways that users go.

use std::fs;

use image::{ImageBuffer, Luma};
use shapeloom::core::glam::DVec3;
use shapeloom::io::{ReadContext, detect, read};
use shapeloom::mesh::TriMesh;
use shapeloom::shape::Representation;

use crate::support::{data, run, run_on};

/// A cone of 16 bits, higher in the north-west than elsewhere.
fn terrain() -> Vec<u8> {
    let picture = ImageBuffer::from_fn(41, 31, |x, y| {
        let far = (f64::from(x) - 10.0).hypot(f64::from(y) - 10.0);
        Luma([(65535.0 * (1.0 - far / 40.0).max(0.0)) as u16])
    });
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageLuma16(picture).write_to(&mut bytes, image::ImageFormat::Png).expect("a picture");
    bytes.into_inner()
}

#[test]
fn a_picture_becomes_a_mesh_as_high_as_asked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(path("terrain.png"), terrain()).expect("a file");
    let (png, glb, drawn) = (path("terrain.png"), path("terrain.glb"), path("drawn.png"));
    let words = ["convert", &png, &glb, "--set", "height=120", "--set", "diagonal=first", "--picture", &drawn];
    let words = [words.as_slice(), &["--method", "triangulate-height-field"]].concat();
    let outcome = run(&words);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(!outcome.err.contains("warning"), "nothing was guessed: {}", outcome.err);
    let picture = image::open(&drawn).expect("a picture").into_rgb8();
    assert!(picture.pixels().collect::<std::collections::HashSet<_>>().len() > 100);
    let bytes = fs::read(&glb).expect("it was written");
    let again = read(&bytes, detect(&bytes, None).expect("a GLB"), &ReadContext::default()).expect("it is read");
    let placed = again.shape.parts[0].placed();
    let mesh = TriMesh::from_geometry(&placed).expect("triangles");
    // The top of the cone is at (10, 30 - 10); glTF has y up, and the north along -z.
    let top = mesh.positions().iter().max_by(|a, b| a.y.total_cmp(&b.y)).expect("a vertex");
    assert_eq!(*top, DVec3::new(10.0, 120.0, -20.0));
    assert_eq!((mesh.positions().len(), mesh.triangles().len()), (41 * 31, 2 * 40 * 30));
    assert!(shapeloom::mesh::face_normals(mesh).iter().all(|normal| normal.y > 0.0), "fronts look up");
    // Beside it the one that is guessed, and said to be.
    let guessed = run(&["info", &png, "--json"]);
    assert!(guessed.err.contains("W-heights-scale") && guessed.err.contains("--set height"), "{}", guessed.err);
    let guessed = guessed.json();
    assert_eq!(
        (&guessed["kind"], &guessed["samples"], &guessed["holes"]),
        (&"height-field".into(), &1271.into(), &0.into())
    );
    assert_eq!((&guessed["parts"][0]["highest"], &guessed["up"]), (&4.0.into(), &"z".into()));
    assert_eq!(run(&["render", &png, &path("r.png"), "--set", "height=9", "--size", "64x48"]).code, 0);
    let same = run(&["compare", &png, &glb, "--set", "height=120", "--json"]);
    assert_eq!(same.code, 0, "{}", same.err);
    let same = same.json();
    // The picture is cut into triangles within a thousandth of its diagonal to be compared.
    assert!(same["hausdorff"]["lower"].as_f64().expect("a bound") < 0.13, "{same}");
    let none = run(&["compare", &glb, &glb, "--set", "height=120"]);
    assert!(none.code == 2 && none.err.contains("png"), "{}", none.err);
}

#[test]
fn options_of_reading_are_told_from_those_of_converters_and_of_shapes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(path("terrain.png"), terrain()).expect("a file");
    let png = path("terrain.png");
    for (setting, code, word) in [
        ("heigth=120", 2, "height"),
        ("hight=120", 2, "height"),
        ("spaceing=2", 2, "spacing"),
        ("diagnal=first", 2, "diagonal"),
        ("encodng=grey", 2, "encoding"),
        ("colour=red", 2, "E-plan-option"),
        ("height=tall", 2, "number"),
        ("height=nan", 2, "E-option-range"),
        ("spacing=-1", 2, "E-option-range"),
        ("encoding=morse", 2, "expected one of"),
        ("encoding=mapbox", 3, "E-heights-channels"),
        ("weld=false", 2, "stl"),
    ] {
        let outcome = run(&["convert", &png, &path("no.glb"), "--set", setting]);
        assert!(outcome.code == code && outcome.err.contains(word), "{setting}: {} {}", outcome.code, outcome.err);
    }
    // The same word for reading a picture and for writing a mesh.
    let words = ["convert", &png, "-", "--to", "ply", "--set", "encoding=grey", "--set", "encoding=ascii"];
    let both = run(&words);
    assert!(both.code == 0 && both.out.starts_with(b"ply\nformat ascii"), "{}", both.err);
    let words = ["convert", &png, "-", "--to", "ply", "--set", "read.height=7", "--set", "write.encoding=ascii"];
    assert_eq!(run(&words).code, 0);
    // A cone has a height of its own.
    assert_eq!(run(&["make", "cone", &path("cone.ply"), "--set", "height=7"]).code, 0);
    let cone = run(&["info", &path("cone.ply"), "--json"]).json();
    let (low, high) = (&cone["bounds"]["min"][2], &cone["bounds"]["max"][2]);
    assert_eq!(high.as_f64().expect("a number") - low.as_f64().expect("a number"), 7.0);
    // Heights of a file that has them are multiplied, not set.
    let dem = data("mount_st_helens.dem");
    let set = run(&["info", &dem, "--set", "height=9"]);
    assert!(set.code == 2 && set.err.contains("png"), "{}", set.err);
    let twice = run(&["info", &dem, "--set", "exaggeration=2", "--json"]).json();
    assert_eq!(twice["parts"][0]["highest"], 5086.0);
}

/// The elevation model in data/ through every format that holds heights.
#[test]
fn the_mountain_survives_every_format_of_heights() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (dem, asc, png) = (data("mount_st_helens.dem"), path("m.asc"), path("m.png"));
    let told = run(&["info", &dem, "--json"]).json();
    assert_eq!((&told["samples"], &told["holes"]), (&152_382.into(), &3497.into()));
    assert_eq!((&told["parts"][0]["lowest"], &told["parts"][0]["highest"]), (&682.0.into(), &2543.0.into()));
    assert_eq!(told["unit_in_meters"], 1.0);
    let exact = run(&["convert", &dem, &asc, "--strict", "--json"]);
    assert_eq!(exact.json()["deviation"]["kind"], "exact", "{}", exact.err);
    let again = run(&["info", &asc, "--json"]).json();
    for key in ["bounds", "samples", "holes"] {
        assert_eq!(again[key], told[key], "{key}");
    }
    let same = run(&["convert", &asc, "-", "--to", "asc"]);
    assert_eq!(same.out, fs::read(&asc).expect("it was written"));
    let steps = run(&["convert", &dem, &png, "--json"]).json();
    let bound = steps["deviation"]["value"].as_f64().expect("a bound");
    assert!((bound - (2543.0 - 682.0) / 65535.0 / 2.0).abs() < 1e-9, "{steps}");
    let again = run(&["convert", &png, &path("again.asc"), "--json"]);
    assert!(again.code == 0 && !again.err.contains("W-heights"), "{}", again.err);
    let heights = |bytes: &[u8]| -> Vec<f64> {
        let text = String::from_utf8_lossy(bytes).into_owned();
        text.lines().skip(6).flat_map(|line| line.split(' ')).map(|word| word.parse().expect("a number")).collect()
    };
    let (wanted, found) = (heights(&same.out), heights(&fs::read(path("again.asc")).expect("it was written")));
    assert_eq!(wanted.len(), found.len());
    assert!(wanted.iter().zip(&found).all(|(wanted, found)| (wanted - found).abs() <= bound));
    // From a stream, by its content.
    let bytes = fs::read(&dem).expect("data/mount_st_helens.dem is in the repository");
    assert_eq!(run_on(&bytes, &["info", "-", "--json"]).json()["format"], "dem");
}

#[test]
fn triangles_of_a_grid_have_the_area_of_its_cells() {
    let text = "ncols 3\nnrows 2\nxllcenter 0\nyllcenter 0\ncellsize 1\n0 0 3\n0 0 0\n";
    let way = ["--method", "triangulate-height-field", "--set", "diagonal=second"];
    let outcome = run_on(text.as_bytes(), &[&["convert", "-", "-", "--to", "off"][..], &way].concat());
    let mesh =
        read(&outcome.out, detect(&outcome.out, None).expect("OFF"), &ReadContext::default()).expect("it is read");
    let placed = mesh.shape.parts[0].placed();
    let mesh = TriMesh::from_geometry(&placed).expect("triangles");
    // A flat cell; a flat triangle; and one with the corner (2, 1, 3), whose sides have the cross product (-3, -3, 1).
    let area = 1.0 + 0.5 + 0.5 * 19f64.sqrt();
    assert!((mesh.area() - area).abs() < 1e-12, "{}", mesh.area());
}

#[test]
fn what_is_no_height_field_is_no_png() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    assert_eq!(run(&["make", "cube", &path("cube.ply")]).code, 0);
    let outcome = run(&["convert", &path("cube.ply"), &path("cube.png")]);
    assert!(outcome.code == 4 && outcome.err.contains("shapeloom render"), "{}", outcome.err);
    let made = run(&["make", "cube", &path("made.png")]);
    assert!(made.code == 4 && made.err.contains("E-plan-no-way"), "{} {}", made.code, made.err);
}
