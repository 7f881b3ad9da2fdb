//! USGS DEM: hand-made files, and the facts of a real one.

use shapeloom_core::glam::{DVec2, DVec3};
use shapeloom_core::{Diagnostic, Exec, Place};
use shapeloom_mesh::HeightField;
use shapeloom_shape::{Representation, Units, UpAxis};

use super::FORMAT;
use super::header::fortran;
use crate::{ReadContext, ReadError, ReadShape, Sniff};

fn dem(input: &[u8]) -> Result<ReadShape, ReadError> {
    let exec = Exec::default().with_memory(16 << 20);
    crate::read(input, &FORMAT, &ReadContext { exec, ..ReadContext::named("x.dem") })
}

fn field(read: &ReadShape) -> HeightField {
    HeightField::from_geometry(&read.shape.parts[0].geometry).unwrap().clone()
}

fn codes(read: &ReadShape) -> Vec<&'static str> {
    read.findings.iter().map(|finding| finding.code).collect()
}

fn double(value: f64) -> String {
    format!("{:>24}", format!("{value:.15E}").replace('E', "D"))
}

fn block(text: String) -> Vec<u8> {
    let mut bytes = text.into_bytes();
    assert!(bytes.len() <= 1024);
    bytes.resize(1024, b' ');
    bytes
}

struct Made {
    units: (u32, u32),
    angle: f64,
    resolution: [f64; 3],
    range: [f64; 2],
    profiles: i32,
}

const MADE: Made = Made { units: (2, 2), angle: 0.0, resolution: [30.0, 10.0, 1.0], range: [1.0, 9.0], profiles: 3 };

fn header(made: &Made) -> Vec<u8> {
    let mut text = format!("{:<144}{:6}{:6}{:6}{:6}", "A HILL", 1, 1, 1, 10);
    (0..15).for_each(|_| text += &double(0.0));
    text += &format!("{:6}{:6}{:6}", made.units.0, made.units.1, 4);
    (0..8).for_each(|corner| text += &double(f64::from(corner)));
    made.range.iter().chain([&made.angle]).for_each(|value| text += &double(*value));
    text += &format!("{:6}", 0);
    made.resolution.iter().for_each(|value| text += &format!("{:>12}", format!("{value:.6E}")));
    text += &format!("{:6}{:6}", 1, made.profiles);
    block(text)
}

fn profile(number: usize, first: [f64; 2], datum: f64, heights: &[i32]) -> Vec<u8> {
    let mut text = format!("{:6}{:6}{:6}{:6}", 1, number, heights.len(), 1);
    [first[0], first[1], datum, 0.0, 0.0].iter().for_each(|value| text += &double(*value));
    let mut bytes = Vec::new();
    let mut room = 146;
    for height in heights {
        if room == 0 {
            bytes.extend(block(std::mem::take(&mut text)));
            room = 170;
        }
        text += &format!("{height:6}");
        room -= 1;
    }
    bytes.extend(block(text));
    bytes
}

/// Three profiles that begin further to the north from one to the next.
fn made(by: &Made) -> Vec<u8> {
    let heights: [&[i32]; 3] = [&[1, 2, 3], &[4, -32767, 6], &[7, 9]];
    let mut bytes = header(by);
    for (column, heights) in heights.into_iter().enumerate() {
        let first = [500_000.0 + 30.0 * column as f64, 4e6 + 10.0 * column as f64];
        bytes.extend(profile(column + 1, first, 0.0, heights));
    }
    bytes
}

#[test]
fn profiles_are_columns_from_south_to_north() {
    let read = dem(&made(&MADE)).unwrap();
    assert_eq!((read.shape.up, read.shape.units), (Some(UpAxis::Z), Some(Units::METERS)));
    assert_eq!((read.shape.parts[0].name.as_str(), codes(&read)), ("A HILL", vec!["W-heights-holes"]));
    let field = field(&read);
    assert_eq!((field.columns(), field.rows(), field.spacing()), (3, 4, DVec2::new(30.0, 10.0)));
    let heights: Vec<Option<f64>> = (0..4)
        .flat_map(|row| (0..3).map(move |column| (column, row)))
        .map(|(c, r)| field.sample(c, r))
        .map(|s| s.map(|s| s.z))
        .collect();
    let (n, s) = (None, Some);
    assert_eq!(heights, [s(1.0), n, n, s(2.0), s(4.0), n, s(3.0), n, s(7.0), n, s(6.0), s(9.0)]);
    assert_eq!(field.sample(2, 3), Some(DVec3::new(500_060.0, 4_000_030.0, 9.0)));
}

