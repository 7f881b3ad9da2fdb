//! The statements of a piece of OBJ text.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Category, Findings, Limits, OverBudget, Place, Severity};

use crate::audit::DROP_ADVICE;
use crate::faces::Faces;
use crate::memory::{Growing, Memory};
use crate::text::{CountFault, NumberFault, Scanner, quoted};
use crate::{Fault, ReadContext, ReadError};

/// The index of a corner that names no texture coordinate, or no normal.
pub(super) const NONE: u32 = u32::MAX;

/// What one piece of the text says, in its own numbering: positive indices count from the start of the file, negative
/// ones from what the piece has so far.
pub(super) struct Piece<'e> {
    /// Where it lies in the text.
    pub range: Range<usize>,
    pub memory: Memory<'e>,
    pub findings: Findings,
    pub positions: Growing<DVec3>,
    pub colors: Side<[f64; 4]>,
    pub weights: Side<f64>,
    pub texcoords: Growing<[f64; 2]>,
    /// Whether a texture coordinate has a third number other than zero.
    pub deep_texcoords: bool,
    pub normals: Growing<DVec3>,
    pub faces: Faces,
    /// Corners of faces whose vertex is counted from the start of the piece.
    pub relative: Growing<u32>,
    pub face_texcoords: Indices,
    pub face_normals: Indices,
    /// The vertices of all `l` statements, and where each ends.
    pub lines: Indices,
    pub line_ends: Growing<u32>,
    pub line_texcoords: bool,
    /// The vertices of all `p` statements.
    pub points: Indices,
    pub events: Growing<Event>,
    pub comments: bool,
}

/// Values that only some vertices have: kept for all from the first that has one on.
pub(super) struct Side<T> {
    pub values: Growing<T>,
    pub numbers: u8,
}

/// Indices from 0, some counted from the start of the piece: the positions of those are in `relative`.
#[derive(Default)]
pub(super) struct Indices {
    pub values: Growing<u32>,
    pub relative: Growing<u32>,
}

/// A statement that holds for what follows it.
#[derive(Clone, Copy)]
pub(super) struct Event {
    pub kind: EventKind,
    /// Its words, as offsets into the text.
    pub start: usize,
    pub end: usize,
    /// How many vertices, faces, lines and points of the piece stand before it.
    pub vertices: u32,
    pub faces: u32,
    pub lines: u32,
    pub points: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum EventKind {
    Object,
    Group,
    Smoothing,
    Material,
    Library,
}

impl<T> Default for Side<T> {
    fn default() -> Self {
        Self { values: Growing::default(), numbers: 0 }
    }
}

impl<T: Copy> Side<T> {
    /// The value of the vertex after `before` others.
    fn set(&mut self, memory: &mut Memory<'_>, before: usize, missing: T, value: Option<T>) -> Result<(), OverBudget> {
        if value.is_some() {
            while self.values.len() < before {
                self.values.push(memory, missing)?;
            }
        } else if self.values.is_empty() {
            return Ok(());
        }
        self.values.push(memory, value.unwrap_or(missing))
    }
}

impl Indices {
    fn push(&mut self, memory: &mut Memory<'_>, index: Index) -> Result<(), OverBudget> {
        if index.relative {
            self.relative.push(memory, self.values.len() as u32)?;
        }
        self.values.push(memory, index.value)
    }
}

/// An index as it is written.
#[derive(Clone, Copy)]
struct Index {
    value: u32,
    relative: bool,
}

impl<'e> Piece<'e> {
    pub fn read(text: &[u8], range: Range<usize>, context: &'e ReadContext) -> Result<Self, ReadError> {
        let mut piece = Self {
            range: range.clone(),
            memory: Memory::new(&context.exec),
            findings: Findings::default(),
            positions: Growing::default(),
            colors: Side::default(),
            weights: Side::default(),
            texcoords: Growing::default(),
            deep_texcoords: false,
            normals: Growing::default(),
            faces: Faces::default(),
            relative: Growing::default(),
            face_texcoords: Indices::default(),
            face_normals: Indices::default(),
            lines: Indices::default(),
            line_ends: Growing::default(),
            line_texcoords: false,
            points: Indices::default(),
            events: Growing::default(),
            comments: false,
        };
        let mut scan = Scanner::new(&text[..range.end], range.start);
        let mut corners = Vec::new();
        let mut statements = 0usize;
        loop {
            let before = scan.offset();
            let more = scan.skip_empty_lines();
            // What was passed over is blank but for comments.
            piece.comments = piece.comments
                || before < scan.offset() && memchr::memchr(b'#', &text[before..scan.offset()]).is_some();
            if !more {
                break;
            }
            statements += 1;
            if statements.is_multiple_of(1 << 14) {
                context.exec.check()?;
                context.exec.progress(scan.offset() as f64 / text.len() as f64);
            }
            let word_at = scan.offset();
            match scan.word() {
                b"v" => piece.vertex(&mut scan, context)?,
                b"f" | b"fo" => piece.face(&mut scan, &mut corners, &context.limits)?,
                b"vn" => piece.normal(&mut scan)?,
                b"vt" => piece.texcoord(&mut scan)?,
                b"l" => piece.line(&mut scan)?,
                b"p" => piece.point(&mut scan)?,
                b"o" => piece.event(EventKind::Object, &scan)?,
                b"g" => piece.event(EventKind::Group, &scan)?,
                b"s" => piece.event(EventKind::Smoothing, &scan)?,
                b"usemtl" => piece.event(EventKind::Material, &scan)?,
                b"mtllib" => piece.event(EventKind::Library, &scan)?,
                word => piece.other(word, word_at)?,
            }
            piece.comments |= scan.peek() == Some(b'#');
            scan.next_line();
        }
        Ok(piece)
    }

