//! Malformed input: typed errors that name the place, never a panic.

use std::fs;

use crate::support::{Dice, data, run, run_on, shared_data};

fn teapot() -> Vec<u8> {
    std::fs::read(data("teapot.bpt")).expect("data/teapot.bpt is in the repository")
}

fn convert(input: &[u8], more: &[&str]) -> crate::support::Outcome {
    let mut words = vec!["convert", "-", "-", "--from", "bpt", "--to", "ply", "--tolerance", "5%"];
    words.extend(more);
    run_on(input, &words)
}

#[test]
fn truncated_patch_files_are_refused_at_every_line() {
    let whole = teapot();
    let lines: Vec<usize> = whole.iter().enumerate().filter(|(_, byte)| **byte == b'\n').map(|(at, _)| at).collect();
    for &end in lines.iter().step_by(7) {
        if end + 1 == whole.len() {
            continue;
        }
        let outcome = convert(&whole[..end], &[]);
        assert_eq!(outcome.code, 3, "cut after {end} bytes: {}", outcome.err);
        assert!(outcome.out.is_empty());
        assert!(outcome.err.contains("line"), "{}", outcome.err);
    }
}

#[test]
fn lying_patch_files_are_told_apart() {
    let text = String::from_utf8(teapot()).expect("text");
    let with_first = |line: &str| text.replacen("32", line, 1).into_bytes();
    // Too many patches promised: the data ends early. Too few: the rest is a finding.
    let more = convert(&with_first("33"), &[]);
    assert!(more.code == 3 && more.err.contains("33") && more.err.contains("32"), "{}", more.err);
    let fewer = convert(&with_first("31"), &[]);
    assert!(fewer.code == 0 && fewer.err.contains("W-bpt-trailing"), "{}", fewer.err);
    for count in ["-1", "1e3", "4294967297", "99999999999999999999", "nonsense", "0x20"] {
        let outcome = convert(&with_first(count), &[]);
        assert!([3, 7].contains(&outcome.code), "{count}: {}", outcome.err);
        assert!(outcome.err.contains("line"), "{count}: {}", outcome.err);
    }
    let degrees = |line: &str| text.replacen("3 3", line, 1).into_bytes();
    for line in ["3 4", "4 3", "-3 3", "3", "300 300", "4294967295 4294967295", "3.5 3"] {
        let outcome = convert(&degrees(line), &[]);
        assert!([3, 7].contains(&outcome.code), "{line}: {} {}", outcome.code, outcome.err);
    }
}

#[test]
fn control_points_that_are_not_finite_are_named() {
    let text = String::from_utf8(teapot()).expect("text");
    for word in ["nan", "NaN", "inf", "-inf", "1e400", "-1e999"] {
        let outcome =
            convert(text.replacen("1.3375 0.0 2.53125", &format!("1.3375 {word} 2.53125"), 1).as_bytes(), &[]);
        assert_eq!(outcome.code, 3, "{word}: {}", outcome.err);
        assert!(outcome.err.contains("line 7") && outcome.err.contains(word), "{word}: {}", outcome.err);
    }
}

#[test]
fn tolerances_that_mean_nothing_are_refused() {
    let teapot = data("teapot.bpt");
    for tolerance in ["0", "-1", "nan", "inf", "0%", "tight", ""] {
        let outcome = run(&["convert", &teapot, "-", "--to", "glb", "--tolerance", tolerance]);
        assert_eq!(outcome.code, 2, "{tolerance}: {}", outcome.err);
        assert!(outcome.err.contains("tolerance"), "{}", outcome.err);
    }
    let outcome = run(&["convert", &teapot, "-", "--to", "glb", "--tolerance", "1e-300"]);
    assert!(outcome.code == 5 && outcome.err.contains("E-tessellation-rounding"), "{}", outcome.err);
    let outcome = run(&["convert", &teapot, "-", "--to", "glb", "--tolerance", "1e-11"]);
    assert!(outcome.code == 7 && outcome.err.contains("E-"), "{}", outcome.err);
    let outcome = run(&["convert", &teapot, "-", "--to", "glb", "--max-memory", "1M"]);
    assert!(outcome.code == 7 && outcome.err.contains("E-memory-budget"), "{}", outcome.err);
}

#[test]
fn flipped_bytes_never_panic() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("cube.glb").display().to_string();
    assert_eq!(run(&["make", "cube", &glb]).code, 0);
    let mut dice = Dice(17);
    for (format, whole) in [("glb", std::fs::read(&glb).expect("it was written")), ("bpt", teapot())] {
        for _ in 0..400 {
            let mut broken = whole.clone();
            for _ in 0..1 + dice.next() % 4 {
                let at = dice.next() as usize % broken.len();
                broken[at] = dice.next() as u8;
            }
            let words =
                ["convert", "-", "-", "--from", format, "--to", "ply", "--tolerance", "20%", "--max-memory", "64M"];
            let outcome = run_on(&broken, &words);
            assert!([0, 2, 3, 4, 5, 7].contains(&outcome.code), "{format}: {} {}", outcome.code, outcome.err);
        }
    }
}

#[test]
fn what_is_no_known_format_is_told() {
    for input in [&b""[..], b"\0\0\0\0", b"hello", b"\xff\xfe1\0", b"glTF"] {
        let outcome = run_on(input, &["info", "-"]);
        assert!([3, 4].contains(&outcome.code), "{input:?}: {} {}", outcome.code, outcome.err);
        assert!(outcome.err.starts_with("error[E-"), "{}", outcome.err);
    }
    assert_eq!(run(&["info", "no-such-file.bpt"]).code, 3);
    assert_eq!(run(&["info", "."]).code, 3);
}

/// GLBs that are broken in their container, made from a sound one.
#[test]
fn broken_containers_are_refused_with_the_byte() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let glb = folder.path().join("cube.glb").display().to_string();
    assert_eq!(run(&["make", "cube", &glb]).code, 0);
    let sound = fs::read(&glb).expect("it was written");
    let with = |at: usize, value: u32| {
        let mut broken = sound.clone();
        broken[at..at + 4].copy_from_slice(&value.to_le_bytes());
        broken
    };
    let total = sound.len() as u32;
    for (what, broken, place) in [
        ("magic", with(0, 0x1234_5678), "byte 0"),
        ("version 1", with(4, 1), "byte 4"),
        ("length beyond the file", with(8, total + 4), "byte 8"),
        ("chunk of 4 GiB", with(12, u32::MAX), "byte 12"),
        ("header alone", sound[..12].to_vec(), "byte"),
        ("cut in its data", sound[..sound.len() - 7].to_vec(), "byte"),
        ("first chunk no JSON", with(16, 0x0042_4942), "byte"),
    ] {
        let outcome = run_on(&broken, &["info", "-", "--from", "glb"]);
        assert!([3, 4].contains(&outcome.code), "{what}: {} {}", outcome.code, outcome.err);
        assert!(outcome.err.contains(place), "{what}: {}", outcome.err);
        assert!(outcome.out.is_empty());
    }
}

/// The collection of malformed files, where it is there: an error that names a place, never a panic.
#[test]
fn malformed_glbs_of_the_collection_are_refused() {
    for name in ["glb_bad_magic", "glb_total_too_long", "glb_json_chunk_4g", "glb_header_only", "glb_truncated_bin"] {
        let Some(path) = shared_data(&format!("malformed/gltf/{name}.glb")) else { continue };
        let outcome = run(&["info", &path.display().to_string()]);
        assert_eq!(outcome.code, 3, "{name}: {}", outcome.err);
        assert!(outcome.err.contains("byte"), "{name}: {}", outcome.err);
    }
}
