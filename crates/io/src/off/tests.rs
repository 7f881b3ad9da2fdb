//! Texts and bytes made by hand, and texts cut anywhere.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Deviation, Place};
use shapeloom_mesh::{COLOR, Column, Domain, NORMAL, PointCloud, PolyMesh, TEXCOORD, Values};
use shapeloom_shape::{Geometry, Kind, Part, Shape};

use super::FORMAT;
use crate::placed::{columns_of, points_of};
use crate::test_data::{whats, written_as};
use crate::{Encoding, ReadContext, ReadShape, WriteContext, WriteOptions, read};

fn read_text(text: &str) -> ReadShape {
    read(text.as_bytes(), &FORMAT, &ReadContext::default()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The code, the place and what was found, of a text that is refused.
fn fault(text: &str) -> (&'static str, Place, String) {
    let error = read(text.as_bytes(), &FORMAT, &ReadContext::default()).expect_err(text);
    let fault = error.fault().unwrap_or_else(|| panic!("{error}"));
    (fault.code, fault.place.clone(), fault.found.clone())
}

fn geometry(read: &ReadShape) -> &Geometry {
    &read.shape.parts[0].geometry
}

fn column<'r>(read: &'r ReadShape, domain: Domain, name: &str) -> &'r Column {
    columns_of(geometry(read), domain).unwrap().get(name).unwrap()
}

fn codes(read: &ReadShape) -> Vec<&str> {
    read.findings.iter().map(|finding| finding.code).collect()
}

/// A tetrahedron with what follows after the position of each vertex, and after the corners of each face.
fn tetrahedron(header: &str, vertices: [&str; 4], faces: [&str; 4]) -> String {
    let mut text = format!("{header}\n4 4 6\n");
    for (position, more) in ["0 0 0", "1 0 0", "0 1 0", "0 0 1"].iter().zip(vertices) {
        text += &format!("{position} {more}\n");
    }
    for (corners, more) in ["0 2 1", "0 1 3", "0 3 2", "1 2 3"].iter().zip(faces) {
        text += &format!("3 {corners} {more}\n");
    }
    text
}

#[test]
fn keywords_say_what_follows_after_the_position() {
    let read = read_text(&tetrahedron(
        "STCNOFF",
        ["0 0 1 255 0 0 .5 .25", "0 1 0 0 9 0 0 0", "1 0 0 0 0 1 1 1", "0 0 -1 7 7 7 0 1"],
        [""; 4],
    ));
    assert_eq!(column(&read, Domain::Vertex, NORMAL).vector(3), -DVec3::Z);
    let colors = Values::U8(vec![255, 0, 0, 0, 9, 0, 0, 0, 1, 7, 7, 7]);
    assert_eq!(column(&read, Domain::Vertex, COLOR).values(), &colors);
    let coordinates = Values::F64(vec![0.5, 0.25, 0.0, 0.0, 1.0, 1.0, 0.0, 1.0]);
    assert_eq!(column(&read, Domain::Vertex, TEXCOORD).values(), &coordinates);
    assert!(read.findings.is_empty());

    let read = read_text(&tetrahedron("4OFF", ["1", "2", "-4", ".5"], [""; 4]));
    let wanted = [DVec3::ZERO, DVec3::X / 2.0, -DVec3::Y / 4.0, DVec3::Z * 2.0];
    assert_eq!(points_of(geometry(&read)).unwrap(), wanted);

    let flat = read_text("nOFF 2\n3 1 0\n1 2\n3 4\n5 7\n3 0 1 2\n");
    assert_eq!(points_of(geometry(&flat)).unwrap()[2], DVec3::new(5.0, 7.0, 0.0));
    for text in ["nOFF 4\n1 0 0\n1 2 3 4\n", "nOFF\n0\n0 0 0\n", "4nOFF 3\n1 0 0\n1 2 3 4"] {
        assert_eq!(fault(text).0, "E-off-dimension", "{text}");
    }
}

