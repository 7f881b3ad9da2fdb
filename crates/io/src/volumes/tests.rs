//! What all formats of volumes have in common: what is written comes back.

use shapeloom_core::glam::{DMat3, DVec3};
use shapeloom_core::{Affine, Deviation, Report};
use shapeloom_shape::{Geometry, Part, Shape, Units};
use shapeloom_voxels::isosurface::Lattice;
use shapeloom_voxels::{Quantity, Samples, VoxelGrid};

use crate::{ReadContext, ReadOptions, ReadShape, ScalarType, WriteContext, WriteOptions, format_by_id, read, write};

fn written(shape: &Shape, id: &str, compress: bool) -> (Vec<u8>, Report) {
    let options = WriteOptions { compress, ..WriteOptions::new() };
    let mut bytes = Vec::new();
    let context = WriteContext { options, ..WriteContext::default() };
    let report = write(shape, format_by_id(id).unwrap(), &context, &mut bytes).unwrap();
    (bytes, report)
}

fn again(bytes: &[u8], id: &str) -> ReadShape {
    read(bytes, format_by_id(id).unwrap(), &ReadContext::named("again")).unwrap()
}

fn grid(shape: &Shape) -> &VoxelGrid {
    match &*shape.parts[0].geometry {
        Geometry::VoxelGrid(grid) => grid,
        other => panic!("a {}", other.kind()),
    }
}

/// Samples of every width with odd values: signs of zero, the smallest numbers, NaN.
fn samples(count: usize) -> [(Samples, Quantity); 4] {
    let mut words = vec![0u64; count.div_ceil(64)];
    (0..count).filter(|at| at * at % 7 == 2).for_each(|at| words[at / 64] |= 1 << (at % 64));
    let odd = [0.0f32, -0.0, 1e-45, f32::MAX, f32::NAN, f32::NEG_INFINITY, -3.25, 0.1];
    [
        (Samples::Bits(words), Quantity::Occupancy),
        (Samples::U8((0..count).map(|at| (at * 37) as u8).collect()), Quantity::Density),
        (Samples::U16((0..count).map(|at| (at * 2749) as u16).collect()), Quantity::Density),
        (Samples::F32((0..count).map(|at| odd[at % 8]).collect()), Quantity::SignedDistance),
    ]
}

fn same_samples(found: &VoxelGrid, wanted: &VoxelGrid) {
    assert_eq!((found.samples().name(), found.quantity()), (wanted.samples().name(), wanted.quantity()));
    for at in 0..wanted.lattice().samples() {
        assert_eq!(found.samples().get(at).to_bits(), wanted.samples().get(at).to_bits(), "sample {at}");
    }
}

#[test]
fn volumes_along_the_axes_survive_every_format_to_the_bit() {
    let lattice = Lattice::along_axes([5, 7, 11], DVec3::new(0.1, -1e6, 1e-9), DVec3::new(0.3, 1e-3, 7.0)).unwrap();
    for (samples, quantity) in samples(5 * 7 * 11) {
        let shape = Shape::new(Part::new(VoxelGrid::try_new(lattice, samples, quantity).unwrap()));
        for (id, compress) in
            [("nrrd", false), ("nrrd", true), ("mha", false), ("mha", true), ("vti", false), ("vtk", false)]
        {
            let (bytes, report) = written(&shape, id, compress);
            assert_eq!((report.deviation, report.losses.len()), (Deviation::Exact, 0), "{id}");
            let read = again(&bytes, id);
            assert_eq!(grid(&read.shape).lattice(), &lattice, "{id}");
            same_samples(grid(&read.shape), grid(&shape));
            // The same shape gives the same bytes.
            assert_eq!(written(&shape, id, compress).0, bytes);
        }
    }
}

#[test]
fn directions_survive_exactly_in_nrrd_and_within_the_bound_elsewhere() {
    let turns = [
        (DMat3::from_cols(-DVec3::Y * 2.0, DVec3::Z * 0.3, DVec3::X), true),
        (DMat3::from_cols(DVec3::new(0.3, 0.1, 0.0), DVec3::new(-0.1, 0.25, 0.7), DVec3::new(1e-3, 0.0, 0.4)), false),
    ];
    for (linear, exact) in turns {
        let placement = Affine { linear, translation: DVec3::new(1.0, 0.2, -3e5) };
        let lattice = Lattice::try_new([9, 8, 7], placement).unwrap();
        let own = VoxelGrid::try_new(lattice, Samples::U8(vec![3; 504]), Quantity::Density).unwrap();
        let shape = Shape::new(Part::new(own));
        assert_eq!(grid(&again(&written(&shape, "nrrd", true).0, "nrrd").shape).lattice(), &lattice);
        for id in ["mha", "vti"] {
            let (bytes, report) = written(&shape, id, false);
            let found = *grid(&again(&bytes, id).shape).lattice();
            let far = found.position([8, 7, 6]).distance(lattice.position([8, 7, 6]));
            match report.deviation {
                Deviation::Exact => assert_eq!(far, 0.0, "{id}"),
                Deviation::AtMost(bound) => assert!(!exact && far <= bound * 1.01 + 1e-10 && bound < 1e-13, "{id}"),
                other => panic!("{other:?}"),
            }
        }
        let error = write(&shape, format_by_id("vtk").unwrap(), &WriteContext::default(), &mut Vec::new());
        assert!(matches!(error, Err(crate::WriteError::Turned { .. })));
    }
}

