//! The command `boolean`, on volumes by formula.

use crate::support::{Outcome, run};

/// A cube of samples of the distance to a ball, from -1 to 1 in each direction, as a file.
fn ball(folder: &tempfile::TempDir, name: &str, side: u32, center: f64, radius: f64) -> String {
    let step = 2.0 / f64::from(side - 1);
    let mut bytes = format!(
        "NRRD0004\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: {side} {side} {side}\n\
         space directions: ({step},0,0) (0,{step},0) (0,0,{step})\nspace origin: (-1,-1,-1)\n\
         endian: little\nencoding: raw\nquantity:=signed-distance\n\n"
    )
    .into_bytes();
    for index in 0..side.pow(3) {
        let place = [index % side, index / side % side, index / side / side].map(|at| f64::from(at) * step - 1.0);
        let distance = (place[0] - center).hypot(place[1]).hypot(place[2]) - radius;
        bytes.extend((distance as f32).to_le_bytes());
    }
    let path = folder.path().join(name).display().to_string();
    std::fs::write(&path, bytes).expect("written");
    path
}

fn boolean(words: &[&str]) -> Outcome {
    run(&[&["boolean"], words].concat())
}

fn samples(path: &str) -> Vec<f32> {
    let bytes = std::fs::read(path).expect("it was written");
    let start = bytes.windows(2).position(|pair| pair == b"\n\n").expect("a header") + 2;
    bytes[start..].as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect()
}

#[test]
fn volumes_are_combined_sample_by_sample() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let [a, b] =
        [("a.nrrd", -0.2, 0.6), ("b.nrrd", 0.25, 0.5)].map(|(name, x, radius)| ball(&folder, name, 21, x, radius));
    let (of_a, of_b) = (samples(&a), samples(&b));
    type Rule = fn(f32, f32) -> f32;
    let rules: [(&[&str], Rule); 4] = [
        (&["--op", "union"], f32::min),
        (&["--op", "intersection"], f32::max),
        (&["--op", "difference"], |a, b| a.max(-b)),
        (&["--morph", "0.25"], |a, b| a * 0.75 + b * 0.25),
    ];
    for (n, (words, rule)) in rules.into_iter().enumerate() {
        let out = path(&format!("{n}.nrrd"));
        let done = boolean(&[&[&a[..], &b, &out], words].concat());
        assert_eq!(done.code, 0, "{}", done.err);
        let wanted: Vec<f32> = of_a.iter().zip(&of_b).map(|(&a, &b)| rule(a, b)).collect();
        assert!(samples(&out) == wanted, "{words:?}");
    }
    // A fillet takes at most a quarter of its radius, and something.
    let out = path("smooth.nrrd");
    assert_eq!(boolean(&[&a, &b, &out, "--op", "union", "--smooth", "0.2"]).code, 0);
    let less: Vec<f32> =
        samples(&out).iter().zip(of_a.iter().zip(&of_b)).map(|(found, (a, b))| a.min(*b) - found).collect();
    assert!(less.iter().all(|less| (-1e-6..=0.050_001).contains(less)) && less.iter().any(|&less| less > 0.03));
    // Full cells, a bit each; and a mesh at once.
    let out = path("cells.nrrd");
    let done = boolean(&[&a, &b, &out, "--op", "difference", "--cells"]);
    assert!(done.code == 0 && done.err.contains("exact"), "{}", done.err);
    let info = run(&["info", &out, "--json"]).json();
    assert_eq!(info["parts"][0]["dimensions"].to_string(), "[21,21,21]", "{info}");
    let full = of_a.iter().zip(&of_b).filter(|&(&a, &b)| a < 0.0 && b >= 0.0).count();
    let bytes = std::fs::read(&out).expect("it was written");
    let body = &bytes[bytes.len() - 21 * 21 * 21..];
    assert_eq!(body.iter().filter(|&&byte| byte != 0).count(), full);
    let out = path("union.ply");
    let done = boolean(&[&a, &b, &out, "--op", "union", "--json"]);
    assert_eq!(done.code, 0, "{}", done.err);
    assert_eq!(done.json()["input"]["operation"], "union");
    // Two balls whose centres are 0.45 apart: the lens that they share is counted once.
    let volume = run(&["info", &out, "--json"]).json()["volume"].as_f64().expect("a number");
    let (r, s, d) = (0.6f64, 0.5f64, 0.45f64);
    let pi = std::f64::consts::PI;
    let lens = pi * (r + s - d).powi(2) * (d * d + 2.0 * d * (r + s) - 3.0 * (r - s).powi(2)) / (12.0 * d);
    let wanted = 4.0 / 3.0 * pi * (r.powi(3) + s.powi(3)) - lens;
    // Chords of a ball of five or six cells lie inside.
    assert!(volume / wanted > 0.96 && volume / wanted < 1.0, "{volume} {wanted}");
}

