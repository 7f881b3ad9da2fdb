//! Reading PLY.

use std::cell::Cell;

use shapeloom_core::{Findings, Place, Severity};
use shapeloom_shape::Shape;

use super::build::Builder;
use super::header::{Header, Layout};
use super::plan::{Plan, Role};
use super::{ascii, binary};
use crate::memory::Memory;
use crate::text::{in_lines, line_at, line_place, plain_text};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    let mut memory = Memory::new(&context.exec);
    let mut findings = Findings::default();
    let unmarked = input.strip_prefix(b"\xef\xbb\xbf").unwrap_or(input);
    let header = Header::parse(unmarked, context, &mut memory, &mut findings)?;
    let text = header.layout == Layout::Ascii;
    if text {
        plain_text(input, &context.limits)?;
    }
    let places = Places { bytes: unmarked, mark: (input.len() - unmarked.len()) as u64, text };
    read_body(&places, header, context, &mut memory, findings).map_err(|error| match error {
        ReadError::Input(fault) => ReadError::Input(places.of_fault(fault)),
        other => other,
    })
}

/// What places in the body are called: lines of text, bytes of a binary file.
struct Places<'a> {
    bytes: &'a [u8],
    /// The bytes of the byte order mark before.
    mark: u64,
    text: bool,
}

impl Places<'_> {
    fn of(&self, offset: usize) -> Place {
        match self.text {
            true => line_place(self.bytes, Place::Byte(offset as u64)),
            false => Place::Byte(self.mark + offset as u64),
        }
    }

    fn of_fault(&self, mut fault: Box<Fault>) -> Box<Fault> {
        match fault.place {
            Place::Byte(_) if self.text => in_lines(self.bytes, fault),
            Place::Byte(offset) => {
                fault.place = Place::Byte(self.mark + offset);
                fault
            }
            _ => fault,
        }
    }
}

/// A line whose place is known.
#[derive(Clone, Copy)]
struct KnownLine {
    /// Its number among the lines of the body that have something on them.
    line: u64,
    offset: usize,
    /// Its number in the file.
    number: u64,
}

fn read_body(
    places: &Places<'_>,
    mut header: Header,
    context: &ReadContext,
    memory: &mut Memory<'_>,
    mut findings: Findings,
) -> Result<ReadShape, ReadError> {
    let bytes = places.bytes;
    header.check_room(bytes.len().saturating_sub(header.body))?;
    let comments = std::mem::take(&mut header.comments);
    let plans: Vec<Plan> = header.elements.iter().map(Plan::new).collect();
    let vertices = vertex_count(&header, &plans)?;
    let mut starts = vec![header.body; plans.len()];
    let (all, rest) = if places.text {
        ascii::read_rows(bytes, &header, &plans, context, memory)?
    } else {
        let mut at = header.body;
        let mut all = Vec::with_capacity(plans.len());
        for ((element, plan), start) in header.elements.iter().zip(&plans).zip(&mut starts) {
            *start = at;
            all.push(binary::read_rows(bytes, &mut at, header.layout, (element, plan), vertices, context, memory)?);
        }
        (all, (at < bytes.len()).then_some(at))
    };
    if let Some(rest) = rest {
        let message = "the file goes on after its last row; the rest was passed over";
        findings.push("W-ply-trailing", Severity::Warning, places.of(rest), message);
    }
    // Rows are asked for in order mostly: lines are counted from the last one on.
    let last: Cell<Option<KnownLine>> = Cell::new(None);
    let place = |index: usize, row: usize| match (header.elements.get(index), starts.get(index)) {
        (Some(element), Some(&start)) if !places.text => {
            places.of(binary::row_offset(bytes, start, header.layout, element, row))
        }
        _ => {
            let line = ascii::line_of_row(&header, index, row);
            let (offset, number) = match last.get().filter(|known| known.line <= line) {
                Some(known) => {
                    let offset = ascii::line_offset(bytes, known.offset, line - known.line);
                    let more = line_at(bytes.get(known.offset..).unwrap_or(&[]), offset - known.offset);
                    (offset, known.number + more - 1)
                }
                None => {
                    let offset = ascii::line_offset(bytes, header.body, line);
                    (offset, line_at(bytes, offset))
                }
            };
            last.set(Some(KnownLine { line, offset, number }));
            Place::line(number)
        }
    };
    let shape = Shape { comments, ..Shape::default() };
    let builder = Builder { vertices, context, memory, place: &place, findings, losses: Vec::new(), shape };
    builder.build(&header.elements, &plans, all)
}

/// How many vertices there are.
///
/// # Errors
/// They have no coordinates.
fn vertex_count(header: &Header, plans: &[Plan]) -> Result<usize, Box<Fault>> {
    let vertices = header.elements.iter().zip(plans).find(|(_, plan)| plan.role == Role::Vertex);
    let Some((element, plan)) = vertices else { return Ok(0) };
    if plan.axes.is_none() {
        let found: Vec<&str> = element.properties.iter().take(10).map(|property| property.name.as_str()).collect();
        let found = if found.is_empty() { "vertices without properties".into() } else { found.join(", ") };
        return Err(Fault::new("E-ply-header", Place::line(element.line), found, "vertices with numbers x, y and z"));
    }
    Ok(element.rows)
}