/// Other readers want to know how many packed bytes follow.
#[test]
fn packed_metaimages_say_how_many_bytes_follow() {
    let lattice = Lattice::along_axes([30, 20, 10], DVec3::ZERO, DVec3::ONE).unwrap();
    let own = VoxelGrid::try_new(lattice, Samples::U8((0..6000).map(|at| (at / 7) as u8).collect()), Quantity::Density);
    let (bytes, _) = written(&Shape::new(Part::new(own.unwrap())), "mha", true);
    let end = b"ElementDataFile = LOCAL\n";
    let data = bytes.windows(end.len()).position(|window| window == end).unwrap() + end.len();
    let said = format!("\nCompressedDataSize = {}\n", bytes.len() - data);
    assert!(String::from_utf8_lossy(&bytes[..data]).contains(&said), "{said}");
}

/// All samples are there, and that nothing shows them to be right is told.
#[test]
fn packed_metaimages_that_end_within_their_checksum_are_told() {
    let lattice = Lattice::along_axes([3, 2, 1], DVec3::ZERO, DVec3::ONE).unwrap();
    let own = VoxelGrid::try_new(lattice, Samples::U8((0..6).collect()), Quantity::Density).unwrap();
    let (bytes, _) = written(&Shape::new(Part::new(own.clone())), "mha", true);
    for cut in 1..=4 {
        let read = again(&bytes[..bytes.len() - cut], "mha");
        same_samples(grid(&read.shape), &own);
        assert_eq!(read.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["W-volume-truncated"]);
    }
    let few = read(&bytes[..bytes.len() - 9], format_by_id("mha").unwrap(), &ReadContext::named("a")).unwrap_err();
    assert_eq!(shapeloom_core::Diagnostic::code(&few), "E-volume-truncated");
}

/// Where a part places its grid, the file has it.
#[test]
fn placements_units_and_words_are_kept() {
    let lattice = Lattice::along_axes([2, 3, 4], DVec3::ONE, DVec3::ONE).unwrap();
    let own = VoxelGrid::try_new(lattice, Samples::U8((0..24).collect()), Quantity::Density).unwrap();
    let moved = Affine::from_translation(DVec3::X * 5.0) * Affine::from_scale(DVec3::new(2.0, 1.0, 1.0));
    let part = Part { placement: moved, ..Part::new(own) };
    let comments = vec!["space: right-anterior-superior".to_owned(), "made by hand".into(), "key:=value".into()];
    let shape = Shape { comments: comments.clone(), units: Some(Units::MILLIMETERS), ..Shape::new(part) };
    for id in ["nrrd", "mha", "vti", "vtk"] {
        let (bytes, report) = written(&shape, id, false);
        let read = again(&bytes, id).shape;
        assert_eq!(grid(&read).lattice().position([1, 0, 0]), DVec3::new(9.0, 1.0, 1.0), "{id}");
        match id {
            "nrrd" | "mha" => assert_eq!((&read.comments, read.units), (&comments, shape.units), "{id}"),
            "vti" => assert_eq!(report.losses.len(), 2, "{:?}", report.losses),
            _ => assert_eq!((&read.comments[..], report.losses.len()), (&comments[..1], 2), "{:?}", report.losses),
        }
    }
}

#[test]
fn legacy_vtk_keeps_one_line_of_words_and_says_what_it_leaves_out() {
    let lattice = Lattice::along_axes([2, 1, 1], DVec3::ZERO, DVec3::ONE).unwrap();
    let own = VoxelGrid::try_new(lattice, Samples::U8(vec![1, 2]), Quantity::Density).unwrap();
    let long = "x".repeat(256);
    for (comments, kept, lost) in [
        (vec![], vec![], None),
        (vec!["one"], vec!["one"], None),
        (vec!["one", "two"], vec!["one"], Some("comments after the first")),
        (vec![&long[..]], vec![&long[..255]], Some("the comment beyond its first 255 bytes")),
    ] {
        let comments = comments.into_iter().map(str::to_owned).collect();
        let (bytes, report) = written(&Shape { comments, ..Shape::new(Part::new(own.clone())) }, "vtk", false);
        assert_eq!(again(&bytes, "vtk").shape.comments, kept);
        assert_eq!(crate::test_data::whats(&report), lost.into_iter().collect::<Vec<_>>());
    }
}

