//! The lines of a header.

use shapeloom_core::{Findings, Place};

use super::SPACE;
use crate::memory::{Memory, make_room};
use crate::text::{Scanner, lossy, quoted};
use crate::{Fault, ReadContext, ReadError};

/// A field: its value, and where its line and its value begin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field<'a> {
    name: &'static str,
    pub(super) value: &'a [u8],
    pub(super) line: u64,
}

impl Field<'_> {
    pub(super) fn place(&self) -> Place {
        Place::Byte(self.line)
    }

    /// What is wrong with the value.
    pub(super) fn fault(
        &self,
        code: &'static str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Box<Fault> {
        Fault::new(code, self.place(), found, expected).within(self.name)
    }
}

/// Every field that is heeded, by its name and other spellings. Names are compared without blanks and case.
const NAMES: [(&str, &[&str]); 21] = [
    ("type", &[]),
    ("dimension", &[]),
    ("sizes", &[]),
    ("encoding", &[]),
    ("endian", &[]),
    ("spacings", &[]),
    ("space", &[]),
    ("space dimension", &[]),
    ("space directions", &[]),
    ("space origin", &[]),
    ("space units", &[]),
    ("units", &[]),
    ("kinds", &[]),
    ("centers", &["centerings"]),
    ("axis mins", &[]),
    ("axis maxs", &[]),
    ("data file", &[]),
    ("byte skip", &[]),
    ("line skip", &[]),
    ("measurement frame", &[]),
    ("block size", &[]),
];

/// Whether a value of `data file` says that names follow.
pub(super) fn is_list(value: &[u8]) -> bool {
    value.strip_prefix(b"LIST").is_some_and(|rest| rest.first().is_none_or(u8::is_ascii_whitespace))
}

/// The fields of a header, its comments, and where it ends.
#[derive(Debug, Default)]
pub(super) struct Fields<'a> {
    all: Vec<Field<'a>>,
    /// The names of files that follow `data file: LIST` to the end.
    pub(super) listed: Vec<&'a [u8]>,
    /// What the file says of the quantity of its samples.
    pub(super) quantity: &'a [u8],
    pub(super) comments: Vec<String>,
    /// Where the samples begin: after the blank line, or none where the header goes on to the end.
    pub(super) data: Option<usize>,
    pub(super) end: usize,
}

impl<'a> Fields<'a> {
    /// Reads lines up to the blank one.
    ///
    /// # Errors
    /// Another mark, a line that is no field, a field that is there twice.
    pub(super) fn read(
        text: &'a [u8],
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Self, ReadError> {
        let mut scan = Scanner::new(text, 0);
        let magic = scan.rest_of_line();
        match magic.strip_prefix(b"NRRD000") {
            Some(b"1" | b"2" | b"3" | b"4" | b"5") => {}
            Some(_) => {
                let fault = Fault::new("E-nrrd-version", Place::Byte(0), quoted(magic), "NRRD0001 to NRRD0005");
                return Err(fault.category(shapeloom_core::Category::Unsupported).into());
            }
            None => {
                let found = if text.is_empty() { "an empty file".to_owned() } else { quoted(magic) };
                return Err(
                    Fault::new("E-nrrd-magic", Place::Byte(0), found, "a first line NRRD0001 to NRRD0005").into()
                );
            }
        }
        scan.next_line();
        let mut fields = Self::default();
        loop {
            context.exec.check()?;
            let line = scan.offset() as u64;
            let content = scan.rest_of_line();
            let blank = scan.at_line_end();
            if !scan.next_line() {
                fields.end = text.len();
                return Ok(fields);
            }
            if blank {
                fields.data = Some(scan.offset());
                fields.end = line as usize;
                return Ok(fields);
            }
            if let Some(comment) = content.strip_prefix(b"#") {
                memory.take(comment.len() + 64, 4)?;
                let comment = lossy(comment.trim_ascii(), Place::Byte(line), findings).into_owned();
                make_room(memory, &mut fields.comments, 1)?;
                fields.comments.push(comment);
                continue;
            }
            let colon = memchr::memchr(b':', content).filter(|colon| *colon > 0);
            let Some(colon) = colon else {
                let expected =
                    "a line \"field: value\", \"key:=value\", a comment from #, or the blank line at the end";
                return Err(Fault::new("E-nrrd-header", Place::Byte(line), quoted(content), expected).into());
            };
            let (name, value) = (&content[..colon], &content[colon + 1..]);
            if let Some(value) = value.strip_prefix(b"=") {
                if name == b"quantity" {
                    fields.quantity = value;
                } else {
                    memory.take(content.len() + 64, 4)?;
                    let pair = lossy(content, Place::Byte(line), findings).into_owned();
                    make_room(memory, &mut fields.comments, 1)?;
                    fields.comments.push(pair);
                }
                continue;
            }
            let value = value.trim_ascii();
            if fields.take(name, value, line, context, memory, findings)? == Some("data file") && is_list(value) {
                fields.list(&mut scan, context, memory)?;
                fields.end = text.len();
                return Ok(fields);
            }
        }
    }

    fn take(
        &mut self,
        name: &[u8],
        value: &'a [u8],
        line: u64,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Option<&'static str>, ReadError> {
        let _ = context;
        let squeezed: Vec<u8> = name.iter().take(64).filter(|byte| !byte.is_ascii_whitespace()).copied().collect();
        let same = |word: &str| {
            let word = word.bytes().filter(|byte| *byte != b' ');
            word.eq(squeezed.iter().map(u8::to_ascii_lowercase))
        };
        let known = NAMES.iter().find(|(name, others)| same(name) || others.iter().any(|other| same(other)));
        let Some((name, _)) = known else {
            // What samples mean beyond their places, thicknesses, old extrema: kept as words.
            memory.take(name.len() + value.len() + 64, 4)?;
            let field = [name, b": ", value].concat();
            let text = lossy(&field, Place::Byte(line), findings).into_owned();
            make_room(memory, &mut self.comments, 1)?;
            self.comments.push(text);
            return Ok(None);
        };
        if self.find(name).is_some() {
            let found = format!("{name} a second time");
            return Err(Fault::new("E-nrrd-duplicate", Place::Byte(line), found, "each field once").into());
        }
        self.all.push(Field { name, value, line });
        if *name == "space" {
            let words = lossy(value, Place::Byte(line), findings).into_owned();
            memory.take(words.len() + 64, 4)?;
            self.comments.push(format!("{SPACE}{words}"));
        }
        Ok(Some(name))
    }

    /// The names of files, one a line, to the end.
    fn list(
        &mut self,
        scan: &mut Scanner<'a>,
        context: &ReadContext,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        loop {
            context.exec.check()?;
            let name = scan.rest_of_line().trim_ascii();
            if !name.is_empty() {
                make_room(memory, &mut self.listed, 1)?;
                self.listed.push(name);
            }
            if !scan.next_line() {
                return Ok(());
            }
        }
    }

    pub(super) fn find(&self, name: &str) -> Option<&Field<'a>> {
        self.all.iter().find(|field| field.name == name)
    }

    /// A field that must be there.
    ///
    /// # Errors
    /// It is not.
    pub(super) fn require(&self, name: &str) -> Result<&Field<'a>, Box<Fault>> {
        self.find(name).ok_or_else(|| {
            Fault::new(
                "E-nrrd-header",
                Place::Byte(self.end as u64),
                "the end of the header",
                format!("the field {name}"),
            )
            .advice(format!("put the field {name} into the header"))
        })
    }
}
