//! Bodies in text: a line for each row.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Exec, Place};
use shapeloom_mesh::Values;

use super::header::{Element, Header, short};
use super::plan::{Plan, Role};
use super::rows::{Rows, check_list_values, drop_last, finite_fault, index_fault, polygon_fault};
use super::types::{NO_INDEX, Type, with_values};
use crate::memory::{Memory, make_room};
use crate::text::{CountFault, NumberFault, Scanner, is_blank, never_joined, pieces};
use crate::{Fault, ReadContext, ReadError};

/// Reads the rows of all elements. Also returns where text begins behind the last row, if there is any. Places are
/// offsets into the text.
///
/// # Errors
/// Lines of the wrong number of values; values that do not fit their type; lines that are missing; indices of faces that
/// no vertex has; positions that are not finite, unless they are to be dropped later.
pub(super) fn read_rows(
    text: &[u8],
    header: &Header,
    plans: &[Plan],
    context: &ReadContext,
    memory: &mut Memory<'_>,
) -> Result<(Vec<Rows>, Option<usize>), ReadError> {
    let pieces = pieces(text, header.body, &context.exec, never_joined);
    let (mut all, rest) = read_pieces(text, &pieces, header, plans, context, memory)?;
    for (rows, plan) in all.iter_mut().zip(plans) {
        for (group, values) in plan.columns.iter().zip(&mut rows.columns) {
            if !group.properties.is_sorted() {
                with_values!(values, vector => reorder(vector, &group.properties), ());
            }
        }
    }
    Ok((all, rest))
}

/// Puts components, which stand in the order of the file, into the order of their column.
fn reorder<T: Copy>(values: &mut [T], properties: &[usize]) {
    let mut in_file: Vec<usize> = (0..properties.len()).collect();
    in_file.sort_by_key(|&component| properties.get(component));
    for element in values.chunks_exact_mut(properties.len().max(1)) {
        let before: Vec<T> = element.to_vec();
        for (&component, &value) in in_file.iter().zip(&before) {
            if let Some(place) = element.get_mut(component) {
                *place = value;
            }
        }
    }
}

fn read_pieces(
    text: &[u8],
    pieces: &[Range<usize>],
    header: &Header,
    plans: &[Plan],
    context: &ReadContext,
    memory: &mut Memory<'_>,
) -> Result<(Vec<Rows>, Option<usize>), ReadError> {
    let reader = Reader::new(text, header, plans, context);
    let total = reader.elements.iter().map(|element| element.lines()).sum::<u64>();
    if let [] | [_] = pieces {
        let piece = pieces.first().cloned().unwrap_or(text.len()..text.len());
        let (rows, done, rest) = reader.piece(piece, 0, u64::MAX, &context.exec, memory)?;
        return if done < total { Err(reader.missing(done).into()) } else { Ok((rows, rest)) };
    }
    // Each piece has to know which row its first line is.
    let exec = &context.exec;
    let lines = map_chunks(exec, pieces.len(), 1, |range| {
        Ok::<u64, ReadError>(pieces.get(range).unwrap_or(&[]).iter().map(|piece| filled_lines(text, piece)).sum())
    })?;
    let firsts: Vec<u64> = lines
        .iter()
        .scan(0, |sum, &count| {
            let first = *sum;
            *sum += count;
            Some(first)
        })
        .collect();
    let parts = map_chunks(exec, pieces.len(), 1, |range| {
        let mut memory = Memory::new(exec);
        let index = range.start;
        let (Some(piece), Some(&first), Some(&count)) = (pieces.get(index), firsts.get(index), lines.get(index)) else {
            return Ok::<_, ReadError>(None);
        };
        let part = reader.piece(piece.clone(), first, count, exec, &mut memory)?;
        exec.progress((index + 1) as f64 / pieces.len() as f64);
        Ok(Some((part, memory)))
    })?;
    let mut all: Option<Vec<Rows>> = None;
    let mut rest = None;
    // What the first piece has reserved stays so as long as its vectors live.
    let mut held = Vec::new();
    for ((rows, _, more), piece_memory) in parts.into_iter().flatten() {
        rest = rest.or(more);
        match &mut all {
            None => {
                all = Some(rows);
                held.push(piece_memory);
            }
            Some(all) => {
                all.iter_mut().zip(rows).try_for_each(|(rows, more)| rows.append(more, memory))?;
            }
        }
    }
    let found: u64 = lines.iter().sum();
    match all {
        Some(all) if found >= total => Ok((all, rest)),
        _ => Err(reader.missing(found).into()),
    }
}

