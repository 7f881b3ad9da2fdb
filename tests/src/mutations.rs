//! Readers on inputs that were changed at random, the same each time.

use std::collections::HashMap;

use shapeloom::core::glam::{DMat3, DVec2, DVec3};
use shapeloom::core::{Affine, Options};
use shapeloom::io::{FORMATS, WriteContext, WriteOptions, format_by_id, write};
use shapeloom::mesh::{COLOR, Column, Domain, GeometricGraph, HeightField, NORMAL, PointCloud, TEXCOORD, Values};
use shapeloom::shape::{Material, Part, Shape, Units, UpAxis};
use shapeloom::voxels::isosurface::Lattice;
use shapeloom::voxels::{Quantity, Samples, VoxelGrid};

use crate::entry::read_as;
use crate::shapes;
use crate::support::{Dice, data, root};

/// Inputs of each format by hand, beside those that the writers make.
const BY_HAND: [(&str, &str); 31] = [
    (
        "obj",
        "mtllib a.mtl\no a\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvn 0 0 1\ng b c\nusemtl m\ns 1\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf -4//1 -3//1 \\\n-2//1\nl 1 2 3\np 1 2\n",
    ),
    ("obj", "v 0 0 0\r\nv 1 0 0 0.5\r\nv 1 1 0\r\nf 1 2 3\r\no b\r\nv 5 5 5\r\np -1\r\ncstype bezier\r\n"),
    (
        "off",
        "COFF\n# comment\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n1 1 0 0 0 255 255\n0 1 0 9 9 9 255\n3 0 1 2\n3 0 2 3 10 20 30\n",
    ),
    (
        "off",
        "STCN4OFF 3 1 0\n0 0 0 1 0 0 1 1 0 0 1 0 0\n1 0 0 1 0 0 1 1 0 0 1 1 0\n0 1 0 2 0 0 1 1 0 0 1 0 1\n3 0 1 2\n",
    ),
    (
        "stl",
        "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a b\nsolid c\nendsolid\n",
    ),
    (
        "ply",
        "ply\nformat ascii 1.0\ncomment c\nobj_info i\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty list uchar int tags\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nelement odd 2\nproperty short s\nend_header\n0 0 0 1 2 3 1 7\n1 0 0 1 2 3 0\n1 1 0 1 2 3 2 1 2\n0 1 0 1 2 3 0\n3 0 1 2 6 0 0 1 0 1 1\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n0 1\n5\n6\n",
    ),
    (
        "ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n6 0 1 2 3 -1 2\n",
    ),
    (
        "gltf",
        r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,3,0,0,1]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":0}}},{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],"buffers":[{"byteLength":44,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA="}]}"#,
    ),
    ("bpt", "1\n1 1\n0 0 0\n1 0 0\n0 1 0\n1 1 0.5\n"),
    (
        "stl",
        "solid\nfacet normal nan 0 0\n outer loop\n vertex 1e39 0 0\n vertex 0 1 0\n vertex 0 0 1\n endloop\n endfacet\nendsolid\n",
    ),
    ("pgm", "P2 # made\n3 2\n9\n0 1 2 3\n# half\n4 9\n"),
    ("pgm", "P5\n4 3\n255\n0123456789ab"),
    ("pgm", "P5 3 2 65000\n0a1b2c3d4e5f"),
    ("asc", "ncols 3\nnrows 2\nxllcorner 5e5\nyllcenter -10.5\ndx 1\ndy 2.5\nnodata_value -1\n1 2 3\n4.5e1 -1 nan\n"),
    ("asc", "NCOLS 2\r\nNROWS 2\r\nXLLCENTER 0\r\nYLLCENTER 0\r\nCELLSIZE .5\r\n1 2\r\n-9999 4\r\n"),
    ("off", "4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 1\n"),
    (
        "ply",
        "ply\rformat ascii 1.0\relement vertex 1\rproperty int8 x\rproperty uint16 y\rproperty float64 z\rend_header\r-1 2 3\r",
    ),
    (
        "nrrd",
        "NRRD0004\n# comment\ntype: short\ndimension: 4\nspace: left-posterior-superior\nsizes: 1 3 2 2\nspace directions: none (1,0,0) (0,0.5,0.25) (0,-1,2)\nkinds: stub domain domain domain\nspace origin: (1,-2,3e2)\nspace units: \"mm\" \"mm\" \"mm\"\nkey:=value\nencoding: ascii\n\n1 2 3 4 5 6\n7 8 9 -10 11 12\n",
    ),
    (
        "nrrd",
        "NRRD0001\ntype: uint8\ndimension: 3\nsizes: 3 2 2\nspacings: 1 2 0.5\naxis mins: 0 1 2\ncenters: cell node cell\nencoding: raw\nline skip: 1\nbyte skip: 2\n\nskipped\n..0123456789ab",
    ),
    (
        "nrrd",
        "NRRD0005\ntype: float\ndimension: 3\nsizes: 2 2 2\nendian: big\nencoding: raw\nbyte skip: -1\n\n???abcdabcdabcdabcdabcdabcdabcdabcd",
    ),
    (
        "mha",
        "ObjectType = Image\nNDims = 3\nBinaryData = False\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\nPosition = 1 2 3\nElementSpacing = 1 1 2.5\nDimSize = 3 2 2\nAnatomicalOrientation = RAI\nElementType = MET_SHORT\nElementDataFile = LOCAL\n1 2 3 4 5 6 -7 8 9 10 11 12\n",
    ),
    (
        "mha",
        "NDims = 3\r\nDimSize = 3 2 2\r\nElementSize = 1 1 1\r\nHeaderSize = -1\r\nElementByteOrderMSB = True\r\nElementType = MET_USHORT\r\nElementDataFile = LOCAL\r\n0123456789abcdefghijklmn",
    ),
    (
        "vti",
        "<?xml version=\"1.0\"?>\n<!-- made -->\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"BigEndian\">\n<ImageData WholeExtent=\"0 2 1 2 0 1\" Origin=\"1 2 3\" Spacing=\"1 0.5 2\" Direction=\"0 -1 0 1 0 0 0 0 1\">\n<Piece Extent=\"0 2 1 2 0 1\">\n<PointData Scalars=\"b\">\n<DataArray type=\"Float64\" Name=\"a\" format=\"ascii\">1 2</DataArray>\n<DataArray type=\"Int16\" Name=\"b\" format=\"ascii\">1 2 3 4 5 6\n-7 8 9 10 11 12</DataArray>\n</PointData>\n</Piece>\n</ImageData>\n</VTKFile>\n",
    ),
    (
        "vti",
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 3 0 2 0 2\"><Piece><CellData><DataArray type=\"UInt8\" Name=\"c\" format=\"binary\">\nDAAAADAxMjM0NTY3ODlhYg==\n</DataArray></CellData></Piece></ImageData></VTKFile>",
    ),
    (
        "vtk",
        "# vtk DataFile Version 2.0\na title\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 2\nASPECT_RATIO 1 2 0.5\nORIGIN -1 0 1\nPOINT_DATA 12\nSCALARS density double\nLOOKUP_TABLE default\n1 2 3 4 5 6 nan 8 9 10 11 1e39\n",
    ),
    (
        "vtk",
        "# vtk DataFile Version 3.0\nbits\nBINARY\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 3 3\nSPACING 1 1 1\nORIGIN 0 0 0\nCELL_DATA 12\nSCALARS cells bit 1\nLOOKUP_TABLE default\n\u{3}p\nMETADATA\n",
    ),
    (
        "shape",
        "# a part\nplate = rounded_box(6, 4, 1, radius: 0.25);\nhole = cylinder(0.5, 2).move(1, 2 * 0.5, 0);\nbounds(-4, -4, -4, 4, 4, 4);\nsmooth_union(plate \\ hole, sphere(1) & ~plane(0, 0, 1), radius: 0.3).rotate_x(30 deg) | x ^ 2 + y - 1\n",
    ),
    (
        "shape",
        "metaballs(0.5, 1e-7, 0, 0, 0, 2, 1, 1, 0, 0, 2, 1).displace(sin(x) * 0.1).repeat(4, 0, 4, copies_x: 2)\n",
    ),
    (
        "vm",
        "# a ball\nx var-x\ny var-y\nxx square x\nyy mul y y\ns add xx yy\none const 1e0\nout sub s one\nm max out x\n",
    ),
    (
        "pdb",
        "TITLE     WATER\nATOM      1  N   MET A   1      38.198  19.582  28.998  1.00 54.11           N  \nHETATM    2  O   HOH A   2      37.000  19.000  28.000  1.00 50.00           O  \nEND\n",
    ),
    ("molecule-xyz", "3\nwater\nO 0 0 0.1\nH 0.7 0.5 -0.4\nh -0.7 0.5 -4e-1 0.5\n"),
];

