//! Files made by hand, and text cut anywhere.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Affine, Category, Deviation, Diagnostic, Exec, Place, Threads};
use shapeloom_mesh::{COLOR, Column, Domain, TriMesh, Values};
use shapeloom_shape::{Geometry, Part, Shape, UpAxis};

use super::FORMAT;
use crate::test_data::{shuffled_lines, whats, written_as};
use crate::{Encoding, ReadContext, ReadShape, Sniff, WriteContext, read};

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
        assert!(crate::text::cut(text.as_bytes(), 0, size, super::ascii::inside_facet).len() > 2);
        assert_eq!(cut_into(&text, size).unwrap(), whole);
    }
    let exec = Exec::default().with_threads(Threads::Sequential);
    assert_eq!(read_as(text.as_bytes(), &ReadContext { exec, ..ReadContext::default() }), whole);
}

/// A text read in pieces of about a size.
fn cut_into(text: &str, size: usize) -> Result<ReadShape, crate::ReadError> {
    let cuts = crate::text::cut(text.as_bytes(), 0, size, super::ascii::inside_facet);
    super::ascii::read_pieces(text.as_bytes(), &cuts, &ReadContext::default())
}

#[test]
fn nothing_after_the_last_solid_is_read_wherever_the_text_is_cut() {
    let text = solids();
    let facets = text.split_once('\n').unwrap().1;
    for more in [format!("junk\n{facets}"), format!("junk\n{text}{text}"), "junk\nfacet\nendfacet\nsolid\n".repeat(9)] {
        let text = format!("{text}{more}");
        let whole = cut_into(&text, usize::MAX).unwrap();
        assert_eq!(whole.shape.parts.len(), 3);
        for size in [1, 50, 300, 1000] {
            assert_eq!(cut_into(&text, size).unwrap(), whole, "{size}");
        }
    }
}

#[test]
fn texts_of_shuffled_lines_are_the_same_wherever_they_are_cut() {
    let facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let text =
        format!("solid a\n{facet}{facet}endsolid a\nsolid b\n{facet}\nendsolid\njunk\nfacet normal 0 0\n{facet}");
    let mut read = 0;
    shuffled_lines(&text, 4000, |text| {
        let whole = cut_into(text, usize::MAX);
        read += usize::from(whole.is_ok());
        for size in [1, 70, 150, 300] {
            assert_eq!(cut_into(text, size), whole, "{size}\n{text}");
        }
    });
    assert!((400..3600).contains(&read), "{read}");
}

#[test]
fn floods_of_solids_are_refused() {
    let many = "solid\nendsolid\n".repeat(40_000);
    let facet = "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop\nendfacet\n";
    // Neither half is too many.
    let half = "solid\nendsolid\n".repeat(30_000);
    let halves = format!("{half}solid\n{facet}{facet}endsolid\n{half}");
    for text in [many.clone(), format!("{many}solid\n{facet}{facet}"), halves] {
        for size in [usize::MAX, 500_000, 100] {
            let error = cut_into(&text, size).unwrap_err();
            assert_eq!((error.code(), error.category()), ("E-stl-limit", Category::OverLimit));
        }
    }
    assert_eq!(cut_into(&"solid\nendsolid\n".repeat(20_000), 100).unwrap().shape.parts.len(), 20_000);
}

