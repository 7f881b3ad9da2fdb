//! Every encoding of VTI holds the same samples.

use shapeloom_core::Diagnostic;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::Geometry;
use shapeloom_voxels::VoxelGrid;

use crate::{ReadContext, ReadError, ReadShape, format_by_id, read};

fn attempt(bytes: &[u8]) -> Result<ReadShape, ReadError> {
    read(bytes, format_by_id("vti").unwrap(), &ReadContext::named("a.vti"))
}

fn grid(read: &ReadShape) -> &VoxelGrid {
    let Geometry::VoxelGrid(grid) = &*read.shape.parts[0].geometry else { panic!("a grid") };
    grid
}

fn base64(bytes: &[u8]) -> String {
    const SYMBOLS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let groups = bytes.chunks(3).map(|group| {
        let bits = (0..3).fold(0u32, |bits, at| bits << 8 | u32::from(group.get(at).copied().unwrap_or(0)));
        let symbol = |at: usize| char::from(SYMBOLS[(bits >> (18 - 6 * at)) as usize & 63]);
        (0..4).map(|at| if at <= group.len() { symbol(at) } else { '=' }).collect::<String>()
    });
    groups.collect()
}

fn number(value: u64, wide: bool, big: bool) -> Vec<u8> {
    let mut bytes = if wide { value.to_le_bytes().to_vec() } else { (value as u32).to_le_bytes().to_vec() };
    if big {
        bytes.reverse();
    }
    bytes
}

/// Blocks of ten bytes: numbers of two bytes are not cut, nor are they whole in a piece.
fn blocks(data: &[u8], wide: bool, big: bool) -> (Vec<u8>, Vec<u8>) {
    use std::io::Write;
    let packed: Vec<Vec<u8>> = data
        .chunks(10)
        .map(|chunk| {
            let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
            encoder.write_all(chunk).unwrap();
            encoder.finish().unwrap()
        })
        .collect();
    let mut table = [packed.len() as u64, 10, data.len() as u64 % 10].map(|count| number(count, wide, big)).concat();
    table.extend(packed.iter().flat_map(|block| number(block.len() as u64, wide, big)));
    (table, packed.concat())
}

#[test]
fn every_encoding_holds_the_same_samples() {
    let values: Vec<i16> = (0..24).map(|at| at * at * 7 - 300).collect();
    for (wide, big, packed) in (0..8).map(|bits| (bits & 1 == 1, bits & 2 == 2, bits & 4 == 4)) {
        let data: Vec<u8> =
            values.iter().flat_map(|value| if big { value.to_be_bytes() } else { value.to_le_bytes() }).collect();
        let (table, body) = match packed {
            true => blocks(&data, wide, big),
            false => (number(data.len() as u64, wide, big), data.clone()),
        };
        let raw = [&table[..], &body].concat();
        // Compressed tables are padded by themselves, plain counts are not.
        let text = if packed { base64(&table) + &base64(&body) } else { base64(&raw) };
        let list: String = values.iter().map(|value| format!("{value}\n")).collect();
        for (format, content, appended) in [
            ("format=\"ascii\"", list, None),
            ("format=\"binary\"", format!("\n   {text}\n  "), None),
            ("format=\"appended\" offset=\"3\"", String::new(), Some((b"raw".as_slice(), [b"???", &raw[..]].concat()))),
            ("format=\"appended\" offset=\"0\"", String::new(), Some((b"base64", text.clone().into_bytes()))),
        ] {
            let mut file = format!(
                "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" byte_order=\"{}\" header_type=\"{}\" {}>\n\
                 <ImageData WholeExtent=\"2 5 0 2 -1 0\" Origin=\"1 2 3\" Spacing=\"1 2 0.5\" Direction=\"0 -1 0 1 0 0 0 0 1\">\
                 <Piece Extent=\"2 5 0 2 -1 0\"><PointData Scalars=\"b\"><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1\
                 </DataArray><DataArray type=\"Int16\" Name=\"b\" {format}>{content}</DataArray></PointData></Piece></ImageData>",
                if big { "BigEndian" } else { "LittleEndian" },
                if wide { "UInt64" } else { "UInt32" },
                if packed { "compressor=\"vtkZLibDataCompressor\"" } else { "" },
            )
            .into_bytes();
            if let Some((encoding, data)) = &appended {
                let parts: [&[u8]; 5] =
                    [b"<AppendedData encoding=\"", encoding, b"\">\n _", data, b"\n</AppendedData>"];
                file.extend(parts.concat());
            }
            file.extend(b"</VTKFile>\n");
            let read = attempt(&file).unwrap_or_else(|error| panic!("{wide} {big} {packed} {format}: {error}"));
            assert_eq!((read.losses.len(), read.findings.is_empty()), (1, true), "{:?}", read.findings);
            let grid = grid(&read);
            assert!(values.iter().enumerate().all(|(at, &value)| grid.samples().get(at as u64) == f32::from(value)));
            // Extent and matrix by hand: columns are the directions of the axes.
            assert_eq!(grid.lattice().position([0; 3]), DVec3::new(1.0, 4.0, 2.5));
            assert_eq!(grid.lattice().position([1, 1, 1]), DVec3::new(-1.0, 5.0, 3.0));
        }
    }
}

