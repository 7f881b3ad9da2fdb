//! Reading ESRI ASCII grids.

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Findings, Place, Severity, Words};

use crate::heights::{HOLE_ADVICE, NorthFirst, check_options, check_size, room, shape_of};
use crate::memory::Memory;
use crate::text::{CountFault, NumberFault, Scanner, end_place, in_lines, line_place, plain_text, quoted};
use crate::{Fault, ReadContext, ReadError, ReadShape};

/// What cells without data have where the header says nothing of it.
const NO_DATA: f64 = -9999.0;

/// The words of a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Key {
    Columns,
    Rows,
    WestCorner,
    WestCenter,
    SouthCorner,
    SouthCenter,
    CellSize,
    Dx,
    Dy,
    NoData,
}

impl Key {
    const ALL: [(Self, &'static str); 10] = [
        (Self::Columns, "ncols"),
        (Self::Rows, "nrows"),
        (Self::WestCorner, "xllcorner"),
        (Self::WestCenter, "xllcenter"),
        (Self::SouthCorner, "yllcorner"),
        (Self::SouthCenter, "yllcenter"),
        (Self::CellSize, "cellsize"),
        (Self::Dx, "dx"),
        (Self::Dy, "dy"),
        (Self::NoData, "nodata_value"),
    ];

    pub(super) fn from_word(word: &[u8]) -> Option<Self> {
        Self::ALL.into_iter().find(|(_, name)| word.eq_ignore_ascii_case(name.as_bytes())).map(|(key, _)| key)
    }
}

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    check_options(&context.options)?;
    let text = plain_text(input, &context.limits)?;
    let mut findings = Findings::default();
    let read = grid(text, context, &mut findings).map_err(|error| match error {
        ReadError::Input(fault) => ReadError::Input(in_lines(text, fault)),
        other => other,
    })?;
    let mut findings = findings.with_places(|place| line_place(text, place));
    let field = read.into_field(context, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape_of(field)) })
}

fn grid(text: &[u8], context: &ReadContext, findings: &mut Findings) -> Result<NorthFirst, ReadError> {
    let mut scan = Scanner::new(text, 0);
    let header = Header::read(&mut scan, text)?;
    let (columns, rows) = (header.count(Key::Columns, text)?, header.count(Key::Rows, text)?);
    let place = Place::Byte(header.offset(Key::Columns));
    let (columns, rows) = check_size(columns, rows, place.clone(), "", text.len(), context)?;
    let spacing = header.spacing(text)?;
    let south_west = DVec2::new(
        header.origin(Key::WestCorner, Key::WestCenter, spacing.x, text)?,
        header.origin(Key::SouthCorner, Key::SouthCenter, spacing.y, text)?,
    );
    let no_data = header.no_data.unwrap_or(NO_DATA);

    let count = columns as usize * rows as usize;
    // A digit and a blank each, but for the last.
    let most = scan.rest().len() / 2 + 1;
    if count > most {
        let found = format!("{columns} × {rows} samples");
        return Err(Fault::new("E-asc-claim", place, found, format!("at most {most}, as many as can follow")).into());
    }
    let mut memory = Memory::new(&context.exec);
    let mut heights = room(count, &mut memory)?;
    let mut unsaid = 0u64;
    while heights.len() < count {
        if heights.len() % 1024 == 0 {
            context.exec.check()?;
            context.exec.progress(heights.len() as f64 / count as f64);
        }
        if scan.at_line_end() {
            if scan.next_line() {
                continue;
            }
            let found = format!("the end of the file after {} samples", heights.len());
            let expected = format!("{columns} × {rows} = {count} samples, as the header says");
            return Err(Fault::new("E-asc-truncated", end_place(text), found, expected).into());
        }
        let (row, column) = (heights.len() / columns as usize, heights.len() % columns as usize);
        let height = match scan.number() {
            Ok(height) => height,
            Err(fault) => word_height(&mut scan, fault, context, row, column)?,
        };
        let hole = height == no_data;
        unsaid += u64::from(hole && header.no_data.is_none());
        heights.push(if hole { f64::NAN } else { height });
    }
    if unsaid > 0 {
        let message = format!("{} without the word NODATA_value in the header: such samples are holes", Words(NO_DATA));
        findings.push_many("W-asc-nodata", Severity::Warning, Place::Byte(header.end as u64), message, unsaid);
    }
    while scan.at_line_end() && scan.next_line() {}
    if !scan.rest().is_empty() {
        let message = format!("found {} after the last sample; the rest was not read", scan.found());
        findings.push("W-asc-trailing", Severity::Warning, scan.place(), message);
    }
    Ok(NorthFirst { columns, rows, spacing, south_west, heights })
}

/// A height that is no decimal number: a hole for words that mean no number.
fn word_height(
    scan: &mut Scanner<'_>,
    fault: NumberFault,
    context: &ReadContext,
    row: usize,
    column: usize,
) -> Result<f64, Box<Fault>> {
    let (place, found) = (scan.place(), scan.found());
    let word = scan.word();
    let unsigned = word.strip_prefix(b"-").or_else(|| word.strip_prefix(b"+")).unwrap_or(word);
    let infinite = unsigned.eq_ignore_ascii_case(b"inf") || unsigned.eq_ignore_ascii_case(b"infinity");
    if fault == NumberFault::NotFinite && !infinite {
        return Ok(f64::NAN);
    }
    if fault != NumberFault::Syntax && context.options.drop_non_finite {
        return Ok(f64::INFINITY);
    }
    let within = format!("row {row}, column {column}");
    Err(if fault == NumberFault::Syntax {
        Fault::new("E-asc-number", place, found, fault.to_string()).within(within)
    } else {
        Fault::new("E-asc-finite", place, found, fault.to_string()).within(within).advice(HOLE_ADVICE)
    })
}

