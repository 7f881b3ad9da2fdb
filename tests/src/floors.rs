//! The house: which package may stand on which, how much each brings along, and rules that every package keeps.

use std::collections::BTreeSet;
use std::process::Command;

use serde_json::Value;

use crate::support::{files_below, root, text};

/// The floors, from the ground up. A package may use lower floors only.
const FLOORS: &[&[&str]] = &[
    &["core"],
    &["spatial"],
    &["mesh"],
    &["isosurface", "judge"],
    &["process", "points", "parametric", "implicit", "voxels", "images"],
    &["shape"],
    &["io", "render"],
    &["convert"],
    &["shapeloom"],
    &["cli", "bench"],
];

fn floor(package: &str) -> Option<usize> {
    let room = package.strip_prefix("shapeloom-").unwrap_or(package);
    FLOORS.iter().position(|rooms| rooms.contains(&room))
}

fn cargo(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO")).args(arguments).current_dir(root()).output().expect("cargo runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("cargo prints UTF-8")
}

fn packages() -> Vec<Value> {
    let metadata = cargo(&["metadata", "--format-version", "1", "--no-deps", "--offline"]);
    let metadata: Value = serde_json::from_str(&metadata).expect("cargo prints JSON");
    metadata["packages"].as_array().expect("packages").clone()
}

fn dependencies(package: &Value) -> Vec<(&str, bool)> {
    let all = package["dependencies"].as_array().expect("dependencies");
    all.iter().map(|one| (one["name"].as_str().expect("a name"), one["kind"] == "dev")).collect()
}

#[test]
fn packages_use_lower_floors_only() {
    for package in packages() {
        let name = package["name"].as_str().expect("a name");
        let Some(own) = floor(name) else {
            assert!(["shapeloom-examples", "shapeloom-tests"].contains(&name), "{name} has no floor");
            continue;
        };
        for (other, dev) in dependencies(&package) {
            if let Some(below) = floor(other) {
                assert!(below < own, "{name} (floor {own}) uses {other} (floor {below})");
                assert!(!dev, "{name} has {other} as a dev-dependency: unit tests use lower floors only");
            }
        }
    }
}

#[test]
fn glam_trees_and_triangulations_are_named_where_they_belong() {
    for package in packages() {
        let name = package["name"].as_str().expect("a name");
        for (other, _) in dependencies(&package) {
            if other == "glam" {
                assert!(["shapeloom-core", "shapeloom-spatial"].contains(&name), "{name} names glam");
            }
            if ["obvhs", "kiddo"].contains(&other) {
                assert_eq!(name, "shapeloom-spatial", "{name} names {other}");
            }
            if ["spade", "earcut"].contains(&other) {
                assert_eq!(name, "shapeloom-mesh", "{name} names {other}");
            }
        }
    }
}

/// The number of packages in a tree of normal dependencies, our own not counted.
fn tree_size(package: &str) -> usize {
    let tree = cargo(&["tree", "--offline", "-p", package, "-e", "normal", "--prefix", "none", "--format", "{p}"]);
    let names: BTreeSet<&str> = tree.lines().filter_map(|line| line.split_whitespace().next()).collect();
    names.into_iter().filter(|name| !name.starts_with("shapeloom")).count()
}

#[test]
fn packages_bring_few_others_along() {
    for (package, most) in [("shapeloom-core", 10), ("shapeloom-mesh", 25), ("shapeloom", 100)] {
        let found = tree_size(package);
        assert!(found <= most, "{package} brings {found} packages, at most {most} are wanted");
    }
}

#[test]
fn every_package_keeps_the_common_lints_and_core_keeps_its_features() {
    for package in packages() {
        let manifest = package["manifest_path"].as_str().expect("a path");
        let manifest = std::fs::read_to_string(manifest).expect("a manifest");
        assert!(manifest.contains("[lints]\nworkspace = true"), "{} has lints of its own", package["name"]);
    }
    assert!(text("Cargo.toml").contains("unsafe_code = \"forbid\""));
}

#[test]
fn libraries_neither_print_nor_know_the_time() {
    for path in files_below("crates", ".rs") {
        let relative = path.strip_prefix(root()).expect("below the root").display().to_string();
        let source = std::fs::read_to_string(&path).expect("a source file");
        let code: String =
            source.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
        let outermost = relative.starts_with("crates/cli/") || relative.starts_with("crates/bench/");
        if !outermost {
            for word in ["println!", "eprintln!", "std::process::exit"] {
                assert!(!code.contains(word), "{relative} has {word}");
            }
        }
        if !outermost && !relative.starts_with("crates/convert/") {
            for word in ["Instant::now", "SystemTime::now"] {
                assert!(!code.contains(word), "{relative} has {word}");
            }
        }
        assert!(!code.contains("mul_add"), "{relative} has mul_add: its result depends on the processor");
    }
}

#[test]
fn nothing_in_the_tree_is_large() {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    // A source archive has no git; there the rule was kept before it was made.
    let Ok(output) = listed else { return };
    for name in String::from_utf8_lossy(&output.stdout).split('\0').filter(|name| !name.is_empty()) {
        let size = std::fs::metadata(root().join(name)).map_or(0, |data| data.len());
        assert!(size <= 2 << 20, "{name} has {size} bytes");
    }
}