/// How many lines of a piece have something on them.
fn filled_lines(text: &[u8], piece: &Range<usize>) -> u64 {
    let text = text.get(..piece.end).unwrap_or(text);
    let mut scan = Scanner::new(text, piece.start);
    let mut lines = 0;
    while skip_blank_lines(&mut scan) {
        lines += 1;
        scan.next_line();
    }
    lines
}

/// Where the line of a row begins.
pub(super) fn row_offset(text: &[u8], header: &Header, element: usize, row: usize) -> usize {
    let before = header.elements.iter().take(element).filter(|element| !element.properties.is_empty());
    let lines = before.map(|element| element.rows as u64).sum::<u64>() + row as u64;
    let mut scan = Scanner::new(text, header.body);
    for _ in 0..lines {
        skip_blank_lines(&mut scan);
        scan.next_line();
    }
    skip_blank_lines(&mut scan);
    scan.offset()
}

/// Passes over lines with nothing on them, and returns whether something is left.
#[inline]
fn skip_blank_lines(scan: &mut Scanner<'_>) -> bool {
    loop {
        match scan.peek() {
            None => return false,
            Some(b'\n' | b'\r') => {
                scan.next_line();
            }
            Some(byte) if is_blank(byte) => {
                scan.skip_blanks();
            }
            Some(_) => return true,
        }
    }
}

/// What becomes of the next number or list of a row.
#[derive(Clone, Copy)]
enum Slot {
    Axis { axis: usize, kind: Type },
    Column(usize),
    List(usize),
    Corners,
}

struct ElementReader<'a> {
    element: &'a Element,
    plan: &'a Plan,
    slots: Vec<Slot>,
}

impl ElementReader<'_> {
    /// How many lines the rows take.
    fn lines(&self) -> u64 {
        if self.slots.is_empty() { 0 } else { self.element.rows as u64 }
    }
}

struct Reader<'a> {
    text: &'a [u8],
    elements: Vec<ElementReader<'a>>,
    vertices: usize,
    context: &'a ReadContext,
}

impl<'a> Reader<'a> {
    fn new(text: &'a [u8], header: &'a Header, plans: &'a [Plan], context: &'a ReadContext) -> Self {
        let elements = header.elements.iter().zip(plans).map(|(element, plan)| {
            let slots = element.properties.iter().enumerate().map(|(at, property)| {
                let axis = plan.axes.and_then(|axes| axes.iter().position(|&axis| axis == at));
                let list = plan.lists.iter().position(|&list| list == at);
                let column = plan.columns.iter().position(|group| group.properties.contains(&at));
                match (axis, list, column) {
                    (Some(axis), ..) => Slot::Axis { axis, kind: property.kind },
                    (_, Some(list), _) => Slot::List(list),
                    (_, _, Some(column)) => Slot::Column(column),
                    _ => Slot::Corners,
                }
            });
            ElementReader { element, plan, slots: slots.collect() }
        });
        let vertices = header.elements.iter().find(|element| element.name == "vertex").map_or(0, |found| found.rows);
        Self { text, elements: elements.collect(), vertices, context }
    }

    /// What a text says that has fewer lines than its header promises.
    fn missing(&self, found: u64) -> Box<Fault> {
        let mut before = 0;
        let element = self.elements.iter().find(|element| {
            before += element.lines();
            before > found
        });
        let (name, rows, line) = element
            .map_or(("rows", 0, 0), |found| (found.element.name.as_str(), found.element.rows, found.element.line));
        let row = found + rows as u64 - before.min(found + rows as u64);
        let expected = format!("{rows} rows of \"{}\", as line {line} promises", short(name));
        Fault::new("E-ply-truncated", Place::Byte(self.text.len() as u64), "the end of the file", expected)
            .within(format!("{} {row}", short(name)))
            .advice("the file was cut off, or its header is wrong")
    }

