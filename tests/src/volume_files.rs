//! Volumes through the program: stacks of pictures, raw samples, every format to every other.

use image::{ImageBuffer, Luma};
use serde_json::Value;

use crate::support::{data, run};

fn info(words: &[&str]) -> Value {
    let outcome = run(&[&["info", "--json"], words].concat());
    assert_eq!(outcome.code, 0, "{words:?}: {}", outcome.err);
    outcome.json()
}

/// The value of a sample by a formula: every place has another one.
fn value(x: u32, y: u32, z: u32) -> u16 {
    (x + 7 * y + 50 * z) as u16
}

/// The words of `info` on the one grid of a shape.
fn grid(info: &Value) -> Vec<String> {
    let part = &info["parts"][0];
    assert!(part["lowest"].is_number(), "{info}");
    ["dimensions", "spacing", "lowest", "highest", "sample_type"].iter().map(|key| part[*key].to_string()).collect()
}

#[test]
fn pictures_with_numbers_are_slices() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    for z in 0..4 {
        let bytes = ImageBuffer::from_fn(7, 5, |x, y| Luma([value(x, y, z) as u8]));
        bytes.save(path(&format!("a_{:03}.png", z + 8))).expect("a picture");
        let words = ImageBuffer::<Luma<u16>, _>::from_fn(7, 5, |x, y| Luma([100 * value(x, y, z)]));
        words.save(path(&format!("b{z}.png"))).expect("a picture");
        words.save(path(&format!("c{z}.tif"))).expect("a picture");
    }
    for (name, high) in [("a_008.png", 184.0), ("b0.png", 18_400.0), ("c0.tif", 18_400.0)] {
        let words = [&path(name)[..], "--set", "stack=true", "--set", "voxel_size=0.5x0.5x2"];
        let found = info(&words);
        assert_eq!(found["kind"], "voxel-grid", "{found}");
        assert!(found.to_string().contains("[7,5,4]"), "{found}");
        assert!(found.to_string().contains(&format!("{high:?}")), "{name}: {found}");
        let bounds = &found["bounds"];
        assert_eq!(bounds["max"].to_string(), "[3.0,2.0,6.0]", "{bounds}");
        // The same through a file of volumes.
        let out = path(&format!("{name}.nrrd"));
        let done = run(&["convert", &path(name), &out, "--set", "stack=true", "--set", "voxel_size=0.5x0.5x2"]);
        assert_eq!(done.code, 0, "{}", done.err);
        assert_eq!(grid(&info(&[&out])), grid(&found));
        let bytes = std::fs::read(&out).expect("it was written");
        let scale = if name.starts_with('a') { 1 } else { 100 };
        let size = if scale == 1 { 1 } else { 2 };
        let at = bytes.len() - (7 * 5 * 4 - (3 * 35 + 2 * 7 + 6)) * size;
        let sample = if size == 1 { u16::from(bytes[at]) } else { u16::from_le_bytes([bytes[at], bytes[at + 1]]) };
        assert_eq!(sample, scale * value(6, 2, 3), "{name}");
    }
    // Options of the other kind of picture.
    for (options, words) in [
        (["stack=true", "height=3"], "the option height = 3 with stack = true"),
        (["stack=true", "exaggeration=2"], "the option exaggeration = 2 with stack = true"),
        (["stack=true", "spacing=2"], "the option spacing = 2 with stack = true"),
        (["stack=true", "encoding=mapbox"], "the option encoding = mapbox with stack = true"),
        (["stack=true", "dimensions=7x5x4"], "--set dimensions for"),
        (["stack=false", "voxel_size=2"], "the option voxel_size = 2 without stack = true"),
    ] {
        for name in ["b0.png", "c0.tif"] {
            let refused = run(&["info", &path(name), "--set", options[0], "--set", options[1]]);
            assert!(refused.code == 2 && refused.err.contains(words), "{name} {options:?}: {}", refused.err);
        }
    }
    // A gap, another size, and a name without a number.
    std::fs::remove_file(path("b2.png")).expect("it was there");
    let words = |name: &str| run(&["info", &path(name), "--set", "stack=true"]);
    let gap = words("b0.png");
    assert!(gap.code == 3 && gap.err.contains("E-volume-stack") && gap.err.contains("b2.png"), "{}", gap.err);
    ImageBuffer::from_fn(6, 5, |_, _| Luma([1u8])).save(path("a_010.png")).expect("a picture");
    let odd = words("a_008.png");
    assert!(odd.code == 3 && odd.err.contains("6 × 5") && odd.err.contains("a_010.png"), "{}", odd.err);
    ImageBuffer::from_fn(6, 5, |_, _| Luma([1u8])).save(path("slice.png")).expect("a picture");
    assert!(words("slice.png").err.contains("E-volume-stack"));
}