/// The same numbers in each type, in both orders of bytes.
#[test]
fn raw_samples_are_read_as_options_say() {
    let numbers: Vec<i64> = (0..24).map(|at| at * 5).collect();
    type Bytes = fn(i64) -> Vec<u8>;
    let types: [(ScalarType, Bytes); 10] = [
        (ScalarType::I8, |x| (x as i8).to_be_bytes().to_vec()),
        (ScalarType::U8, |x| (x as u8).to_be_bytes().to_vec()),
        (ScalarType::I16, |x| (x as i16).to_be_bytes().to_vec()),
        (ScalarType::U16, |x| (x as u16).to_be_bytes().to_vec()),
        (ScalarType::I32, |x| (x as i32).to_be_bytes().to_vec()),
        (ScalarType::U32, |x| (x as u32).to_be_bytes().to_vec()),
        (ScalarType::I64, |x| x.to_be_bytes().to_vec()),
        (ScalarType::U64, |x| (x as u64).to_be_bytes().to_vec()),
        (ScalarType::F32, |x| (x as f32).to_be_bytes().to_vec()),
        (ScalarType::F64, |x| (x as f64).to_be_bytes().to_vec()),
    ];
    for (scalar, bytes) in types {
        for byte_order in [crate::ByteOrder::Big, crate::ByteOrder::Little] {
            let mut input = b"skipped".to_vec();
            for &number in &numbers {
                let mut one = bytes(number);
                if byte_order == crate::ByteOrder::Little {
                    one.reverse();
                }
                input.extend(one);
            }
            let dimensions = "4x3x2".to_owned();
            let (skip, voxel_size) = (7, "1x2x0.5".to_owned());
            let options = ReadOptions { dimensions, scalar, byte_order, skip, voxel_size, ..ReadOptions::new() };
            let context = ReadContext { options, ..ReadContext::named("raw") };
            let read = read(&input, format_by_id("raw").unwrap(), &context).unwrap();
            assert!(read.findings.is_empty(), "{:?}", read.findings);
            let grid = grid(&read.shape);
            assert_eq!((grid.sample([3, 1, 1]), grid.lattice().position([3, 1, 1])), (95.0, DVec3::new(3.0, 2.0, 0.5)));
            assert!((0..24).all(|at| grid.samples().get(at as u64) == numbers[at] as f32), "{scalar:?}");
        }
    }
    let without = read(&[0; 9], format_by_id("raw").unwrap(), &ReadContext::named("raw")).unwrap_err();
    assert_eq!(shapeloom_core::Diagnostic::code(&without), "E-volume-option");
    let words = without.to_string();
    assert!(words.contains("9 bytes without a header, and no option dimensions"), "{words}");
}

#[test]
fn raw_samples_have_the_sign_of_their_type() {
    for (scalar, signed) in [
        (ScalarType::I8, -2.0),
        (ScalarType::U8, 254.0),
        (ScalarType::I16, -2.0),
        (ScalarType::U16, 65534.0),
        (ScalarType::I32, -2.0),
        (ScalarType::U32, 4_294_967_296.0),
        (ScalarType::I64, -2.0),
        (ScalarType::U64, 18_446_744_073_709_551_616.0),
    ] {
        let options = ReadOptions { dimensions: "1x1x1".into(), scalar, ..ReadOptions::new() };
        let bytes = [0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff];
        let context = ReadContext { options, ..ReadContext::named("raw") };
        let read = read(&bytes, format_by_id("raw").unwrap(), &context).unwrap();
        // Up to rounding to single precision.
        assert_eq!(grid(&read.shape).samples().get(0), signed, "{scalar:?}");
    }
}

/// A slice of a run, of bytes as they are, and of both.
#[test]
fn run_lengths_are_unpacked() {
    let mut bytes = b"11111\n3 2 2 8 \n1.0 1.0 2.0\n1 6 0 1\n1 1 XRGB".to_vec();
    bytes.extend(b"3 X\x06\x07\0");
    bytes.extend(b"7X\x83abc\x03d\0");
    let read = again(&bytes, "slc");
    assert!(read.findings.is_empty());
    assert_eq!(grid(&read.shape).samples(), &Samples::U8(b"\x07\x07\x07\x07\x07\x07abcddd".to_vec()));
    assert_eq!(grid(&read.shape).lattice().spacing(), DVec3::new(1.0, 1.0, 2.0));
    let plain = again(b"11111\n3 2 1 8 \n1.0 1.0 2.0\n1 6 0 0\n1 1 XRGBabcdef", "slc");
    assert!(plain.findings.is_empty());
    assert_eq!(grid(&plain.shape).samples(), &Samples::U8(b"abcdef".to_vec()));
}
