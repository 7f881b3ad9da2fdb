//! Text STL.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Category, Findings, Place, Severity};
use shapeloom_mesh::TriMesh;
use shapeloom_shape::{Part, Shape};

use super::binary::too_many;
use super::weld::{BATCH, Welder};
use crate::audit::degenerate_faces;
use crate::memory::{Growing, Memory};
use crate::parts::most_parts;
use crate::text::{NumberFault, Scanner, end_place, in_lines, line_place, lossy, pieces, plain_text};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// How far into a file words are looked for that tell text from binary.
const HEAD: usize = 1 << 13;

fn trimmed(input: &[u8]) -> &[u8] {
    input.strip_prefix(b"\xef\xbb\xbf").unwrap_or(input).trim_ascii_start()
}

fn begins_with(text: &[u8], word: &[u8]) -> bool {
    text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
        && text.get(word.len()).is_none_or(u8::is_ascii_whitespace)
}

/// Whether it begins as text does: with the word solid, or without it with a facet, and no zero byte follows soon.
pub(super) fn begins(input: &[u8]) -> bool {
    let text = trimmed(&input[..input.len().min(HEAD)]);
    (begins_with(text, b"solid") || begins_with(text, b"facet")) && memchr::memchr(0, text).is_none()
}

/// Whether a facet, or the end of a solid, begins a line near the start.
pub(super) fn goes_on(input: &[u8]) -> bool {
    let text = &input[..input.len().min(HEAD)];
    let mut words = text.split(|byte| matches!(byte, b'\n' | b'\r')).map(<[u8]>::trim_ascii_start);
    words.any(|line| begins_with(line, b"facet") || begins_with(line, b"endsolid"))
}

/// Whether a piece of text may not end after its last line: only after the end of a facet the next line does not depend
/// on those before.
pub(super) fn inside_facet(piece: &[u8]) -> bool {
    let start = memchr::memrchr2(b'\n', b'\r', piece).map_or(0, |end| end + 1);
    !piece[start..].trim_ascii().eq_ignore_ascii_case(b"endfacet")
}

/// Facets of one solid, in a row.
#[derive(Default)]
struct Run {
    /// The name, if the solid begins here.
    begins: Option<String>,
    /// Three corners a facet.
    corners: Growing<DVec3>,
    /// Where each facet begins, in bytes.
    facets: Growing<usize>,
}

/// What a piece of text holds.
#[derive(Default)]
struct Read {
    runs: Vec<Run>,
    /// How many solids begin here.
    solids: u64,
    findings: Findings,
}

/// How reading a piece ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    /// Within a solid, after one of its facets: the next piece goes on there.
    Within,
    /// After the end of a solid.
    Between,
    /// Before something that is no STL: all that follows is passed over.
    Stopped,
    /// Before a fault.
    Fault,
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let text = plain_text(input, &context.limits)?;
    let cuts = pieces(text, 0, &context.exec, inside_facet);
    read_pieces(text, &cuts, context).map_err(|error| match error {
        ReadError::Input(fault) => in_lines(text, fault).into(),
        error => error,
    })
}

/// The file in pieces, each of which ends after a facet or with the text.
pub(super) fn read_pieces(text: &[u8], cuts: &[Range<usize>], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let apart = if cuts.len() > 1 { read_apart(text, cuts, context)? } else { None };
    let read = match apart {
        Some(read) => read,
        None => {
            let mut reader = Reader::new(text, 0..text.len(), context);
            reader.run()?;
            vec![(reader.read, reader.memory)]
        }
    };
    let mut findings = Findings::default();
    let (mut runs, mut held) = (Vec::new(), Vec::new());
    for (read, memory) in read {
        runs.extend(read.runs);
        findings.extend(read.findings);
        held.push(memory);
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut runs = runs.into_iter().peekable();
    while let Some(first) = runs.next() {
        let name = first.begins.clone().unwrap_or_default();
        let mut solid = vec![first];
        while let Some(more) = runs.next_if(|run| run.begins.is_none()) {
            solid.push(more);
        }
        parts.push(part(name, &solid, context, &mut findings)?);
    }
    if parts.iter().all(|part| part.geometry.memory_bytes() == 0) {
        findings.push("W-stl-empty", Severity::Warning, Place::Byte(0), "the file has no facets");
    }
    let shape = Shape { parts, ..Shape::default() };
    Ok(ReadShape { findings: findings.with_places(|place| line_place(text, place)), ..ReadShape::new(shape) })
}

/// Reads pieces at the same time, each as if a facet had ended before it and its solid had not. None where that is not
/// so: then only reading in a row tells what the text says.
fn read_apart<'a>(
    text: &'a [u8],
    cuts: &[Range<usize>],
    context: &'a ReadContext,
) -> Result<Option<Vec<(Read, Memory<'a>)>>, ReadError> {
    let read = map_chunks(&context.exec, cuts.len(), 1, |range| {
        let mut reader = Reader::new(text, cuts[range.start].clone(), context);
        if range.start > 0 {
            reader.open = true;
            reader.read.runs.push(Run::default());
        }
        // A fault counts only if the pieces before it do not say that nothing is read from here on.
        let end = match reader.run() {
            Err(ReadError::Input(_)) => End::Fault,
            end => end?,
        };
        Ok::<_, ReadError>((reader.read, reader.memory, end))
    })?;
    let mut found = Vec::new();
    let (mut solids, last) = (0, read.len() - 1);
    for (index, (read, memory, end)) in read.into_iter().enumerate() {
        solids += read.solids;
        found.push((read, memory));
        match end {
            End::Stopped => break,
            End::Within => {}
            End::Between if index == last => {}
            End::Between | End::Fault => return Ok(None),
        }
    }
    Ok((solids <= most_solids(text, context)).then_some(found))
}