    /// Reads the rows of a piece of the text, of which the first line is the row of that number, and of which at most
    /// `lines` have something on them. Returns the rows, how many rows there were up to here, and where text is left.
    fn piece(
        &self,
        piece: Range<usize>,
        first: u64,
        lines: u64,
        exec: &Exec,
        memory: &mut Memory<'_>,
    ) -> Result<(Vec<Rows>, u64, Option<usize>), ReadError> {
        let text = self.text.get(..piece.end).unwrap_or(self.text);
        let mut scan = Scanner::new(text, piece.start);
        let end = first.saturating_add(lines);
        let (mut line, mut before) = (first, 0);
        let mut all = Vec::with_capacity(self.elements.len());
        for reader in &self.elements {
            let after = before + reader.lines();
            let mut rows = if after > before {
                let count = after.min(end).saturating_sub(line.max(before).min(after));
                Rows::with_room(reader.element, reader.plan, count as usize, memory)?
            } else {
                let mut rows = Rows::with_room(reader.element, reader.plan, 0, memory)?;
                // Rows of no lines are counted once.
                rows.len = if first == 0 { reader.element.rows } else { 0 };
                rows
            };
            while (before..after).contains(&line) && skip_blank_lines(&mut scan) {
                if line.is_multiple_of(4096) {
                    exec.check()?;
                    if lines == u64::MAX {
                        exec.progress(scan.offset() as f64 / text.len().max(1) as f64);
                    }
                }
                self.row(reader, &mut scan, (line - before) as usize, &mut rows, memory)?;
                line += 1;
            }
            before = after;
            all.push(rows);
        }
        let rest = (line >= before && skip_blank_lines(&mut scan)).then(|| scan.offset());
        Ok((all, line, rest))
    }

    #[inline]
    fn row(
        &self,
        reader: &ElementReader<'_>,
        scan: &mut Scanner<'_>,
        row: usize,
        rows: &mut Rows,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let start = scan.offset();
        let mut point = [0.0; 3];
        let mut skip = false;
        for (number, &slot) in reader.slots.iter().enumerate() {
            if scan.at_line_end() {
                return Err(few_values(reader, start, row, number).into());
            }
            match slot {
                Slot::Axis { axis, kind } => {
                    if let Some(value) = point.get_mut(axis) {
                        *value = coordinate(scan, kind)?;
                    }
                }
                Slot::Column(column) => {
                    if let Some(values) = rows.columns.get_mut(column) {
                        with_values!(values, vector => vector.push(Parse::parse(scan)?), ());
                    }
                }
                Slot::List(list) => {
                    let count = self.length(reader, scan, start, row, number)?;
                    let Some(list) = rows.lists.get_mut(list) else { continue };
                    let end = list.values.len() as u64 + count as u64;
                    check_list_values(end)?;
                    with_values!(&mut list.values, vector => {
                        make_room(memory, vector, count)?;
                        for _ in 0..count {
                            if scan.at_line_end() {
                                return Err(few_values(reader, start, row, number).into());
                            }
                            vector.push(Parse::parse(scan)?);
                        }
                    }, ());
                    list.ends.push(end as u32);
                }
                Slot::Corners => skip = !self.face(reader, scan, (start, row, number), rows, memory)?,
            }
        }
        if !scan.at_line_end() {
            let expected = format!("the end of the line after {} values", reader.slots.len());
            return Err(Fault::new("E-ply-row", scan.place(), scan.found(), expected)
                .within(format!("{} {row}", short(&reader.element.name)))
                .advice("each row has a line of its own, with a value for each property of the header")
                .into());
        }
        scan.next_line();
        if skip {
            for (group, values) in reader.plan.columns.iter().zip(&mut rows.columns) {
                drop_last(values, group.properties.len());
            }
            for list in &mut rows.lists {
                list.ends.pop();
                let end = list.ends.last().map_or(0, |&end| end as usize);
                let more = list.values.len() - end;
                drop_last(&mut list.values, more);
            }
            make_room(memory, &mut rows.skipped, 1)?;
            rows.skipped.push(row as u32);
            return Ok(());
        }
        rows.len += 1;
        if reader.plan.role == Role::Vertex {
            let point = DVec3::from_array(point);
            if !point.is_finite() && !self.context.options.drop_non_finite {
                let words = self.text.get(start..).unwrap_or(&[]);
                return Err(finite_fault(Place::Byte(start as u64), row, first_not_finite(reader, words, point)).into());
            }
            rows.positions.push(point);
        }
        Ok(())
    }

