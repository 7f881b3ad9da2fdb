//! The counts after the keyword.

use shapeloom_core::{Category, Limits, Place};

use super::header::Header;
use super::rows::{NumberText, whole};
use crate::Fault;
use crate::text::{CountFault, Scanner, end_place};

/// How many rows of which length there are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Counts {
    pub vertices: u64,
    pub faces: u64,
}

/// The fewest bytes of a number in a text, with what separates it from the next.
const NUMBER: u64 = 2;

/// Reads the number of coordinates, if it is given.
pub(super) fn dimension(scan: &mut Scanner<'_>, header: &Header, text: &[u8]) -> Result<usize, Box<Fault>> {
    if !header.dimensioned {
        return Ok(3);
    }
    scan.skip_empty_lines();
    let place = scan.place();
    let found = scan.found();
    let dimension = count(scan, text, "the number of coordinates")?;
    checked_dimension(dimension, header, place, found)
}

/// Refuses what has no place in space.
pub(super) fn checked_dimension(
    dimension: u64,
    header: &Header,
    place: Place,
    found: String,
) -> Result<usize, Box<Fault>> {
    // With both marks even the order of the coordinates is read in two ways.
    let fits = (1..=3).contains(&dimension) && !header.weight;
    if fits {
        return Ok(dimension as usize);
    }
    let found = if header.weight { "homogeneous coordinates of any number (4nOFF)".to_owned() } else { found };
    let fault = Fault::new("E-off-dimension", place, found, "one to three coordinates");
    Err(fault.category(Category::Unsupported).advice("project the shape to three dimensions with another program"))
}

/// Reads the numbers of vertices, of faces and of edges, of which the last is not used and may be absent.
pub(super) fn counts(
    scan: &mut Scanner<'_>,
    text: &[u8],
    numbers: usize,
    limits: &Limits,
) -> Result<Counts, Box<Fault>> {
    scan.skip_empty_lines();
    let place = scan.place();
    let vertices = count(scan, text, "the number of vertices")?;
    let faces = count(scan, text, "the number of faces")?;
    if !scan.at_line_end_or_comment() {
        let edges = scan.place();
        let found = scan.found();
        if scan.number_text().is_err() {
            return Err(Fault::new("E-off-number", edges, found, "the number of edges"));
        }
    }
    let counts = Counts { vertices, faces };
    let left = (text.len() - scan.offset()) as u64;
    counts.check(numbers as u64 * NUMBER, NUMBER, left + 1, limits, place)?;
    Ok(counts)
}

impl Counts {
    /// Refuses more than as many bytes can hold, and more than the limits allow.
    pub(super) fn check(
        &self,
        vertex_bytes: u64,
        face_bytes: u64,
        left: u64,
        limits: &Limits,
        place: Place,
    ) -> Result<(), Box<Fault>> {
        let least =
            u128::from(self.vertices) * u128::from(vertex_bytes) + u128::from(self.faces) * u128::from(face_bytes);
        let found = format!("{} vertices and {} faces", self.vertices, self.faces);
        if least > u128::from(left) {
            let expected = format!("no more than the {left} bytes that follow can hold");
            let fault = Fault::new("E-off-claim", place, found, expected);
            return Err(fault.advice("the file was cut off, or its counts are wrong"));
        }
        let most = limits.max_elements.min(u64::from(u32::MAX) - 1);
        if self.vertices > most || self.faces > most {
            let fault = Fault::new("E-off-limit", place, found, format!("at most {most} of each"));
            return Err(fault.category(Category::OverLimit));
        }
        Ok(())
    }
}

/// A count of the header.
fn count(scan: &mut Scanner<'_>, text: &[u8], what: &str) -> Result<u64, Box<Fault>> {
    match whole(scan) {
        Ok(count) => Ok(count),
        Err(fault) => Err(no_count(scan, text, what, fault)),
    }
}

#[cold]
fn no_count(scan: &Scanner<'_>, text: &[u8], what: &str, fault: CountFault) -> Box<Fault> {
    let (place, found) = (scan.place(), scan.found());
    let mut ahead = scan.clone();
    match ahead.skip_blanks() {
        None => return Fault::new("E-off-truncated", end_place(text), "the end of the file", what),
        Some(b'\n' | b'\r' | b'#') => {
            let fault = Fault::new("E-off-row", place, "the end of the line", what);
            return fault.advice("the counts of vertices, faces and edges are on one line");
        }
        Some(_) => {}
    }
    let expected = match fault {
        CountFault::Overflow => format!("{what}, a whole number below 2^64"),
        CountFault::Syntax => format!("{what}, a whole number"),
    };
    let word = ahead.word();
    let negative = word.strip_prefix(b"-").is_some_and(|rest| rest.iter().all(u8::is_ascii_digit));
    Fault::new(if negative { "E-off-count" } else { "E-off-number" }, place, found, expected)
}