fn most_solids(text: &[u8], context: &ReadContext) -> u64 {
    context.limits.max_elements.min(most_parts(text.len()) as u64)
}

/// A solid as a part.
fn part(name: String, runs: &[Run], context: &ReadContext, findings: &mut Findings) -> Result<Part, ReadError> {
    let exec = &context.exec;
    let memory = &mut Memory::new(exec);
    let count: usize = runs.iter().map(|run| run.facets.len()).sum();
    let most = context.limits.max_elements.min(u64::from(u32::MAX / 3) - 1);
    if count as u64 > most {
        let fault = Fault::new("E-stl-limit", Place::Whole, format!("{count} facets"), format!("at most {most}"));
        return Err(fault.category(Category::OverLimit).into());
    }
    let corners = runs.iter().flat_map(|run| run.corners.as_slice().chunks(BATCH));
    let mesh = if context.options.weld {
        let mut welder = Welder::new(memory, count)?;
        let mut triangles = Growing::with_room(memory, count)?;
        let mut numbers = [0u32; BATCH];
        for (index, points) in corners.enumerate() {
            if index % 64 == 0 {
                exec.check()?;
            }
            let numbers = &mut numbers[..points.len()];
            welder.number(memory, points, numbers)?;
            triangles.extend(memory, numbers.as_chunks::<3>().0)?;
        }
        TriMesh::try_new(welder.into_positions(), triangles.into_vec())
    } else {
        let mut positions = Growing::with_room(memory, count * 3)?;
        for points in corners {
            positions.extend(memory, points)?;
        }
        memory.take(count, size_of::<[u32; 3]>())?;
        let triangles = (0..count as u32).map(|facet| [3 * facet, 3 * facet + 1, 3 * facet + 2]).collect();
        TriMesh::try_new(positions.into_vec(), triangles)
    };
    let geometry = mesh.map_err(|error| too_many(error.to_string()))?.into();
    let place = |facet: usize| {
        let mut before = 0;
        let found = runs.iter().find_map(|run| {
            let at = run.facets.as_slice().get(facet - before).copied();
            before += run.facets.len();
            at
        });
        found.map_or(Place::Whole, |at| Place::Byte(at as u64))
    };
    degenerate_faces(&geometry, "W-stl-degenerate", exec, findings, place)?;
    Ok(Part::new(geometry).named(name))
}

struct Reader<'a> {
    scan: Scanner<'a>,
    /// The whole text, for the line after its last.
    text: &'a [u8],
    context: &'a ReadContext,
    memory: Memory<'a>,
    /// Whether a solid has begun and not ended.
    open: bool,
    read: Read,
}

impl<'a> Reader<'a> {
    fn new(text: &'a [u8], piece: Range<usize>, context: &'a ReadContext) -> Self {
        let scan = Scanner::new(&text[..piece.end], piece.start);
        Self { scan, text, context, memory: Memory::new(&context.exec), open: false, read: Read::default() }
    }

    fn run(&mut self) -> Result<End, ReadError> {
        let mut polled = 0;
        while self.next_word() {
            let at = self.scan.offset();
            if self.take(b"facet") {
                if !self.open && !self.read.runs.is_empty() {
                    return Err(self.expected_at(at, "the word solid"));
                }
                if !self.open {
                    self.begin(at, None)?;
                }
                self.facet(at)?;
                polled += 1;
                if polled % 4096 == 0 {
                    self.context.exec.check()?;
                }
            } else if self.take(b"endsolid") {
                if !self.open {
                    self.note("W-stl-end", at, "an end of a solid without its start was passed over");
                }
                self.open = false;
                self.scan.next_line();
            } else if self.take(b"solid") {
                let place = Place::Byte(at as u64);
                let name = lossy(self.scan.rest_of_line(), place, &mut self.read.findings).into_owned();
                self.begin(at, Some(name))?;
                self.scan.next_line();
            } else if self.open {
                return Err(self.expected_at(at, "facet or endsolid"));
            } else {
                self.note("W-stl-trailing", at, "what follows after the last solid was not read");
                return Ok(End::Stopped);
            }
        }
        if self.open && self.scan.offset() >= self.text.len() {
            self.note(
                "W-stl-open",
                self.text.len(),
                "the last solid does not end with endsolid; the file may be cut off",
            );
        }
        Ok(if self.open { End::Within } else { End::Between })
    }

