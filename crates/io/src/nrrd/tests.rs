//! NRRD by hand.

use std::sync::Arc;

use shapeloom_core::Diagnostic;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::{Geometry, Units};
use shapeloom_voxels::VoxelGrid;

use crate::{ReadContext, ReadError, ReadShape, SiblingError, SiblingName, Siblings, format_by_id, read};

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

/// Of four axes the first one of a single sample goes, with what is said of it.
#[test]
fn each_axis_has_its_own_spacing_and_axes_of_one_sample_go() {
    let fields = "type: uchar\ndimension: 4\nencoding: raw\nspacings: NaN 2 3 5\naxis mins: NaN 1 7 9\nsizes: 1 2 1 4";
    let read = attempt(fields, b"12345678").unwrap();
    let lattice = grid(&read).lattice();
    assert_eq!(lattice.dimensions(), [2, 1, 4]);
    assert_eq!((lattice.position([0; 3]), lattice.spacing()), (DVec3::new(1.0, 7.0, 9.0), DVec3::new(2.0, 3.0, 5.0)));
    assert_eq!(attempt(&fields.replace("1 2 1 4", "2 2 1 2"), b"12345678").unwrap_err().code(), "E-volume-spacing");
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

/// Files beside a header.
struct Beside(Vec<(String, Vec<u8>)>);

impl Siblings for Beside {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let found = self.0.iter().find(|(own, _)| own == name.as_str()).ok_or(SiblingError::Missing)?;
        Ok(found.1[..found.1.len().min(max_bytes as usize)].to_vec())
    }
}

fn beside(header: &str, files: &[(&str, &[u8])]) -> Result<ReadShape, ReadError> {
    let files = files.iter().map(|(name, bytes)| ((*name).to_owned(), bytes.to_vec())).collect();
    let siblings: Arc<dyn Siblings> = Arc::new(Beside(files));
    let context = ReadContext { siblings: Some(siblings), ..ReadContext::named("a.nhdr") };
    read(format!("NRRD0004\n{header}").as_bytes(), format_by_id("nrrd").unwrap(), &context)
}

/// The documentation of Teem: files are slices along the last axis, or parts of it, one a line or by numbers.
#[test]
fn samples_lie_in_several_files() {
    use std::io::Write;
    let header = "type: uchar\ndimension: 3\nsizes: 2 1 4\nencoding: raw";
    let files: [(&str, &[u8]); 6] = [
        ("s 7.raw", b"ab"),
        ("s 9.raw", b"cd"),
        ("s11.raw", b"ef"),
        ("s13.raw", b"gh"),
        ("one", b"abcd"),
        ("two", b"efgh"),
    ];
    let gzip = |bytes: &[u8]| {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    };
    let samples = |read: &ReadShape| (0..8).map(|at| grid(read).samples().get(at) as u8).collect::<Vec<_>>();
    for (field, wanted) in [
        ("data file: s%2d.raw 7 13 2", b"abcdefgh"),
        ("data file: s%2d.raw 13 7 -2", b"ghefcdab"),
        ("data file: s%2i.raw 7 14 2 2", b"abcdefgh"),
        ("data file: LIST\ns11.raw\ns 7.raw\ns 9.raw\ns13.raw\n", b"efabcdgh"),
        ("data file: LIST 3\r\none\r\ntwo", b"abcdefgh"),
    ] {
        let read = beside(&format!("{header}\n{field}"), &files).unwrap_or_else(|error| panic!("{field}: {error}"));
        assert!(samples(&read) == *wanted && read.findings.is_empty(), "{field}: {:?}", read.findings);
        assert_eq!(grid(&read).lattice().dimensions(), [2, 1, 4]);
    }
    // Every file has what the header says of one: packed, in text, with bytes and lines to be passed over.
    let (one, two) = (gzip(b"??abcd"), gzip(b"??efgh"));
    let packed = format!("{}\nbyte skip: 2\ndata file: p%d 0 1 1 3\n", header.replace("raw", "gzip"));
    assert_eq!(samples(&beside(&packed, &[("p0", &one), ("p1", &two)]).unwrap()), b"abcdefgh");
    let text = format!("{}\nline skip: 1\ndata file: LIST 3\nt1\nt2\n", header.replace("raw", "ascii"));
    let found = beside(&text, &[("t1", b"first\n1 2\n3 4"), ("t2", b"second\n5 6 7 8\n")]).unwrap();
    assert_eq!(samples(&found), [1, 2, 3, 4, 5, 6, 7, 8]);
    let last = format!("{header}\nbyte skip: -1\ndata file: l%02d 1 2 1 3\n");
    assert_eq!(samples(&beside(&last, &[("l01", b"head abcd"), ("l02", b"efgh")]).unwrap()), b"abcdefgh");
}

#[test]
fn wrong_lists_of_files_are_refused_before_anything_is_opened() {
    let header = "type: uchar\ndimension: 3\nsizes: 2 1 4\nencoding: raw";
    let files: [(&str, &[u8]); 3] = [("a0", b"abcd"), ("a1", b"efg"), ("..", b"abcd")];
    for (field, code, words) in [
        ("data file: a%d 0 1 1", "E-nrrd-count", "2 files, expected 4"),
        ("data file: a%d 0 2 1 3", "E-nrrd-count", "3 files, expected a number that divides the last of the sizes, 4"),
        ("data file: a%d 0 1 1 4", "E-nrrd-count", "axes in each file from 1 to 3"),
        ("data file: a%d 0 18446744073709551615 1", "E-nrrd-count", "18446744073709551615 files, expected 4"),
        ("data file: a%d 0 1 0", "E-nrrd-header", "the step"),
        ("data file: a%d 1 0 1", "E-nrrd-header", "the step"),
        ("data file: a%d 0 1", "E-nrrd-header", "the step"),
        ("data file: a%f 0 1 1", "E-nrrd-header", "the step"),
        ("data file: a%99d 0 1 1", "E-nrrd-header", "the step"),
        ("data file: LIST", "E-nrrd-count", "0 files"),
        ("data file: LIST 3\n\n", "E-nrrd-count", "0 files"),
        ("data file: a%d 0 1 1 3", "E-volume-truncated", "a1"),
        ("data file: LIST 3\na0\nmissing", "E-sibling-missing", "\"missing\""),
        ("data file: LIST 3\na0\n../a1", "E-sibling-path", "\"../a1\""),
        ("data file: /a%d 0 1 1 3", "E-sibling-path", "\"/a0\""),
        ("data file: 100%.raw", "E-sibling-missing", "\"100%.raw\""),
    ] {
        let error = beside(&format!("{header}\n{field}"), &files).unwrap_err();
        assert!(error.code() == code && error.to_string().contains(words), "{field}: {error}");
    }
    // What a header claims is not taken before files are there.
    let huge =
        "type: double\ndimension: 3\nsizes: 4000 4000 60000\nendian: little\nencoding: gzip\ndata file: a%d 1 60000 1";
    assert_eq!(beside(huge, &files).unwrap_err().code(), "E-volume-truncated");
}