    /// Reads the corners of a face, and returns whether it has three or more.
    #[inline]
    fn face(
        &self,
        reader: &ElementReader<'_>,
        scan: &mut Scanner<'_>,
        (start, row, number): (usize, usize, usize),
        rows: &mut Rows,
        memory: &mut Memory<'_>,
    ) -> Result<bool, ReadError> {
        let arity = self.length(reader, scan, start, row, number)?;
        let most = self.context.limits.max_polygon;
        if arity as u64 > u64::from(most) {
            return Err(polygon_fault(Place::Byte(start as u64), row, arity as u64, most).into());
        }
        let mut small = [0; 8];
        let mut large = Vec::new();
        let corners = match small.get_mut(..arity) {
            Some(corners) => corners,
            None => {
                // There are twice as many bytes on the line, or more: the length was compared with it.
                large.resize(arity, 0);
                &mut large[..]
            }
        };
        for corner in &mut *corners {
            scan.skip_blanks();
            let at = scan.clone();
            *corner = match scan.count() {
                Ok(index) => u32::try_from(index).unwrap_or(NO_INDEX),
                Err(_) => {
                    if scan.at_line_end() {
                        return Err(few_values(reader, start, row, number).into());
                    }
                    // A sign, a point, or what is no number at all.
                    whole(scan, i64::MIN, i64::MAX)?.try_into().unwrap_or(NO_INDEX)
                }
            };
            if *corner as usize >= self.vertices {
                return Err(index_fault(at.place(), row, at.found(), self.vertices).into());
            }
        }
        if arity < 3 {
            return Ok(false);
        }
        rows.faces.push(memory, corners)?;
        Ok(true)
    }

    /// The length of a list, which the rest of its line has room for.
    #[inline]
    fn length(
        &self,
        reader: &ElementReader<'_>,
        scan: &mut Scanner<'_>,
        start: usize,
        row: usize,
        number: usize,
    ) -> Result<usize, ReadError> {
        let at = scan.clone();
        let count = match scan.count() {
            Ok(count) => count,
            Err(CountFault::Syntax | CountFault::Overflow) => {
                return Err(Fault::new("E-ply-count", at.place(), at.found(), "the length of a list, in digits alone")
                    .within(format!("{} {row}", short(&reader.element.name)))
                    .into());
            }
        };
        // A digit and a blank each; only long lists are compared with the line that they are on.
        let left = scan.rest().len() as u64 / 2;
        if count > left || (count > 255 && count > scan.rest_of_line().len() as u64 / 2 + 1) {
            let fault = few_values(reader, start, row, number);
            return Err(fault.advice(format!("the list says that it has {count} numbers")).into());
        }
        Ok(count as usize)
    }
}

#[cold]
fn few_values(reader: &ElementReader<'_>, start: usize, row: usize, number: usize) -> Box<Fault> {
    let name = reader.element.properties.get(number).map_or("", |property| &property.name);
    let expected = format!("{} values, up to \"{}\" and beyond", reader.slots.len(), short(name));
    Fault::new("E-ply-row", Place::Byte(start as u64), "the end of the line", expected)
        .within(format!("{} {row}", short(&reader.element.name)))
        .advice("each row has a line of its own, with a value for each property of the header")
}