    fn vertex(&mut self, scan: &mut Scanner<'_>, context: &ReadContext) -> Result<(), ReadError> {
        let start = scan.offset();
        let lenient = context.options.drop_non_finite;
        let mut numbers = [0.0; 8];
        let mut count = 0;
        while !scan.at_line_end_or_comment() {
            let at = scan.clone();
            let value = match scan.number() {
                Ok(value) => value,
                // Colours that are no numbers are passed over with a finding; positions are an error unless dropped.
                Err(NumberFault::NotFinite | NumberFault::Overflow) if count >= 3 || lenient => {
                    scan.word();
                    f64::NAN
                }
                Err(fault) => return Err(number_fault(&at, fault, "vertex")),
            };
            if count == numbers.len() {
                count += 1;
                break;
            }
            numbers[count] = value;
            count += 1;
        }
        let [x, y, z, ..] = numbers;
        let before = self.positions.len();
        let (color, weight) = match count {
            3 => (None, None),
            4 => (None, Some(numbers[3])),
            6 => (Some([numbers[3], numbers[4], numbers[5], 1.0]), None),
            7 => (Some([numbers[3], numbers[4], numbers[5], numbers[6]]), None),
            _ => {
                let expected = "3 coordinates, or 4 with a weight, or 6 or 7 with a colour";
                let found = if count > 7 { "more than 7 numbers".to_owned() } else { plural(count, "number") };
                let place = Place::Byte(start as u64);
                return Err(Fault::new("E-obj-row", place, found, expected).within("v").into());
            }
        };
        self.positions.push(&mut self.memory, DVec3::new(x, y, z))?;
        if weight == Some(0.0) {
            let place = Place::Byte(start as u64);
            let message = "a vertex has the weight 0; weights mean nothing for polygons and were kept aside";
            self.findings.push("W-obj-weight", Severity::Warning, place, message);
        }
        if color.is_some() || self.colors.numbers > 0 {
            self.colors.numbers = self.colors.numbers.max(if count == 7 { 4 } else { 3 });
            self.colors.set(&mut self.memory, before, [f64::NAN; 4], color)?;
        }
        if weight.is_some() || self.weights.numbers > 0 {
            self.weights.numbers = 1;
            self.weights.set(&mut self.memory, before, 1.0, weight)?;
        }
        Ok(())
    }

    fn normal(&mut self, scan: &mut Scanner<'_>) -> Result<(), ReadError> {
        let numbers = self.numbers(scan, "vn", 3..=3)?.0;
        Ok(self.normals.push(&mut self.memory, DVec3::new(numbers[0], numbers[1], numbers[2]))?)
    }

    fn texcoord(&mut self, scan: &mut Scanner<'_>) -> Result<(), ReadError> {
        let (numbers, _) = self.numbers(scan, "vt", 1..=3)?;
        self.deep_texcoords |= numbers[2] != 0.0;
        Ok(self.texcoords.push(&mut self.memory, [numbers[0], numbers[1]])?)
    }

    /// Numbers that may be no numbers: they do not carry the shape.
    fn numbers(
        &mut self,
        scan: &mut Scanner<'_>,
        word: &'static str,
        wanted: std::ops::RangeInclusive<usize>,
    ) -> Result<([f64; 3], usize), ReadError> {
        let mut numbers = [0.0; 3];
        let start = scan.offset();
        let mut count = 0;
        while !scan.at_line_end_or_comment() {
            let at = scan.clone();
            let value = match scan.number() {
                Ok(value) => value,
                Err(NumberFault::Syntax) => {
                    return Err(number_fault(&at, NumberFault::Syntax, word));
                }
                Err(NumberFault::NotFinite | NumberFault::Overflow) => {
                    let message = format!("{word} holds {}; it was read as not a number", quoted(scan.word()));
                    self.findings.push("W-obj-finite", Severity::Warning, at.place(), message);
                    f64::NAN
                }
            };
            if let Some(slot) = numbers.get_mut(count) {
                *slot = value;
            }
            count += 1;
        }
        if wanted.contains(&count) {
            return Ok((numbers, count));
        }
        let (least, most) = wanted.into_inner();
        let expected = if least == most { plural(most, "number") } else { format!("{least} to {most} numbers") };
        let place = Place::Byte(start as u64);
        Err(Fault::new("E-obj-row", place, plural(count, "number"), expected).within(word).into())
    }

