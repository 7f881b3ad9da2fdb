//! Reading OBJ: pieces read at the same time, put together in order.

use std::borrow::Cow;
use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Category, Findings, Limits, Place, Severity};
use shapeloom_mesh::TriMesh;
use shapeloom_shape::{Part, Shape};

use super::assemble::assemble;
use super::freeform;
use super::statements::{Event, Indices, NONE, Piece, Side};
use crate::faces::Faces;
use crate::memory::{Growing, Memory};
use crate::text::{Scanner, in_lines, line_place, never_joined, pieces, plain_text};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let text = plain_text(input, &context.limits)?;
    // A copy is made where lines are continued.
    let _copy = match memchr::memchr(b'\\', text) {
        Some(_) => Some(context.exec.reserve(text.len() as u64)?),
        None => None,
    };
    let text = joined(text);
    let parts = pieces(&text, 0, &context.exec, never_joined);
    // Lines are counted in the text as it is in the file.
    read_pieces(&text, &parts, context).map_err(|error| match error {
        ReadError::Input(fault) => ReadError::Input(in_lines(plain_text(input, &context.limits).unwrap_or(&[]), fault)),
        other => other,
    })
}

/// The text with continued lines made one: a backslash before a line end, and the line end, become blanks, so that
/// offsets stay. Comments do not go on: programs write paths in them.
fn joined(text: &[u8]) -> Cow<'_, [u8]> {
    let mut changed: Option<Vec<u8>> = None;
    // Whether the line that `from` is in is a comment, and where it is looked at from: never twice the same bytes.
    let (mut from, mut comment) = (0, starts_comment(text));
    while let Some(at) = memchr::memchr(b'\\', &text[from..]).map(|found| from + found) {
        if let Some(before) = memchr::memrchr2(b'\n', b'\r', &text[from..at]) {
            comment = starts_comment(&text[from + before + 1..at]);
        }
        let end = match text.get(at + 1..) {
            Some([b'\r', b'\n', ..]) => at + 3,
            Some([b'\n' | b'\r', ..]) => at + 2,
            _ => at + 1,
        };
        if end > at + 1 {
            if comment {
                comment = starts_comment(&text[end..]);
            } else {
                changed.get_or_insert_with(|| text.to_vec())[at..end].fill(b' ');
            }
        }
        from = end;
    }
    changed.map_or(Cow::Borrowed(text), Cow::Owned)
}

fn starts_comment(line: &[u8]) -> bool {
    line.iter().find(|byte| !matches!(byte, b' ' | b'\t')) == Some(&b'#')
}

/// What a whole file says, in one numbering.
pub(super) struct Whole<'t> {
    pub text: &'t [u8],
    pub positions: Vec<DVec3>,
    pub colors: Side<[f64; 4]>,
    pub weights: Side<f64>,
    pub texcoords: Vec<[f64; 2]>,
    pub deep_texcoords: bool,
    pub normals: Vec<DVec3>,
    pub faces: Faces,
    /// For each corner of each face, or empty.
    pub face_texcoords: Vec<u32>,
    pub face_normals: Vec<u32>,
    pub lines: Vec<u32>,
    pub line_ends: Vec<u32>,
    pub line_texcoords: bool,
    pub points: Vec<u32>,
    pub events: Vec<Event>,
    pub comments: bool,
    /// Where the faces of each piece are in the text, and how many there are.
    places: Vec<(Range<usize>, usize)>,
}

fn read_pieces(text: &[u8], parts: &[Range<usize>], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let result =
        map_chunks(&context.exec, parts.len(), 1, |chunk| Piece::read(text, parts[chunk.start].clone(), context));
    let read = result.map_err(|error| named(text, error, &context.limits))?;
    let mut memory = Memory::new(&context.exec);
    let mut findings = Findings::default();
    let whole = put_together(text, read, &mut memory, &mut findings, context)?;
    let mut found = if whole.positions.is_empty() && whole.faces.is_empty() {
        let message = "the file has no vertices: the mesh is empty";
        findings.push("W-obj-empty", Severity::Warning, Place::Byte(0), message);
        ReadShape::new(Shape::new(Part::new(TriMesh::default())))
    } else {
        assemble(whole, context, &mut memory, &mut findings)?
    };
    found.findings = findings.with_places(|place| line_place(text, place));
    Ok(found)
}

