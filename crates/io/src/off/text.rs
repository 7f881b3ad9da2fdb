//! Text OFF.

use std::ops::Range;

use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Findings, Place, Severity};

use super::body::{Body, Layout};
use super::counts::{Counts, counts, dimension};
use super::header::{Header, header};
use super::rows::{Reader, Rows, lines_with_words, words_left};
use crate::memory::Memory;
use crate::text::{Scanner, end_place, in_lines, line_place, never_joined, pieces, plain_text, rows_before};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let text = plain_text(input, &context.limits)?;
    if text.trim_ascii().is_empty() {
        let place = if text.is_empty() { Place::Byte(0) } else { end_place(text) };
        return Err(Fault::new("E-off-truncated", place, "an empty file", "a keyword and counts").into());
    }
    let cut = |from: usize| pieces(text, from, &context.exec, never_joined);
    read_text(text, context, cut).map_err(|error| match error {
        ReadError::Input(fault) => in_lines(text, fault).into(),
        error => error,
    })
}

/// Reads a text whose rows, from an offset on, are cut into pieces so. The result does not depend on where.
pub(super) fn read_text(
    text: &[u8],
    context: &ReadContext,
    cut: impl Fn(usize) -> Vec<Range<usize>>,
) -> Result<ReadShape, ReadError> {
    let mut findings = Findings::default();
    let mut scan = Scanner::new(text, 0);
    let header = header(&mut scan, &mut findings)?;
    let dimension = dimension(&mut scan, &header, text)?;
    let least = Layout::new(&header, dimension, if header.color { 3 } else { 0 });
    let counts = counts(&mut scan, text, least.numbers(), &context.limits)?;
    let (rows, vertices_joined) = rows(text, &mut scan, &header, dimension, counts, context)?;
    if rows.guessed_color {
        let message = "vertices have the columns of a colour that the keyword does not promise (COFF)";
        findings.push("W-off-columns", Severity::Warning, scan.place(), message);
    }
    let start = scan.offset();
    let cuts = if vertices_joined { Vec::new() } else { cut(start) };
    let read = if cuts.len() > 1 { in_pieces(&rows, &cuts)? } else { None };
    let (mut body, mut memory, faces_joined) = match read {
        Some((body, memory)) => (body, memory, false),
        None => {
            let mut reader = Reader::new(&rows, scan, 0);
            reader.vertices_joined = vertices_joined;
            reader.run()?;
            (reader.body, reader.memory, reader.faces_joined == Some(true))
        }
    };
    ends_early(&body, &counts, text)?;
    findings.extend(std::mem::take(&mut body.findings));
    body.findings = findings;
    let place = |face: usize| match vertices_joined || faces_joined {
        true => Place::element("face", face as u64),
        false => place_of_row(text, start, counts.vertices + face as u64),
    };
    let found = body.into_shape(&rows.layout, &mut memory, context, place)?;
    let findings = found.findings.with_places(|place| line_place(text, place));
    Ok(ReadShape { findings, ..found })
}

/// What rows look like, from the first vertex, and whether vertices lie several on a line: that is so where there are
/// fewer lines than rows. Goes to the first row.
fn rows<'a>(
    text: &'a [u8],
    scan: &mut Scanner<'_>,
    header: &Header,
    dimension: usize,
    counts: Counts,
    context: &'a ReadContext,
) -> Result<(Rows<'a>, bool), Box<Fault>> {
    let wanted = counts.vertices + counts.faces;
    let few_lines = |from: usize| lines_with_words(text, from, wanted) < wanted;
    let mut joined = false;
    if scan.at_line_end_or_comment() {
        scan.next_line();
    } else {
        let mut next = scan.clone();
        next.next_line();
        joined = few_lines(next.offset());
        if !joined {
            let found = format!("{} more numbers", words_left(scan));
            let expected = "the numbers of vertices, faces and edges alone";
            return Err(Fault::new("E-off-row", scan.place(), found, expected));
        }
    }
    let mut first = scan.clone();
    first.skip_empty_lines();
    let found = words_left(&first);
    let base = Layout::new(header, dimension, 0).numbers();
    let own_lines = |least: usize| !joined && (found <= least || !few_lines(scan.offset()));
    let mut guessed_color = false;
    let color = if header.color {
        joined |= !own_lines(base + 4);
        match (found % (base + 3), found % (base + 4)) {
            _ if !joined => 3 + usize::from(found == base + 4),
            (0, 0) => {
                let place = first.place();
                let fault = Fault::new("E-off-row", place, format!("{found} numbers"), "one vertex a line");
                return Err(fault.advice("colours may have three channels or four: write each vertex on its own line"));
            }
            (_, 0) => 4,
            _ => 3,
        }
    } else {
        joined |= !own_lines(base);
        let plain = base == dimension;
        guessed_color = !joined && plain && (found == base + 3 || found == base + 4);
        if guessed_color { found - base } else { 0 }
    };
    let layout = Layout::new(header, dimension, color);
    Ok((Rows { text, layout, guessed_color, counts, context }, joined && counts.vertices > 0))
}

/// Reads pieces at the same time, if every row has a line of its own.
fn in_pieces<'a>(rows: &'a Rows<'a>, cuts: &[Range<usize>]) -> Result<Option<(Body, Memory<'a>)>, ReadError> {
    let (text, exec) = (rows.text, &rows.context.exec);
    let counted = rows_before(exec, cuts, |piece| lines_with_words(&text[..piece.end], piece.start, u64::MAX))?;
    let wanted = rows.counts.vertices + rows.counts.faces;
    let all = counted.last().map_or(0, |(before, count)| before + count);
    if all < wanted {
        return Ok(None);
    }
    let read = map_chunks(exec, cuts.len(), 1, |range| {
        let (piece, first) = (&cuts[range.start], counted[range.start].0);
        let mut reader = Reader::new(rows, Scanner::new(&text[..piece.end], piece.start), first);
        reader.faces_joined = Some(false);
        // What follows after the first row too many was told.
        if first <= wanted {
            reader.run()?;
        }
        exec.progress(first as f64 / all.max(1) as f64);
        Ok::<_, ReadError>((reader.body, reader.memory))
    })?;
    let mut memory = Memory::new(exec);
    let mut body = Body::default();
    // What was read stays reserved until it is put together.
    let mut held = Vec::new();
    for (index, (piece, reserved)) in read.into_iter().enumerate() {
        if index == 0 {
            (body, memory) = (piece, reserved);
            body.reserve(&mut memory, &rows.counts, &rows.layout)?;
        } else {
            body.append(&mut memory, piece)?;
            held.push(reserved);
        }
    }
    Ok(Some((body, memory)))
}

fn ends_early(body: &Body, counts: &Counts, text: &[u8]) -> Result<(), Box<Fault>> {
    let (vertices, faces) = (body.positions.len() as u64, (body.faces.len() + body.skipped.len()) as u64);
    let (what, there, promised) = match vertices < counts.vertices {
        true => ("vertices", vertices, counts.vertices),
        false => ("faces", faces, counts.faces),
    };
    if there < promised {
        let found = format!("the end of the file after {there} {what}");
        let fault =
            Fault::new("E-off-truncated", end_place(text), found, format!("{promised}, as the header promises"));
        return Err(fault.advice("get the file again, or correct its counts"));
    }
    Ok(())
}

/// Where a row with a line of its own begins.
fn place_of_row(text: &[u8], start: usize, row: u64) -> Place {
    let mut scan = Scanner::new(text, start);
    for _ in 0..row {
        scan.skip_empty_lines();
        scan.next_line();
    }
    scan.skip_empty_lines();
    scan.place()
}
