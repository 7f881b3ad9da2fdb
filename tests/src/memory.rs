//! The memory of the process itself, on files made to take much of it.

use std::fs;
use std::process::Command;

use crate::support::{data, root};

/// Beside what the program takes for nothing: its own code, threads and buffers.
const BASE: u64 = 64 << 20;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// The peak of a process that runs these words, in bytes; none where the system does not tell.
fn peak(words: &[&str]) -> Option<u64> {
    let program = env!("CARGO_BIN_EXE_shapeloom-under-test");
    let mut command = Command::new(program);
    let outcome =
        command.args(words).env("SHAPELOOM_PEAK", "1").current_dir(root()).output().expect("the program runs");
    let code = outcome.status.code();
    assert!([Some(0), Some(3), Some(4), Some(7)].contains(&code), "{words:?}: {code:?}");
    let text = String::from_utf8_lossy(&outcome.stderr).into_owned();
    text.lines().last()?.parse::<u64>().ok().map(|kilobytes| kilobytes << 10)
}

fn numbered(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(line).collect()
}

/// What is read takes at most 64 MB and 40 times the file, measured from outside.
#[test]
fn readers_take_memory_in_proportion_to_the_file() {
    let long = "n".repeat(300_000);
    let files: Vec<(&str, String)> = vec![
        (
            "names.obj",
            format!(
                "{SQUARE}g {long}\n{}",
                numbered(4000, |i| format!("o {i}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n"))
            ),
        ),
        ("groups.obj", format!("{SQUARE}{}", numbered(100_000, |i| format!("g {i}\nf 1 2 3\n")))),
        ("materials.obj", format!("{SQUARE}{}", numbered(100_000, |i| format!("usemtl {i}\nf 1 2 3\n")))),
        ("objects.obj", numbered(60_000, |i| format!("o {i}\nv 0 0 0\nf -1 -1 -1\n"))),
        ("lines.obj", numbered(60_000, |i| format!("o {i}\nv 0 0 0\nv 1 1 1\nl 1 2\n"))),
        ("corners.obj", format!("{SQUARE}{}", "f 1 2 3 4\n".repeat(300_000))),
        ("late.obj", format!("{SQUARE}vt 0\nvn 0 0 1\n{}f 1/1/1 2/1/1 3/1/1\n", "f 1 2 3\n".repeat(300_000))),
        ("solids.stl", "solid\nendsolid\n".repeat(100_000)),
        (
            "facets.stl",
            format!(
                "solid\n{}endsolid\n",
                "facet outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n".repeat(50_000)
            ),
        ),
        ("points.off", format!("OFF 300000 0 0\n{}", "0 0 0\n".repeat(300_000))),
        ("faces.off", format!("OFF 3 300000 0\n0 0 0\n1 0 0\n0 1 0\n{}", "3 0 1 2 1 2 3\n".repeat(300_000))),
        (
            "rows.ply",
            format!(
                "ply\nformat ascii 1.0\nelement vertex 300000\nproperty char x\nproperty char y\nproperty char z\nproperty list uchar char l\nend_header\n{}",
                "0 0 0 0\n".repeat(300_000)
            ),
        ),
        (
            "tables.ply",
            format!(
                "ply\nformat ascii 1.0\n{}end_header\n{}",
                numbered(3000, |i| format!("element e{i} 30\nproperty char a\n")),
                "1\n".repeat(90_000)
            ),
        ),
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::write(&path, &text).expect("a file");
        let path = path.display().to_string();
        let Some(found) = peak(&["info", &path]) else { return };
        let most = BASE + 40 * text.len() as u64;
        assert!(found <= most, "{name}: {} bytes took {found}, more than {most}", text.len());
    }
}

