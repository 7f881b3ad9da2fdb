//! The command line's contract: streams, JSON, exit codes, errors, whole outputs.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::support::{data, run, run_on};

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// The README's main command, at a size that tests can afford, twice in a row.
#[test]
fn the_main_job_works_twice_in_a_row() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("new/folder");
    let file = |name: &str| out.join(name).display().to_string();
    let (teapot, glb, png) = (data("teapot.bpt"), file("teapot.glb"), file("teapot.png"));
    for _ in 0..2 {
        let words = ["convert", &teapot, &glb, "--tolerance", "0.5%", "--picture", &png, "--force"];
        let outcome = run(&words);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        assert!(outcome.out.is_empty(), "data goes to standard output, words to standard error");
        assert!(outcome.err.contains("tessellate-patches") && outcome.err.contains("proven"), "{}", outcome.err);
    }
    assert_eq!(names(&out), ["teapot.glb", "teapot.png"]);
    let picture = image::load_from_memory(&fs::read(&png).expect("a picture")).expect("a PNG");
    assert_eq!((picture.width(), picture.height()), (1280, 960));
    let again = run(&["convert", &teapot, &glb]);
    assert!(again.code == 6 && again.err.contains("--force"), "{}", again.err);
}

#[test]
fn info_keeps_its_contract() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("torus.glb").display().to_string();
    assert_eq!(run(&["make", "torus", &glb]).code, 0);
    let info = run(&["info", &glb, "--json"]).json();
    for key in [
        "kind",
        "format",
        "vertices",
        "edges",
        "faces",
        "triangles",
        "bounds",
        "area",
        "volume",
        "attributes",
        "memory_bytes",
        "schema",
    ] {
        assert!(!info[key].is_null(), "{key} is missing: {info}");
    }
    assert_eq!((info["kind"].as_str(), info["format"].as_str()), (Some("tri-mesh"), Some("glb")));
    // 96 x 48 quadrilaterals; a torus has V - E + F = 0 while its vertices are shared.
    assert_eq!(info["triangles"], 9216);
    assert_eq!(info["bounds"]["min"].as_array().map(Vec::len), Some(3));
    for (key, known) in [
        ("components", 1),
        ("boundary_loops", 0),
        ("boundary_edges", 0),
        ("non_manifold_edges", 0),
        ("non_manifold_vertices", 0),
        ("euler_characteristic", 0),
        ("genus", 1),
        ("degenerate_faces", 0),
        ("duplicate_faces", 0),
        ("isolated_vertices", 0),
    ] {
        assert_eq!(info[key], known, "{key}");
    }
    for flag in ["manifold", "closed", "orientable", "oriented"] {
        assert_eq!(info[flag], true, "{flag}");
    }
    let patches = run(&["info", &data("teapot.bpt"), "--json"]).json();
    assert_eq!((&patches["patches"], &patches["control_points"]), (&32.into(), &512.into()));
    assert!(patches.get("area").is_none());
    let words = run(&["info", &data("teapot.bpt")]);
    assert!(String::from_utf8_lossy(&words.out).contains("patches: 32"));
}

#[test]
fn streams_go_both_ways() {
    let teapot = fs::read(data("teapot.bpt")).expect("the teapot");
    let glb = run_on(&teapot, &["convert", "-", "-", "--to", "glb", "--tolerance", "1%"]);
    assert_eq!(glb.code, 0, "{}", glb.err);
    assert_eq!(&glb.out[..4], b"glTF");
    let info = run_on(&glb.out, &["info", "-", "--json"]).json();
    assert_eq!(info["format"], "glb");
    let png = run_on(&glb.out, &["render", "-", "-", "--size", "64x48"]);
    assert!(png.code == 0 && png.out.starts_with(b"\x89PNG"), "{}", png.err);
    let same = run_on(&teapot, &["convert", "-", "-", "--to", "bpt"]);
    assert_eq!(same.code, 0, "{}", same.err);
    assert_eq!(run_on(&same.out, &["convert", "-", "-", "--to", "bpt"]).out, same.out);
}