    fn face(&mut self, scan: &mut Scanner<'_>, corners: &mut Vec<u32>, limits: &Limits) -> Result<(), ReadError> {
        corners.clear();
        let start = scan.offset();
        let before = (self.faces.corner_count(), self.relative.len());
        let texcoords_before = (self.face_texcoords.values.len(), self.face_texcoords.relative.len());
        let normals_before = (self.face_normals.values.len(), self.face_normals.relative.len());
        while !scan.at_line_end_or_comment() {
            let vertex = self.index(scan, "vertex", self.positions.len())?;
            if vertex.relative {
                self.relative.push(&mut self.memory, (before.0 + corners.len()) as u32)?;
            }
            let at = before.0 + corners.len();
            corners.push(vertex.value);
            if scan.peek() == Some(b'/') {
                scan.advance(1);
                if !matches!(scan.peek(), Some(b'/' | b' ' | b'\t' | b'\n' | b'\r') | None) {
                    let index = self.index(scan, "texture coordinate", self.texcoords.len())?;
                    pad(&mut self.face_texcoords.values, &mut self.memory, at)?;
                    self.face_texcoords.push(&mut self.memory, index)?;
                }
                if scan.peek() == Some(b'/') {
                    scan.advance(1);
                    if !matches!(scan.peek(), Some(b' ' | b'\t' | b'\n' | b'\r') | None) {
                        let index = self.index(scan, "normal", self.normals.len())?;
                        pad(&mut self.face_normals.values, &mut self.memory, at)?;
                        self.face_normals.push(&mut self.memory, index)?;
                    }
                }
            }
            if !matches!(scan.peek(), Some(b' ' | b'\t' | b'\n' | b'\r' | b'\x0b' | b'\x0c') | None) {
                return Err(corner_fault(scan));
            }
        }
        if corners.len() as u64 > u64::from(limits.max_polygon) {
            let most = format!("at most {} corners", limits.max_polygon);
            let place = Place::Byte(start as u64);
            let fault = Fault::new("E-obj-limit", place, plural(corners.len(), "corner"), most);
            return Err(fault.category(Category::OverLimit).into());
        }
        if corners.len() < 3 {
            let message = format!("a face of {} was passed over", plural(corners.len(), "corner"));
            self.findings.push("W-obj-skipped", Severity::Warning, Place::Byte(start as u64), message);
            self.relative.truncate(before.1);
            self.face_texcoords.values.truncate(texcoords_before.0);
            self.face_texcoords.relative.truncate(texcoords_before.1);
            self.face_normals.values.truncate(normals_before.0);
            self.face_normals.relative.truncate(normals_before.1);
            return Ok(());
        }
        self.faces.push(&mut self.memory, corners)
    }

    fn line(&mut self, scan: &mut Scanner<'_>) -> Result<(), ReadError> {
        let start = scan.offset();
        let before = (self.lines.values.len(), self.lines.relative.len());
        while !scan.at_line_end_or_comment() {
            let vertex = self.index(scan, "vertex", self.positions.len())?;
            self.lines.push(&mut self.memory, vertex)?;
            if scan.peek() == Some(b'/') {
                scan.advance(1);
                if !matches!(scan.peek(), Some(b' ' | b'\t' | b'\n' | b'\r') | None) {
                    self.index(scan, "texture coordinate", self.texcoords.len())?;
                    self.line_texcoords = true;
                }
            }
            if !matches!(scan.peek(), Some(b' ' | b'\t' | b'\n' | b'\r' | b'\x0b' | b'\x0c') | None) {
                return Err(corner_fault(scan));
            }
        }
        if self.lines.values.len() - before.0 < 2 {
            let message = "a line of fewer than two vertices was passed over";
            self.findings.push("W-obj-skipped", Severity::Warning, Place::Byte(start as u64), message);
            self.lines.values.truncate(before.0);
            self.lines.relative.truncate(before.1);
            return Ok(());
        }
        Ok(self.line_ends.push(&mut self.memory, self.lines.values.len() as u32)?)
    }

