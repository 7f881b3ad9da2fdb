//! NRRD by hand.

use shapeloom_core::Diagnostic;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::{Geometry, Units};
use shapeloom_voxels::VoxelGrid;

use crate::{ReadContext, ReadError, ReadShape, format_by_id, read};

fn attempt(header: &str, data: &[u8]) -> Result<ReadShape, ReadError> {
    let bytes = [b"NRRD0004\n", header.as_bytes(), b"\n\n", data].concat();
    read(&bytes, format_by_id("nrrd").unwrap(), &ReadContext::named("a.nrrd"))
}

fn grid(read: &ReadShape) -> &VoxelGrid {
    let Geometry::VoxelGrid(grid) = &*read.shape.parts[0].geometry else { panic!("a grid") };
    grid
}

const PLAIN: &str = "type: uchar\ndimension: 3\nsizes: 2 2 2\nencoding: raw";

/// Teem's documentation: cells of a range divide it, nodes are at its ends.
#[test]
fn ranges_of_axes_become_spacings() {
    for (fields, first, step) in [
        ("axis mins: 0 0 0\naxis maxs: 4 4 4", 1.0, 2.0),
        ("axis mins: 0 0 0\naxis maxs: 4 4 4\ncenters: node node node", 0.0, 4.0),
        ("axis mins: 1 1 1\nspacings: 3 3 3", 1.0, 3.0),
        ("axis mins: 1 1 1\nspacings: 3 3 3\ncenterings: cell cell cell", 2.5, 3.0),
        ("spacings: 3 3 3\nspace dimension: 3\nspace origin: (7,7,7)", 7.0, 3.0),
    ] {
        let read = attempt(&format!("{PLAIN}\n{fields}"), b"12345678").unwrap();
        let lattice = grid(&read).lattice();
        assert_eq!(
            (lattice.position([0; 3]), lattice.spacing()),
            (DVec3::splat(first), DVec3::splat(step)),
            "{fields}"
        );
    }
}

#[test]
fn directions_units_and_words_are_read() {
    let fields = "Space Directions: (0,2,0) (-1,0,0) (0,0.5,3)\nspace origin: (1,2,3)\nspace: RAS\nspace units: \"um\" \"um\" \"um\"\n\
                  # hello\nkey:=value\ncontent: a ball";
    let read = attempt(&format!("{PLAIN}\n{fields}"), b"12345678").unwrap();
    let lattice = grid(&read).lattice();
    assert_eq!(lattice.position([1, 1, 1]), DVec3::new(0.0, 4.5, 6.0));
    assert_eq!(read.shape.units, Units::from_meters(1e-6).ok());
    assert_eq!(read.shape.comments, ["space: RAS", "hello", "key:=value", "content: a ball"]);
}

#[test]
fn text_skips_and_orders_of_bytes() {
    let text = "type: short\ndimension: 3\nsizes: 2 1 2\nencoding: text\nline skip: 1";
    let read = attempt(text, b"not this\n1 -2\n3 4\n").unwrap();
    assert_eq!([0, 1, 2, 3].map(|at| grid(&read).samples().get(at)), [1.0, -2.0, 3.0, 4.0]);
    let big = "type: uint16\ndimension: 3\nsizes: 1 1 2\nencoding: raw\nendian: big\nbyte skip: -1";
    let read = attempt(big, b"??\x01\x02\x03\x04").unwrap();
    assert_eq!([0, 1].map(|at| grid(&read).samples().get(at)), [258.0, 772.0]);
    let code = |header: &str, data: &[u8]| attempt(header, data).unwrap_err().code();
    assert_eq!(code("type: uint16\ndimension: 3\nsizes: 1 1 2\nencoding: raw", b"1234"), "E-nrrd-header");
    assert_eq!(code(&format!("{PLAIN}\nsizes: 2 2 2"), b"12345678"), "E-nrrd-duplicate");
    assert_eq!(code(&format!("{PLAIN}\nno field"), b"12345678"), "E-nrrd-header");
    assert_eq!(code(&PLAIN.replace("uchar", "block"), b"12345678"), "E-nrrd-type");
}

/// A bomb stops after one byte too many; a second member of a gzip file goes on with the first; a wrong sum is told.
#[test]
fn gzip_stops_where_the_samples_end() {
    use std::io::Write;
    let packed = |bytes: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    let header = PLAIN.replace("raw", "gzip");
    let two = [packed(b"1234"), packed(b"5678")].concat();
    assert_eq!(grid(&attempt(&header, &two).unwrap()).samples().get(7), 56.0);
    let bomb = attempt(&header, &packed(&vec![7; 50 << 20])).unwrap_err();
    assert_eq!(bomb.code(), "E-volume-trailing");
    let mut wrong = packed(b"12345678");
    let sum = wrong.len() - 8;
    wrong[sum] ^= 1;
    assert_eq!(attempt(&header, &wrong).unwrap_err().code(), "E-volume-data");
    let cut = &packed(b"12345678")[..14];
    assert_eq!(attempt(&header, cut).unwrap_err().code(), "E-volume-truncated");
    let more = [packed(b"12345678"), b"more".to_vec()].concat();
    let findings = attempt(&header, &more).unwrap().findings;
    assert_eq!(findings.iter().next().unwrap().code, "W-volume-trailing");
}