/// The word of the first coordinate that is not finite.
#[cold]
fn first_not_finite(reader: &ElementReader<'_>, words: &[u8], point: DVec3) -> String {
    let mut scan = Scanner::new(words, 0);
    for slot in &reader.slots {
        match slot {
            Slot::Axis { axis, .. } if !point[*axis].is_finite() => return scan.found(),
            // The words of a list cannot be told without its length: the number says enough.
            Slot::List(_) | Slot::Corners => break,
            _ => {
                scan.word();
            }
        }
    }
    point.to_array().into_iter().find(|number| !number.is_finite()).map_or_else(String::new, |found| found.to_string())
}

/// A coordinate as its type holds it; infinite where the type does not reach so far.
#[inline]
fn coordinate(scan: &mut Scanner<'_>, kind: Type) -> Result<f64, Box<Fault>> {
    match kind {
        Type::Float => f32::parse(scan).map(f64::from),
        Type::Double => f64::parse(scan),
        other => {
            let (least, most) = other.bounds().unwrap_or((i64::MIN, i64::MAX));
            whole(scan, least, most).map(|number| number as f64)
        }
    }
}

/// A number that is read from text.
trait Parse: Sized {
    /// The next word as a number. On failure the fault names it.
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>>;
}

impl Parse for f64 {
    #[inline]
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
        scan.number().or_else(|fault| odd_number(scan, fault))
    }
}

impl Parse for f32 {
    #[inline]
    fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
        let before = scan.clone();
        let value = f64::parse(scan)?;
        // The float nearest to the double is that nearest to the text, unless the double is halfway between two floats.
        let halfway = value.to_bits() & 0x1fff_ffff == 0x1000_0000;
        if halfway || (value != 0.0 && value.abs() < f64::from(Self::MIN_POSITIVE)) {
            let word = before.clone().word();
            if let Some(exact) = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()) {
                return Ok(exact);
            }
        }
        Ok(value as Self)
    }
}

macro_rules! parse_whole {
    ($($type:ty),*) => {
        $(impl Parse for $type {
            #[inline]
            fn parse(scan: &mut Scanner<'_>) -> Result<Self, Box<Fault>> {
                let ahead = scan.clone();
                match scan.count() {
                    Ok(count) if count <= Self::MAX as u64 => Ok(count as Self),
                    _ => {
                        *scan = ahead;
                        whole(scan, i64::from(Self::MIN), i64::from(Self::MAX)).map(|number| number as Self)
                    }
                }
            }
        })*
    };
}

parse_whole!(i8, u8, i16, u16, i32, u32);

/// A whole number within bounds. `2.0` is one too.
fn whole(scan: &mut Scanner<'_>, least: i64, most: i64) -> Result<i64, Box<Fault>> {
    scan.skip_blanks();
    let before = scan.clone();
    match scan.number() {
        Ok(number) if number.fract() == 0.0 && number >= least as f64 && number <= most as f64 => Ok(number as i64),
        _ => {
            let expected = match (least, most) {
                (i64::MIN, _) => "a whole number".to_owned(),
                _ => format!("a whole number from {least} to {most}"),
            };
            Err(Fault::new("E-ply-number", before.place(), before.found(), expected))
        }
    }
}

/// Infinity and what is no number, which columns may hold.
#[cold]
fn odd_number(scan: &mut Scanner<'_>, fault: NumberFault) -> Result<f64, Box<Fault>> {
    let before = scan.clone();
    let word = scan.word();
    if fault == NumberFault::NotFinite {
        let lower = word.to_ascii_lowercase();
        let negative = lower.starts_with(b"-");
        let size = if lower.windows(3).any(|part| part == b"inf") { f64::INFINITY } else { f64::NAN };
        return Ok(if negative { -size } else { size });
    }
    if fault == NumberFault::Overflow {
        // A position of this size is refused as one that is not finite, with its line.
        return Ok(if word.starts_with(b"-") { f64::NEG_INFINITY } else { f64::INFINITY });
    }
    Err(Fault::new("E-ply-number", before.place(), before.found(), fault.to_string()))
}
