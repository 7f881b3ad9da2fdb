//! The command `structures`.

use crate::support::{data, run};

fn torus(folder: &tempfile::TempDir) -> String {
    let path = folder.path().join("torus.ply").display().to_string();
    assert_eq!(run(&["make", "torus", &path]).code, 0);
    path
}

#[test]
fn structures_are_listed_with_their_size_and_ranked() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let outcome = run(&["structures", &torus(&folder), "--triangles", "--json", "--mix", "VV=10,VF=10,size=1"]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let object = outcome.json();
    assert_eq!(object["schema"], "shapeloom.structures/1");
    let structures = object["structures"].as_array().expect("a list");
    let half_edges = structures.iter().find(|one| one["name"] == "half-edges (triangles)").expect("it is listed");
    assert_eq!((&half_edges["holds"], &half_edges["bytes_per_face"]), (&true.into(), &26.0.into()));
    assert_eq!(half_edges["words_per_vertex"], half_edges["theory_words_per_vertex"]);
    assert_eq!(half_edges["queries"]["VV"]["cost"], "local");
    assert!(half_edges["queries"]["VV"]["seconds"].as_f64().is_some_and(|seconds| seconds > 0.0));
    let ranking = object["ranking"].as_array().expect("a list");
    let weighed: Vec<f64> = ranking.iter().filter_map(|one| one["weighed_by_size"].as_f64()).collect();
    assert!(weighed.len() == ranking.len() && weighed.is_sorted());
    // Every structure is ranked, or not, or cannot hold the mesh.
    let unheld = structures.iter().filter(|one| one["holds"] == false).count();
    let unranked = object["unranked"].as_array().expect("a list").len();
    assert_eq!(ranking.len() + unranked + unheld, structures.len());
}

/// Coordinates count: a soup has each six times, so that it is no small structure.
#[test]
fn size_counts_with_coordinates() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = torus(&folder);
    let object = run(&["structures", &path, "--triangles", "--json", "--mix", "updates=100,size=1"]).json();
    let ranking = object["ranking"].as_array().expect("a list");
    let of = |name: &str| ranking.iter().find(|one| one["name"] == name).expect("it is ranked").clone();
    let ratio = |one: &serde_json::Value| {
        one["weighed_by_size"].as_f64().expect("a number") / one["seconds"].as_f64().expect("a number")
    };
    // 144 bytes a vertex beside 24 for coordinates and 24 for indices, the least that there is.
    assert!((ratio(&of("triangle soup")) / ratio(&of("indexed triangles")) - 3.0).abs() < 1e-9);
    let refused = run(&["structures", &path, "--method", "weld"]);
    assert!(refused.code == 2 && refused.err.contains("--method weld"), "{}", refused.err);
    assert_eq!(run(&["check", &path, "--set", "distance=1"]).code, 2);
    assert_eq!(run(&["structures", &data("teapot.bpt"), "--method", "nonsense"]).code, 2);
}

#[test]
fn what_a_structure_cannot_hold_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("three.off");
    std::fs::write(&path, "OFF\n5 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 1 2\n3 1 0 3\n3 0 1 4\n")
        .expect("written");
    let outcome = run(&["structures", &path.display().to_string()]);
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    let words = String::from_utf8_lossy(&outcome.out);
    assert!(words.contains("cannot hold it: edge 0-1: found 3 faces (0, 1, 2)"), "{words}");
    let patches = run(&["structures", &data("teapot.bpt"), "--tolerance", "2%"]);
    assert!(patches.code == 0 && patches.err.contains("taken as triangles"), "{}", patches.err);
    let wrong = run(&["structures", &data("teapot.bpt"), "--mix", "VX=3"]);
    assert!(wrong.code == 2 && wrong.err.contains("E-structures-mix"), "{}", wrong.err);
}

/// A structure that does not fit is named with what it needs; where nothing fits, that is the failure.
#[test]
fn memory_that_is_short_is_told_for_each_structure_or_for_all() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("grid.ply").display().to_string();
    let made = run(&["make", "grid", &path, "--set", "columns=120", "--set", "rows=120"]);
    assert_eq!(made.code, 0, "{}", made.err);
    let (mut some, mut none) = (0, 0);
    for kilobytes in [1, 64, 256, 512, 1024, 2048, 3072, 4096, 6144, 8192, 16384, 65536] {
        let memory = (kilobytes * 1024).to_string();
        let outcome = run(&["structures", &path, "--max-memory", &memory, "--json"]);
        let object = outcome.json();
        if outcome.code == 7 {
            none += 1;
            assert!(some == 0 && outcome.err.contains("help:"), "{kilobytes}: {}", outcome.err);
            continue;
        }
        assert_eq!(outcome.code, 0, "{kilobytes}: {}", outcome.err);
        let structures = object["structures"].as_array().expect("a list");
        assert!(structures.iter().any(|one| one["holds"] == true), "{kilobytes}");
        let short = |one: &&serde_json::Value| {
            one["why"].as_str().or(one["why_not_in_place"].as_str()).is_some_and(|why| why.contains("memory budget"))
        };
        some += usize::from(structures.iter().any(|one| short(&one)));
    }
    assert!(some > 0 && none > 0, "{some} {none}");
}

#[test]
fn mixes_without_work_and_huge_ones_are_short_and_clear() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = torus(&folder);
    for empty in ["", "queries=0", "size=2"] {
        let outcome = run(&["structures", &path, "--mix", empty]);
        assert!(outcome.code == 2 && outcome.err.contains("no query and no update"), "{empty}: {}", outcome.err);
    }
    let outcome = run(&["structures", &path, "--mix", "queries=1e300"]);
    let words = String::from_utf8_lossy(&outcome.out).into_owned();
    assert_eq!(outcome.code, 0, "{}", outcome.err);
    assert!(words.lines().all(|line| line.len() < 200), "{words}");
}
