//! Bodies in text: a line for each row.

use std::ops::Range;

use shapeloom_core::glam::DVec3;
use shapeloom_core::parallel::map_chunks;
use shapeloom_core::{Exec, Place};
use shapeloom_mesh::Values;

use super::header::{Element, Header, short};
use super::plan::{Plan, Role};
use super::rows::{Rows, check_list_values, drop_last, finite_fault, index_fault, polygon_fault};
use super::types::{NO_INDEX, Type, float_index, with_values};
use super::words::{Parse, coordinate, whole};
use crate::memory::{Memory, make_room};
use crate::text::{CountFault, Scanner, is_blank, never_joined, pieces, rows_before};
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
    let counted = rows_before(exec, pieces, |piece| filled_lines(text, piece))?;
    let parts = map_chunks(exec, pieces.len(), 1, |range| {
        let mut memory = Memory::new(exec);
        let index = range.start;
        let (Some(piece), Some(&(first, count))) = (pieces.get(index), counted.get(index)) else {
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
                // Rows without lines are in every piece, and are counted once.
                for ((rows, more), element) in all.iter_mut().zip(rows).zip(&reader.elements) {
                    if !element.slots.is_empty() {
                        rows.append(more, memory)?;
                    }
                }
            }
        }
    }
    let found = counted.last().map_or(0, |(before, count)| before + count);
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

/// The number of a row's line among those that have something on them.
pub(super) fn line_of_row(header: &Header, element: usize, row: usize) -> u64 {
    let before = header.elements.iter().take(element).filter(|element| !element.properties.is_empty());
    before.map(|element| element.rows as u64).sum::<u64>() + row as u64
}