/// Words that break readers.
const WORDS: [&[u8]; 20] = [
    b"4294967295",
    b"-1",
    b"0",
    b"1e400",
    b"nan",
    b"inf",
    b"99999999999999999999",
    b"18446744073709551615",
    b"-0",
    b"1e-400",
    b"2147483648",
    b"#",
    b"\\\n",
    b"\r",
    b"\xff\xff\xff\xff",
    b"\0\0\0\x80",
    b"\0\0\xc0\x7f",
    b"{",
    b"[[",
    b"\"",
];

fn shapes() -> Vec<Shape> {
    let mut cube = shapes::tagged_polygons();
    let vertices = cube.positions().len();
    let normals: Vec<DVec3> = cube.positions().iter().map(|point| point.normalize_or(DVec3::Z)).collect();
    cube.insert_attribute(Domain::Vertex, Column::normals(NORMAL, &normals)).expect("a normal each");
    let colors = Values::U8((0..3 * vertices).map(|i| i as u8).collect());
    let colors = Column::try_new(COLOR, 3, colors).expect("three a vertex");
    cube.insert_attribute(Domain::Vertex, colors).expect("a colour each");
    let uv = vec![[0.25, 0.5]; cube.wedge_vertices().len()];
    cube.insert_attribute(Domain::Wedge, Column::texcoords(TEXCOORD, &uv)).expect("coordinates each");
    let graph = GeometricGraph::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1], [0, 2]]).expect("a graph");
    let soup = Part { material: Some(0), ..Part::new(shapes::tagged_triangles()).named("soup") };
    let materials = vec![Material { name: "red".into(), ..Material::default() }];
    vec![
        Shape::new(Part::new(cube).named("cube")),
        Shape { materials, ..Shape::new(soup) },
        Shape { parts: vec![Part::new(graph), Part::new(PointCloud::new(vec![DVec3::ONE; 3]))], ..Shape::default() },
        heights(),
        Shape::new(Part::new(shapes::random_cells())),
        Shape::new(Part::new(shapes::part())),
        Shape::new(Part::new(numbers(false))),
        Shape {
            units: Some(Units::MILLIMETERS),
            comments: vec!["space: scanner".into()],
            ..Shape::new(Part::new(numbers(true)))
        },
        Shape::new(Part::new(shapeloom::parametric::BezierSurface::new(vec![shapes::bent_patch()]))),
    ]
}