/// The words of the header with their values.
struct Header {
    values: Vec<(Key, f64, u64)>,
    no_data: Option<f64>,
    end: usize,
}

impl Header {
    fn read(scan: &mut Scanner<'_>, text: &[u8]) -> Result<Self, Box<Fault>> {
        let mut header = Self { values: Vec::new(), no_data: None, end: 0 };
        loop {
            while scan.at_line_end() && scan.next_line() {}
            header.end = scan.offset();
            let mut ahead = scan.clone();
            let word = ahead.word();
            let Some(key) = Key::from_word(word) else {
                // Numbers begin the samples, and so do words for no number.
                let number = !matches!(crate::text::parse_number(word), Err(NumberFault::Syntax));
                if number || word.is_empty() {
                    return Ok(header);
                }
                let names: Vec<&str> = Key::ALL.iter().map(|(_, name)| *name).collect();
                let expected = format!("a number, or a word of the header: {}", names.join(", "));
                return Err(Fault::new("E-asc-header", scan.place(), quoted(word), expected));
            };
            let place = scan.place();
            let offset = scan.offset() as u64;
            *scan = ahead;
            if header.values.iter().any(|(known, ..)| *known == key) {
                let found = format!("{} a second time", quoted(word));
                return Err(Fault::new("E-asc-duplicate", place, found, "each word of the header once"));
            }
            let value_place = scan.place();
            let found = scan.found();
            let value = if matches!(key, Key::Columns | Key::Rows) {
                scan.count().map(|count| count as f64).map_err(|fault| {
                    let expected = if fault == CountFault::Overflow { "a number of 64 bits" } else { "a whole number" };
                    Fault::new("E-asc-count", value_place, found, expected)
                })?
            } else {
                match scan.number() {
                    Ok(value) => value,
                    Err(NumberFault::NotFinite) if key == Key::NoData => {
                        scan.word();
                        f64::NAN
                    }
                    Err(fault) => {
                        let code = if fault == NumberFault::Syntax { "E-asc-number" } else { "E-asc-finite" };
                        return Err(Fault::new(code, value_place, found, fault.to_string()));
                    }
                }
            };
            if key == Key::NoData {
                header.no_data = Some(value);
            }
            header.values.push((key, value, offset));
            if header.values.len() > Key::ALL.len() || scan.offset() >= text.len() {
                header.end = scan.offset();
                return Ok(header);
            }
        }
    }

    fn find(&self, key: Key) -> Option<f64> {
        self.values.iter().find(|(known, ..)| *known == key).map(|(_, value, _)| *value)
    }

    /// Where a word of the header stands; its end where it does not.
    fn offset(&self, key: Key) -> u64 {
        self.values.iter().find(|(known, ..)| *known == key).map_or(self.end as u64, |(.., offset)| *offset)
    }

    fn missing(&self, what: &str, text: &[u8]) -> Box<Fault> {
        let place = if self.end >= text.len() { end_place(text) } else { Place::Byte(self.end as u64) };
        if text.iter().all(u8::is_ascii_whitespace) {
            let fault = Fault::new("E-asc-header", place, "an empty file", format!("a header, first of all {what}"));
            return fault.advice("get a complete copy of the file: this one has nothing in it");
        }
        let found = if self.end >= text.len() { "the end of the file" } else { "the end of the header" };
        Fault::new("E-asc-header", place, found, what)
            .advice(format!("put {what} with its number into the header, before the samples"))
    }

    fn count(&self, key: Key, text: &[u8]) -> Result<u64, Box<Fault>> {
        let name = if key == Key::Columns { "ncols" } else { "nrows" };
        // Counts beyond 2^53 are rounded, and far beyond every limit.
        self.find(key).map(|count| count as u64).ok_or_else(|| self.missing(&format!("the word {name}"), text))
    }

    fn spacing(&self, text: &[u8]) -> Result<DVec2, Box<Fault>> {
        let (both, dx, dy) = (self.find(Key::CellSize), self.find(Key::Dx), self.find(Key::Dy));
        let (Some(x), Some(y)) = (dx.or(both), dy.or(both)) else {
            return Err(self.missing("the word cellsize, or dx and dy", text));
        };
        if x > 0.0 && y > 0.0 {
            return Ok(DVec2::new(x, y));
        }
        let key = if both.is_some() {
            Key::CellSize
        } else if x > 0.0 {
            Key::Dy
        } else {
            Key::Dx
        };
        let found = Words(if x > 0.0 { y } else { x }).to_string();
        Err(Fault::new("E-asc-cell", Place::Byte(self.offset(key)), found, "a size of cells above 0"))
    }

    /// The place of the first sample along an axis.
    fn origin(&self, corner: Key, center: Key, spacing: f64, text: &[u8]) -> Result<f64, Box<Fault>> {
        match (self.find(center), self.find(corner)) {
            (Some(center), None) => Ok(center),
            (None, Some(corner)) => Ok(corner + spacing / 2.0),
            (Some(_), Some(_)) => {
                let place = Place::Byte(self.offset(corner).max(self.offset(center)));
                Err(Fault::new("E-asc-duplicate", place, "a corner and a centre", "one of them"))
            }
            (None, None) => {
                let axis = if corner == Key::WestCorner { "x" } else { "y" };
                Err(self.missing(&format!("the word {axis}llcorner or {axis}llcenter"), text))
            }
        }
    }
}