    fn begin(&mut self, at: usize, name: Option<String>) -> Result<(), ReadError> {
        if self.open {
            self.note("W-stl-nested", at, "a solid begins before the one before it has ended");
            // A solid of no bytes but its first line would take more memory than the file has bytes by far.
            if let Some(run) = self.read.runs.last_mut().filter(|run| run.facets.is_empty() && run.begins.is_some()) {
                run.begins = name;
                return Ok(());
            }
        } else if name.is_none() {
            self.note("W-stl-solid", at, "facets without the word solid before them");
        }
        let most = most_solids(self.text, self.context);
        if self.read.solids >= most {
            let expected = format!("at most {most} solids in a file of this length");
            let fault = Fault::new("E-stl-limit", Place::Byte(at as u64), "another solid", expected);
            return Err(fault.category(Category::OverLimit).into());
        }
        self.read.solids += 1;
        let name = name.unwrap_or_default();
        self.memory.take(1, size_of::<Run>() + size_of::<Part>() + 512 + name.len())?;
        self.read.runs.push(Run { begins: Some(name), ..Run::default() });
        self.open = true;
        Ok(())
    }

    /// What follows after the word facet at that offset.
    fn facet(&mut self, at: usize) -> Result<(), ReadError> {
        self.word(b"normal")?;
        let mut odd = false;
        for _ in 0..3 {
            // A normal may be missing; corners say it anyway.
            if !self.next_word() || begins_with(self.scan.rest(), b"outer") {
                odd = true;
                break;
            }
            if self.scan.number().is_err() {
                self.scan.word();
                odd = true;
            }
        }
        if odd {
            self.note("W-stl-normal", at, ODD_NORMAL);
        }
        self.word(b"outer")?;
        self.word(b"loop")?;
        let mut corners = [DVec3::ZERO; 3];
        for corner in &mut corners {
            self.word(b"vertex")?;
            *corner = self.position()?;
        }
        self.word(b"endloop")?;
        self.word(b"endfacet")?;
        let memory = &mut self.memory;
        if let Some(run) = self.read.runs.last_mut() {
            run.corners.extend(memory, &corners)?;
            run.facets.push(memory, at)?;
        }
        Ok(())
    }

    fn position(&mut self) -> Result<DVec3, ReadError> {
        let mut numbers = [0.0; 3];
        for value in &mut numbers {
            if !self.next_word() {
                return Err(self.ends_early("a coordinate"));
            }
            *value = match self.scan.number() {
                Ok(value) => value,
                Err(fault) => self.no_number(fault)?,
            };
        }
        Ok(DVec3::from_array(numbers))
    }

    #[cold]
    fn no_number(&mut self, fault: NumberFault) -> Result<f64, ReadError> {
        let place = self.scan.place();
        let found = self.scan.found();
        let word = self.scan.word();
        if fault == NumberFault::Syntax {
            let error = Fault::new("E-stl-number", place, found, "a coordinate");
            return Err(match word.contains(&b',') {
                true => error.advice("numbers have a decimal point, not a comma").into(),
                false => error.into(),
            });
        }
        if self.context.options.drop_non_finite {
            return Ok(f64::NAN);
        }
        let error = Fault::new("E-stl-finite", place, found, "a finite number of at most 1.8e308");
        Err(error.advice(crate::audit::DROP_ADVICE).into())
    }

    /// Goes to the next word; false at the end of the piece.
    #[inline]
    fn next_word(&mut self) -> bool {
        loop {
            match self.scan.skip_blanks() {
                None => return false,
                Some(b'\n' | b'\r') => self.scan.advance(1),
                Some(_) => return true,
            }
        }
    }

    /// Passes over a word in capitals or not, if it stands here.
    #[inline]
    fn take(&mut self, word: &[u8]) -> bool {
        let found = begins_with(self.scan.rest(), word);
        if found {
            self.scan.advance(word.len());
        }
        found
    }

    /// The same, after white space; anything else is an error.
    #[inline]
    fn word(&mut self, word: &'static [u8]) -> Result<(), ReadError> {
        let there = self.next_word();
        if there && self.take(word) {
            return Ok(());
        }
        let word = std::str::from_utf8(word).unwrap_or_default();
        Err(if there { self.expected_at(self.scan.offset(), word) } else { self.ends_early(word) })
    }

    #[cold]
    fn expected_at(&self, at: usize, expected: &str) -> ReadError {
        let scan = Scanner::new(self.text, at);
        let fault = Fault::new("E-stl-row", scan.place(), scan.found(), expected);
        match expected {
            "endloop" => fault.advice("facets are triangles: cut polygons into triangles before writing STL").into(),
            _ => fault.into(),
        }
    }

    #[cold]
    fn ends_early(&self, expected: &str) -> ReadError {
        let fault = Fault::new("E-stl-truncated", end_place(self.text), "the end of the file", expected);
        fault.advice("get the file again").into()
    }

    #[cold]
    fn note(&mut self, code: &'static str, at: usize, message: &str) {
        self.read.findings.push(code, Severity::Warning, Place::Byte(at as u64), message);
    }
}

const ODD_NORMAL: &str = "the stored normal of a facet is not three finite numbers; normals follow from the corners";