/// A height field with a hole.
fn heights() -> Shape {
    let heights = (0..20).map(|i| if i == 7 { f64::NAN } else { f64::from(i * i % 13) - 4.5 }).collect();
    let field = HeightField::try_new(5, 4, DVec2::new(2.0, 3.0), heights).expect("a field");
    Shape { up: Some(UpAxis::Z), units: Some(Units::METERS), ..Shape::new(Part::new(field)) }
}

/// A volume of single precision, turned and sheared, or of 16 bits along the axes.
fn numbers(turned: bool) -> VoxelGrid {
    let count = 5 * 4 * 3u16;
    if turned {
        let steps = DMat3::from_cols(DVec3::new(0.0, 2.0, 0.0), DVec3::new(-1.0, 0.5, 0.0), DVec3::new(0.0, 0.0, -3.0));
        let placement = Affine { linear: steps, translation: DVec3::new(0.1, -20.0, 1e-3) };
        let lattice = Lattice::try_new([5, 4, 3], placement).expect("a lattice");
        let samples = (0..count).map(|i| f32::from(i * i % 17) - 7.25).collect();
        return VoxelGrid::try_new(lattice, Samples::F32(samples), Quantity::SignedDistance).expect("as many");
    }
    let lattice = Lattice::along_axes([5, 4, 3], DVec3::new(-1.0, 0.0, 7.5), DVec3::new(0.3, 0.3, 2.5));
    let samples = Samples::U16((0..count).map(|i| i * 1057).collect());
    VoxelGrid::try_new(lattice.expect("a lattice"), samples, Quantity::Density).expect("as many")
}

