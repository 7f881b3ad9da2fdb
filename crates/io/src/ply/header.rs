//! The header: what the file says that its body holds.

use std::collections::HashSet;

use shapeloom_core::{Category, Findings, Place, Severity};

use super::types::Type;
use crate::memory::{Growing, Memory};
use crate::text::{CountFault, lossy, parse_count, quoted};
use crate::{Fault, ReadContext, ReadError};

/// How the numbers of the body are laid down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// What one number or list of each row is.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: String,
    /// The type of the number, or of the numbers of the list.
    pub kind: Type,
    /// The type of the number of numbers, for a list.
    pub count: Option<Type>,
}

/// Rows of the same properties.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: String,
    /// How many rows the header promises. The body has room for them: see [`Header::check_room`].
    pub rows: usize,
    /// The line of the header, counted from 1.
    pub line: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// The property of that name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.properties.iter().position(|property| property.name == name)
    }

    /// The list of one of these names.
    pub fn find_list(&self, names: &[&str]) -> Option<usize> {
        let is_list = |at: &usize| self.properties.get(*at).is_some_and(|property| property.count.is_some());
        names.iter().find_map(|name| self.find(name).filter(is_list))
    }

    /// The fewest bytes that a row takes.
    fn least_bytes(&self, layout: Layout) -> u64 {
        match layout {
            // A digit and what ends it.
            Layout::Ascii => 2 * self.properties.len() as u64,
            _ => self.properties.iter().map(|property| property.count.unwrap_or(property.kind).size() as u64).sum(),
        }
    }
}

/// A header.
#[derive(Debug)]
pub(super) struct Header {
    pub layout: Layout,
    pub elements: Vec<Element>,
    /// Comments in order, those of `obj_info` with that word before them.
    pub comments: Vec<String>,
    /// Where the body begins.
    pub body: usize,
}

/// No writer needs more, and columns are looked up by name one after the other.
const MAX_PROPERTIES: usize = 10_000;

/// The word before comments that were an `obj_info`.
pub(super) const OBJ_INFO: &str = "obj_info ";

impl Header {
    /// The header at the start of a file. Places are lines, or byte 0 of an empty file.
    pub fn parse(
        input: &[u8],
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Self, ReadError> {
        let mut lines = HeaderLines { input, at: 0, number: 0, all_return: true };
        let first = lines.next();
        match first {
            Some(line) if line.trim_ascii_end() == b"ply" => {}
            _ => {
                let place = if input.is_empty() { Place::Byte(0) } else { Place::line(1) };
                let found = first.map_or_else(|| "an empty file".to_owned(), quoted);
                return Err(Fault::new("E-ply-magic", place, found, "\"ply\" alone on the first line")
                    .advice("name the format if the file has another one")
                    .into());
            }
        }
        let mut parser = Parser {
            layout: None,
            elements: Vec::new(),
            comments: Growing::default(),
            element_names: Names::default(),
            property_names: Names::default(),
            properties: 0,
            line: 1,
        };
        loop {
            let Some(line) = lines.next() else {
                return Err(truncated(lines.number.max(1), "the end of the file").into());
            };
            parser.line = lines.number;
            if parser.line.is_multiple_of(4096) {
                context.exec.check()?;
            }
            if line.len() as u64 > context.limits.max_line {
                let most = format!("lines of at most {}", context.limits.max_line);
                return Err(Fault::new("E-text-line", parser.place(), format!("{} bytes", line.len()), most)
                    .category(Category::OverLimit)
                    .into());
            }
            if line.trim_ascii() == b"end_header" {
                let layout = parser.layout.ok_or_else(|| parser.no_format(line))?;
                let (elements, comments) = (parser.elements, parser.comments.into_vec());
                return Ok(Self { layout, elements, comments, body: lines.at });
            }
            // What was cut in the middle of a word is no wrong word.
            if lines.at == input.len() && !input.ends_with(b"\n") && !input.ends_with(b"\r") {
                return Err(truncated(lines.number, &quoted(line)).into());
            }
            parser.line(line, context, memory, findings)?;
        }
    }

    /// Refuses a header that promises more rows than the body has room for, before anything is allocated for them.
    pub fn check_room(&self, body: usize) -> Result<(), Box<Fault>> {
        let mut left = body as u64;
        // The last line of a text need not end.
        if self.layout == Layout::Ascii {
            left = left.saturating_add(1);
        }
        for element in &self.elements {
            let each = element.least_bytes(self.layout);
            let needed = (element.rows as u64).saturating_mul(each);
            if needed > left {
                let found = format!("{} rows of \"{}\"", element.rows, short(&element.name));
                let expected =
                    format!("at most {}: a row takes {each} bytes or more, and {left} are left", left / each.max(1));
                return Err(Fault::new("E-ply-claim", Place::line(element.line), found, expected)
                    .advice("the file was cut off, or its header is wrong"));
            }
            left -= needed;
        }
        Ok(())
    }
}

/// A name for a message.
pub(super) fn short(name: &str) -> String {
    let mut short: String = name.chars().take(40).flat_map(char::escape_debug).collect();
    if name.chars().nth(40).is_some() {
        short.push_str("...");
    }
    short
}

fn truncated(line: u64, found: &str) -> Box<Fault> {
    Fault::new("E-ply-truncated", Place::line(line), found, "more of the header, up to \"end_header\"")
        .advice("the file was cut off: get it again")
}

/// The lines of the header. They end in LF, CRLF or CR, and where all before end in CR alone the last one does too: a
/// feed after it is the first byte of the body.
struct HeaderLines<'a> {
    input: &'a [u8],
    at: usize,
    number: u64,
    all_return: bool,
}

