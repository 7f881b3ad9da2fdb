//! The command `compare` and pictures coloured by distance.

use std::fs;
use std::path::Path;

use serde_json::Value;
use shapeloom::core::Exec;
use shapeloom::core::glam::DVec3;
use shapeloom::judge::{Distances, Simplices};
use shapeloom::mesh::TriMesh;
use shapeloom::shape::Geometry;

use crate::oracles::Pieces;
use crate::support::{Dice, data, run, run_on};

/// A cube of side 1 about a centre, as OFF.
fn cube(center: [f64; 3], side: f64) -> String {
    let mut text = String::from("OFF\n8 6 0\n");
    for i in 0..8u32 {
        let at = |axis: usize| center[axis] + side * (f64::from(i >> axis & 1) - 0.5);
        text += &format!("{} {} {}\n", at(0), at(1), at(2));
    }
    text + "4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n"
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("found {value}, expected a number"))
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn found_codes(shape: &Value) -> Vec<&str> {
    let findings = shape["findings"].as_array().expect("findings");
    findings.iter().map(|finding| finding["code"].as_str().expect("a code")).collect()
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    fn with(&self, name: &str, content: &str) -> String {
        fs::write(self.0.path().join(name), content).expect("a file");
        self.path(name)
    }
}

#[test]
fn compare_keeps_its_contract() {
    let folder = Folder::new();
    let (a, b) = (folder.with("a.off", &cube([0.0; 3], 1.0)), folder.with("b.off", &cube([0.0; 3], 2.0)));
    let outcome = run(&["compare", &a, &b, "--json"]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let found = outcome.json();
    assert_eq!(found["schema"], "shapeloom.compare/1");
    // From the inner cube every face is 1/2 away, from the outer one the corners are half a diagonal away.
    let (lower, upper) = (number(&found["hausdorff"]["lower"]), number(&found["hausdorff"]["upper"]));
    let wanted = 0.75f64.sqrt();
    assert!(lower <= wanted && wanted <= upper && upper - lower <= 0.01 * upper, "{lower} {upper}");
    for (way, largest) in [("a_to_b", 0.5), ("b_to_a", wanted)] {
        let (mean, rms, max) = (&found[way]["mean"], &found[way]["rms"], &found[way]["max"]);
        assert!(number(mean) <= number(rms) && number(rms) <= number(max) * 1.000_001, "{found}");
        assert!((number(max) - largest).abs() < 1e-9, "{way}: {max}");
        assert!(number(&found[way]["mean_bounds"]["lower"]) <= number(mean));
    }
    assert!((number(&found["a_to_b"]["mean"]) - 0.5).abs() < 1e-12);
    assert!((number(&found["diagonal"]) - 3f64.sqrt()).abs() < 1e-15);
    assert_eq!(found["diagonal_of"], a.as_str());
    for (index, key, side) in [(0, "a", 1.0f64), (1, "b", 2.0)] {
        assert_eq!(found["shapes"][index], found[key]);
        assert_eq!((number(&found[key]["area"]), number(&found[key]["volume"])), (6.0 * side * side, side.powi(3)));
    }
    assert_eq!(found["comparisons"].as_array().map(Vec::len), Some(1));
    assert_eq!(found["comparisons"][0]["hausdorff"], found["hausdorff"]);
    assert_eq!(found["hausdorff"]["proven"], true);
    let words = run(&["compare", &a, &b]);
    let text = String::from_utf8(words.out).expect("words");
    for part in ["Hausdorff distance: from 0.86602", "mean 0.5", "area: 6 and 24", "volume: 1 and 8"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}

#[test]
fn exit_codes_say_whether_a_limit_is_kept() {
    let folder = Folder::new();
    let (a, b) = (folder.with("a.off", &cube([0.0; 3], 1.0)), folder.with("b.off", &cube([0.25, 0.0, 0.0], 1.0)));
    for (limit, code, says) in [
        ("0.3", 0, "within the limit of 0.3"),
        ("20%", 0, "within"),
        ("0.2", 1, "above the limit of 0.2"),
        ("10%", 1, "above"),
        // The distance itself: no bound that is rounded outward proves it.
        ("0.25", 1, "not decided"),
    ] {
        let outcome = run(&["compare", &a, &b, "--fail-above", limit]);
        let text = String::from_utf8_lossy(&outcome.out).into_owned();
        assert_eq!(outcome.code, code, "{limit}: {text} {}", outcome.err);
        assert!(text.contains(says), "{limit}: {text}");
        assert!(!outcome.err.contains("error"), "{}", outcome.err);
    }
    // The bounds and the limit are told apart.
    let text = String::from_utf8(run(&["compare", &a, &b, "--fail-above", "0.25"]).out).expect("words");
    let (low, rest) = text.split_once("from ").and_then(|(_, rest)| rest.split_once(" to ")).expect("bounds");
    let high = rest.split_whitespace().next().expect("a bound");
    let [low, high] = [low, high].map(|bound| bound.parse::<f64>().expect("a number"));
    assert!(low < 0.25 && high > 0.25, "{text}");
    // Identical shapes keep the limit 0.
    for (other, code, says) in [(&a, 0, "within the limit of 0"), (&b, 1, "above the limit of 0")] {
        for limit in ["0", "0%"] {
            let outcome = run(&["compare", &a, other, "--fail-above", limit]);
            let text = String::from_utf8_lossy(&outcome.out).into_owned();
            assert!(outcome.code == code && text.contains(says), "{limit}: {text} {}", outcome.err);
        }
    }
    let json = run(&["compare", &a, &b, "--fail-above", "0.2", "--json"]);
    assert_eq!((json.code, json.json()["verdict"].as_str()), (1, Some("above")));
    let json = run(&["compare", &a, &a, "--fail-above", "1e-300", "--json"]);
    assert_eq!((json.code, json.json()["hausdorff"]["upper"].as_f64()), (0, Some(0.0)));
    for (words, code, says) in [
        (vec!["compare", &a], 2, "E-usage-shapes"),
        (vec!["compare", "-", "-"], 2, "E-usage-shapes"),
        (vec!["compare", &a, "nowhere.off"], 3, "E-input-open"),
        (vec!["compare", &a, &b, "--fail-above", "-1"], 2, "E-tolerance-range"),
        (vec!["compare", &a, &b, "--fail-above", "near"], 2, "E-tolerance-text"),
        (vec!["compare", &a, &b, "--accuracy", "0"], 2, "--accuracy"),
        (vec!["compare", &a, &b, "--accuracy", "nan"], 2, "--accuracy"),
        (vec!["compare", &a, &b, "--set", "colour=red"], 2, "E-plan-option"),
        (vec!["compare", &a, &b, "--max-memory", "1K"], 7, "E-memory-budget"),
    ] {
        let outcome = run(&words);
        assert_eq!(outcome.code, code, "{words:?}: {}", outcome.err);
        assert!(outcome.err.contains(says) && outcome.out.is_empty(), "{words:?}: {}", outcome.err);
    }
}

#[test]
fn empty_and_open_shapes_are_named() {
    let folder = Folder::new();
    let a = folder.with("a.off", &cube([0.0; 3], 1.0));
    let empty = folder.with("empty.off", "OFF\n0 0 0\n");
    for words in [["compare", &a, &empty], ["compare", &empty, &a]] {
        let outcome = run(&words);
        assert!(outcome.code == 4 && outcome.err.contains("E-compare-empty"), "{}", outcome.err);
        assert!(outcome.err.contains("empty.off"), "{}", outcome.err);
    }
    let open = folder.with("open.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let found = run(&["compare", &a, &open, "--json"]).json();
    assert!(found["b"]["volume"].is_null() && found["b"]["findings"][0]["code"] == "W-compare-open", "{found}");
    assert_eq!((number(&found["b"]["area"]), number(&found["a"]["volume"])), (0.5, 1.0));
    let huge = folder.with("huge.off", &cube([0.0; 3], 1e160));
    let found = run(&["compare", &huge, &huge, "--json"]).json();
    assert!(found["a"]["area"].is_null() && found["hausdorff"]["upper"] == 0.0, "{found}");
    assert_eq!(found["a"]["findings"][0]["code"], "W-compare-size");
    // What vanishes is no 0, as info says too.
    let tiny = folder.with("tiny.off", &cube([0.0; 3], 1e-170));
    let found = run(&["compare", &tiny, &tiny, "--json"]).json();
    assert!(found["a"]["area"].is_null() && found["a"]["volume"].is_null(), "{found}");
    assert_eq!(found["a"]["findings"][0]["code"], "W-compare-size");
    assert!(run(&["info", &tiny, "--json"]).json()["area"].is_null());
    // Sizes whose squares are numbers and whose cubes are none.
    for size in [1e-120, 1e120] {
        let between = folder.with("between.off", &cube([0.0; 3], size));
        let found = run(&["compare", &between, &between, "--json"]).json();
        assert!((number(&found["a"]["area"]) / size / size - 6.0).abs() < 1e-12, "{found}");
        assert!(found["a"]["volume"].is_null() && found["a"]["findings"][0]["code"] == "W-compare-size", "{found}");
    }
    assert_eq!(found_codes(&run(&["compare", &a, &open, "--json"]).json()["b"]), ["W-compare-open"]);
    let nan = folder.with("nan.off", "OFF\n3 1 0\nnan 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let outcome = run(&["compare", &a, &nan]);
    assert_eq!(outcome.code, 3, "{}", outcome.err);
}

#[test]
fn many_shapes_streams_and_a_truth() {
    let folder = Folder::new();
    let texts = [1.0, 1.5, 2.0].map(|side| cube([0.0; 3], side));
    let paths = [0, 1, 2].map(|i| folder.with(&format!("{i}.off"), &texts[i]));
    let all = run(&["compare", &paths[0], &paths[1], &paths[2], "--json"]).json();
    let uppers = |found: &Value| -> Vec<f64> {
        found["comparisons"].as_array().expect("comparisons").iter().map(|c| number(&c["hausdorff"]["upper"])).collect()
    };
    assert!(all.get("hausdorff").is_none() && all["shapes"].as_array().map(Vec::len) == Some(3));
    let wanted = [0.25 * 3f64.sqrt(), 0.5 * 3f64.sqrt()];
    assert!(uppers(&all).iter().zip(wanted).all(|(found, wanted)| (found / wanted - 1.0).abs() < 0.011), "{all}");
    let truth = run(&["compare", "--truth", &paths[2], &paths[0], &paths[1], "--json"]).json();
    assert_eq!((truth["truth"].as_str(), uppers(&truth).len()), (Some(paths[2].as_str()), 2));
    assert!(uppers(&truth)[0] > uppers(&truth)[1]);
    let piped = run_on(texts[1].as_bytes(), &["compare", &paths[0], "-", "--json"]).json();
    assert_eq!(piped["hausdorff"], all["comparisons"][0]["hausdorff"]);
    assert_eq!(piped["b"]["name"], "standard input");
}

/// Patches are compared through triangles, whose error widens the bounds; what stands upright elsewhere is turned.
#[test]
fn patches_points_and_turned_shapes_are_compared() {
    let folder = Folder::new();
    let (teapot, glb) = (data("teapot.bpt"), folder.path("teapot.glb"));
    assert_eq!(run(&["-q", "convert", &teapot, &glb, "--tolerance", "1%"]).code, 0);
    let found = run(&["compare", &teapot, &glb, "--json"]).json();
    let (upper, diagonal) = (number(&found["hausdorff"]["upper"]), number(&found["diagonal"]));
    let slack = number(&found["error_of_tessellation"]);
    assert!(slack > 0.0 && slack <= 1e-3 * diagonal, "{slack}");
    assert!(upper > slack && upper < 0.012 * diagonal, "{upper} {diagonal}");
    // The report says the same numbers, the error of tessellation within.
    let report = folder.path("report");
    assert_eq!(run(&["-q", "compare", &teapot, &glb, "--report", &report]).code, 0);
    let read = |name: &str| fs::read_to_string(Path::new(&report).join(name)).expect("a file");
    let (table, page) = (read("distances.csv"), read("index.html"));
    for (row, way) in table.lines().skip(1).zip(["a_to_b", "b_to_a"]) {
        let cells: Vec<f64> = row.rsplit(',').skip(2).take(3).map(|cell| cell.parse().expect("a number")).collect();
        let bounds = &found[way]["hausdorff"];
        assert_eq!(cells, [&bounds["upper"], &bounds["lower"], &found[way]["max"]].map(number), "{row}");
        let shown = format!("{:.5e}", number(&bounds["upper"])).parse::<f64>().expect("a number");
        assert!(page.contains(&format!("<td>{shown}</td></tr>")), "{way}: {shown}");
    }
    let inner = &found["hausdorff"]["of_triangles"];
    assert!(number(&inner["upper"]) < upper && number(&found["hausdorff"]["lower"]) < number(&inner["lower"]));
    // A cloud of the corners of a cube: the middles of its sides are farthest from them.
    let cube_file = folder.with("cube.off", &cube([0.0; 3], 1.0));
    let mut cloud = String::from(
        "ply\nformat ascii 1.0\nelement vertex 8\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
    );
    for i in 0..8u32 {
        cloud += &[0, 1, 2].map(|axis| (f64::from(i >> axis & 1) - 0.5).to_string()).join(" ");
        cloud += "\n";
    }
    let cloud = folder.with("cloud.ply", &cloud);
    let found = run(&["compare", &cloud, &cube_file, "--json"]).json();
    assert_eq!(found["a_to_b"]["max"], 0.0);
    assert!((number(&found["b_to_a"]["max"]) - 0.5f64.sqrt()).abs() < 0.01, "{found}");
    assert!(found["a"]["area"].is_null() && found["a"]["volume"].is_null());
    let line = folder.with("line.obj", "v -0.5 -0.5 -0.5\nv 0.5 0.5 0.5\nl 1 2\n");
    let found = run(&["compare", &line, &cube_file, "--json"]).json();
    assert!((number(&found["a_to_b"]["max"]) - 0.5).abs() < 0.006, "{found}");
}

#[test]
fn reports_are_whole_and_replace_nothing_unasked() {
    let folder = Folder::new();
    let (a, b) = (folder.with("a&b.off", &cube([0.0; 3], 1.0)), folder.with("b.off", &cube([0.25, 0.0, 0.0], 1.0)));
    let out = folder.path("new/report");
    let words = ["compare", &a, &b, "--report", &out, "--fail-above", "1%"];
    let outcome = run(&words);
    assert_eq!(outcome.code, 1, "{}", outcome.err);
    let names =
        ["distance-1-on-0.png", "distance-1-on-1.png", "distances.csv", "index.html", "shape-0.png", "shape-1.png"];
    assert_eq!(files(Path::new(&out)), names);
    let read = |name: &str| fs::read(Path::new(&out).join(name)).expect("a file");
    for name in names.iter().filter(|name| name.ends_with(".png")) {
        assert!(image::load_from_memory(&read(name)).is_ok(), "{name}");
    }
    let page = String::from_utf8(read("index.html")).expect("UTF-8");
    assert!(page.contains("a&amp;b.off") && !page.contains("a&b.off"), "names are escaped");
    assert!(
        page.matches("data:image/png;base64,").count() == 4 && !page.contains("http"),
        "the page is whole in itself"
    );
    let table = String::from_utf8(read("distances.csv")).expect("UTF-8");
    let rows: Vec<&str> = table.lines().collect();
    assert!(rows.len() == 3 && rows[0].starts_with("from,to,mean,rms,max,hausdorff_lower"), "{table}");
    let max: f64 = rows[1].split(',').nth(4).and_then(|cell| cell.parse().ok()).expect("a number");
    assert!((max - 0.25).abs() < 1e-9, "{table}");
    let again = run(&words);
    assert!(again.code == 6 && again.err.contains("E-output-exists"), "{}", again.err);
    let bytes = read("distance-1-on-0.png");
    assert_eq!(run(&["compare", &a, &b, "--report", &out, "--force", "--threads", "1"]).code, 0);
    assert!(read("distance-1-on-0.png") == bytes, "the same bytes for any number of threads");
    // Nothing is left where one file cannot be written.
    let blocker = folder.with("blocker", "x");
    let outcome = run(&["compare", &a, &b, "--report", &format!("{blocker}/report")]);
    assert_eq!(outcome.code, 6, "{}", outcome.err);
}

#[test]
fn pictures_are_coloured_by_distance() {
    let folder = Folder::new();
    let (a, b) = (folder.with("a.off", &cube([0.0; 3], 1.0)), folder.with("b.off", &cube([0.0; 3], 2.0)));
    let (plain, colored, ranged) = (folder.path("p.png"), folder.path("c.png"), folder.path("r.png"));
    let small = ["--size", "64x48"];
    let with = |rest: &[&str]| run(&[&["render"], rest, &small].concat());
    assert_eq!(with(&[&a, &plain]).code, 0);
    let outcome = with(&[&b, &colored, "--color", "distance", "--reference", &a]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(outcome.err.contains("from 0 (dark) to 0.866"), "{}", outcome.err);
    let object =
        with(&[&b, &ranged, "--color", "distance", "--reference", &a, "--color-range", "0.4,0.6", "--json"]).json();
    assert_eq!((number(&object["colors"]["from"]), number(&object["colors"]["to"])), (0.4, 0.6));
    let pictures = [&plain, &colored, &ranged].map(|path| fs::read(path).expect("a picture"));
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    for words in [
        vec![a.as_str(), "x.png", "--color", "distance"],
        vec![&a, "x.png", "--reference", &b],
        vec![&a, "x.png", "--color-range", "0,1"],
        vec!["-", "x.png", "--color", "distance", "--reference", "-"],
    ] {
        let outcome = with(&words);
        assert!(outcome.code == 2 && outcome.err.contains("E-usage-color"), "{words:?}: {}", outcome.err);
    }
    assert_eq!(with(&[&a, "x.png", "--color", "mood"]).code, 2);
}

/// What cannot be drawn is measured and told all the same; where only a picture was wanted the error says why there is none.
#[test]
fn sizes_that_cannot_be_drawn_are_measured() {
    let folder = Folder::new();
    let unit = folder.with("unit.off", &cube([0.0; 3], 1.0));
    for (index, size) in [1e300, 1e153, 1e-300].into_iter().enumerate() {
        let wild = folder.with(&format!("wild{index}.off"), &cube([0.0; 3], size));
        let out = folder.path(&format!("report{index}"));
        // Beside the unit cube a tiny one is no trouble for a view.
        let other = if size > 1.0 { &unit } else { &wild };
        let outcome = run(&["compare", &wild, other, "--report", &out]);
        assert_eq!(outcome.code, 0, "{size}: {}", outcome.err);
        assert!(outcome.err.contains("pictures are left out"), "{size}: {}", outcome.err);
        assert!(String::from_utf8_lossy(&outcome.out).contains("Hausdorff distance: from "), "{size}");
        let page = fs::read_to_string(Path::new(&out).join("index.html")).expect("a page");
        assert!(page.contains("<p>pictures are left out"), "{size}");
        assert_eq!(files(Path::new(&out)), ["distances.csv", "index.html"], "{size}");
        let png = folder.path("x.png");
        for rest in [&[][..], &["--color", "distance", "--reference", &unit], &["--turntable", "2"]] {
            let outcome = run(&[&["render", &wild, &png, "--size", "64x48"], rest].concat());
            assert_eq!(outcome.code, 4, "{size} {rest:?}: {}", outcome.err);
            assert!(outcome.err.contains("E-picture-size") && !outcome.err.contains("colours:"), "{}", outcome.err);
        }
    }
    let empty = folder.with("empty.off", "OFF\n0 0 0\n");
    let outcome = run(&["render", &empty, "x.png", "--color", "distance", "--reference", &unit]);
    assert!(outcome.code == 4 && outcome.err.contains("E-picture-empty"), "{}", outcome.err);
    assert!(!outcome.err.contains("colours:"), "{}", outcome.err);
}

#[test]
fn findings_name_their_file_where_there_are_several() {
    let folder = Folder::new();
    let flat = folder.with("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n");
    let cube = folder.with("cube.off", &cube([0.0; 3], 1.0));
    let alone = run(&["info", &flat]).err;
    let warning = alone.lines().find(|line| line.starts_with("warning[")).expect("a warning").to_owned();
    let lines = |outcome: &str| outcome.lines().filter(|line| line.contains("warning[")).map(str::to_owned).collect();
    let found: Vec<String> = lines(&run(&["compare", &cube, &flat]).err);
    assert_eq!(found, [format!("{flat}: {warning}")]);
    let png = folder.path("x.png");
    let words = ["render", &flat, &png, "--size", "64x48", "--color", "distance", "--reference", &cube];
    let outcome = run(&words);
    assert_eq!(lines(&outcome.err) as Vec<String>, [format!("{flat}: {warning}")], "{}", outcome.err);
    // Six digits of √½.
    assert!(outcome.err.contains("(dark) to 0."), "{}", outcome.err);
    let end = outcome.err.split("(dark) to ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a number");
    assert!(end.len() <= 8, "{end}");
}

/// Another way to the same bounds: a tiny shape is a point.
#[test]
fn a_tiny_shape_has_true_distances() {
    let folder = Folder::new();
    let segment = folder.with("segment.obj", "v 1 0 0\nv 0 1 0\nl 1 2\n");
    for size in ["1e-150", "1e-160", "1e-250", "1e-300"] {
        let point = folder.with("point.obj", &format!("v {size} {size} 0\np 1\n"));
        for words in [["compare", &segment, &point, "--json"], ["compare", &point, &segment, "--json"]] {
            let found = run(&words).json();
            let (lower, upper) = (number(&found["hausdorff"]["lower"]), number(&found["hausdorff"]["upper"]));
            assert!(lower <= 1.0 && upper >= 1.0 && upper - lower < 0.01, "{size}: {lower} {upper}");
        }
    }
}

/// The bounds hold what another way of measuring finds on random shapes, and the means what sampling finds.
#[test]
fn distances_hold_what_brute_force_finds() {
    let mut dice = Dice(5);
    let soup = |count: u32, dice: &mut Dice| {
        let mut point = || DVec3::new(dice.unit(), dice.unit(), dice.unit());
        let positions: Vec<DVec3> = (0..3 * count).map(|_| point()).collect();
        TriMesh::try_new(positions, (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect()).expect("a mesh")
    };
    for count in [1, 4, 12] {
        let (a, b) = (soup(count, &mut dice), soup(count + 2, &mut dice));
        let found =
            Distances::new().measure(&Simplices::from(&a), &Simplices::from(&b), &Exec::default()).expect("distances");
        let pieces = Pieces::of(&Geometry::from(b.clone())).expect("triangles");
        let (mut largest, mut sum, mut weight) = (0.0f64, 0.0, 0.0);
        for triangle in 0..a.triangles().len() {
            let [p, q, r] = a.corners(triangle);
            let area = (q - p).cross(r - p).length();
            for _ in 0..2000 {
                let (mut u, mut v) = (dice.unit(), dice.unit());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                let distance = pieces.distance(p + (q - p) * u + (r - p) * v);
                largest = largest.max(distance);
                sum += area * distance;
                weight += area;
            }
        }
        let way = &found.hausdorff.a_to_b;
        assert!(way.upper >= largest && way.lower >= largest * 0.97, "{way:?} {largest}");
        // The error of so many random samples is about a hundredth.
        let mean = &found.a_to_b.mean;
        assert!(
            (mean.value / (sum / weight) - 1.0).abs() < 0.05 && mean.lower <= mean.value && mean.value <= mean.upper
        );
    }
}