/// A volume of run lengths: 3 × 2 × 2 bytes.
fn packed_slices() -> Vec<u8> {
    let mut bytes = b"11111\n3 2 2 8\n1.0 1.0 2.0\n1 6 0 1\n1 1 XRGB".to_vec();
    bytes.extend(b"5 X\x06\x07\0..6X\x83abc\x03d\0");
    bytes
}

/// Binary and long inputs by hand: tiled and plain TIFF in both byte orders, the first profiles of a DEM, a PNG with its
/// calibration damaged.
fn more_by_hand() -> Vec<(&'static str, Vec<u8>)> {
    let mut dem = std::fs::read(data("mount_st_helens.dem")).expect("data/mount_st_helens.dem is in the repository");
    dem.truncate(4 * 1024);
    dem[858..864].copy_from_slice(b"     2");
    let floats: Vec<u8> = [0.5f32, -1.0, f32::NAN, 3e-40, 1e38, 7.0].iter().flat_map(|x| x.to_be_bytes()).collect();
    let words: Vec<u8> = (0..6u16).flat_map(|word| (word * 9000).to_le_bytes()).collect();
    let mut png = Vec::new();
    write(&heights(), format_by_id("png").expect("a format"), &WriteContext::default(), &mut png).expect("a picture");
    let calibration = png.windows(4).position(|kind| kind == b"pCAL").expect("a calibration");
    png[calibration + 20] ^= 1;
    vec![
        ("dem", dem),
        ("slc", packed_slices()),
        ("raw", (0..120).collect()),
        ("raw", vec![0; 130]),
        ("tiff", tiff(true, 32, 3, &floats)),
        ("tiff", tiff(false, 16, 1, &words)),
        ("tiff", tiff(false, 16, 2, &words)),
        ("png", png),
    ]
}

/// 3 × 2 samples in one strip, with the distance of samples.
fn tiff(big: bool, depth: u32, format: u32, data: &[u8]) -> Vec<u8> {
    let word = |value: u16| if big { value.to_be_bytes() } else { value.to_le_bytes() };
    let long = |value: u32| if big { value.to_be_bytes() } else { value.to_le_bytes() };
    let scale = 8 + 2 + 11 * 12 + 4;
    let tags: [(u16, u16, u32, u32); 11] = [
        (256, 4, 1, 3),
        (257, 4, 1, 2),
        (258, 4, 1, depth),
        (259, 4, 1, 1),
        (262, 4, 1, 1),
        (273, 4, 1, scale + 24),
        (277, 4, 1, 1),
        (278, 4, 1, 2),
        (279, 4, 1, data.len() as u32),
        (339, 4, 1, format),
        (33550, 12, 3, scale),
    ];
    let mut bytes = if big { b"MM\0*\0\0\0\x08".to_vec() } else { b"II*\0\x08\0\0\0".to_vec() };
    bytes.extend(word(11));
    for (tag, kind, count, value) in tags {
        bytes.extend([word(tag), word(kind)].concat());
        bytes.extend([long(count), long(value)].concat());
    }
    bytes.extend(long(0));
    for size in [30.0f64, 20.0, 0.0] {
        bytes.extend(if big { size.to_be_bytes() } else { size.to_le_bytes() });
    }
    bytes.extend(data);
    bytes
}