#[test]
fn long_profiles_go_on_in_further_blocks() {
    let heights: Vec<i32> = (0..1000).collect();
    let mut bytes = header(&Made { profiles: 2, range: [0.0, 999.0], ..MADE });
    bytes.extend(profile(1, [0.0, 0.0], 0.0, &heights));
    bytes.extend(profile(2, [30.0, 0.0], 0.0, &heights));
    let whole = field(&dem(&bytes).unwrap());
    assert_eq!(whole.heights().len(), 2000);
    assert!((0..1000).all(|row| whole.sample(1, row).unwrap().z == f64::from(row)));
    // The same with ends of lines between blocks, and without the blanks before them.
    for end in ["\n", "\r\n"] {
        let lines: Vec<Vec<u8>> = bytes.chunks(1024).map(|block| [block, end.as_bytes()].concat()).collect();
        assert_eq!(field(&dem(&lines.concat()).unwrap()), whole);
        let short: Vec<Vec<u8>> =
            bytes.chunks(1024).map(|block| [block.trim_ascii_end(), end.as_bytes()].concat()).collect();
        assert_eq!(field(&dem(&short.concat()).unwrap()), whole);
    }
}

#[test]
fn units_are_brought_together() {
    let feet = dem(&made(&Made { units: (2, 1), resolution: [30.0, 10.0, 0.5], range: [0.5, 4.5], ..MADE })).unwrap();
    assert_eq!(codes(&feet), ["W-dem-units", "W-heights-holes"]);
    assert_eq!(field(&feet).sample(0, 1).unwrap().z, 1.0 * 0.3048);
    let ground = dem(&made(&Made { units: (1, 2), ..MADE })).unwrap();
    assert!((field(&ground).sample(0, 0).unwrap().z - 1.0 / 0.3048).abs() < 1e-15);
    assert_eq!(ground.shape.units.map(Units::meters), Some(0.3048));
    let arcs = dem(&made(&Made { units: (3, 2), ..MADE })).unwrap();
    assert_eq!((arcs.shape.units, codes(&arcs)[0]), (None, "W-heights-degrees"));
    let mut datum = header(&Made { profiles: 2, range: [101.0, 104.0], ..MADE });
    datum.extend(profile(1, [0.0, 0.0], 100.0, &[1, 2]));
    datum.extend(profile(2, [30.0, 0.0], 100.0, &[3, 4]));
    assert_eq!(field(&dem(&datum).unwrap()).heights(), [101.0, 103.0, 102.0, 104.0]);
}

#[test]
fn what_is_odd_is_said() {
    let range = dem(&made(&Made { range: [1.0, 800.0], ..MADE })).unwrap();
    assert_eq!(codes(&range)[0], "W-dem-range");
    let mut beside = header(&Made { profiles: 3, range: [1.0, 6.0], ..MADE });
    beside.extend(profile(1, [0.0, 0.0], 0.0, &[1, 2]));
    beside.extend(profile(2, [33.0, 0.0], 0.0, &[3, 4]));
    beside.extend(profile(2, [33.0, 0.0], 0.0, &[5, 6]));
    let read = dem(&beside).unwrap();
    assert_eq!(codes(&read), ["W-dem-twice", "W-dem-grid"]);
    assert_eq!(field(&read).heights(), [1.0, 5.0, 2.0, 6.0]);
}