impl<'a> HeaderLines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.input.get(self.at..).filter(|rest| !rest.is_empty())?;
        let end = memchr::memchr2(b'\n', b'\r', rest).unwrap_or(rest.len());
        let (line, after) = rest.split_at(end);
        let last = self.all_return && self.number > 0 && line.trim_ascii() == b"end_header";
        let ending = match after {
            [b'\r', b'\n', ..] if !last => 2,
            [] => 0,
            _ => 1,
        };
        self.all_return &= ending == 1 && after.first() == Some(&b'\r');
        self.at += end + ending;
        self.number += 1;
        Some(line)
    }
}

/// Names of which each is there once.
#[derive(Default)]
struct Names {
    /// As the file has them.
    bytes: HashSet<Vec<u8>>,
    /// As the shape has them.
    texts: HashSet<String>,
}

impl Names {
    /// A name in bytes and as text, in which other bytes may have been replaced; none if it was there before. Two names
    /// that only replacement has made the same are told apart by the line of the second.
    fn new_one(&mut self, bytes: &[u8], text: &str, line: u64) -> Option<String> {
        if !self.bytes.insert(bytes.to_vec()) {
            return None;
        }
        let mut name = text.to_owned();
        while !self.texts.insert(name.clone()) {
            name.push_str(&format!("_line{line}"));
        }
        Some(name)
    }
}

struct Parser {
    layout: Option<Layout>,
    elements: Vec<Element>,
    comments: Growing<String>,
    element_names: Names,
    /// Of the last element.
    property_names: Names,
    properties: usize,
    line: u64,
}

impl Parser {
    fn place(&self) -> Place {
        Place::line(self.line)
    }

    fn fault(&self, code: &'static str, found: &[u8], expected: impl Into<String>) -> Box<Fault> {
        let found = if found.is_empty() { "the end of the line".to_owned() } else { quoted(found) };
        Fault::new(code, self.place(), found, expected)
    }

    fn no_format(&self, line: &[u8]) -> Box<Fault> {
        self.fault("E-ply-format", line, "the line \"format ascii 1.0\", or that of a binary format")
    }

