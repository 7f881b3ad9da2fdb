//! Inputs that once went wrong: each stays here as a test.

use std::fs;

use shapeloom::core::glam::DVec3;
use shapeloom::io::{WriteContext, format_by_id, write};
use shapeloom::mesh::TriMesh;
use shapeloom::shape::{Part, Shape};

use crate::support::{data, run, run_on};

fn glb(shape: &Shape) -> Vec<u8> {
    let mut bytes = Vec::new();
    let format = format_by_id("glb").expect("a format");
    write(shape, format, &WriteContext::default(), &mut bytes).expect("it can be written");
    bytes
}

/// A small file with many instances of one mesh must not take more memory than allowed to draw.
#[test]
fn instances_do_not_outgrow_the_budget() {
    let positions = (0..30_000).map(|k| DVec3::new(f64::from(k % 173), f64::from(k / 173), 0.0)).collect();
    let triangles = (0..9_999).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let part = Part::new(TriMesh::try_new(positions, triangles).expect("a soup"));
    let shape = Shape { parts: vec![part; 500], ..Shape::default() };
    let outcome = run_on(&glb(&shape), &["render", "-", "-", "--size", "20x20", "--max-memory", "100M"]);
    assert!(outcome.code == 7 && outcome.err.contains("E-memory-budget"), "{} {}", outcome.code, outcome.err);
}

/// Of a buffer's file no more is read than the buffer declares, however often it is named.
#[test]
fn files_that_a_gltf_names_are_read_as_far_as_declared() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("large.bin"), vec![0u8; 8 << 20]).expect("a file");
    let buffer = r#"{"byteLength":4,"uri":"large.bin"}"#;
    let text = format!(r#"{{"asset":{{"version":"2.0"}},"buffers":[{}]}}"#, vec![buffer; 20].join(","));
    let name = folder.path().join("m.gltf");
    fs::write(&name, text).expect("a file");
    let read = bytes_asked_for(&name.display().to_string());
    assert!(read <= 20 * 4, "{read} bytes were kept of files of 8 MiB");
}

/// The bytes that the reader asks for of the files beside a glTF.
fn bytes_asked_for(name: &str) -> u64 {
    use shapeloom::io::{ReadContext, SiblingError, SiblingName, Siblings, read};
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU64, Ordering};

    struct Counting(Arc<AtomicU64>);
    impl Siblings for Counting {
        fn open(&self, _: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
            self.0.fetch_add(max_bytes, Ordering::Relaxed);
            Ok(vec![0; max_bytes.min(1 << 20) as usize])
        }
    }
    let asked = Arc::new(AtomicU64::new(0));
    let context = ReadContext { siblings: Some(Arc::new(Counting(Arc::clone(&asked)))), ..ReadContext::named(name) };
    let bytes = fs::read(name).expect("a file");
    let _ = read(&bytes, format_by_id("gltf").expect("a format"), &context);
    asked.load(Ordering::Relaxed)
}

/// Shapes without size need no scale where no step needs a tolerance.
#[test]
fn shapes_without_size_are_converted() {
    let point = TriMesh::try_new(vec![DVec3::ONE; 3], vec![[0, 1, 2]]).expect("a mesh");
    for shape in [Shape::new(Part::new(point)), Shape::new(Part::new(TriMesh::default()))] {
        let outcome = run_on(&glb(&shape), &["convert", "-", "-", "--to", "obj"]);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
    }
    let nothing = run_on(b"0\n", &["convert", "-", "-", "--from", "bpt", "--to", "obj"]);
    assert!(nothing.code == 0 && nothing.err.contains("W-bpt-empty"), "{}", nothing.err);
    let patch = b"1\n1 1\n1 2 3\n1 2 3\n1 2 3\n1 2 3\n";
    let outcome = run_on(patch, &["convert", "-", "-", "--to", "obj"]);
    assert!(outcome.code == 2 && outcome.err.contains("E-tolerance-scale"), "{}", outcome.err);
}