#[test]
fn defects_are_told_where_they_stand() {
    let sound = made(&MADE);
    let patched = |at: usize, text: &str| {
        let mut bytes = sound.clone();
        bytes[at..at + text.len()].copy_from_slice(text.as_bytes());
        bytes
    };
    for (input, code, byte) in [
        (patched(528, "     7"), "E-dem-header", 528),
        (patched(534, "     x"), "E-dem-number", 534),
        (patched(786, &double(0.5)), "E-dem-feature", 786),
        (patched(816, " 0.000000E+0"), "E-dem-header", 816),
        (patched(858, "    -3"), "E-dem-count", 858),
        (patched(858, "999999"), "E-dem-truncated", 4096),
        (patched(1024 + 12, "     0"), "E-dem-claim", 1036),
        (patched(1024 + 12, "999999"), "E-dem-claim", 1036),
        (patched(1024 + 12, "   600"), "E-dem-number", 1024 + 144 + 18),
        (patched(1024 + 18, "     2"), "E-dem-profile", 1042),
        (patched(1024 + 24, "    abc"), "E-dem-number", 1048),
        (patched(1024 + 24, &double(1e300)), "E-dem-spread", 816),
        (patched(1024 + 48, &double(-1e9)), "E-dem-spread", 816),
        (patched(1024 + 144, "   1.5"), "E-dem-number", 1168),
    ] {
        let error = dem(&input).unwrap_err();
        let found = error.fault().map(|fault| (fault.code, fault.place.clone()));
        assert_eq!(found, Some((code, Place::Byte(byte))), "{error}");
        assert!(error.advice().is_some(), "{error}");
    }
    // Behind the last height only blanks are missed.
    for end in 0..sound.len() - 1024 + 144 + 12 {
        assert!(dem(&sound[..end]).is_err(), "{end}");
    }
    assert!(dem(&sound[..sound.len() - 1024 + 144 + 12]).is_ok());
    assert_eq!((FORMAT.sniff)(&sound), Sniff::Certain);
    assert_eq!((FORMAT.sniff)(&[b' '; 1024]), Sniff::No);
}

#[test]
fn numbers_are_those_of_fortran() {
    for (text, value) in
        [("0.557945011821133D+06", 557_945.011_821_133), ("-0.3d-2", -0.003), ("0.300000E+02", 30.0), ("7", 7.0)]
    {
        assert_eq!(fortran(text.as_bytes()), Some(value), "{text}");
    }
    for text in ["", "1D", "D5", "1.5.2", "nan", "1DD2", "0.1234567890123456789012345678901D+06"] {
        assert_eq!(fortran(text.as_bytes()), None, "{text}");
    }
}

/// What the file of Mount St. Helens says of itself, and what is known of the mountain.
#[test]
fn mount_st_helens_is_as_high_as_its_header_says() {
    let read = dem(include_bytes!("../../../../data/mount_st_helens.dem")).unwrap();
    assert_eq!(codes(&read), ["W-heights-holes"]);
    assert_eq!(read.shape.parts[0].name, "MOUNT ST. HELENS, WASH. (POST-ERUPTION)");
    let field = field(&read);
    assert_eq!((field.columns(), field.rows(), field.spacing()), (327, 466, DVec2::splat(30.0)));
    let samples: Vec<DVec3> = (0..466)
        .flat_map(|row| (0..327).map(move |column| (column, row)))
        .filter_map(|(c, r)| field.sample(c, r))
        .collect();
    // Counted and summed from the columns of the file by another program.
    assert_eq!(samples.len(), 148_885);
    assert_eq!(samples.iter().map(|sample| sample.z).sum::<f64>(), 192_320_028.0);
    let highest = samples.iter().max_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
    let lowest = samples.iter().min_by(|a, b| a.z.total_cmp(&b.z)).unwrap();
    // The range in the header; the summit has 2549 m since 1980, and had 2950 m before.
    assert_eq!((lowest.z, *highest), (682.0, DVec3::new(562_260.0, 5_115_390.0, 2543.0)));
    // The corners of the quadrangle in the header lie within two steps of the box of the samples.
    let bounds = read.shape.bounds();
    for (found, said) in
        [(bounds.min.x, 557_813.8), (bounds.max.x, 567_602.5), (bounds.min.y, 5_107_991.3), (bounds.max.y, 5_121_978.7)]
    {
        assert!((found - said).abs() < 60.0, "{found} {said}");
    }
}
