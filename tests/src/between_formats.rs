//! Every mesh format to every other, through the program, by standard streams.

use shapeloom::io::{ReadContext, format_by_id, read};

use crate::collection::measured;
use crate::support::{data, run, run_on};

const FORMATS: [&str; 6] = ["off", "obj", "ply", "stl", "glb", "gltf"];

/// A closed surface keeps every triangle, its area and volume on every way.
#[test]
fn every_format_converts_to_every_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Of the cube the size is known, of the sphere the number of triangles.
    for (shape, known) in [("sphere", None), ("cube", Some((12, 6.0, 1.0)))] {
        let mut wanted = known;
        for from in FORMATS {
            let file = folder.path().join(format!("{shape}.{from}")).display().to_string();
            let made = run(&["make", shape, &file]);
            assert_eq!(made.code, 0, "{from}: {}", made.err);
            let bytes = std::fs::read(&file).expect("it was written");
            for to in FORMATS {
                let words = ["convert", "-", "-", "--from", from, "--to", to, "--via", "tri-mesh"];
                let outcome = run_on(&bytes, &words);
                assert_eq!(outcome.code, 0, "{from} to {to}: {}", outcome.err);
                let format = format_by_id(to).expect("a format");
                let read = read(&outcome.out, format, &ReadContext::named("again")).expect("it is read again");
                let (_, faces, area, volume) = measured(&read.shape);
                let (wanted_faces, wanted_area, wanted_volume) = *wanted.get_or_insert((faces, area, volume));
                assert_eq!(faces, wanted_faces, "{from} to {to}");
                assert!((area / wanted_area - 1.0).abs() < 1e-6, "{from} to {to}: area {area}");
                assert!((volume / wanted_volume - 1.0).abs() < 1e-6, "{from} to {to}: volume {volume}");
            }
        }
        let (_, area, volume) = wanted.expect("some shape came through");
        if shape == "sphere" {
            assert!((area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 0.02);
            assert!((volume / (4.0 / 3.0 * std::f64::consts::PI) - 1.0).abs() < 0.02);
        }
    }
}

#[test]
fn soups_stay_soups_where_that_is_asked_for() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("cube.stl").display().to_string();
    assert_eq!(run(&["make", "cube", &file]).code, 0);
    let vertices = |words: &[&str]| {
        let outcome = run(words);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        outcome.json()["vertices"].as_u64().expect("a count")
    };
    assert_eq!(vertices(&["info", &file, "--json"]), 8);
    assert_eq!(vertices(&["info", &file, "--json", "--set", "weld=false"]), 36);
    let off = folder.path().join("soup.off").display().to_string();
    assert_eq!(run(&["convert", &file, &off, "--set", "weld=false"]).code, 0);
    assert_eq!(vertices(&["info", &off, "--json"]), 36);
    let wrong = run(&["info", &off, "--set", "weld=false"]);
    assert!(wrong.code == 2 && wrong.err.contains("expected it for one of: stl"), "{}", wrong.err);
    let wrong = run(&["convert", &file, &off, "--force", "--set", "encoding=morse"]);
    assert!(wrong.code == 2 && wrong.err.contains("automatic"), "{}", wrong.err);
}

#[test]
fn encodings_are_chosen_by_an_option() {
    let teapot = data("teapot.bpt");
    for (to, encoding, head) in [
        ("ply", "ascii", &b"ply\nformat ascii"[..]),
        ("ply", "binary-big-endian", b"ply\nformat binary_big_endian"),
        ("stl", "ascii", b"solid"),
        ("off", "binary", b"OFF BINARY"),
    ] {
        let set = format!("encoding={encoding}");
        let outcome = run(&["convert", &teapot, "-", "--to", to, "--tolerance", "5%", "--set", &set]);
        assert_eq!(outcome.code, 0, "{to}: {}", outcome.err);
        let start = String::from_utf8_lossy(&outcome.out[..40.min(outcome.out.len())]).into_owned();
        assert!(
            start.replace("NOFF", "OFF").replace("STOFF", "OFF").contains(&*String::from_utf8_lossy(head)),
            "{start}"
        );
    }
}