#[test]
fn colors_are_bytes_or_fractions() {
    let color = |read: &ReadShape, domain| column(read, domain, COLOR).values().clone();
    let fractions = read_text(&tetrahedron("COFF", ["1 0 0 1", "0.5 0 0 1", "0 1e-3 0 1", "0 0 0 0"], [""; 4]));
    let numbers = [1.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 1e-3, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(color(&fractions, Domain::Vertex), Values::F64(numbers.to_vec()));
    // As Geomview takes whole numbers of vertices: fractions, if they can be.
    let ones = read_text(&tetrahedron("COFF", ["1 0 0"; 4], [""; 4]));
    assert_eq!(color(&ones, Domain::Vertex), Values::F64([1.0, 0.0, 0.0].repeat(4)));
    assert_eq!(codes(&ones), ["W-off-fractions"]);

    let faces = read_text(&tetrahedron("OFF", [""; 4], ["9 8 7", "1 0 0", "", "255 254 253 4"]));
    let bytes = vec![9, 8, 7, 255, 1, 0, 0, 255, 170, 170, 170, 255, 255, 254, 253, 4];
    assert_eq!(color(&faces, Domain::Face), Values::U8(bytes));
    assert_eq!(codes(&faces), ["W-off-grey"]);
    let mixed = read_text(&tetrahedron("OFF", [""; 4], ["0.25 0 1", "51 0 255", "1 1 0", "0.0 0.0 0.0"]));
    let numbers = vec![0.25, 0.0, 1.0, 0.2, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    assert_eq!(color(&mixed, Domain::Face), Values::F64(numbers));

    let indexed = read_text(&tetrahedron("OFF", [""; 4], ["", "7", "1 2 3", "0"]));
    let indices = Values::U32(vec![u32::MAX, 7, u32::MAX, 0]);
    assert_eq!(column(&indexed, Domain::Face, "colormap").values(), &indices);
    for wrong in ["256 0 0", "-1 0 0", "-0.5 0 0", "0.5"] {
        let text = tetrahedron("OFF", [""; 4], ["", "", wrong, ""]);
        assert_eq!((fault(&text).0, fault(&text).1), ("E-off-color", Place::line(9)), "{wrong}");
    }
    let two = fault(&tetrahedron("OFF", [""; 4], ["", "1 2", "", ""]));
    assert_eq!((two.0, two.1), ("E-off-row", Place::line(8)));
}

#[test]
fn columns_that_look_like_colors_are_taken_as_colors() {
    let read = read_text(&tetrahedron("OFF", ["255 0 0 255", "0 255 0 255", "0 0 255 255", "1 2 3 4"], [""; 4]));
    assert_eq!((column(&read, Domain::Vertex, COLOR).width(), codes(&read)), (4, vec!["W-off-columns"]));
    let normals = fault(&tetrahedron("OFF", ["0 0 1", "0 -1 0", "1 0 0", "0 0 1"], [""; 4]));
    assert_eq!((normals.0, normals.1, normals.2.as_str()), ("E-off-row", Place::line(4), "6 numbers"));
    let five = fault(&tetrahedron("OFF", ["1 2"; 4], [""; 4]));
    assert_eq!((five.0, five.1, five.2.as_str()), ("E-off-row", Place::line(3), "5 numbers"));
}

#[test]
fn rows_may_share_lines_but_not_be_broken() {
    let plain = read_text(&tetrahedron("OFF", [""; 4], [""; 4]));
    let joined = [
        "OFF 4 4 6 0 0 0 1 0 0 0 1 0 0 0 1 3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3",
        "OFF\n4 4 6\n0 0 0 1 0 0 # two\n0 1 0 0 0 1\n3 0 2 1 3 0 1 3\n3 0 3 2 3 1 2 3\n",
        "OFF 4 4\n0 0 0 1 0 0 0 1 0 0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
        "4 4 6\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1 3 0 1 3 3 0 3 2 3 1 2 3\n",
    ];
    for text in joined {
        assert_eq!(read_text(text).shape, plain.shape, "{text}");
    }
    for (text, line) in [
        ("OFF\n3 1 0\n0 0 0\n1 0\n0\n0 1 0\n3 0 1 2\n", 4),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n2\n", 6),
        ("OFF\n3\n1 0\n0 0 0\n", 2),
    ] {
        let (code, place, found) = fault(text);
        assert_eq!((code, place, found.as_str()), ("E-off-row", Place::line(line), "the end of the line"), "{text}");
    }
}

#[test]
fn comments_may_follow_without_a_space() {
    let text = "# by hand\nOFF#1\n4#2 \n";
    assert_eq!(fault(text).0, "E-off-row");
    let text = "OFF#1\r3 1 0#2\r\r0 0 0#\u{ff}\n1 0 0#3\r\n#\n0 1 0\x0c# 4 5\n3 0 1 2#6 7 8\n#9";
    let read = read_text(text);
    assert_eq!((geometry(&read).kind(), read.findings.is_empty()), (Kind::TriMesh, true));
}

#[test]
fn results_do_not_depend_on_where_texts_are_cut() {
    let mut text = String::from("COFF\n# a comment\n60 62 0\n");
    for i in 0..60 {
        let comment = if i % 7 == 0 { "# one\r\n\r\n" } else { "" };
        text += &format!("{comment}{} {} {} {} 0 {}\r\n", i % 8, i / 8, i * i % 5, i, 255 - i);
    }
    for i in 0..62u32 {
        text += match i {
            20 => "2 0 1 255 255 255\n",
            _ if i % 9 == 0 => " 4 0 1 2 3 0.5 0.25 0.125\n",
            _ if i % 11 == 0 => "3 5 5 5 9\n",
            _ => "3 5 6 7\n",
        };
    }
    text += "more\nand more\n";
    let whole = read_text(&text);
    let wanted = ["W-off-skipped", "W-off-trailing", "W-off-grey", "W-off-degenerate"];
    assert_eq!(codes(&whole), wanted);
    let Geometry::PolyMesh(mesh) = geometry(&whole) else { panic!("polygons") };
    assert_eq!((mesh.positions().len(), mesh.face_count()), (60, 61));
    for size in [1, 30, 100, 777] {
        let cut = |from: usize| crate::text::cut(text.as_bytes(), from, size, crate::text::never_joined);
        let found = super::text::read_text(text.as_bytes(), &ReadContext::default(), cut).unwrap();
        assert_eq!(found.shape, whole.shape);
        let summed = |read: &ReadShape| read.findings.iter().map(|found| (found.code, found.count)).collect::<Vec<_>>();
        assert_eq!(summed(&found), summed(&whole));
    }
    // Faults too are the same.
    let broken = text.replacen("3 5 6 7\n", "3 5 6 60\n", 1);
    let cut = |from: usize| crate::text::cut(broken.as_bytes(), from, 50, crate::text::never_joined);
    let error = super::text::read_text(broken.as_bytes(), &ReadContext::default(), cut).unwrap_err();
    let fault = crate::text::in_lines(broken.as_bytes(), error.fault().unwrap().clone().into());
    assert_eq!(Some(&*fault), read(broken.as_bytes(), &FORMAT, &ReadContext::default()).unwrap_err().fault());
}

#[test]
fn texts_of_shuffled_lines_are_the_same_wherever_they_are_cut() {
    let text = "0 0 0 255 0 0\n1 0 0 9 9 9 # one\n\n0 1 0 0 nan 1\n0 0 2 1 1 1\n1 1 0 7 8 9\n# two\n3 0 1 2 255 0 0\n\
        2 0 1\n4 0 1 2 3 0.5 0.5 nan\n3 1 1 2 7\n3 0 1 2\n3 0 1 4\nmore\n";
    let mut read = 0;
    crate::test_data::shuffled_lines(text, 4000, |rows| {
        let text = format!("COFF\n5 5 0\n{rows}");
        let cut = |size: usize| {
            let cut = |from: usize| crate::text::cut(text.as_bytes(), from, size, crate::text::never_joined);
            super::text::read_text(text.as_bytes(), &ReadContext::default(), cut)
        };
        let whole = cut(usize::MAX);
        read += usize::from(whole.is_ok());
        let whole = format!("{whole:?}");
        for size in [1, 20, 40, 90] {
            assert_eq!(format!("{:?}", cut(size)), whole, "{size}\n{text}");
        }
    });
    assert!((400..3600).contains(&read), "{read}");
}

#[test]
fn numbers_beside_positions_need_not_be_finite() {
    let read = read_text(
        "STCNOFF\n3 1 0\n0 0 0 nan 0 1 0.5 0 0 0 0\n1 0 0 0 0 -inf 0 NaN 0 1 1e999\n0 1 0 0 0 1 1 1 0 0 inf#x\n3 0 1 2 0 nan 1\n",
    );
    let found: Vec<_> = read.findings.iter().map(|one| (one.code, one.count, one.places[0].clone())).collect();
    assert_eq!(found, [("W-off-finite", 3, Place::line(3)), ("W-off-color", 2, Place::line(4))]);
    let colors = Values::F64(vec![0.5, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]);
    assert_eq!(column(&read, Domain::Vertex, COLOR).values(), &colors);
    let normals = column(&read, Domain::Vertex, NORMAL);
    assert!(normals.number(0, 0).is_nan() && normals.number(1, 2) == f64::NEG_INFINITY);
    assert!(columns_of(geometry(&read), Domain::Face).unwrap().get(COLOR).is_none());

    let nan = f32::NAN;
    let file = big_endian(
        "CNOFF BINARY\n",
        &[
            (&[3, 1, 0], &[0.0, 0.0, 0.0, 0.0, 0.0, nan, 0.5, 0.0, 0.0, 1.0]),
            (&[], &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, nan, 0.0, 0.0, 1.0]),
            (&[], &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.0, 1.0]),
            (&[3, 0, 1, 2, 3], &[0.5, 0.25, f32::INFINITY]),
        ],
    );
    let read = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
    assert_eq!(codes(&read), ["W-off-finite", "W-off-color"]);
    assert_eq!(column(&read, Domain::Vertex, COLOR).number(1, 0), 1.0);
}