    fn line(
        &mut self,
        line: &[u8],
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<(), ReadError> {
        let (keyword, rest) = first_word(line);
        let mut words = rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let mut word = || words.next().unwrap_or(&[]);
        match keyword {
            // A line of nothing, as some editors leave.
            b"" => return Ok(()),
            b"comment" | b"obj_info" => {
                let text = lossy(rest.get(1..).unwrap_or(&[]), self.place(), findings);
                let text = if keyword == b"comment" { text.into_owned() } else { format!("{OBJ_INFO}{text}") };
                memory.take(text.len(), 1)?;
                return Ok(self.comments.push(memory, text)?);
            }
            b"format" => {
                let (name, version) = (word(), word());
                if self.layout.is_some() {
                    return Err(self.fault("E-ply-duplicate", line, "one format line").into());
                }
                self.layout = Some(match name {
                    b"ascii" => Layout::Ascii,
                    b"binary_little_endian" => Layout::LittleEndian,
                    b"binary_big_endian" => Layout::BigEndian,
                    _ => {
                        let expected = "ascii, binary_little_endian or binary_big_endian";
                        return Err(self.fault("E-ply-format", name, expected).into());
                    }
                });
                if version != b"1.0" {
                    let message = format!("version {} was read as 1.0, the only one there is", quoted(version));
                    findings.push("W-ply-version", Severity::Warning, self.place(), message);
                }
            }
            b"element" => {
                let (name, count) = (word(), word());
                self.element(line, name, count, context, memory, findings)?;
            }
            b"property" => {
                let mut parts = [word(), word(), word(), word()];
                if parts[0] != b"list" {
                    parts[3] = &[];
                }
                self.property(parts, memory, findings)?;
            }
            _ => {
                let expected = "format, comment, obj_info, element, property or end_header";
                return Err(self.fault("E-ply-header", keyword, expected).into());
            }
        }
        match word() {
            b"" => Ok(()),
            more => Err(self.fault("E-ply-header", more, "the end of the line").into()),
        }
    }

    fn element(
        &mut self,
        line: &[u8],
        name: &[u8],
        count: &[u8],
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<(), ReadError> {
        if self.layout.is_none() {
            return Err(self.no_format(line).into());
        }
        if name.is_empty() {
            return Err(self.fault("E-ply-header", name, "the name of an element").into());
        }
        let rows = parse_count(count).map_err(|fault| {
            let expected = match fault {
                CountFault::Syntax => "a number of rows, in digits alone",
                CountFault::Overflow => "a number of rows of at most 64 bits",
            };
            self.fault("E-ply-count", count, expected)
        })?;
        let most = context.limits.max_elements;
        let Some(rows) = usize::try_from(rows).ok().filter(|_| rows <= most) else {
            return Err(self
                .fault("E-ply-limit", count, format!("at most {most} rows of an element"))
                .category(Category::OverLimit)
                .into());
        };
        self.count_one()?;
        memory.take(8 * name.len() + size_of::<Element>() + 128, 1)?;
        let text = lossy(name, self.place(), findings);
        let Some(name) = self.element_names.new_one(name, &text, self.line) else {
            return Err(self.fault("E-ply-duplicate", name, "each element once").into());
        };
        self.property_names = Names::default();
        self.elements.push(Element { name, rows, line: self.line, properties: Vec::new() });
        Ok(())
    }

    fn property(
        &mut self,
        parts: [&[u8]; 4],
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<(), ReadError> {
        self.count_one()?;
        let kind = |word: &[u8]| {
            Type::from_name(word)
                .ok_or_else(|| self.fault("E-ply-type", word, "char, uchar, short, ushort, int, uint, float or double"))
        };
        let (name, kind, count) = match parts {
            [b"list", count, item, name] => {
                let count_type = kind(count)?;
                if count_type.is_floating() {
                    let expected = "a type of whole numbers for the length of a list";
                    return Err(self.fault("E-ply-type", count, expected).into());
                }
                (name, kind(item)?, Some(count_type))
            }
            [word, name, more, _] => {
                let kind = kind(word)?;
                if !more.is_empty() {
                    return Err(self.fault("E-ply-header", more, "the end of the line").into());
                }
                (name, kind, None)
            }
        };
        if name.is_empty() {
            return Err(self.fault("E-ply-header", name, "the name of a property").into());
        }
        if self.elements.is_empty() {
            let expected = "an element before its properties";
            return Err(self.fault("E-ply-header", b"property", expected).into());
        }
        memory.take(8 * name.len() + size_of::<Property>() + 128, 1)?;
        let text = lossy(name, self.place(), findings);
        let Some(name) = self.property_names.new_one(name, &text, self.line) else {
            return Err(self.fault("E-ply-duplicate", name, "each property of an element once").into());
        };
        if let Some(element) = self.elements.last_mut() {
            element.properties.push(Property { name, kind, count });
        }
        Ok(())
    }

    /// Elements and properties are few, whatever the file says.
    fn count_one(&mut self) -> Result<(), Box<Fault>> {
        self.properties += 1;
        if self.properties <= MAX_PROPERTIES {
            return Ok(());
        }
        let expected = format!("at most {MAX_PROPERTIES} elements and properties");
        Err(Fault::new("E-ply-limit", self.place(), "more", expected).category(Category::OverLimit))
    }
}

/// The first word of a line, and the line after it.
fn first_word(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii_start();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    line.split_at(end)
}

#[cfg(test)]
mod tests {
    use super::*;
    use shapeloom_core::{Diagnostic, Limits};

    fn parse(input: &[u8]) -> Result<(Header, Findings), ReadError> {
        let context = ReadContext { limits: Limits { max_line: 10_000, ..Limits::default() }, ..Default::default() };
        let mut findings = Findings::default();
        let header = Header::parse(input, &context, &mut Memory::new(&context.exec), &mut findings)?;
        Ok((header, findings))
    }

    fn fails(body: &str, code: &str, line: u64) {
        let error = parse(format!("ply\n{body}").as_bytes()).unwrap_err();
        let place = error.fault().map(|fault| fault.place.clone());
        assert_eq!((error.code(), place), (code, Some(Place::line(line))), "{body}: {error}");
    }

    #[test]
    fn bodies_begin_after_the_end_of_the_last_line() {
        let lines = ["ply", "format binary_little_endian 1.0", "end_header"];
        for (between, last, body) in [
            ("\n", "\n", &b"\nx"[..]),
            ("\r\n", "\r\n", b"\nx"),
            ("\r", "\r", b"\nx"),
            ("\n", "\n", b"\rx"),
            ("\n", "\r\n", b"x"),
            ("\r\n", "\n", b"\n"),
        ] {
            let mut file = (lines.join(between) + last).into_bytes();
            let start = file.len();
            file.extend_from_slice(body);
            let header = parse(&file).unwrap().0;
            assert_eq!(header.body, start, "{between:?} {last:?} {body:?}");
        }
        assert_eq!(parse(b"ply\nformat ascii 1.0\nend_header").unwrap().0.body, 31);
    }

    #[test]
    fn every_line_is_understood() {
        let text = "ply\nformat ascii 1.0\ncomment  two blanks \nobj_info n 5\n\ncomment\nelement my-thing 3\n\
                    property list uint8 float32 a.b\nproperty  int8\tc\nend_header\n";
        let (header, findings) = parse(text.as_bytes()).unwrap();
        assert!(findings.is_empty());
        assert_eq!(header.comments, [" two blanks ", "obj_info n 5", ""]);
        let element = &header.elements[0];
        assert_eq!((element.name.as_str(), element.rows, element.line), ("my-thing", 3, 7));
        let list = &element.properties[0];
        assert_eq!((list.name.as_str(), list.kind, list.count), ("a.b", Type::Float, Some(Type::Uchar)));
        assert_eq!((element.properties[1].kind, element.properties[1].count), (Type::Char, None));
        assert_eq!((element.find_list(&["c", "a.b"]), element.find("c")), (Some(0), Some(1)));
    }

    #[test]
    fn wrong_lines_are_named() {
        fails("element vertex 1\nend_header\n", "E-ply-format", 2);
        fails("end_header\n", "E-ply-format", 2);
        fails("format text 1.0\n", "E-ply-format", 2);
        fails("format ascii 1.0\nformat ascii 1.0\n", "E-ply-duplicate", 3);
        fails("format ascii 1.0\nproperty float x\n", "E-ply-header", 3);
        fails("format ascii 1.0\nvertex 3\n", "E-ply-header", 3);
        for count in ["-1", "1.0", "x", "", "18446744073709551616"] {
            fails(&format!("format ascii 1.0\nelement vertex {count}\n"), "E-ply-count", 3);
        }
        fails("format ascii 1.0\nelement vertex 4294967295\n", "E-ply-limit", 3);
        fails("format ascii 1.0\nelement vertex 1 2\n", "E-ply-header", 3);
        fails("format ascii 1.0\nelement a 1\nelement a 1\n", "E-ply-duplicate", 4);
        let property = |text: &str, code| fails(&format!("format ascii 1.0\nelement a 1\nproperty {text}\n"), code, 4);
        property("quad x", "E-ply-type");
        property("list float int x", "E-ply-type");
        property("list uchar quad x", "E-ply-type");
        property("float", "E-ply-header");
        property("float x y", "E-ply-header");
        property("list uchar int", "E-ply-header");
        property("list uchar int x y", "E-ply-header");
        fails("format ascii 1.0\nelement a 1\nproperty int x\nproperty int x\n", "E-ply-duplicate", 5);
        fails("format ascii 1.0\nelement ver", "E-ply-truncated", 3);
        fails("format ascii 1.0\n", "E-ply-truncated", 2);
        fails(&format!("comment {}\n", "x".repeat(10_000)), "E-text-line", 2);
        let (_, findings) = parse(b"ply\nformat ascii 2.0\nend_header\n").unwrap();
        assert_eq!(findings.iter().next().unwrap().places, [Place::line(2)]);
    }

    #[test]
    fn names_that_are_no_utf_8_are_told_and_told_apart() {
        let text = b"ply\nformat ascii 1.0\ncomment \xe4\nelement \xff 1\nproperty int \xfc\nproperty int \xfd\n\
            property int \xef\xbf\xbd\nelement \xfe 1\nend_header\n";
        let (header, findings) = parse(text).unwrap();
        let names: Vec<&str> = header.elements[0].properties.iter().map(|property| property.name.as_str()).collect();
        assert_eq!(names, ["\u{fffd}", "\u{fffd}_line6", "\u{fffd}_line7"]);
        assert_ne!(header.elements[0].name, header.elements[1].name);
        let only = findings.iter().next().unwrap();
        assert_eq!((only.code, &only.places[..]), ("W-text-encoding", &[3, 4, 5, 6, 8].map(Place::line)[..]));
        let twice = text.iter().map(|&byte| if byte == 0xfd { 0xfc } else { byte }).collect::<Vec<_>>();
        assert_eq!(parse(&twice).unwrap_err().code(), "E-ply-duplicate");
    }

    #[test]
    fn floods_are_bounded() {
        let mut text = "ply\nformat ascii 1.0\nelement a 1\n".to_owned();
        (0..1_000_000).for_each(|i| text.push_str(&format!("property int p{i}\n")));
        let error = parse(text.as_bytes()).unwrap_err();
        assert_eq!((error.code(), error.category()), ("E-ply-limit", Category::OverLimit));
        let exec = shapeloom_core::Exec::default().with_memory(100_000);
        let context = ReadContext { exec, ..ReadContext::default() };
        let comments = "ply\n".to_owned() + &"comment x\n".repeat(100_000);
        let parsed =
            Header::parse(comments.as_bytes(), &context, &mut Memory::new(&context.exec), &mut Findings::default());
        assert!(matches!(parsed, Err(ReadError::OverBudget(_))));
    }

    #[test]
    fn rows_need_room() {
        let room = |text: &str, body: usize| parse(text.as_bytes()).unwrap().0.check_room(body).is_ok();
        let binary = "ply\nformat binary_big_endian 1.0\nelement a 3\nproperty double x\nproperty list ushort int l\n\
                      element none 4000000000\nelement b 2\nproperty char c\nend_header\n";
        assert!(room(binary, 32) && !room(binary, 31));
        let ascii = "ply\nformat ascii 1.0\nelement a 3\nproperty float x\nproperty float y\nend_header\n";
        assert!(room(ascii, 11) && !room(ascii, 10));
    }
}