/// Where the line begins that comes so many lines that have something on them after a line.
pub(super) fn line_offset(text: &[u8], from: usize, lines: u64) -> usize {
    let mut scan = Scanner::new(text, from);
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
                rows.len = reader.element.rows;
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
                    float_index(whole(scan)?)
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
        let left = (self.text.len() - scan.offset()) as u64 / 2;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_data::shuffled_lines;
    use shapeloom_core::{Diagnostic, Findings};

    const FILE: &str = "ply\nformat ascii 1.0\nelement none 3\nelement camera 1\nproperty list uchar float l\n\
        property int id\nelement vertex 5\nproperty uchar blue\nproperty float y\nproperty float x\nproperty uchar red\n\
        property double z\nproperty uchar green\nproperty list uchar short near\nelement face 5\nproperty float w\n\
        property list uchar int vertex_index\nproperty list uchar int more\nend_header\n\
        2 0.5 nan 7\n\n1 2 3 4 5e-1 6 0\n  11 12 13 14 15 16 2 -7 8\r\n21 22 23 24 25 26 1 9\n\t \n31 32 33 34 35 36 0\n\
        41 0.1 0.1 44 0.1 46 0\n0.5 3 0 1 2 0\n1.5 2 0 1 1 8\n\n2.5 4 0 1 2 3 2 9 8\n3.5 0 1 1\n4.5 3 4.0 +3 2 0\n\n  \n";

    fn with_pieces(text: &str, pieces: Option<Vec<Range<usize>>>) -> Result<(Vec<Rows>, Option<usize>), ReadError> {
        let context = ReadContext::default();
        let mut memory = Memory::new(&context.exec);
        let header = Header::parse(text.as_bytes(), &context, &mut memory, &mut Findings::default())?;
        let plans: Vec<Plan> = header.elements.iter().map(Plan::new).collect();
        match pieces {
            None => read_rows(text.as_bytes(), &header, &plans, &context, &mut memory),
            Some(pieces) => read_pieces(text.as_bytes(), &pieces, &header, &plans, &context, &mut memory),
        }
    }

    fn line_pieces(text: &str, lines_each: usize) -> Vec<Range<usize>> {
        let mut at = text.find("end_header\n").unwrap() + 11;
        let lines: Vec<&str> = text[at..].split_inclusive('\n').collect();
        let mut pieces = Vec::new();
        for part in lines.chunks(lines_each) {
            let length: usize = part.iter().map(|line| line.len()).sum();
            pieces.push(at..at + length);
            at += length;
        }
        pieces
    }

    #[test]
    fn rows_are_read_as_their_header_says() {
        let (rows, rest) = with_pieces(FILE, None).unwrap();
        assert_eq!((rest, rows[0].len, rows[1].columns[0].clone()), (None, 3, Values::I32(vec![7])));
        let Values::F32(list) = &rows[1].lists[0].values else { panic!("floats") };
        assert!(list[0] == 0.5 && list[1].is_nan());
        assert_eq!(rows[2].positions[0], DVec3::new(3.0, 2.0, 0.5));
        // A float is as near to 0.1 as floats are, a double as doubles.
        assert_eq!(rows[2].positions[4], DVec3::new(f64::from(0.1f32), f64::from(0.1f32), 0.1));
        // Components are put in order: red, green, blue.
        let Values::U8(color) = &rows[2].columns[0] else { panic!("bytes") };
        assert_eq!(color[..6], [4, 6, 1, 14, 16, 11]);
        assert_eq!(
            (&rows[2].lists[0].ends[..], &rows[2].lists[0].values),
            (&[0, 2, 3, 3, 3][..], &Values::I16(vec![-7, 8, 9]))
        );
        // Two faces have too few corners: the rest of their rows goes with them.
        assert_eq!((rows[3].len, rows[3].faces.len(), &rows[3].skipped[..]), (3, 3, &[1, 3][..]));
        assert_eq!(rows[3].faces.face(2), [4, 3, 2]);
        assert_eq!(rows[3].columns[0], Values::F32(vec![0.5, 2.5, 4.5]));
        assert_eq!((&rows[3].lists[0].ends[..], &rows[3].lists[0].values), (&[0, 2, 2][..], &Values::I32(vec![9, 8])));
    }

    #[test]
    fn pieces_do_not_change_what_is_read() {
        let whole = format!("{:?}", with_pieces(FILE, None).unwrap());
        for lines in 1..20 {
            let (mut rows, rest) = with_pieces(FILE, Some(line_pieces(FILE, lines))).unwrap();
            // Components are put in order when all pieces are together.
            let Values::U8(color) = &mut rows[2].columns[0] else { panic!("bytes") };
            reorder(color, &[3, 5, 0]);
            assert_eq!(format!("{:?}", (rows, rest)), whole, "{lines} lines in a piece");
        }
        let fault = |text: &str, lines: Option<usize>| {
            let error = with_pieces(text, lines.map(|lines| line_pieces(text, lines))).unwrap_err();
            let fault = error.fault().unwrap();
            (error.code(), fault.place.clone(), fault.within.clone(), fault.found.clone())
        };
        let short = FILE.rsplit_once("4.5").unwrap().0;
        let long = FILE.replace("3.5 0 1 1", "3.5 0 1 1 1");
        for text in [short, &long, &FILE.replace("2 9 8", "2 9"), &FILE.replace("0 1 2 3", "0 1 2 5")] {
            let alone = fault(text, None);
            for lines in 1..20 {
                assert_eq!(fault(text, Some(lines)), alone);
            }
        }
        let more = FILE.to_owned() + "  x\n";
        for lines in 1..20 {
            let rest = with_pieces(&more, Some(line_pieces(&more, lines))).unwrap().1;
            assert_eq!(rest, Some(more.len() - 2));
        }
    }

    #[test]
    fn shuffled_lines_are_the_same_wherever_they_are_cut() {
        let (head, body) = FILE.split_at(FILE.find("end_header\n").unwrap() + 11);
        let mut read = 0;
        shuffled_lines(body, 4000, |body| {
            let text = format!("{head}{body}");
            let cut =
                |size| with_pieces(&text, Some(crate::text::cut(text.as_bytes(), head.len(), size, never_joined)));
            let whole = cut(usize::MAX);
            read += usize::from(whole.is_ok());
            let whole = format!("{whole:?}");
            for size in [1, 30, 60, 150] {
                assert_eq!(format!("{:?}", cut(size)), whole, "{size}\n{text}");
            }
        });
        assert!((400..3600).contains(&read), "{read}");
    }

    #[test]
    fn values_that_do_not_fit_are_named() {
        let code = |from: &str, to: &str| {
            let error = with_pieces(&FILE.replacen(from, to, 1), None).unwrap_err();
            (error.code(), error.fault().unwrap().found.clone())
        };
        let pair = |code, found: &str| (code, format!("\"{found}\""));
        assert_eq!(code("1 2 3 4", "256 2 3 4"), pair("E-ply-number", "256"));
        assert_eq!(code("1 2 3 4", "-1 2 3 4"), pair("E-ply-number", "-1"));
        assert_eq!(code("1 2 3 4", "1.5 2 3 4"), pair("E-ply-number", "1.5"));
        assert_eq!(code("1 2 3 4", "1 2,0 3 4"), pair("E-ply-number", "2,0"));
        assert_eq!(code("1 2 3 4", "1 inf 3 4"), pair("E-ply-finite", "inf"));
        assert_eq!(code("1 2 3 4", "1 2 -1e39 4"), pair("E-ply-finite", "-1e39"));
        assert_eq!(code("1 2 3 4 5e-1", "1 2 3 4 1e400"), pair("E-ply-finite", "1e400"));
        assert_eq!(code("2 -7 8", "-2 -7 8"), pair("E-ply-count", "-2"));
        assert_eq!(code("2 -7 8", "99999999999999999999 -7 8"), pair("E-ply-count", "99999999999999999999"));
        assert_eq!(code("2 -7 8", "4294967295 -7 8").0, "E-ply-row");
        assert_eq!(code("3 0 1 2 0", "3 0 1 -2 0"), pair("E-ply-index", "-2"));
        assert_eq!(code("3 0 1 2 0", "3 0 1 5 0"), pair("E-ply-index", "5"));
        assert_eq!(code("3 0 1 2 0", "3 0 1 0.5 0"), pair("E-ply-number", "0.5"));
        assert_eq!(code("3 0 1 2 0", "3 0 1 18446744073709551617 0"), pair("E-ply-index", "18446744073709551617"));
        assert_eq!(code("3 0 1 2 0", "3 0").0, "E-ply-row");
        assert_eq!(code("3 0 1 2 0", "3000000 0 1 2 0").0, "E-ply-row");
    }
}