#[test]
fn quiet_is_quiet_and_json_is_one_object() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, b) = (folder.path().join("a.glb").display().to_string(), folder.path().join("b.glb").display().to_string());
    let quiet = run(&["-q", "convert", &data("teapot.bpt"), &a, "--tolerance", "1%"]);
    assert!(quiet.code == 0 && quiet.err.is_empty() && quiet.out.is_empty());
    let report = folder.path().join("b.json").display().to_string();
    let loud =
        run(&["convert", &data("teapot.bpt"), &b, "--tolerance", "1%", "--json", "--report", &report, "--timings"]);
    let object = loud.json();
    assert_eq!(object["schema"], "shapeloom.convert/1");
    assert_eq!(object["within_tolerance"], true);
    let bound = object["deviation"]["value"].as_f64().expect("a bound");
    assert!(bound > 0.0 && bound <= object["tolerance"].as_f64().expect("a tolerance"));
    assert_eq!(object["steps"][0]["report"]["certificates"].as_array().map(Vec::len), Some(32));
    assert!(object["steps"][0]["seconds"].is_number());
    let written: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(report).expect("a report")).expect("JSON");
    assert_eq!(written, object);
    let failed = run(&["info", "nowhere.glb", "--json"]);
    assert_eq!(failed.json()["error"]["code"], "E-input-open");
}

#[test]
fn outputs_that_cannot_be_written_are_told_and_leave_nothing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let blocker = folder.path().join("file");
    fs::write(&blocker, "x").expect("a file");
    let teapot = data("teapot.bpt");
    let inside = blocker.join("out.glb").display().to_string();
    let outcome = run(&["convert", &teapot, &inside, "--tolerance", "5%"]);
    assert!(outcome.code == 6 && outcome.err.contains("out.glb"), "{}", outcome.err);
    let outcome = run(&["convert", &teapot, "/proc/no/such/place/out.glb", "--tolerance", "5%"]);
    assert_eq!(outcome.code, 6, "{}", outcome.err);
    let as_folder = folder.path().join("sub.glb");
    fs::create_dir(&as_folder).expect("a folder");
    let outcome = run(&["convert", &teapot, &as_folder.display().to_string(), "--force"]);
    assert_eq!(outcome.code, 6, "{}", outcome.err);
    // A picture that cannot be written keeps the mesh from appearing as well.
    let (glb, picture) =
        (folder.path().join("a.glb").display().to_string(), blocker.join("a.png").display().to_string());
    let outcome = run(&["convert", &teapot, &glb, "--tolerance", "5%", "--picture", &picture]);
    assert_eq!(outcome.code, 6, "{}", outcome.err);
    assert_eq!(names(folder.path()), ["file", "sub.glb"]);
}

#[test]
fn wrong_usage_says_what_was_found_and_expected() {
    let teapot = data("teapot.bpt");
    for (words, code, says) in [
        (vec!["convert", &teapot, "x.glb", "--set", "colour=red"], 2, "E-plan-option"),
        (vec!["convert", &teapot, "x.glb", "--set", "normals=perhaps"], 2, "E-option-text"),
        (vec!["convert", &teapot, "x.glb", "--set", "max_segments=0"], 2, "E-option-range"),
        (vec!["convert", &teapot, "x.glb", "--method", "magic"], 2, "E-plan-method"),
        (vec!["convert", &teapot, "x.glb", "--method", "triangulate-polygons"], 4, "E-plan-off-the-way"),
        (vec!["convert", &teapot, "x.glb", "--via", "jelly"], 2, "E-usage-kind"),
        (vec!["convert", &teapot, "x.nothing"], 4, "error[E-"),
        (vec!["convert", &teapot, "-"], 2, "E-usage-format"),
        (vec!["convert", &teapot, "x.glb", "--picture", "x.glb"], 2, "E-usage-outputs"),
        (vec!["make", "hat", "x.glb"], 2, "E-usage-shape"),
        (vec!["make", "sphere", "x.glb", "--set", "radius=-1"], 2, "E-option-range"),
        (vec!["make", "sphere", "x.glb", "--set", "segments=32768", "--set", "bands=32768"], 7, "E-memory-budget"),
        (vec!["render", &teapot, "x.png", "--size", "0x9"], 2, "--size"),
        (vec!["render", &teapot, "x.png", "--mode", "dreamy"], 2, "shaded"),
        (vec!["render", &teapot, "x.png", "--threads", "0"], 2, "--threads"),
        (vec!["fly"], 2, "fly"),
        (vec![], 2, "Usage"),
    ] {
        let outcome = run(&words);
        assert_eq!(outcome.code, code, "{words:?}: {}", outcome.err);
        assert!(outcome.err.contains(says), "{words:?}: {}", outcome.err);
        assert!(outcome.out.is_empty(), "{words:?}");
    }
    assert!(!Path::new("x.glb").exists() && !Path::new("x.png").exists());
    assert_eq!(run(&["--version"]).code, 0);
    assert_eq!(run(&["convert", "--help"]).code, 0);
}