#[test]
fn what_a_made_shape_lacks_of_the_exact_one_counts() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let coarse = ["make", "sphere", &file("a.obj"), "--set", "segments=3", "--set", "bands=2"];
    let told = run(&[&coarse[..], &["--json"]].concat()).json();
    assert_eq!(told["within_tolerance"], false);
    assert!(told["deviation"]["value"].as_f64().expect("a bound") > 0.5);
    let strict = run(&["make", "sphere", &file("b.obj"), "--set", "segments=3", "--set", "bands=2", "--strict"]);
    assert!(strict.code == 5 && !folder.path().join("b.obj").exists(), "{}", strict.err);
    let strict = run(&["render", &data("teapot.bpt"), &file("c.png"), "--set", "chord_tolerance=1", "--strict"]);
    assert!(strict.code == 5 && strict.err.contains("E-strict-tolerance"), "{}", strict.err);
}

#[test]
fn tiny_and_huge_made_shapes_are_whole_or_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    for (index, edge) in ["1e-100", "1e-50", "1e50", "1e100"].into_iter().enumerate() {
        let name = file(&format!("{index}.obj"));
        assert_eq!(run(&["make", "icosahedron", &name, "--set", &format!("edge={edge}")]).code, 0);
        let faces =
            fs::read_to_string(&name).expect("it was written").lines().filter(|line| line.starts_with("f ")).count();
        assert_eq!(faces, 20, "{edge}");
    }
    // Single precision has nothing left of this: the loss is as large as the shape, and said.
    let told = run(&["make", "sphere", &file("tiny.glb"), "--set", "radius=1e-90", "--json"]).json();
    assert!(told["deviation"]["value"].as_f64().expect("a bound") >= 1e-90, "{told}");
    for radius in ["1e300", "1e-300", "1.7e308"] {
        let outcome = run(&["make", "sphere", &file("x.obj"), "--set", &format!("radius={radius}")]);
        assert_eq!(outcome.code, 2, "{}", outcome.err);
        assert!(outcome.err.len() < 200, "numbers of hundreds of digits: {}", outcome.err);
    }
}

#[test]
fn two_spellings_of_one_output_are_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let (teapot, name, same) = (data("teapot.bpt"), file("a.png"), file("./new/../a.png"));
    for force in [&["--force"][..], &[]] {
        let words = [&["convert", &teapot, &name, "--to", "obj", "--picture", &same], force].concat();
        let outcome = run(&words);
        assert!(outcome.code == 2 && outcome.err.contains("E-usage-outputs"), "{}", outcome.err);
    }
    assert_eq!(fs::read_dir(folder.path()).expect("a folder").count(), 0);
    let outcome = run(&["render", &data("teapot.bpt"), &file("a.jpg")]);
    assert!(outcome.code == 4 && outcome.err.contains("E-picture-format"), "{}", outcome.err);
}

#[cfg(unix)]
#[test]
fn devices_are_written_through_links_followed_and_modes_kept() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let teapot = data("teapot.bpt");
    let outcome = run(&["convert", &teapot, "/dev/null", "--to", "obj", "--tolerance", "5%"]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(fs::metadata("/dev/null").expect("a device").file_type().is_char_device());

    let folder = tempfile::tempdir().expect("a temporary folder");
    let (file, link) = (folder.path().join("real.obj"), folder.path().join("link.obj"));
    fs::write(&file, "old").expect("a file");
    fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).expect("a mode");
    symlink(&file, &link).expect("a link");
    let name = link.display().to_string();
    assert_eq!(run(&["convert", &teapot, &name, "--tolerance", "5%"]).code, 6);
    let outcome = run(&["convert", &teapot, &name, "--tolerance", "5%", "--force"]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(link.symlink_metadata().expect("a link").is_symlink());
    assert!(fs::read_to_string(&file).expect("a file").contains("v "));
    assert_eq!(file.metadata().expect("a file").permissions().mode() & 0o777, 0o600);
}