/// An error about a vertex gets its number, which only the whole text tells.
fn named(text: &[u8], error: ReadError, limits: &Limits) -> ReadError {
    match error {
        ReadError::Input(fault) if fault.code == "E-obj-freeform" => freeform::refusal(text, limits).into(),
        ReadError::Input(mut fault) if fault.within.as_deref() == Some("vertex") => {
            let Place::Byte(offset) = fault.place else { return fault.into() };
            let mut scan = Scanner::new(text, 0);
            let mut vertices = 0u64;
            while scan.skip_empty_lines() && (scan.offset() as u64) < offset {
                vertices += u64::from(scan.word() == b"v");
                scan.next_line();
            }
            // The one whose line the fault is in was counted too.
            fault.within = Some(format!("vertex {}", vertices.saturating_sub(1)));
            fault.into()
        }
        error => error,
    }
}

fn put_together<'t, 'e>(
    text: &'t [u8],
    pieces: Vec<Piece<'e>>,
    memory: &mut Memory<'e>,
    findings: &mut Findings,
    context: &ReadContext,
) -> Result<Whole<'t>, ReadError> {
    let mut positions = Growing::default();
    let (mut colors, mut weights): (Side<[f64; 4]>, Side<f64>) = Default::default();
    let (mut texcoords, mut normals) = (Growing::default(), Growing::default());
    let mut faces = Faces::default();
    let (mut face_texcoords, mut face_normals) = (Growing::default(), Growing::default());
    let (mut lines, mut line_ends, mut points) = (Growing::default(), Growing::default(), Growing::default());
    let mut events = Growing::default();
    let mut places = Vec::with_capacity(pieces.len());
    let (mut deep_texcoords, mut line_texcoords, mut comments) = (false, false, false);
    let mut held = Vec::with_capacity(pieces.len());
    for mut piece in pieces {
        context.exec.check()?;
        let vertices = piece.positions.len();
        places.push((piece.range.clone(), piece.faces.len()));
        for event in piece.events.as_slice() {
            let mut event = *event;
            event.vertices += positions.len() as u32;
            event.faces += faces.len() as u32;
            event.lines += line_ends.len() as u32;
            event.points += points.len() as u32;
            events.push(memory, event)?;
        }
        // Indices from the start of the piece are from the start of the file now.
        let relative = std::mem::take(&mut piece.relative);
        rebase(piece.faces.corners_mut(), relative.as_slice(), positions.len());
        join_corners(&mut face_texcoords, memory, piece.face_texcoords, texcoords.len(), faces.corner_count())?;
        join_corners(&mut face_normals, memory, piece.face_normals, normals.len(), faces.corner_count())?;
        faces.append(memory, piece.faces)?;
        for &end in piece.line_ends.as_slice() {
            line_ends.push(memory, lines.len() as u32 + end)?;
        }
        join(&mut lines, memory, piece.lines, positions.len())?;
        join(&mut points, memory, piece.points, positions.len())?;
        colors.append(memory, positions.len(), piece.colors, vertices, [f64::NAN; 4])?;
        weights.append(memory, positions.len(), piece.weights, vertices, 1.0)?;
        positions.append(memory, piece.positions)?;
        texcoords.append(memory, piece.texcoords)?;
        normals.append(memory, piece.normals)?;
        deep_texcoords |= piece.deep_texcoords;
        line_texcoords |= piece.line_texcoords;
        comments |= piece.comments;
        findings.extend(std::mem::take(&mut piece.findings));
        // What the pieces have reserved, the whole holds.
        held.push(piece.memory);
    }
    memory.adopt(held);
    let corner_count = faces.corner_count();
    for indices in [&mut face_texcoords, &mut face_normals] {
        while !indices.is_empty() && indices.len() < corner_count {
            indices.push(memory, NONE)?;
        }
    }
    let most = positions.len().max(faces.len()).max(texcoords.len()).max(normals.len()) as u64;
    if most > context.limits.max_elements {
        let expected = format!("at most {} vertices and faces", context.limits.max_elements);
        return Err(Fault::new("E-obj-limit", Place::Whole, most.to_string(), expected)
            .category(Category::OverLimit)
            .into());
    }
    let whole = Whole {
        text,
        positions: positions.into_vec(),
        colors,
        weights,
        texcoords: texcoords.into_vec(),
        deep_texcoords,
        normals: normals.into_vec(),
        faces,
        face_texcoords: face_texcoords.into_vec(),
        face_normals: face_normals.into_vec(),
        lines: lines.into_vec(),
        line_ends: line_ends.into_vec(),
        line_texcoords,
        points: points.into_vec(),
        events: events.into_vec(),
        comments,
        places,
    };
    whole.check_indices()?;
    Ok(whole)
}