/// Small sound inputs of every format that is read.
fn corpus() -> HashMap<&'static str, Vec<Vec<u8>>> {
    let mut corpus: HashMap<&'static str, Vec<Vec<u8>>> = HashMap::new();
    for (id, text) in BY_HAND {
        corpus.entry(id).or_default().push(text.as_bytes().to_vec());
    }
    for (id, bytes) in more_by_hand() {
        corpus.entry(id).or_default().push(bytes);
    }
    for format in FORMATS.iter().filter(|format| format.writes.is_some() && format.reads.is_some()) {
        for shape in shapes() {
            let encodings: &[&str] = match format.write_options.contains(&"encoding") {
                true => &["automatic", "ascii", "binary", "binary-big-endian"],
                false => &["automatic"],
            };
            for encoding in encodings {
                let mut options = WriteOptions::new();
                options.compress = format.write_options.contains(&"compress") && corpus.contains_key(format.id);
                options.set("encoding", encoding).expect("a word of the choice");
                let mut bytes = Vec::new();
                let context = WriteContext { options, ..WriteContext::default() };
                if write(&shape, format, &context, &mut bytes).is_ok() && bytes.len() < 40_000 {
                    corpus.entry(format.id).or_default().push(bytes);
                }
            }
        }
    }
    corpus
}

fn mutate(input: &[u8], others: &[Vec<u8>], dice: &mut Dice) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..1 + dice.next() % 4 {
        let at = dice.next() as usize % (bytes.len() + 1);
        let end = (at + dice.next() as usize % 24).min(bytes.len());
        match dice.next() % 8 {
            0 if at < bytes.len() => bytes[at] ^= 1 << (dice.next() % 8),
            1 if at < bytes.len() => bytes[at] = dice.next() as u8,
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes[at..end].to_vec();
                bytes.splice(at..at, piece);
            }
            4 => bytes.truncate(at.max(1)),
            5 => {
                let other = &others[dice.next() as usize % others.len()];
                let from = dice.next() as usize % other.len();
                let to = (from + dice.next() as usize % 64).min(other.len());
                bytes.splice(at..end, other[from..to].iter().copied());
            }
            _ => {
                // A whole word or number becomes one of the words that break readers.
                let word = WORDS[dice.next() as usize % WORDS.len()];
                let is_word = |byte: &u8| !byte.is_ascii_whitespace() && *byte != b',' && *byte != b'/';
                let start = bytes[..at].iter().rposition(|byte| !is_word(byte)).map_or(0, |before| before + 1);
                let stop = bytes[at..].iter().position(|byte| !is_word(byte)).map_or(bytes.len(), |after| at + after);
                bytes.splice(start..stop.min(start + 40), word.iter().copied());
            }
        }
    }
    bytes
}

/// Readers neither panic nor take more than 64 MB and 40 times the input, and what they read they can write and read.
#[test]
fn changed_inputs_are_read_or_refused() {
    let corpus = corpus();
    let mut dice = Dice(2026);
    for format in FORMATS.iter().filter(|format| format.reads.is_some()) {
        let inputs = corpus.get(format.id).unwrap_or_else(|| panic!("{}: add a sound input here", format.id));
        let mut read = 0;
        for input in inputs {
            read += usize::from(read_as(format.id, input));
        }
        assert_eq!(read, inputs.len(), "{}: sound inputs are read", format.id);
        let (mut accepted, rounds) = (0, 6000);
        for round in 0..rounds {
            let input = &inputs[round % inputs.len()];
            accepted += usize::from(read_as(format.id, &mutate(input, inputs, &mut dice)));
        }
        // Neither all nor none: the changes are neither harmless nor hopeless.
        assert!((rounds / 100..rounds).contains(&accepted), "{}: {accepted} of {rounds}", format.id);
    }
}

/// Every format that is read has a fuzz target.
#[test]
fn every_reader_has_a_fuzz_target() {
    let manifest = std::fs::read_to_string(root().join("tests/fuzz/Cargo.toml")).expect("the fuzz package");
    for format in FORMATS.iter().filter(|format| format.reads.is_some()) {
        let name = format!("read_{}", format.id);
        let target = std::fs::read_to_string(root().join(format!("tests/fuzz/targets/{name}.rs"))).expect(&name);
        assert!(target.contains(&format!("read_as(\"{}\"", format.id)) && manifest.contains(&name), "{name}");
    }
}