#[test]
fn samples_of_cells_are_their_middles() {
    let file = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 1 0 1\" Spacing=\"2 1 1\"><Piece><CellData>\
                <DataArray type=\"UInt8\" Name=\"occupancy\" format=\"ascii\">1 0</DataArray></CellData></Piece></ImageData></VTKFile>";
    let read = attempt(file.as_bytes()).unwrap();
    assert_eq!(grid(&read).lattice().dimensions(), [2, 1, 1]);
    assert_eq!(grid(&read).lattice().position([1, 0, 0]), DVec3::new(3.0, 0.5, 0.5));
    assert_eq!(grid(&read).quantity(), shapeloom_voxels::Quantity::Occupancy);
}

#[test]
fn a_piece_of_a_whole_is_where_its_extent_says() {
    let file = "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 9 0 9 0 9\" Origin=\"1 0 0\" Spacing=\"2 1 1\">\
                <Piece Extent=\"3 4 5 5 6 6\"><PointData><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">1 2</DataArray>\
                </PointData></Piece></ImageData></VTKFile>";
    let read = attempt(file.as_bytes()).unwrap();
    assert_eq!(grid(&read).lattice().dimensions(), [2, 1, 1]);
    assert_eq!(grid(&read).lattice().position([1, 0, 0]), DVec3::new(9.0, 5.0, 6.0));
    assert_eq!(read.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["W-vti-piece"]);
}

#[test]
fn what_is_not_read_is_named() {
    let file = |attributes: &str, array: &str| {
        format!(
            "<VTKFile type=\"ImageData\" {attributes}><ImageData WholeExtent=\"0 1 0 1 0 1\"><Piece><PointData>\
                 <DataArray type=\"UInt8\" {array}</DataArray></PointData></Piece></ImageData></VTKFile>"
        )
    };
    for (attributes, array, code) in [
        ("compressor=\"vtkLZ4DataCompressor\"", "format=\"ascii\">1 2 3 4 5 6 7 8", "E-vti-feature"),
        ("byte_order=\"Middle\"", "format=\"ascii\">1 2 3 4 5 6 7 8", "E-vti-value"),
        ("", "format=\"ascii\" NumberOfComponents=\"3\">1 2 3 4 5 6 7 8", "E-vti-dimension"),
        ("", "format=\"binary\">CAAAADEyMzQ1Njc4", ""),
        ("", "format=\"binary\">CQAAADEyMzQ1Njc4", "E-vti-length"),
        ("", "format=\"binary\">CAAAADEyMzQ1Njc", "E-vti-data"),
        ("", "format=\"binary\">CAAAADEyMzQ1", "E-volume-truncated"),
        ("", "format=\"appended\" offset=\"0\">", "E-vti-header"),
        ("header_type=\"UInt64\"", "format=\"binary\">//////////8xMjM0NTY3OA==", "E-vti-length"),
        ("compressor=\"vtkZLibDataCompressor\"", "format=\"binary\">AQAAAAgAAAAAAAAACAAAADEyMzQ1Njc4", "E-volume-data"),
        (
            "compressor=\"vtkZLibDataCompressor\"",
            "format=\"binary\">AQAAAAgAAAAAAAAA/////zEyMzQ1Njc4",
            "E-volume-truncated",
        ),
        ("compressor=\"vtkZLibDataCompressor\"", "format=\"binary\">/////wAAAAAIAAAA", "E-volume-truncated"),
    ] {
        let found = attempt(file(attributes, array).as_bytes()).map_err(|error| error.code());
        assert_eq!(found.map_or_else(|code| code, |_| ""), code, "{array}");
    }
}