/// Pages of one file.
#[test]
fn pages_of_a_tiff_are_slices() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("pages.tif").display().to_string();
    let mut bytes = b"II*\0".to_vec();
    // Three pages of 2 × 2 bytes: samples, then the tags, page by page.
    let mut link = bytes.len();
    bytes.extend([0; 4]);
    for z in 0..3u8 {
        let samples = bytes.len() as u32;
        bytes.extend([10 * z, 10 * z + 1, 10 * z + 2, 10 * z + 3]);
        let start = bytes.len() as u32;
        bytes[link..link + 4].copy_from_slice(&start.to_le_bytes());
        let tags =
            [(256u16, 2u32), (257, 2), (258, 8), (259, 1), (262, 1), (273, samples), (277, 1), (278, 2), (279, 4)];
        bytes.extend((tags.len() as u16).to_le_bytes());
        for (tag, value) in tags {
            bytes.extend([tag.to_le_bytes(), 4u16.to_le_bytes()].concat());
            bytes.extend([1u32.to_le_bytes(), value.to_le_bytes()].concat());
        }
        link = bytes.len();
        bytes.extend([0; 4]);
    }
    std::fs::write(&path, bytes).expect("a file");
    let found = info(&[&path, "--set", "stack=true"]).to_string();
    assert!(found.contains("[2,2,3]") && found.contains("23.0"), "{found}");
}

#[test]
fn every_format_of_volumes_becomes_every_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let first = data("orbital.nrrd");
    let wanted = info(&[&first]);
    assert!(wanted.to_string().contains("[64,64,64]") && wanted.to_string().contains("248.0"), "{wanted}");
    let mut from = first.clone();
    for to in ["a.mha", "b.vti", "c.vtk", "d.nrrd"] {
        let done = run(&["convert", &from, &path(to)]);
        assert_eq!(done.code, 0, "{to}: {}", done.err);
        from = path(to);
        assert_eq!(grid(&info(&[&from])), grid(&wanted), "{to}");
    }
    // The samples are the last bytes of the last file, plain.
    let bytes = std::fs::read(&from).expect("it was written");
    let samples = &bytes[bytes.len() - 64 * 64 * 64..];
    assert_eq!(samples.iter().map(|&sample| u64::from(sample)).sum::<u64>(), 777_352);
    std::fs::write(path("e.raw"), samples).expect("a file");
    let raw = info(&[&path("e.raw"), "--set", "dimensions=64x64x64", "--set", "voxel_size=0.75"]);
    assert_eq!(grid(&raw), grid(&wanted));
    let packed = run(&["convert", &from, &path("f.nrrd"), "--set", "compress=true"]);
    assert!(
        packed.code == 0 && std::fs::metadata(path("f.nrrd")).is_ok_and(|data| data.len() < 30_000),
        "{}",
        packed.err
    );
    let refused = run(&["info", &path("e.raw")]);
    assert!(refused.code == 2 && refused.err.contains("dimensions=XxYxZ"), "{} {}", refused.code, refused.err);
}

/// Whatever makes triangles of a volume says that it guessed where, and why there are none.
#[test]
fn a_guessed_or_empty_surface_is_said_by_every_command() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let volume = data("orbital.nrrd");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (out, picture) = (path("out.glb"), path("out.png"));
    for words in [
        &["convert", &volume, &out, "--force"][..],
        &["render", &volume, &picture, "--force", "--size", "32x24"],
        &["compare", &volume, &volume],
    ] {
        let guessed = run(words);
        assert!(guessed.code == 0 && guessed.err.contains("warning[W-iso-otsu]"), "{words:?}: {}", guessed.err);
        let given = run(&[words, &["--set", "iso=100"]].concat());
        assert!(given.code == 0 && !given.err.contains("W-iso"), "{words:?}: {}", given.err);
    }
    let checked = run(&["check", &volume]);
    let words = String::from_utf8_lossy(&checked.out).into_owned() + &checked.err;
    assert!(words.contains("warning[W-iso-otsu]"), "{words}");

    let empty = run(&["convert", &volume, &out, "--set", "iso=1e9", "--force"]);
    let wanted = [
        "one side of the iso value 1000000000, so the mesh is empty",
        "set iso to a value between",
        "which is empty: glTF",
    ];
    assert!(empty.code == 0 && wanted.iter().all(|words| empty.err.contains(words)), "{}", empty.err);
    let drawn = run(&["render", &volume, &picture, "--set", "iso=1e9", "--force"]);
    assert!(drawn.code == 4 && drawn.err.contains("W-iso-empty"), "{} {}", drawn.code, drawn.err);
}
