use std::sync::Arc;

use shapeloom_core::Field;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::{Geometry, Shape};

use crate::{
    ReadContext, ReadError, SiblingError, SiblingName, Siblings, WriteContext, detect, format_by_id, read, write,
};

struct Folder(Vec<(&'static str, Vec<u8>)>);

impl Siblings for Folder {
    fn open(&self, name: &SiblingName, max_bytes: u64) -> Result<Vec<u8>, SiblingError> {
        let found = self.0.iter().find(|(file, _)| *file == name.as_str());
        let (_, bytes) = found.ok_or(SiblingError::Missing)?;
        Ok(bytes.iter().copied().take(max_bytes as usize).collect())
    }
}

const BLOCK: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
const LINE: &str = "v 0 0 0\nv 2 0 0\nv 2 2 0\nl 1 2 3\n";
const GRID: &str = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 3 3 3\nencoding: ascii\n\n\
    0 0 0 0 0 0 0 0 0 0 0 0 0 100 0 0 0 0 0 0 0 0 0 0 0 0 0\n";

fn beside() -> ReadContext {
    let files = [("block.obj", BLOCK), ("line.obj", LINE), ("grid.nrrd", GRID), ("other.shape", "sphere(1)\n")];
    let folder = Folder(files.map(|(name, text)| (name, text.as_bytes().to_vec())).to_vec());
    ReadContext { siblings: Some(Arc::new(folder)), ..ReadContext::named("part.shape") }
}

fn text(input: &str) -> Result<Shape, ReadError> {
    Ok(read(input.as_bytes(), format_by_id("shape").unwrap(), &beside())?.shape)
}

fn value(shape: &Shape, point: DVec3) -> f64 {
    let Geometry::Implicit(implicit) = &*shape.parts[0].geometry else { panic!("an implicit") };
    implicit.value(point)
}

#[test]
fn files_beside_a_text_are_nodes() {
    let block = text("mesh(\"block.obj\")").unwrap();
    assert!((value(&block, DVec3::new(3.0, 0.0, 0.0)) - 2.0).abs() < 1e-12);
    assert!((value(&block, DVec3::ZERO) + 1.0).abs() < 1e-12);
    let tube = text("tube(\"line.obj\", radius: 0.5).move(1, 0, 0)").unwrap();
    assert!((value(&tube, DVec3::new(2.0, 0.0, 2.0)) - 1.5).abs() < 1e-12);
    let volume = text("volume(\"grid.nrrd\", iso: 50)").unwrap();
    assert!((value(&volume, DVec3::new(1.0, 1.0, 1.0)) + 50.0).abs() < 1e-4);
    assert!((value(&volume, DVec3::new(1.5, 1.0, 1.0))).abs() < 1e-4);
}

#[test]
fn texts_are_written_as_they_were_read() {
    let source = "hole = mesh(\"block.obj\").scale(0.5);\nbounds(-2, -2, -2, 2, 2, 2);\nbox(3, 3, 3) \\ hole\n";
    let shape = text(source).unwrap();
    let mut bytes = Vec::new();
    let report = write(&shape, format_by_id("shape").unwrap(), &WriteContext::default(), &mut bytes).unwrap();
    assert!(report.losses.is_empty());
    assert_eq!(text(std::str::from_utf8(&bytes).unwrap()).unwrap(), shape);
    let error = write(&shape, format_by_id("vm").unwrap(), &WriteContext::default(), &mut Vec::new()).unwrap_err();
    assert!(error.to_string().contains("block.obj"), "{error}");
}

#[test]
fn steps_are_told_by_their_first_line_and_written_again() {
    let steps = b"# a ball\nx var-x\ny var-y\nxx square x\nyy square y\ns add xx yy\none const 1\nout sub s one\n";
    let format = detect(steps, None).unwrap();
    assert_eq!(format.id, "vm");
    let shape = read(steps, format, &ReadContext::named("ball.vm")).unwrap().shape;
    assert_eq!(value(&shape, DVec3::new(2.0, 1.0, 7.0)), 4.0);
    let mut bytes = Vec::new();
    write(&shape, format, &WriteContext::default(), &mut bytes).unwrap();
    let again = read(&bytes, format, &ReadContext::named("ball.vm")).unwrap().shape;
    assert_eq!(value(&again, DVec3::new(0.5, 1.5, 0.0)), 1.5);
}

#[test]
fn errors_name_line_column_and_what_was_expected() {
    let said = |input: &str| text(input).unwrap_err().to_string();
    for (input, place, words) in [
        ("sphere(1) |", "line 1", "expected"),
        ("a = 1;\nspher(a)", "line 2", "sphere"),
        ("sphere(-1)", "line 1", "radius -1"),
        ("union()", "line 1", "expected"),
        ("mesh(\"none.obj\")", "line 1", "none.obj"),
        ("mesh(\"../block.obj\")", "line 1", "folder"),
        ("mesh(\"other.shape\")", "line 1", "another text"),
        ("mesh(\"block.obj\", colour: 2)", "line 1", "colour"),
        ("tube(\"line.obj\")", "line 1", "radius"),
        ("tube(\"block.obj\", radius: 1)", "line 1", "curves"),
        ("volume(\"block.obj\")", "line 1", "volume"),
        ("bounds(0, 0, 0, 0, 1, 1); sphere(1)", "", "bounds"),
    ] {
        let error = said(input);
        assert!(error.contains(place) && error.contains(words) && error.contains("part.shape"), "{input}: {error}");
    }
    let alone = read(b"mesh(\"block.obj\")", format_by_id("shape").unwrap(), &ReadContext::named("-")).unwrap_err();
    assert!(alone.to_string().contains("read alone"), "{alone}");
}