/// Makes the indices at these places absolute. What reaches below the first becomes an index that no element has.
fn rebase(values: &mut [u32], relative: &[u32], base: usize) {
    for &at in relative {
        let value = base as i64 + i64::from(values[at as usize] as i32);
        values[at as usize] = u32::try_from(value).unwrap_or(NONE - 1);
    }
}

fn join(all: &mut Growing<u32>, memory: &mut Memory<'_>, mut piece: Indices, base: usize) -> Result<(), ReadError> {
    rebase(piece.values.as_mut_slice(), piece.relative.as_slice(), base);
    Ok(all.append(memory, piece.values)?)
}

/// The same for indices that each corner of each face has, or none.
fn join_corners(
    all: &mut Growing<u32>,
    memory: &mut Memory<'_>,
    piece: Indices,
    base: usize,
    corners: usize,
) -> Result<(), ReadError> {
    if piece.values.is_empty() {
        return Ok(());
    }
    while all.len() < corners {
        all.push(memory, NONE)?;
    }
    join(all, memory, piece, base)
}

impl Whole<'_> {
    /// Refuses what names something that does not exist.
    fn check_indices(&self) -> Result<(), ReadError> {
        let beyond = |values: &[u32], count: usize, none: bool| {
            let bad = |&value: &u32| value as usize >= count && !(none && value == NONE);
            values.iter().position(bad)
        };
        let corner = [
            (self.faces.corners(), self.positions.len(), false, "vertex", "vertices", 0),
            (&self.face_texcoords, self.texcoords.len(), true, "texture coordinate", "texture coordinates", 1),
            (&self.face_normals, self.normals.len(), true, "normal", "normals", 2),
        ];
        for (values, count, none, of, many, slot) in corner {
            let Some(at) = beyond(values, count, none) else { continue };
            let face = self.face_of_corner(at);
            let rank = at - self.faces.range(face).start;
            let (place, word) = self.corner_in_text(face, rank, slot);
            let found = if word.is_empty() { format!("a {of} that does not exist") } else { format!("{of} {word}") };
            return Err(self.index_fault(place, found, count, many));
        }
        for (word, values) in [(&b"l"[..], &self.lines), (b"p", &self.points)] {
            let Some(at) = beyond(values, self.positions.len(), false) else { continue };
            let mut seen = 0;
            let mut scan = Scanner::new(self.text, 0);
            while scan.skip_empty_lines() {
                let place = scan.place();
                if scan.word() == word {
                    let mut count = 0;
                    while !scan.at_line_end_or_comment() {
                        scan.word();
                        count += 1;
                    }
                    seen += if word == b"l" && count < 2 { 0 } else { count };
                    if seen > at {
                        let found = format!("vertex {} of 0-based indices", values[at]);
                        let found = if values[at] >= NONE - 1 { "a vertex before the first".to_owned() } else { found };
                        return Err(self.index_fault(place, found, self.positions.len(), "vertices"));
                    }
                }
                scan.next_line();
            }
        }
        Ok(())
    }

    fn index_fault(&self, place: Place, found: String, count: usize, many: &str) -> ReadError {
        let expected = match count {
            0 => format!("one of the file's {many}, of which there are none"),
            _ => format!("one of the file's {count} {many}, from 1 or from -1 back"),
        };
        Fault::new("E-obj-index", place, found, expected).into()
    }

    fn face_of_corner(&self, corner: usize) -> usize {
        let (mut low, mut high) = (0, self.faces.len());
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if self.faces.range(middle).start <= corner { low = middle } else { high = middle }
        }
        low
    }

    /// The place of a face in the text, as an offset: the piece that has it is read once more.
    pub fn face_in_text(&self, face: usize) -> Place {
        self.find_face(face).map_or(Place::Whole, |scan| scan.place())
    }

    /// Where the words of a face's statement start.
    fn find_face(&self, face: usize) -> Option<Scanner<'_>> {
        let mut before = 0;
        for (range, count) in &self.places {
            if face >= before + count {
                before += count;
                continue;
            }
            let mut scan = Scanner::new(&self.text[..range.end], range.start);
            while scan.skip_empty_lines() {
                if matches!(scan.word(), b"f" | b"fo") {
                    let start = scan.clone();
                    let mut corners = 0;
                    while corners < 3 && !scan.at_line_end_or_comment() {
                        scan.word();
                        corners += 1;
                    }
                    if corners == 3 {
                        if before == face {
                            return Some(start);
                        }
                        before += 1;
                    }
                }
                scan.next_line();
            }
        }
        None
    }

    /// The place of a corner of a face, and how it is written: of its three indices the one asked for.
    fn corner_in_text(&self, face: usize, rank: usize, slot: usize) -> (Place, String) {
        let Some(mut scan) = self.find_face(face) else { return (Place::Whole, String::new()) };
        for _ in 0..rank {
            scan.word();
        }
        let place = scan.place();
        let word = scan.word();
        let part = word.split(|&byte| byte == b'/').nth(slot).unwrap_or(word);
        (place, String::from_utf8_lossy(part).into_owned())
    }
}

