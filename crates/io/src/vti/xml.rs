//! The elements of a file.

use std::borrow::Cow;

use quick_xml::events::{BytesStart, Event};
use quick_xml::{Reader, XmlVersion};
use shapeloom_core::Place;

use crate::memory::{Memory, make_room};
use crate::text::quoted;
use crate::{Fault, ReadContext, ReadError};

/// An element with its attributes, of those that are looked at.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub(super) name: &'static str,
    attributes: Vec<(String, String)>,
    pub(super) at: u64,
}

impl Element {
    pub(super) fn get(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    pub(super) fn fault(
        &self,
        code: &'static str,
        attribute: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Box<Fault> {
        let within = if attribute.is_empty() { self.name.to_owned() } else { format!("{}, {attribute}", self.name) };
        Fault::new(code, Place::Byte(self.at), found, expected).within(within)
    }

    /// An attribute that must be there.
    pub(super) fn require(&self, name: &str) -> Result<&str, Box<Fault>> {
        self.get(name)
            .ok_or_else(|| self.fault("E-vti-header", "", "no such attribute", format!("the attribute {name}")))
    }

    /// The numbers of an attribute, if it is there.
    pub(super) fn numbers<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, Box<Fault>> {
        let Some(text) = self.get(name) else { return Ok(None) };
        let mut numbers = [0.0; N];
        let mut words = text.split_ascii_whitespace();
        for number in &mut numbers {
            let word = words.next().unwrap_or_default();
            *number = crate::text::parse_number(word.as_bytes()).map_err(|_| {
                self.fault("E-vti-number", name, quoted(text.as_bytes()), format!("{N} finite numbers"))
            })?;
        }
        if words.next().is_some() {
            return Err(self.fault("E-vti-number", name, quoted(text.as_bytes()), format!("{N} numbers")));
        }
        Ok(Some(numbers))
    }
}

/// A `DataArray` with what is inside it.
#[derive(Clone, Debug)]
pub(super) struct Array {
    pub(super) element: Element,
    /// Whether it is of cells.
    pub(super) cells: bool,
    /// The bytes between its tags.
    pub(super) content: (usize, usize),
}

/// What a file has.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) file: Option<Element>,
    pub(super) image: Option<Element>,
    pub(super) pieces: Vec<Element>,
    /// `PointData` and `CellData`.
    pub(super) data: [Option<Element>; 2],
    pub(super) arrays: Vec<Array>,
    pub(super) appended: Option<Element>,
    /// Where appended data begin, after the `_`, and where they end.
    pub(super) appended_bytes: Option<(usize, usize)>,
    /// Whether the file ends before the tags after appended data do.
    pub(super) cut: bool,
}

/// Elements that mean something here.
const KNOWN: [&str; 7] = ["VTKFile", "ImageData", "Piece", "PointData", "CellData", "DataArray", "AppendedData"];

impl Document {
    /// # Errors
    /// No XML up to the appended data, or none of this kind.
    pub(super) fn read(input: &[u8], context: &ReadContext, memory: &mut Memory<'_>) -> Result<Self, ReadError> {
        let mut document = Self::default();
        // What is appended is no XML: the text ends where its tag does.
        let appended = memchr::memmem::find(input, b"<AppendedData");
        let end = match appended {
            Some(at) => {
                let close = memchr::memchr(b'>', &input[at..]).map(|close| at + close + 1);
                close.ok_or_else(|| cut(input, "the end of the tag AppendedData"))?
            }
            None => input.len(),
        };
        let text = std::str::from_utf8(&input[..end]).map_err(|error| {
            Fault::new("E-vti-xml", Place::Byte(error.valid_up_to() as u64), "bytes that are no UTF-8", "XML in UTF-8")
        })?;
        let mut reader = Reader::from_str(text);
        let mut depth = 0u32;
        let mut in_cells = false;
        // The array whose end tag comes next.
        let mut open: Option<(Element, usize)> = None;
        loop {
            context.exec.check()?;
            let at = reader.buffer_position();
            let event = reader.read_event().map_err(|error| {
                let place = Place::Byte(reader.error_position());
                Fault::new("E-vti-xml", place, error.to_string(), "well-formed XML")
            })?;
            let (start, empty) = match event {
                Event::Eof => break,
                Event::Start(start) => {
                    depth += 1;
                    if depth > 64 {
                        let fault = Fault::new(
                            "E-vti-limit",
                            Place::Byte(at),
                            "more than 64 elements",
                            "fewer, one in another",
                        );
                        return Err(fault.category(shapeloom_core::Category::OverLimit).into());
                    }
                    (start, false)
                }
                Event::Empty(start) => (start, true),
                Event::End(end) => {
                    depth = depth.saturating_sub(1);
                    if end.name().as_ref() == "DataArray"
                        && let Some((element, from)) = open.take()
                    {
                        make_room(memory, &mut document.arrays, 1)?;
                        document.arrays.push(Array { element, cells: in_cells, content: (from, at as usize) });
                    }
                    continue;
                }
                _ => continue,
            };
            let Some(element) = element(&start, at, memory)? else { continue };
            match element.name {
                "VTKFile" => document.file = document.file.or(Some(element)),
                "ImageData" => document.image = document.image.or(Some(element)),
                "Piece" => {
                    make_room(memory, &mut document.pieces, 1)?;
                    document.pieces.push(element);
                }
                "PointData" => {
                    in_cells = false;
                    document.data[0] = document.data[0].take().or(Some(element));
                }
                "CellData" => {
                    in_cells = true;
                    document.data[1] = document.data[1].take().or(Some(element));
                }
                "DataArray" => {
                    let from = reader.buffer_position() as usize;
                    if empty {
                        make_room(memory, &mut document.arrays, 1)?;
                        document.arrays.push(Array { element, cells: in_cells, content: (from, from) });
                    } else {
                        open = Some((element, from));
                    }
                }
                _ => {
                    document.appended = Some(element);
                    document.appended_bytes = appended_bytes(input, end);
                    document.cut = !is_closed(&input[end..]);
                    break;
                }
            }
        }
        if open.is_some() || (depth > 0 && document.appended.is_none()) {
            return Err(cut(input, "the end of every element").into());
        }
        Ok(document)
    }
}

/// Where data begin after a tag, behind the mark `_`, and where its end tag is, or the file ends.
fn appended_bytes(input: &[u8], from: usize) -> Option<(usize, usize)> {
    let mark = input[from..].iter().position(|byte| !byte.is_ascii_whitespace())?;
    let start = (input[from + mark] == b'_').then_some(from + mark + 1)?;
    let end = memchr::memmem::rfind(&input[start..], b"</AppendedData").map_or(input.len(), |end| start + end);
    Some((start, end))
}

/// Whether the elements of appended data and of the file end in the bytes after the tag of the former.
fn is_closed(bytes: &[u8]) -> bool {
    let end = |bytes: &'static [u8], within: &[u8]| {
        let at = memchr::memmem::rfind(within, bytes)?;
        memchr::memchr(b'>', &within[at..]).map(|close| at + close + 1)
    };
    end(b"</AppendedData", bytes).and_then(|at| end(b"</VTKFile", &bytes[at..])).is_some()
}

fn cut(input: &[u8], expected: &str) -> Box<Fault> {
    Fault::new("E-vti-truncated", Place::Byte(input.len() as u64), "the end of the file", expected)
}

/// The element of a tag, if it is one that means something.
fn element(start: &BytesStart<'_>, at: u64, memory: &mut Memory<'_>) -> Result<Option<Element>, ReadError> {
    let name = start.name();
    let Some(&name) = KNOWN.iter().find(|known| **known == name.as_ref()) else { return Ok(None) };
    // Attributes and their names, a few bytes each, as strings of their own.
    memory.take(start.len() + 64, 16)?;
    let mut attributes = Vec::new();
    for attribute in start.attributes().with_checks(false) {
        let broken = |error: String| {
            let found = error.trim_end_matches('.').to_owned();
            Fault::new("E-vti-xml", Place::Byte(at), found, "attributes as XML has them").within(name)
        };
        let attribute = attribute.map_err(|error| broken(error.to_string()))?;
        let value: Cow<'_, str> =
            attribute.normalized_value(XmlVersion::Implicit1_0).map_err(|error| broken(error.to_string()))?;
        attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
    }
    Ok(Some(Element { name, attributes, at }))
}