/// As a gzip file that ends within its checksum is: all samples are there, which is told.
#[test]
fn files_that_end_after_their_samples_are_told() {
    let data: Vec<u8> = (1..=24).collect();
    let (table, body) = blocks(&data, false, false);
    let file = |compressor: &str, data: &[u8], end: &str| {
        let head = format!(
            "<VTKFile type=\"ImageData\" {compressor}><ImageData WholeExtent=\"0 3 0 2 0 1\"><Piece><PointData>\
             <DataArray type=\"UInt8\" Name=\"a\" format=\"appended\" offset=\"0\"/></PointData></Piece></ImageData>\
             <AppendedData encoding=\"raw\">_"
        );
        [head.as_bytes(), data, end.as_bytes()].concat()
    };
    let told = |bytes: &[u8]| {
        let read = attempt(bytes)?;
        assert!(data.iter().enumerate().all(|(at, &value)| grid(&read).samples().get(at as u64) == f32::from(value)));
        Ok(read.findings.iter().map(|finding| finding.code).collect::<Vec<_>>())
    };
    let plain = [&number(24, false, false)[..], &data].concat();
    let end = "\n</AppendedData>\n</VTKFile>\n";
    assert_eq!(told(&file("", &plain, end)).unwrap(), [""; 0]);
    let tags = end.trim_end().len();
    for cut in 0..tags {
        assert_eq!(told(&file("", &plain, &end[..cut])).unwrap(), ["W-volume-truncated"], "{cut}");
    }
    let few = told(&file("", &plain[..plain.len() - 1], "")).map_err(|error: ReadError| error.code());
    assert_eq!(few, Err("E-volume-truncated"));

    let zlib = "compressor=\"vtkZLibDataCompressor\"";
    let packed = [&table[..], &body].concat();
    assert_eq!(told(&file(zlib, &packed, end)).unwrap(), [""; 0]);
    for cut in 1..=4 {
        // Once for the tags that are not there, once for the checksum.
        let found = told(&file(zlib, &packed[..packed.len() - cut], "")).unwrap();
        assert!(found.iter().all(|code| *code == "W-volume-truncated") && !found.is_empty(), "{cut}: {found:?}");
        // A table that gives the second block less than it takes.
        let mut short = table.clone();
        short[16] -= cut as u8;
        let first = usize::from(table[12]);
        let end_of_second = first + usize::from(table[16]);
        let body = [&body[..end_of_second - cut], &body[end_of_second..]].concat();
        let whole = file(zlib, &[&short[..], &body].concat(), end);
        assert_eq!(told(&whole).unwrap(), ["W-volume-truncated"], "{cut}");
    }
    let few = told(&file(zlib, &packed[..packed.len() - 5], "")).map_err(|error: ReadError| error.code());
    assert_eq!(few, Err("E-volume-truncated"));
}