#[test]
fn degenerate_faces_are_placed_past_those_left_out() {
    let read = read_text("OFF\n3 5 0\n0 0 0\n1 0 0\n0 1 0\n\n1 0\n3 0 1 2\n0\n3 0 1 1\n# note\n3 2 2 1\n");
    let found: Vec<_> = read.findings.iter().map(|one| (one.code, &one.places[..], one.count)).collect();
    let (skipped, kept) = ([7, 9].map(Place::line), [10, 12].map(Place::line));
    assert_eq!(found, [("W-off-skipped", &skipped[..], 2), ("W-off-degenerate", &kept[..], 2)]);
}

/// Numbers, whole and floating, in big endian.
fn big_endian(header: &str, numbers: &[(&[i32], &[f32])]) -> Vec<u8> {
    let mut file = header.as_bytes().to_vec();
    for (whole, floats) in numbers {
        file.extend(whole.iter().flat_map(|number| number.to_be_bytes()));
        file.extend(floats.iter().flat_map(|number| number.to_be_bytes()));
    }
    file
}

#[test]
fn binary_files_are_big_endian() {
    let file = big_endian(
        "# made by hand\nNOFF BINARY\n",
        &[
            (&[3, 3, 0], &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            (&[], &[1.0, 0.0, 0.0, 0.0, 0.0, 1.0]),
            (&[], &[0.0, 0.1, 0.0, 0.0, 0.0, -1.0]),
            (&[3, 0, 1, 2, 4], &[0.5, 0.25, 0.0, 1.0]),
            (&[2, 0, 1, 0], &[]),
            (&[3, 0, 1, 1, 1], &[5.0]),
            (&[7], &[]),
        ],
    );
    let read = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
    assert_eq!(points_of(geometry(&read)).unwrap()[2].y, f64::from(0.1f32));
    assert_eq!(column(&read, Domain::Vertex, NORMAL).vector(2), -DVec3::Z);
    let grey = 170.0 / 255.0;
    let colors = Values::F64(vec![0.5, 0.25, 0.0, 1.0, grey, grey, grey, 1.0]);
    assert_eq!(column(&read, Domain::Face, COLOR).values(), &colors);
    assert_eq!(column(&read, Domain::Face, "colormap").values(), &Values::U32(vec![u32::MAX, 5]));
    assert_eq!(codes(&read), ["W-off-skipped", "W-off-trailing", "W-off-grey", "W-off-degenerate"]);
    let places: Vec<Place> = read.findings.iter().map(|finding| finding.places[0].clone()).collect();
    let first_face = 27 + 12 + 72;
    assert_eq!((&places[0], &places[3]), (&Place::Byte(first_face + 36), &Place::Byte(first_face + 52)));
    for (cut, code) in [(100, "E-off-claim"), (file.len() - 12, "E-off-truncated"), (30, "E-off-truncated")] {
        let error = crate::read(&file[..cut], &FORMAT, &ReadContext::default()).unwrap_err();
        assert_eq!(error.fault().unwrap().code, code);
    }
    for (at, number, code) in [
        (27, -1, "E-off-count"),
        (31, i32::MAX, "E-off-claim"),
        (first_face as usize, 1 << 30, "E-off-claim"),
        (first_face as usize + 4, 3, "E-off-index"),
        (first_face as usize + 4, -1, "E-off-index"),
        (first_face as usize + 16, 2, "E-off-row"),
        (39, 0x7f80_0000, "E-off-finite"),
    ] {
        let mut broken = file.clone();
        broken[at..at + 4].copy_from_slice(&number.to_be_bytes());
        let error = crate::read(&broken, &FORMAT, &ReadContext::default()).unwrap_err();
        let fault = error.fault().unwrap();
        assert_eq!(fault.code, code);
        // Of the three counts the first is named.
        let wanted = if at == 31 { 27 } else { at };
        assert_eq!(fault.place, Place::Byte(wanted as u64), "{code}");
    }
}

/// Two triangles and a square with every column that OFF takes, and some that it does not.
fn painted(vertex_color: Values, face_color: Option<Values>) -> PolyMesh {
    let positions = (0..5).map(|i| DVec3::new(f64::from(i) / 3.0, f64::from(i * i) * 1e-9, -0.0)).collect();
    let faces: [&[u32]; 3] = [&[0, 1, 2], &[1, 2, 3, 4], &[0, 4, 3]];
    let mut mesh = PolyMesh::from_faces(positions, &faces).unwrap();
    let mut add = |domain, column| mesh.insert_attribute(domain, column).unwrap();
    let normals: Vec<DVec3> = (0..5).map(|i| DVec3::new(0.1, 0.2, f64::from(i) / 7.0)).collect();
    add(Domain::Vertex, Column::normals(NORMAL, &normals));
    let width = vertex_color.len() / 5;
    add(Domain::Vertex, Column::try_new(COLOR, width, vertex_color).unwrap());
    add(Domain::Vertex, Column::texcoords(TEXCOORD, &[0.1, 0.2, 0.3, 0.4, 0.5].map(|u| [u, 1.0 - u])));
    if let Some(values) = face_color {
        add(Domain::Face, Column::try_new(COLOR, values.len() / 3, values).unwrap());
    } else {
        add(Domain::Face, Column::labels("colormap", vec![3, u32::MAX, 0]));
    }
    mesh
}

#[test]
fn every_column_survives_in_the_same_bits() {
    let bytes = |count: u8| Values::U8((0..count).map(|i| i.wrapping_mul(37)).collect());
    let fractions = |count: u32| Values::F64((0..count).map(|i| f64::from(i) / 11.0).collect());
    let whole = |count: usize| Values::F64(vec![1.0; count]);
    for (header, vertex, face) in [
        ("STCNOFF", bytes(15), Some(bytes(9))),
        ("STCNOFF", bytes(20), Some(fractions(12))),
        ("STCNOFF", fractions(15), Some(whole(9))),
        ("STCNOFF", whole(20), None),
        ("STCNOFF", Values::U8([0, 1, 1, 255].repeat(5)), None),
    ] {
        let mesh = painted(vertex, face);
        let (file, report) = written_as(&FORMAT, &Shape::new(Part::new(mesh.clone())), Encoding::Automatic);
        assert!(file.starts_with(format!("{header}\n5 3 0\n").as_bytes()));
        assert_eq!((report.deviation, whats(&report)), (Deviation::Exact, vec![]));
        let again = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
        assert_eq!(*geometry(&again), mesh.into());
        let (twice, _) = written_as(&FORMAT, &again.shape, Encoding::Automatic);
        assert_eq!(twice, file);
    }
    // Bytes that could be fractions get an alpha that says what they are.
    let (file, _) =
        written_as(&FORMAT, &Shape::new(Part::new(painted(Values::U8(vec![1; 15]), None))), Encoding::Ascii);
    let again = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
    assert_eq!(column(&again, Domain::Vertex, COLOR).values(), &Values::U8([1, 1, 1, 255].repeat(5)));
}

#[test]
fn binary_numbers_are_rounded_and_said_so() {
    let mesh = painted(Values::F64(vec![0.5; 20]), Some(Values::U8(vec![255, 0, 128, 9, 9, 9, 0, 0, 0])));
    let (file, report) = written_as(&FORMAT, &Shape::new(Part::new(mesh.clone())), Encoding::Binary);
    assert!(file.starts_with(b"STCNOFF BINARY\n"));
    let again = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
    let Deviation::AtMost(bound) = report.deviation else { panic!("{:?}", report.deviation) };
    let (found, wanted) = (points_of(geometry(&again)).unwrap(), mesh.positions());
    let moved = found.iter().zip(wanted).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    assert!(moved > 0.0 && moved <= bound && bound <= moved * 1.000_001, "{moved} {bound}");
    assert_eq!(whats(&report), ["positions", "colours in bytes", "values of vertices and faces"]);
    assert!(report.losses[0].why.contains(&format!("{bound:e}")));
    assert_eq!(column(&again, Domain::Vertex, COLOR).values(), &Values::F64(vec![0.5; 20]));
    // Half of sRGB is about a fifth of the light.
    let colors = column(&again, Domain::Face, COLOR);
    assert!((colors.number(0, 2) - 0.2158605).abs() < 1e-6 && colors.number(0, 0) == 1.0);
    let (twice, report) = written_as(&FORMAT, &again.shape, Encoding::BinaryBigEndian);
    assert_eq!((twice, report.deviation), (file, Deviation::Exact));
    let far = Shape::new(Part::new(PointCloud::new(vec![DVec3::ZERO, DVec3::X * 1e39])));
    let context = WriteContext {
        options: WriteOptions { encoding: Encoding::Binary, ..Default::default() },
        ..Default::default()
    };
    let error = crate::write(&far, &FORMAT, &context, &mut Vec::new()).unwrap_err();
    assert!(matches!(error, crate::WriteError::NotFinite { index: 1, .. }), "{error}");
}

#[test]
fn parts_are_put_together_and_what_differs_is_lost() {
    let square = painted(Values::U8(vec![7; 15]), Some(Values::U8(vec![9; 9])));
    let mut cloud = PointCloud::new(vec![DVec3::splat(5.0), DVec3::splat(6.0)]);
    cloud.insert_attribute(Column::try_new(COLOR, 4, Values::U8(vec![200; 8])).unwrap()).unwrap();
    cloud.insert_attribute(Column::labels("id", vec![1, 2])).unwrap();
    let placement = Affine::from_translation(DVec3::X);
    let parts =
        vec![Part { placement, ..Part::new(square.clone()).named("square") }, Part::new(cloud), Part::new(square)];
    let (file, report) = written_as(&FORMAT, &Shape { parts, ..Shape::default() }, Encoding::Automatic);
    let again = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
    let Geometry::PolyMesh(mesh) = geometry(&again) else { panic!("polygons") };
    assert_eq!((mesh.positions().len(), mesh.face_count()), (12, 6));
    assert_eq!((mesh.positions()[0], mesh.face(4)), (DVec3::X, &[8, 9, 10, 11][..]));
    let color = column(&again, Domain::Vertex, COLOR);
    assert_eq!((color.width(), color.number(0, 3), color.number(5, 3)), (4, 255.0, 200.0));
    let wanted = [
        "3 separate parts",
        "part name \"square\"",
        "placements of 1 parts",
        "vertex attribute \"color\"",
        "vertex attribute \"normal\"",
        "vertex attribute \"texcoord\"",
        "vertex attribute \"id\"",
    ];
    assert_eq!(whats(&report), wanted);
}

#[test]
fn clouds_and_nothing_survive() {
    let cloud = Shape::new(Part::new(PointCloud::new(vec![DVec3::ONE, DVec3::X * 1e300])));
    for (shape, counts) in [(cloud, "OFF\n2 0 0\n"), (Shape::default(), "OFF\n0 0 0\n")] {
        let (file, _) = written_as(&FORMAT, &shape, Encoding::Automatic);
        assert!(file.starts_with(counts.as_bytes()));
        let again = crate::read(&file, &FORMAT, &ReadContext::default()).unwrap();
        match shape.parts.first() {
            Some(part) => assert_eq!(again.shape.parts[0].geometry, part.geometry),
            None => assert_eq!((codes(&again), geometry(&again).kind()), (vec!["W-off-empty"], Kind::TriMesh)),
        }
    }
}

#[test]
fn comments_are_named_as_lost() {
    let losses = |text: &str| read_text(text).losses.len();
    assert_eq!((losses("OFF 1 0 0\n0 0 0 # here\n"), losses("OFF 1 0 0\n0 0 0\n")), (1, 0));
}