impl<T: Copy> Side<T> {
    /// Adds the values of a piece; where only one side has any, the other is filled up.
    fn append(
        &mut self,
        memory: &mut Memory<'_>,
        before: usize,
        piece: Self,
        count: usize,
        missing: T,
    ) -> Result<(), ReadError> {
        if piece.values.is_empty() && self.values.is_empty() {
            return Ok(());
        }
        while self.values.len() < before {
            self.values.push(memory, missing)?;
        }
        self.numbers = self.numbers.max(piece.numbers);
        self.values.append(memory, piece.values)?;
        while self.values.len() < before + count {
            self.values.push(memory, missing)?;
        }
        Ok(())
    }
}

#[cfg(test)]
pub(super) fn read_cut(input: &[u8], size: usize, context: &ReadContext) -> Result<ReadShape, ReadError> {
    let text = plain_text(input, &context.limits)?;
    let text = joined(text);
    let parts = crate::text::cut(&text, 0, size, never_joined);
    read_pieces(&text, &parts, context).map_err(|error| match error {
        ReadError::Input(fault) => ReadError::Input(in_lines(input, fault)),
        other => other,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn continued_lines_are_joined_but_not_comments() {
        assert_eq!(&*joined(b"f 1 \\\n2\\\r\n3\n"), b"f 1   2   3\n");
        assert_eq!(&*joined(b"# C:\\\nv 1"), b"# C:\\\nv 1");
        assert_eq!(&*joined(b"f 1\\\n# 2"), b"f 1  # 2");
        assert_eq!(&*joined(b" #a\\\n#b\\\nc\\\nd\n#e\\\nf\\\n\\\ng"), b" #a\\\n#b\\\nc  d\n#e\\\nf    g");
        assert!(matches!(joined(b"mtllib a\\b.mtl\n"), Cow::Borrowed(_)));
    }
}