/// What is not finite is an error that names it, and is left out where that is asked for.
#[test]
fn positions_that_are_not_finite_are_dropped_on_request() {
    let square = "OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\nnan 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n3 0 2 4\n";
    let refused = run_on(square.as_bytes(), &["convert", "-", "-", "--from", "off", "--to", "obj"]);
    assert!(refused.code == 3 && refused.err.contains("line 6") && refused.err.contains("nan"), "{}", refused.err);
    assert!(refused.err.contains("--drop-non-finite"), "{}", refused.err);
    let words = ["convert", "-", "-", "--from", "off", "--to", "obj", "--drop-non-finite"];
    let kept = run_on(square.as_bytes(), &words);
    assert_eq!(kept.code, 0, "{}", kept.err);
    assert!(kept.err.contains("W-read-dropped"), "{}", kept.err);
    let text = String::from_utf8(kept.out).expect("text");
    assert_eq!(text.lines().filter(|line| line.starts_with("f ")).collect::<Vec<_>>(), ["f 1 2 3", "f 1 3 4"]);
}

/// Materials of an OBJ are in a library beside it, and come back.
#[test]
fn material_libraries_are_written_and_read_beside_the_file() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(path("a.mtl"), "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n").expect("a library");
    let text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n";
    std::fs::write(path("a.obj"), text).expect("a file");
    for (from, to) in [("a.obj", "b.obj"), ("b.obj", "c.glb"), ("c.glb", "d.gltf"), ("d.gltf", "e.obj")] {
        let done = run(&["convert", &path(from), &path(to)]);
        assert_eq!(done.code, 0, "{from} to {to}: {}", done.err);
    }
    let library = std::fs::read_to_string(path("e.mtl")).expect("a library");
    assert!(library.contains("newmtl red\nKd 1 0 0") && library.contains("newmtl blue\nKd 0 0 1"), "{library}");
    // Nothing is overwritten, neither the file nor its library.
    std::fs::remove_file(path("b.obj")).expect("it was written");
    let again = run(&["convert", &path("a.obj"), &path("b.obj")]);
    assert!(again.code == 6 && again.err.contains("b.mtl"), "{}", again.err);
    assert!(!std::path::Path::new(&path("b.obj")).exists());
}

/// Loose edges and points beside faces do not keep the faces from formats that have only those.
#[test]
fn loose_edges_are_left_out_where_they_have_no_place() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nl 1 4\np 4\n";
    let outcome = run_on(text.as_bytes(), &["convert", "-", "-", "--from", "obj", "--to", "stl"]);
    assert_eq!((outcome.code, outcome.out.len()), (0, 134), "{}", outcome.err);
    assert!(
        outcome.err.contains("lost: part 1, a polyline") && outcome.err.contains("part 2, a point-cloud"),
        "{}",
        outcome.err
    );
    let edges = "v 0 0 0\nv 1 0 0\nl 1 2\n";
    assert_eq!(run_on(edges.as_bytes(), &["convert", "-", "-", "--from", "obj", "--to", "stl"]).code, 4);
}

/// Links that leave the folder, and pipes, which would be waited for, are not opened.
#[cfg(unix)]
#[test]
fn files_beside_the_input_are_regular_and_inside() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    std::fs::create_dir(path("inside")).expect("a folder");
    std::fs::write(path("secret.mtl"), "newmtl secret\n").expect("a file");
    std::os::unix::fs::symlink(path("secret.mtl"), path("inside/link.mtl")).expect("a link");
    std::os::unix::fs::symlink("/dev/zero", path("inside/zero.mtl")).expect("a link");
    let pipe = std::process::Command::new("mkfifo").arg(path("inside/pipe.mtl")).status();
    let mut names = vec!["link.mtl", "zero.mtl"];
    if pipe.is_ok_and(|status| status.success()) {
        names.push("pipe.mtl");
    }
    for name in names {
        std::fs::write(path("inside/a.obj"), format!("mtllib {name}\nv 0 0 0\n")).expect("a file");
        let outcome = run(&["info", &path("inside/a.obj"), "--json"]);
        assert!(outcome.code == 0 && outcome.err.contains("W-obj-library"), "{name}: {}", outcome.err);
        assert!(!String::from_utf8_lossy(&outcome.out).contains("secret\""), "{name}");
    }
}