    fn point(&mut self, scan: &mut Scanner<'_>) -> Result<(), ReadError> {
        while !scan.at_line_end_or_comment() {
            let vertex = self.index(scan, "vertex", self.positions.len())?;
            self.points.push(&mut self.memory, vertex)?;
            if !scan.at_line_end() && !matches!(scan.peek(), Some(b'0'..=b'9' | b'-' | b'#')) {
                return Err(corner_fault(scan));
            }
        }
        Ok(())
    }

    /// An index that stands next: positive from the start of the file, negative back from the last of `so_far`.
    #[inline]
    fn index(&self, scan: &mut Scanner<'_>, of: &'static str, so_far: usize) -> Result<Index, ReadError> {
        let at = scan.clone();
        match scan.signed_part() {
            Ok((value @ 1..=0x7fff_ffff, false)) => Ok(Index { value: value as u32 - 1, relative: false }),
            Ok((value @ 1..=0x7fff_ffff, true)) => {
                // Below zero where it reaches back into an earlier piece; found out when the pieces are put together.
                let value = (so_far as i64 - value as i64) as i32 as u32;
                Ok(Index { value, relative: true })
            }
            Ok((0, _)) => {
                let fault = Fault::new("E-obj-index", at.place(), "index 0", format!("a {of} from 1, or from -1 back"));
                Err(fault.advice("OBJ counts from 1; was it written from 0?").into())
            }
            Ok((value, _)) if value <= i64::MAX as u64 => {
                let found = quoted(at.clone().word());
                Err(Fault::new("E-obj-index", at.place(), found, format!("the index of a {of} that exists")).into())
            }
            Ok(_) | Err(CountFault::Overflow) => {
                let found = quoted(at.clone().word());
                Err(Fault::new("E-obj-number", at.place(), found, format!("the index of a {of}")).into())
            }
            Err(CountFault::Syntax) => Err(corner_fault(&at)),
        }
    }

    fn event(&mut self, kind: EventKind, scan: &Scanner<'_>) -> Result<(), ReadError> {
        let mut words = scan.clone();
        words.skip_blanks();
        let start = words.offset();
        let event = Event {
            kind,
            start,
            end: start + words.rest_of_line().len(),
            vertices: self.positions.len() as u32,
            faces: self.faces.len() as u32,
            lines: self.line_ends.len() as u32,
            points: self.points.values.len() as u32,
        };
        Ok(self.events.push(&mut self.memory, event)?)
    }

    /// Statements that carry nothing that a mesh holds, and what no OBJ file has.
    #[cold]
    fn other(&mut self, word: &[u8], at: usize) -> Result<(), ReadError> {
        let place = Place::Byte(at as u64);
        match word {
            b"curv" | b"curv2" | b"surf" => {
                // The whole text is looked at to say why.
                Err(Fault::new("E-obj-freeform", place, quoted(word), "polygons, lines and points").into())
            }
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv" | b"sp" | b"end"
            | b"con" | b"bzp" | b"bsp" | b"cdc" | b"cdp" | b"res" => {
                let message = format!("{} belongs to free-form curves and was passed over", quoted(word));
                self.findings.push("W-obj-freeform", Severity::Warning, place, message);
                Ok(())
            }
            b"call" | b"csh" => {
                let message = format!("{} names something to be run or read, and was passed over", quoted(word));
                self.findings.push("W-obj-ignored", Severity::Warning, place, message);
                Ok(())
            }
            b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"maplib" | b"usemap" | b"shadow_obj"
            | b"trace_obj" | b"ctech" | b"stech" => {
                let message = format!("{} says how to draw the shape, and was passed over", quoted(word));
                self.findings.push("W-obj-drawing", Severity::Note, place, message);
                Ok(())
            }
            word => {
                let message = format!("{} is no statement of OBJ; the line was passed over", quoted(word));
                self.findings.push("W-obj-statement", Severity::Warning, place, message);
                Ok(())
            }
        }
    }
}

/// Fills up with corners that name nothing.
fn pad(values: &mut Growing<u32>, memory: &mut Memory<'_>, to: usize) -> Result<(), OverBudget> {
    while values.len() < to {
        values.push(memory, NONE)?;
    }
    Ok(())
}

#[cold]
fn number_fault(at: &Scanner<'_>, fault: NumberFault, what: &str) -> ReadError {
    if fault == NumberFault::Syntax {
        return Fault::new("E-obj-number", at.place(), at.found(), fault.to_string()).within(what).into();
    }
    let fault = Fault::new("E-obj-finite", at.place(), at.found(), fault.to_string());
    fault.within(what).advice(DROP_ADVICE).into()
}

#[cold]
fn corner_fault(at: &Scanner<'_>) -> ReadError {
    let found = at.found();
    Fault::new("E-obj-number", at.place(), found, "indices as v, v/vt, v//vn or v/vt/vn").into()
}

fn plural(count: usize, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}