#[test]
fn other_lattices_are_named_or_sampled_anew() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out.nrrd").display().to_string();
    let (a, b) = (ball(&folder, "a.nrrd", 21, 0.0, 0.5), ball(&folder, "b.nrrd", 41, 0.1, 0.6));
    let refused = boolean(&[&a, &b, &out, "--op", "union"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    for word in ["E-voxels-lattices", "21 x 21 x 21", "41 x 41 x 41", "0.1 x 0.1 x 0.1", "--resample"] {
        assert!(refused.err.contains(word), "{word}: {}", refused.err);
    }
    let done = boolean(&[&a, &b, &out, "--op", "intersection", "--resample"]);
    assert!(done.code == 0 && !done.err.contains("W-boolean-beyond"), "{}", done.err);
    // Every other sample of the finer one lies on a sample of the coarser.
    let wanted = ball(&folder, "wanted.nrrd", 21, 0.1, 0.6);
    let pairs = samples(&a).into_iter().zip(samples(&wanted)).map(|(a, b)| a.max(b));
    assert!(pairs.zip(samples(&out)).all(|(wanted, found)| (wanted - found).abs() < 1e-5));
}

#[test]
fn wrong_words_and_shapes_are_told() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (a, mesh, out) = (ball(&folder, "a.nrrd", 9, 0.0, 0.5), path("mesh.ply"), path("out.nrrd"));
    assert_eq!(run(&["make", "torus", &mesh]).code, 0);
    let told = |words: &[&str], code: u8, word: &str| {
        let refused = boolean(words);
        assert!(refused.code == code && refused.err.contains(word), "{words:?}: {} {}", refused.code, refused.err);
    };
    told(&[&a, &a, &out], 2, "--op");
    told(&[&a, &a, &out, "--op", "both"], 2, "difference");
    told(&[&a, &a, &out, "--op", "intersection", "--smooth", "1"], 2, "E-usage-operation");
    told(&[&a, &a, &out, "--op", "union", "--smooth", "0"], 2, "E-voxels-overflow");
    told(&[&a, &a, &out, "--op", "union", "--smooth", "NaN"], 2, "E-voxels-overflow");
    told(&[&a, &a, &out, "--morph", "1.5"], 2, "E-voxels-overflow");
    told(&[&a, &a, &out, "--op", "union", "--morph", "0.5"], 2, "--morph");
    told(&["-", "-", &out, "--op", "union"], 2, "E-usage-shapes");
    told(&[&a, &mesh, &out, "--op", "union"], 4, "E-boolean-volume");
    told(&[&a, &path("nothing.nrrd"), &out, "--op", "union"], 3, "E-input-open");
    told(&[&a, &a, &out, "--op", "union", "--max-memory", "10K"], 7, "budget");
    told(&[&a, &a, &a, "--op", "union"], 6, "E-output-exists");
    assert!(!std::path::Path::new(&out).exists());
}

/// A tolerance is no wish to move a surface.
#[test]
fn an_offset_must_be_told_its_distance() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (a, out) = (ball(&folder, "a.nrrd", 17, 0.0, 0.5), folder.path().join("out.nrrd").display().to_string());
    let refused = run(&["convert", &a, &out, "--method", "offset-level-set"]);
    assert_eq!(refused.code, 2, "{}", refused.err);
    assert!(refused.err.contains("E-plan-missing") && refused.err.contains("distance"), "{}", refused.err);
    for key in ["distance", "offset-level-set.distance"] {
        let done =
            run(&["convert", &a, &out, "--method", "offset-level-set", "--set", &format!("{key}=0.25"), "--force"]);
        assert_eq!(done.code, 0, "{}", done.err);
        let moved = samples(&a).into_iter().zip(samples(&out)).map(|(before, after)| before - after);
        assert!(moved.into_iter().all(|by| (by - 0.25).abs() < 1e-6));
    }
    // The time of a flow follows from the tolerance: a ball of its radius vanishes.
    let words = ["convert", &a, &out, "--method", "curvature-flow", "--tolerance", "0.1", "--force", "-v"];
    let done = run(&words);
    assert!(done.code == 0 && done.err.contains("time = 0.0025"), "{}", done.err);
}