#[test]
fn methods_options_and_strictness_change_what_is_done() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    let teapot = data("teapot.bpt");
    let welded = run(&["convert", &teapot, &file("w.glb"), "--tolerance", "2%", "--method", "weld", "--json", "-v"]);
    let steps: Vec<String> =
        welded.json()["steps"].as_array().expect("steps").iter().map(|step| step["converter"].to_string()).collect();
    assert_eq!(steps, ["\"tessellate-patches\"", "\"weld\""]);
    let plain = run(&["convert", &teapot, &file("p.glb"), "--tolerance", "2%", "--set", "normals=false", "--explain"]);
    assert!(plain.code == 0 && plain.err.contains("shortest way"), "{}", plain.err);
    let info = run(&["info", &file("p.glb"), "--json"]).json();
    let names: Vec<&str> =
        info["attributes"].as_array().expect("attributes").iter().filter_map(|a| a["name"].as_str()).collect();
    assert!(!names.contains(&"normal") && names.contains(&"texcoord"), "{names:?}");
    // Welding far apart corners gives no proof of being near.
    let words = [
        "convert",
        &teapot,
        &file("s.glb"),
        "--tolerance",
        "2%",
        "--method",
        "weld",
        "--set",
        "distance=3",
        "--strict",
    ];
    let strict = run(&words);
    assert!(strict.code == 5 && strict.err.contains("E-strict-tolerance"), "{}", strict.err);
    assert!(!folder.path().join("s.glb").exists());
}

#[test]
fn pictures_turn_and_show_modes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str| folder.path().join(name).display().to_string();
    assert_eq!(run(&["make", "cone", &file("cone.obj"), "--picture", &file("cone.png")]).code, 0);
    let turn = run(&[
        "render",
        &data("teapot.bpt"),
        &file("t.png"),
        "--size",
        "48x36",
        "--turntable",
        "3",
        "--tolerance",
        "5%",
    ]);
    assert_eq!(turn.code, 0, "{}", turn.err);
    let frames = ["t-000.png", "t-001.png", "t-002.png"].map(|name| fs::read(file(name)).expect("a frame"));
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    let mut pictures = Vec::new();
    for mode in ["shaded", "flat", "wire"] {
        let name = file(&format!("{mode}.png"));
        let words = [
            "render",
            &data("teapot.bpt"),
            &name,
            "--size",
            "64x48",
            "--mode",
            mode,
            "--view",
            "40,10",
            "--tolerance",
            "5%",
        ];
        let outcome = run(&words);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        pictures.push(fs::read(&name).expect("a picture"));
    }
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
}

#[test]
fn formats_and_graph_tell_the_same_in_words_and_json() {
    let formats = run(&["formats", "--json"]).json();
    let words = String::from_utf8(run(&["formats"]).out).expect("words");
    for format in formats["formats"].as_array().expect("formats") {
        assert!(words.contains(format["id"].as_str().expect("an id")));
    }
    let graph = run(&["graph", "--json"]).json();
    let (words, dot) = (run(&["graph"]).out, run(&["graph", "--dot"]).out);
    let (words, dot) = (String::from_utf8(words).expect("words"), String::from_utf8(dot).expect("words"));
    for converter in graph["converters"].as_array().expect("converters") {
        let name = converter["name"].as_str().expect("a name");
        assert!(words.contains(name) && dot.contains(name), "{name}");
    }
}

/// A real process: its exit code, its streams, and what an interrupt and a time limit leave behind.
#[test]
fn the_process_itself_keeps_the_contract() {
    let program = env!("CARGO_BIN_EXE_shapeloom-under-test");
    let mut child = Command::new(program)
        .args(["convert", "-", "-", "--to", "obj", "--tolerance", "5%"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let teapot = fs::read(data("teapot.bpt")).expect("the teapot");
    child.stdin.take().expect("a pipe").write_all(&teapot).expect("it reads");
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success());
    assert!(String::from_utf8_lossy(&output.stdout).contains("\nv "), "data on standard output");
    assert!(!String::from_utf8_lossy(&output.stderr).contains('\x1b'), "no bar where there is no terminal");

    // A reader that has had enough is no failure.
    let mut child = Command::new(program)
        .args(["graph", "--json"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));

    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("slow.glb").display().to_string();
    let words =
        ["convert", &data("teapot.bpt"), &glb, "--tolerance", "1e-4%", "--max-memory", "64G", "--max-time", "0.05"];
    let output = Command::new(program).args(words).output().expect("it ends");
    let err = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(7) && err.contains("E-time-limit"), "{err}");
    assert!(names(folder.path()).is_empty());
}
