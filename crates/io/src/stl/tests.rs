//! Files made by hand, and text cut anywhere.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Exec, Place, Threads};
use shapeloom_mesh::{COLOR, Domain, TriMesh, Values};
use shapeloom_shape::Geometry;

use super::FORMAT;
use crate::{ReadContext, ReadShape, Sniff, read};

/// Facets with their last two bytes, and a header that begins so.
fn binary(header: &[u8], facets: &[([[f32; 3]; 3], u16)]) -> Vec<u8> {
    let mut file = header.to_vec();
    file.resize(80, 0);
    file.extend_from_slice(&(facets.len() as u32).to_le_bytes());
    for (corners, word) in facets {
        file.extend_from_slice(&[0; 12]);
        file.extend(corners.as_flattened().iter().flat_map(|number| number.to_le_bytes()));
        file.extend_from_slice(&word.to_le_bytes());
    }
    file
}

const A: [f32; 3] = [0.0, 0.0, 0.0];
const B: [f32; 3] = [1.0, 0.0, 0.0];
const C: [f32; 3] = [0.0, 1.0, 0.0];
const D: [f32; 3] = [0.1, 0.2, 0.3];

fn read_as(file: &[u8], context: &ReadContext) -> ReadShape {
    read(file, &FORMAT, context).unwrap()
}

fn mesh(read: &ReadShape, part: usize) -> &TriMesh {
    let Geometry::TriMesh(mesh) = &*read.shape.parts[part].geometry else { panic!("triangles") };
    mesh
}

fn codes(read: &ReadShape) -> Vec<(&str, Place, u64)> {
    read.findings.iter().map(|finding| (finding.code, finding.places[0].clone(), finding.count)).collect()
}

#[test]
fn binary_facets_share_corners_unless_asked_not_to() {
    let file = binary(b"solid but binary", &[([A, B, C], 0), ([A, C, D], 7), ([[-0.0, 0.0, 0.0], D, B], 0)]);
    assert_eq!((FORMAT.sniff)(&file), Sniff::Likely);
    let found = read_as(&file, &ReadContext::default());
    assert_eq!(mesh(&found, 0).triangles(), [[0, 1, 2], [0, 2, 3], [0, 3, 1]]);
    assert_eq!(mesh(&found, 0).positions()[3], DVec3::from_array(D.map(f64::from)));
    assert!(found.findings.is_empty() && mesh(&found, 0).attributes().face.is_empty());
    let mut soup = ReadContext::default();
    soup.options.weld = false;
    let found = read_as(&file, &soup);
    assert_eq!((mesh(&found, 0).positions().len(), mesh(&found, 0).triangles()[2]), (9, [6, 7, 8]));
}

#[test]
fn colors_of_both_programs_are_read() {
    let word = |high: u16, middle: u16, low: u16| (high << 10) | (middle << 5) | low;
    let own = 1 << 15;
    let viscam = binary(b"", &[([A, B, C], own | word(31, 16, 1)), ([A, C, D], word(1, 2, 3))]);
    let found = read_as(&viscam, &ReadContext::default());
    let color = mesh(&found, 0).attribute(Domain::Face, COLOR).unwrap();
    assert_eq!((color.width(), color.values()), (3, &Values::U8(vec![255, 132, 8, 255, 255, 255])));
    assert_eq!(codes(&found), [("W-stl-color", Place::Byte(134), 1)]);
    for (alpha, width) in [(255, 3), (9, 4)] {
        let header = [&b"made by hand COLOR="[..], &[10, 20, 30, alpha]].concat();
        let magics = binary(&header, &[([A, B, C], own | word(1, 2, 3)), ([A, C, D], word(31, 16, 1))]);
        let found = read_as(&magics, &ReadContext::default());
        let color = mesh(&found, 0).attribute(Domain::Face, COLOR).unwrap();
        let colors: Vec<f64> = (0..2).flat_map(|face| (0..width).map(move |i| color.number(face, i))).collect();
        let rgba = [10.0, 20.0, 30.0, 9.0, 8.0, 132.0, 255.0, 9.0];
        let wanted: Vec<f64> = rgba.chunks(4).flat_map(|rgba| rgba[..width].to_vec()).collect();
        assert_eq!((color.width(), colors), (width, wanted));
    }
}

fn solids() -> String {
    let mut text = String::from("solid first of two\n");
    for i in 0..40 {
        let z = f64::from(i % 7) / 10.0;
        text += &format!("facet normal 0 0 1\r\n outer loop\n  vertex 0 0 {z}\n  vertex 1 0 {i}\r  vertex 0 1e0 0\n");
        text += " endloop\n endfacet\n";
        if i == 22 {
            text += "endsolid first of two\nSOLID\nendsolid\nSolid next\n";
        }
        if i == 30 {
            text += "FACET NORMAL nan 0 0 OUTER LOOP VERTEX 0 0 0 VERTEX 1 1 1 VERTEX 2 2 2 ENDLOOP ENDFACET\n";
        }
    }
    text + "endsolid next\n"
}

#[test]
fn solids_are_parts_wherever_the_text_is_cut() {
    let text = solids();
    let whole = read_as(text.as_bytes(), &ReadContext::default());
    let names: Vec<&str> = whole.shape.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["first of two", "", "next"]);
    let counts = [0, 1, 2].map(|part| mesh(&whole, part).triangles().len());
    assert_eq!(counts, [23, 0, 18]);
    let line = text.lines().position(|line| line.starts_with("FACET")).unwrap() as u64;
    // Lines that end in a return alone are no lines to the standard library: one in each of 31 facets.
    let place = Place::line(line + 1 + 31);
    assert_eq!(codes(&whole), [("W-stl-normal", place.clone(), 1), ("W-stl-degenerate", place, 1)]);
    for size in [1, 50, 300, 1000] {
        let cuts = crate::text::cut(text.as_bytes(), 0, size, super::ascii::inside_facet);
        assert!(cuts.len() > 2);
        let found = super::ascii::read_pieces(text.as_bytes(), &cuts, &ReadContext::default()).unwrap();
        assert_eq!(found, whole);
    }
    let exec = Exec::default().with_threads(Threads::Sequential);
    assert_eq!(read_as(text.as_bytes(), &ReadContext { exec, ..ReadContext::default() }), whole);
}

#[test]
fn text_is_told_from_binary() {
    for text in ["solid\nfacet normal 0 0 1", "  SOLID x\r\n endsolid x", "\u{feff}solid a b\n\tendsolid"] {
        assert_eq!((FORMAT.sniff)(text.as_bytes()), Sniff::Likely, "{text}");
    }
    for other in [&b"solidity is\nno facet"[..], b"solid ground", b"", &[0; 83], &[1; 84], b"OFF\n"] {
        assert_eq!((FORMAT.sniff)(other), Sniff::No);
    }
    assert_eq!((FORMAT.sniff)(&[0; 84]), Sniff::Likely);
}
