//! The command `check`.

use std::fs;

use serde_json::Value;

use crate::support::{run, shared_data};

fn write(folder: &tempfile::TempDir, name: &str, text: &str) -> String {
    let path = folder.path().join(name);
    fs::write(&path, text).expect("a file");
    path.display().to_string()
}

const TETRAHEDRON: &str = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

fn codes(findings: &Value) -> Vec<String> {
    let findings = findings.as_array().expect("a list");
    findings.iter().map(|finding| finding["code"].as_str().expect("a code").to_owned()).collect()
}

#[test]
fn sound_and_unsound_files_are_told_apart() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let sound = write(&folder, "sound.off", TETRAHEDRON);
    for profile in ["general", "print", "simulation"] {
        let outcome = run(&["check", &sound, "--profile", profile]);
        assert_eq!(outcome.code, 0, "{}", outcome.err);
        assert!(String::from_utf8_lossy(&outcome.out).contains("is sound"));
    }
    let game = run(&["check", &sound, "--profile", "game", "--json"]);
    assert_eq!((game.code, codes(&game.json()["parts"][0]["findings"])), (1, vec!["W-check-normals".to_owned()]));
    let open = write(&folder, "open.off", &TETRAHEDRON.replace("4 4 0", "4 3 0").replace("3 2 0 3\n", ""));
    let outcome = run(&["check", &open]);
    let words = String::from_utf8_lossy(&outcome.out).into_owned();
    assert!(outcome.code == 1 && words.contains("W-check-open") && words.contains("edge 0-2"), "{words}");
    let object = run(&["check", &open, "--json", "--profile", "print"]);
    let (code, object) = (object.code, object.json());
    assert_eq!((code, &object["schema"], &object["sound"]), (1, &"shapeloom.check/1".into(), &false.into()));
    let finding = &object["parts"][0]["findings"][0];
    assert_eq!((&finding["count"], &finding["places"][0]["kind"]), (&3.into(), &"edge".into()));
    assert_eq!(object["parts"][0]["polyhedron"]["is"], false);
    // As the misprinted sample of OFF is mended, it is inside out.
    let mended = "OFF\n4 4 0\n-1 -1 -1\n1 1 -1\n1 -1 1\n-1 1 1\n3 1 2 3\n3 1 0 2\n3 3 2 0\n3 0 1 3\n";
    let mended = run(&["check", &write(&folder, "mended.off", mended), "--json"]);
    let found = mended.json();
    assert_eq!((mended.code, codes(&found["parts"][0]["findings"])), (1, vec!["W-check-inverted".to_owned()]));
    assert!((found["parts"][0]["volume"].as_f64().expect("a number") + 8.0 / 3.0).abs() < 1e-15);
}

#[test]
fn welding_is_on_request() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("cube.glb").display().to_string();
    assert_eq!(run(&["make", "cube", &glb]).code, 0);
    let stl = folder.path().join("cube.stl").display().to_string();
    assert_eq!(run(&["convert", &glb, &stl]).code, 0);
    let apart = run(&["check", &stl, "--set", "weld=false"]);
    assert!(apart.code == 1 && String::from_utf8_lossy(&apart.out).contains("may only need welding"));
    assert_eq!(run(&["check", &stl, "--set", "weld=false", "--weld"]).code, 0);
}

#[test]
fn what_has_no_surface_is_refused_and_patches_are_judged_as_triangles() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let points = write(&folder, "points.off", "OFF\n2 0 0\n0 0 0\n1 1 1\n");
    let outcome = run(&["check", &points]);
    assert!(outcome.code == 4 && outcome.err.contains("E-check-kind"), "{}", outcome.err);
    let patch = write(&folder, "patch.bpt", "1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 1\n");
    let outcome = run(&["check", &patch]);
    let words = String::from_utf8_lossy(&outcome.out).into_owned();
    assert!(outcome.code == 1 && words.contains("taken as triangles") && words.contains("W-check-open"), "{words}");
    let wrong = run(&["check", &points, "--profile", "art"]);
    assert!(wrong.code == 2 && wrong.err.contains("simulation"), "{}", wrong.err);
}

