//! Volumes as no program should write them.

use crate::collection::expected;
use crate::support::{run_on, shared_data};

/// The collection of malformed files, where it is there: what it says, where it says.
#[test]
fn the_collection_comes_out_as_expected() {
    for case in expected("volume") {
        case.check(|kind| match kind {
            "CountExceedsInput" => &["E-volume-claim"],
            "InvalidCount" => &["E-nrrd-count"],
            "MissingField" => &["E-nrrd-header", "E-metaimage-header"],
            "UnexpectedEof" => &["E-volume-truncated"],
            "TrailingData" => &["E-volume-trailing"],
            "Io" => &["E-sibling-missing"],
            "NonFinite" => &["W-volume-finite"],
            _ => &[],
        });
    }
    assert!(shared_data("malformed/volume/valid.nrrd").is_none() || expected("volume").len() == 11);
}

/// One header with one line replaced, refused with a code and a place.
#[test]
fn what_is_wrong_with_a_header_is_named_with_its_line() {
    let nrrd = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspacings: 1 1 1\nencoding: raw\n\n12345678";
    let mha = "ObjectType = Image\nNDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 1\nElementType = MET_UCHAR\n\
               ElementDataFile = LOCAL\n12345678";
    let vtk = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nSPACING 1 1 1\n\
               ORIGIN 0 0 0\nPOINT_DATA 8\nSCALARS s float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\n";
    let vti = "<VTKFile type=\"ImageData\">\n<ImageData WholeExtent=\"0 1 0 1 0 1\" Spacing=\"1 1 1\">\n<Piece>\n<PointData>\n\
               <DataArray type=\"UInt8\" format=\"ascii\">1 2 3 4 5 6 7 8</DataArray>\n</PointData></Piece></ImageData></VTKFile>";
    let cases: &[(&str, &str, &str, &str, &str)] = &[
        (nrrd, "spacings: 1 1 1", "spacings: 1 nan 1", "E-volume-spacing", "line 5"),
        (nrrd, "spacings: 1 1 1", "spacings: 1 0 1", "E-volume-spacing", "line 5"),
        (nrrd, "spacings: 1 1 1", "spacings: 1 -2 1", "E-volume-spacing", "line 5"),
        (nrrd, "spacings: 1 1 1", "space directions: (1,0,0) (1,0,0) (0,0,1)", "E-volume-grid", "line 5"),
        (nrrd, "spacings: 1 1 1", "space directions: (1,0,0) (0,nan,0) (0,0,1)", "E-volume-grid", "line 5"),
        (nrrd, "spacings: 1 1 1", "space directions: (1,0) (0,1) (0,0)", "E-nrrd-dimension", "line 5"),
        (nrrd, "spacings: 1 1 1", "kinds: vector domain domain", "E-nrrd-dimension", "vector"),
        (nrrd, "dimension: 3\nsizes: 2 2 2", "dimension: 4\nsizes: 3 2 2 2", "E-nrrd-dimension", "line 3"),
        (nrrd, "sizes: 2 2 2", "sizes: 18446744073709551615 2 2", "E-volume-claim", "line 4"),
        (nrrd, "sizes: 2 2 2", "sizes: 18446744073709551616 2 2", "E-nrrd-count", "line 4"),
        (nrrd, "sizes: 2 2 2", "sizes: 2 0 2", "E-volume-size", "line 4"),
        (nrrd, "encoding: raw", "encoding: bzip2", "E-nrrd-feature", "line 6"),
        (nrrd, "encoding: raw", "data file: ../up.raw\nencoding: raw", "E-sibling-path", "line 6"),
        (nrrd, "encoding: raw\n\n", "encoding: gzip\n\nno gzip, ", "E-volume-data", "payload"),
        (nrrd, "NRRD0004", "NRRD0009", "E-nrrd-version", "line 1"),
        (nrrd, "\n\n12345678", "", "E-nrrd-header", "end of the file"),
        (mha, "ElementSpacing = 1 1 1", "ElementSpacing = 1 1 0", "E-volume-spacing", "line 4"),
        (mha, "DimSize = 2 2 2", "DimSize = 4294967296 4294967296 2", "E-volume-claim", "line 3"),
        (mha, "LOCAL", "other.raw", "E-sibling-missing", "line 6"),
        (mha, "NDims = 3", "NDims = 2", "E-metaimage-dimension", "line 2"),
        (vtk, "SPACING 1 1 1", "SPACING 1 nan 1", "E-volume-spacing", "line 6"),
        (vtk, "STRUCTURED_POINTS", "POLYDATA", "E-vtk-feature", "line 4"),
        (vtk, "7 8\n", "7.5\n", "E-volume-truncated", "line 12"),
        (vtk, "6 7 8", "6 x 8", "E-volume-number", "line 11"),
        (vtk, "POINT_DATA 8", "POINT_DATA 9", "E-vtk-count", "line 8"),
        (vti, "Spacing=\"1 1 1\"", "Spacing=\"1 -1 1\"", "E-volume-spacing", "line 2"),
        (vti, "0 1 0 1 0 1", "0 4000000000 0 4000000000 0 4000000000", "E-volume-claim", "line 2"),
        (vti, "0 1 0 1 0 1", "0 -1 0 1 0 1", "E-volume-size", "line 2"),
        (vti, "</DataArray>", "", "E-vti-xml", "line 6"),
        (vti, "6 7 8", "6 7 256", "E-volume-number", "line 5"),
        (vti, "UInt8", "Bit", "E-vti-type", "line 5"),
    ];
    for (whole, line, wrong, code, place) in cases {
        assert!(whole.contains(line), "{line}");
        let outcome = run_on(whole.replace(line, wrong).as_bytes(), &["info", "-"]);
        assert!([3, 4].contains(&outcome.code), "{wrong}: {} {}", outcome.code, outcome.err);
        assert!(outcome.err.contains(code) && outcome.err.contains(place), "{wrong}: {code} {place}: {}", outcome.err);
    }
}