#[test]
fn names_that_are_no_utf_8_are_told() {
    let found = read_as(
        b"solid gr\xfcn\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop \
        endfacet\nendsolid\n",
        &ReadContext::default(),
    );
    assert_eq!(found.shape.parts[0].name, "gr\u{fffd}n");
    assert_eq!(codes(&found), [("W-text-encoding", Place::line(1), 1)]);
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

fn tetrahedron(scale: f64) -> TriMesh {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|point| point * scale).to_vec();
    TriMesh::try_new(positions, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap()
}

#[test]
fn text_keeps_names_parts_and_bits() {
    let parts = vec![
        Part::new(tetrahedron(1.0 / 3.0)).named("one third of it"),
        Part::new(TriMesh::default()),
        Part::new(tetrahedron(1e300)),
    ];
    let shape = Shape { parts, ..Shape::default() };
    let (file, report) = written_as(&FORMAT, &shape, Encoding::Ascii);
    assert_eq!((report.deviation, whats(&report)), (Deviation::Exact, vec![]));
    let text = String::from_utf8(file.clone()).unwrap();
    let start = "solid one third of it\nfacet normal 0 0 -1\n outer loop\n  vertex 0 0 0\n  vertex 0 ";
    assert!(text.starts_with(start), "{text}");
    let again = read_as(&file, &ReadContext::default());
    assert_eq!(
        again.shape.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(),
        ["one third of it", "", ""]
    );
    for (part, wanted) in shape.parts.iter().enumerate() {
        let Geometry::TriMesh(wanted) = &*wanted.geometry else { panic!("triangles") };
        // Vertices come in the order in which facets name them; corners are the same.
        let corners = |mesh: &TriMesh| (0..mesh.triangles().len()).map(|face| mesh.corners(face)).collect::<Vec<_>>();
        assert_eq!(corners(mesh(&again, part)), corners(wanted));
        assert_eq!(mesh(&again, part).positions().len(), wanted.positions().len());
    }
    assert_eq!(written_as(&FORMAT, &again.shape, Encoding::Ascii).0, file);
    let named = Shape::new(Part::new(tetrahedron(1.0)).named(" two\nlines"));
    let (file, report) = written_as(&FORMAT, &named, Encoding::Ascii);
    assert_eq!(read_as(&file, &ReadContext::default()).shape.parts[0].name, "two_lines");
    assert_eq!(whats(&report), ["part name \" two\\nlines\""]);
}

#[test]
fn binary_facets_have_their_normal_and_rounding_is_said() {
    let (file, report) = written_as(&FORMAT, &Shape::new(Part::new(tetrahedron(0.1)).named("x")), Encoding::Automatic);
    assert_eq!(file.len(), 84 + 4 * 50);
    assert_eq!((&file[80..84], file.starts_with(b"solid")), (&[4, 0, 0, 0][..], false));
    let number = |at: usize| f32::from_le_bytes(file[at..at + 4].try_into().unwrap());
    assert_eq!([84, 88, 92].map(number), [0.0, 0.0, -1.0]);
    // The slanted one.
    assert!([234, 238, 242].map(number).iter().all(|n| (n - 1.0 / 3f32.sqrt()).abs() < 1e-7));
    let Deviation::AtMost(bound) = report.deviation else { panic!("{:?}", report.deviation) };
    let moved = (f64::from(0.1f32) - 0.1).abs();
    assert!(moved <= bound && bound < moved * 1.000_001);
    assert_eq!(whats(&report), ["part name \"x\"", "positions"]);
    let context = WriteContext::default();
    let error =
        crate::write(&Shape::new(Part::new(tetrahedron(1e39))), &FORMAT, &context, &mut Vec::new()).unwrap_err();
    assert!(matches!(error, crate::WriteError::NotFinite { index: 1, .. }), "{error}");
    // Tiny and degenerate facets have normals too, or none.
    let mut flat = TriMesh::try_new(vec![DVec3::ZERO, DVec3::X, DVec3::X * 2.0], vec![[0, 1, 2]]).unwrap();
    let (file, report) = written_as(&FORMAT, &Shape::new(Part::new(flat.clone())), Encoding::Binary);
    assert_eq!((&file[84..96], report.deviation), (&[0; 12][..], Deviation::Exact));
    flat.positions_mut()[2] = DVec3::Y;
    let tiny = flat.transformed(&Affine::from_scale(DVec3::splat(1e-200)));
    let (file, _) = written_as(&FORMAT, &Shape::new(Part::new(tiny)), Encoding::Ascii);
    assert!(file.starts_with(b"solid \nfacet normal 0 0 1\n"));
}

#[test]
fn colors_survive_in_five_bits_and_all_else_is_lost_by_name() {
    let mut mesh = tetrahedron(1.0);
    let colors = vec![255, 0, 8, 132, 16, 25, 33, 41, 49, 58, 66, 74];
    mesh.insert_attribute(Domain::Face, Column::try_new(COLOR, 3, Values::U8(colors.clone())).unwrap()).unwrap();
    let shape = Shape::new(Part::new(mesh.clone()));
    let (file, report) = written_as(&FORMAT, &shape, Encoding::Binary);
    assert!(whats(&report).is_empty());
    let again = read_as(&file, &ReadContext::default());
    let found = self::mesh(&again, 0).attribute(Domain::Face, COLOR).unwrap();
    assert_eq!(found.values(), &Values::U8(colors));
    assert_eq!(written_as(&FORMAT, &again.shape, Encoding::Binary).0, file);

    mesh.remove_attribute(Domain::Face, COLOR);
    mesh.insert_attribute(Domain::Face, Column::try_new(COLOR, 4, Values::U8(vec![100; 16])).unwrap()).unwrap();
    mesh.insert_attribute(Domain::Vertex, Column::normals("normal", &[DVec3::X; 4])).unwrap();
    mesh.insert_attribute(Domain::Wedge, Column::labels("id", vec![0; 12])).unwrap();
    let lone = TriMesh::try_new(vec![DVec3::ZERO; 4], vec![[0, 1, 2]]).unwrap();
    let parts = vec![Part::new(mesh), Part::new(lone)];
    let shape = Shape { parts, up: Some(UpAxis::Z), ..Shape::default() };
    let (file, report) = written_as(&FORMAT, &shape, Encoding::BinaryBigEndian);
    let wanted = [
        "2 separate parts",
        "up axis (z)",
        "1 vertices without triangles",
        "big endian",
        "vertex attribute \"normal\"",
        "face attribute \"color\"",
        "face attribute \"color\"",
        "wedge attribute \"id\"",
        "part without colours among others that have them",
    ];
    assert_eq!(whats(&report), wanted);
    assert!(report.losses[5].why.contains("at most 1 of 255"), "{}", report.losses[5].why);
    let again = read_as(&file, &ReadContext::default());
    assert_eq!(again.shape.parts.len(), 1);
    let color = self::mesh(&again, 0).attribute(Domain::Face, COLOR).unwrap();
    assert_eq!((color.number(0, 0), color.number(4, 0)), (99.0, 255.0));
    let (_, report) = written_as(&FORMAT, &shape, Encoding::Ascii);
    assert!(whats(&report).contains(&"face attribute \"color\"") && !whats(&report).contains(&"2 separate parts"));
}

/// What people and programs put beside the facets is named where it is not kept.
#[test]
fn headers_and_words_that_are_no_colors_are_named() {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let said = |header: &[u8], word: u16| -> Vec<String> {
        let file = binary(header, &[(corners, word)]);
        let read = read(&file, &FORMAT, &ReadContext::default()).unwrap();
        read.losses.into_iter().map(|loss| loss.what).collect()
    };
    assert_eq!(said(b"Exported by a CAD, unit mm  ", 0), ["the header \"Exported by a CAD, unit mm\""]);
    assert_eq!(said(b"", 7), ["attribute words of facets"]);
    assert!(said(b"   ", 0).is_empty() && said(b"", 1 << 15).is_empty());
    // What the writer puts there itself is nothing to lose.
    let read = read(&binary(b"", &[(corners, 0)]), &FORMAT, &ReadContext::default()).unwrap();
    let (file, _) = written_as(&FORMAT, &read.shape, Encoding::Binary);
    assert!(crate::read(&file, &FORMAT, &ReadContext::default()).unwrap().losses.is_empty());
}