/// The same of heights. Of compressed pictures the memory follows from their header, which has a limit of its own: eight
/// bytes a sample.
#[test]
fn readers_of_heights_take_memory_in_proportion_to_their_samples() {
    let grid = |count: usize| {
        format!("ncols {count}\nnrows {count}\nxllcorner 0\nyllcorner 0\ncellsize 1\n{}", "0 ".repeat(count * count))
    };
    let mut sparse = fs::read(data("mount_st_helens.dem")).expect("data/mount_st_helens.dem is in the repository");
    // Profiles of one sample each, as far apart as they may be.
    let (header, profile) = (sparse[..1024].to_vec(), sparse[1024..2048].to_vec());
    sparse = header;
    sparse[858..864].copy_from_slice(b"  3000");
    for number in 0..3000u32 {
        let mut profile = profile.clone();
        profile[12..18].copy_from_slice(b"   146");
        profile[144..1020].copy_from_slice("     7".repeat(146).as_bytes());
        profile[24..48].copy_from_slice(format!("{:24.3}", f64::from(number) * 30.0).as_bytes());
        profile[48..72].copy_from_slice(format!("{:24.3}", f64::from(number / 2 * 30)).as_bytes());
        sparse.extend(profile);
    }
    let mut black = Vec::new();
    let mut encoder = png::Encoder::new(&mut black, 4096, 4096);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&vec![0; 4096 * 4096 / 8]).expect("a black picture");
    writer.finish().expect("its end");
    assert!(black.len() < 20_000);
    let mut binary = b"P5 2000 2000 255\n".to_vec();
    binary.resize(binary.len() + 4_000_000, 9);
    let files: Vec<(&str, Vec<u8>, u64)> = vec![
        ("grid.asc", grid(1500).into_bytes(), 0),
        ("text.pgm", format!("P2 1500 1500 9\n{}", "0 ".repeat(1500 * 1500)).into_bytes(), 0),
        ("binary.pgm", binary, 0),
        ("sparse.dem", sparse, 0),
        ("claim.pgm", b"P5 60000 60000 255\n".to_vec(), 0),
        ("black.png", black, 4096 * 4096),
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes, samples) in files {
        let path = folder.path().join(name);
        fs::write(&path, &bytes).expect("a file");
        let path = path.display().to_string();
        let Some(found) = peak(&["info", &path]) else { return };
        let most = BASE + 40 * bytes.len() as u64 + 8 * samples;
        assert!(found <= most, "{name}: {} bytes took {found}, more than {most}", bytes.len());
    }
}

/// The same of volumes. Of compressed ones the memory follows from their header, which has a limit of its own.
#[test]
fn readers_of_volumes_take_memory_in_proportion_to_their_samples() {
    use std::io::Write;
    let header = |kind: &str, size: usize, encoding: &str| {
        format!(
            "NRRD0004\ntype: {kind}\ndimension: 3\nsizes: {size} {size} {size}\nendian: little\nencoding: {encoding}\n\n"
        )
    };
    let mut zeros =
        flate2::write::GzEncoder::new(header("uint8", 256, "gzip").into_bytes(), flate2::Compression::best());
    // The header is not packed: it is there before the first packed byte.
    zeros.write_all(&vec![0; 256 * 256 * 256]).expect("a buffer");
    let zeros = zeros.finish().expect("a buffer");
    let text = header("double", 110, "ascii") + &"0 ".repeat(110 * 110 * 110);
    let comments = format!("NRRD0004\n{}{}1", "# a\n".repeat(300_000), &header("uint8", 1, "raw")[9..]);
    let arrays = "<DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1 </DataArray>".repeat(20_000);
    let arrays = format!(
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 0 0 0 0 0\"><Piece><PointData>{arrays}</PointData></Piece>\
         </ImageData></VTKFile>"
    );
    let attributes = "a=\"\" ".repeat(200_000);
    let attributes = arrays.replace("<PointData>", &format!("<PointData {attributes}>"));
    let claim = header("double", 2_000_000, "gzip");
    let files: Vec<(&str, Vec<u8>, u64)> = vec![
        ("zeros.nrrd", zeros, 256 * 256 * 256),
        ("text.nrrd", text.into_bytes(), 0),
        ("comments.nrrd", comments.into_bytes(), 0),
        ("arrays.vti", arrays.into_bytes(), 0),
        ("attributes.vti", attributes.into_bytes(), 0),
        ("claim.nrrd", claim.into_bytes(), 0),
    ];
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (name, bytes, samples) in files {
        let path = folder.path().join(name);
        fs::write(&path, &bytes).expect("a file");
        let path = path.display().to_string();
        let Some(found) = peak(&["info", &path]) else { return };
        let most = BASE + 40 * bytes.len() as u64 + 2 * samples;
        assert!(found <= most, "{name}: {} bytes took {found}, more than {most}", bytes.len());
    }
}