/// What the collection's files are known for.
#[test]
fn files_of_the_collection_have_their_defects() {
    let Some(_) = shared_data("MANIFEST.md") else { return };
    for (file, profile, wanted) in [
        ("synthetic/cube_unit.obj", "print", vec![]),
        ("synthetic/nested_cubes.obj", "print", vec![]),
        ("synthetic/two_cubes_share_face.obj", "print", vec![]),
        ("synthetic/cube_inside_out.obj", "general", vec!["W-check-inverted"]),
        ("synthetic/cube_one_flipped.obj", "general", vec!["W-check-orientation"]),
        ("synthetic/cube_duplicate_face.obj", "general", vec!["W-check-edge", "W-check-duplicate"]),
        ("obj/hourglass_ico.obj", "general", vec!["W-check-vertex"]),
        ("synthetic/klein_24x12.off", "general", vec!["W-check-orientation", "W-check-orientable", "W-check-crossing"]),
    ] {
        let path = shared_data(file).expect("a file of the collection").display().to_string();
        let outcome = run(&["check", &path, "--profile", profile, "--json"]);
        let found = codes(&outcome.json()["parts"][0]["findings"]);
        assert_eq!(found, wanted, "{file}");
        assert_eq!(outcome.code, u8::from(!wanted.is_empty()));
    }
}

#[test]
fn lines_are_judged_as_polygons() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let dart = write(&folder, "dart.obj", "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nl 1 2 3 4 1\n");
    let part = run(&["info", &dart, "--json"]).json()["parts"][0].clone();
    for (key, known) in [("closed", true), ("planar", true), ("simple", true), ("convex", false)] {
        assert_eq!(part[key], known, "{key}");
    }
    assert_eq!(part["witnesses"]["not_convex"]["corner"], 2);
    let bow = write(&folder, "bow.obj", "v 0 0 0\nv 4 4 0\nv 4 0 1\nv 0 4 0\nv 1 1 9\nl 1 2 3 4\n");
    let part = run(&["info", &bow, "--json"]).json()["parts"][0].clone();
    assert_eq!((&part["closed"], &part["gap"]), (&false.into(), &4.0.into()));
    assert_eq!((&part["planar"], &part["simple"]), (&false.into(), &true.into()));
}

/// The page has a line for each rule, with who asks for it.
#[test]
fn the_page_tells_every_rule() {
    use shapeloom::core::ChoiceOption;
    use shapeloom::judge::{Profile, RULES};
    let page = crate::support::text("docs/algorithms/checking_meshes.md");
    for rule in &RULES {
        let marks: Vec<&str> = Profile::NAMES
            .iter()
            .map(|name| if Profile::from_name(name).is_some_and(|one| one.asks_for(rule.code)) { "●" } else { "" })
            .collect();
        let line = format!("| `{}` | {} | {} |", rule.code, rule.wants, marks.join(" | "));
        let line = line.replace("|  |", "| |").replace("|  |", "| |");
        assert!(page.contains(&line), "the page lacks: {line}");
    }
}

#[test]
fn parts_that_cross_each_other_are_found_together() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let cube = |at: f64, base: usize| {
        let corner = |i: usize| {
            format!("v {} {} {}\n", at + (i & 1) as f64, at / 2.0 + (i >> 1 & 1) as f64, at / 4.0 + (i >> 2) as f64)
        };
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let face = |face: &[usize; 4]| format!("f {}\n", face.map(|corner| (base + corner + 1).to_string()).join(" "));
        (0..8).map(corner).chain(faces.iter().map(face)).collect::<String>()
    };
    let text = format!("o a\n{}o b\n{}", cube(0.0, 0), cube(0.5, 8));
    let path = write(&folder, "two.obj", &text);
    assert_eq!(run(&["check", &path]).code, 0);
    let together = run(&["check", &path, "--together", "--json"]);
    let object = together.json();
    assert_eq!((together.code, codes(&object["parts"][0]["findings"])), (1, vec!["W-check-crossing".to_owned()]));
    assert_eq!((&object["parts"][0]["together"], &object["parts"][0]["faces"]), (&2.into(), &12.into()));
    assert_eq!(run(&["check", &path, "--together", "--weld"]).code, 1);
}
