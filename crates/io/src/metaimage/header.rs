//! The lines of a header.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{Findings, Place};

use crate::memory::{Memory, make_room};
use crate::text::{NumberFault, Scanner, lossy, parse_count, parse_number, quoted};
use crate::{Fault, ReadContext, ReadError};

/// A line: its key, its value, and where it begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry<'a> {
    key: &'a [u8],
    pub(super) value: &'a [u8],
    line: u64,
}

/// Keys with their other spellings.
const KEYS: [&[&str]; 18] = [
    &["NDims"],
    &["DimSize"],
    &["ElementType"],
    &["ElementSpacing"],
    &["ElementSize"],
    &["Offset", "Position", "Origin"],
    &["TransformMatrix", "Rotation", "Orientation"],
    &["BinaryDataByteOrderMSB", "ElementByteOrderMSB"],
    &["BinaryData"],
    &["CompressedData"],
    &["CompressedDataSize"],
    &["HeaderSize"],
    &["ElementNumberOfChannels"],
    &["ElementDataFile"],
    &["DistanceUnits"],
    &["ObjectType"],
    &["ObjectSubType"],
    &["CenterOfRotation"],
];

/// The entries up to the name of the file of samples, which is the last.
#[derive(Debug, Default)]
pub(super) struct Header<'a> {
    all: Vec<(&'static str, Entry<'a>)>,
    pub(super) quantity: &'a [u8],
    pub(super) comments: Vec<String>,
    /// Where it ends.
    pub(super) end: usize,
}

impl<'a> Entry<'a> {
    pub(super) fn place(&self) -> Place {
        Place::Byte(self.line)
    }

    pub(super) fn fault(
        &self,
        code: &'static str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Box<Fault> {
        Fault::new(code, self.place(), found, expected).within(String::from_utf8_lossy(self.key))
    }

    /// As many numbers as wanted.
    pub(super) fn numbers<const N: usize>(&self) -> Result<[f64; N], Box<Fault>> {
        let mut words = self.value.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let mut numbers = [0.0; N];
        let expected = || format!("{N} numbers");
        for number in &mut numbers {
            let word = words.next().ok_or_else(|| self.fault("E-metaimage-count", quoted(self.value), expected()))?;
            *number = match parse_number(word) {
                Ok(value) => value,
                Err(NumberFault::NotFinite) => f64::NAN,
                Err(fault) => return Err(self.fault("E-metaimage-number", quoted(word), fault.to_string())),
            };
        }
        match words.next() {
            Some(more) => Err(self.fault("E-metaimage-count", format!("{} beyond them", quoted(more)), expected())),
            None => Ok(numbers),
        }
    }

    pub(super) fn three(&self) -> Result<DVec3, Box<Fault>> {
        self.numbers::<3>().map(DVec3::from)
    }

    pub(super) fn count(&self) -> Result<u64, Box<Fault>> {
        let expected = "a whole number in digits alone";
        parse_count(self.value).map_err(|_| self.fault("E-metaimage-count", quoted(self.value), expected))
    }

    pub(super) fn is_true(&self) -> Result<bool, Box<Fault>> {
        match self.value.first() {
            Some(b'T' | b't' | b'1' | b'Y' | b'y') => Ok(true),
            Some(b'F' | b'f' | b'0' | b'N' | b'n') => Ok(false),
            _ => Err(self.fault("E-metaimage-header", quoted(self.value), "True or False")),
        }
    }
}

impl<'a> Header<'a> {
    pub(super) fn read(
        text: &'a [u8],
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Self, ReadError> {
        let mut scan = Scanner::new(text, 0);
        let mut header = Self::default();
        loop {
            context.exec.check()?;
            let line = scan.offset() as u64;
            let content = scan.rest_of_line();
            if !scan.next_line() {
                header.end = text.len();
                return Ok(header);
            }
            if content.is_empty() {
                continue;
            }
            let Some(equals) = memchr::memchr(b'=', content) else {
                let place = Place::Byte(line);
                return Err(Fault::new("E-metaimage-header", place, quoted(content), "a line \"Key = value\"").into());
            };
            let (key, value) = (content[..equals].trim_ascii(), content[equals + 1..].trim_ascii());
            let same = |word: &&str| word.as_bytes().eq_ignore_ascii_case(key);
            let Some(names) = KEYS.iter().find(|names| names.iter().any(same)) else {
                if key == b"Comment" && value.starts_with(b"quantity=") {
                    header.quantity = &value[b"quantity=".len()..];
                    continue;
                }
                let comment = if key == b"Comment" { value } else { content };
                memory.take(comment.len() + 64, 4)?;
                let comment = lossy(comment, Place::Byte(line), findings).into_owned();
                make_room(memory, &mut header.comments, 1)?;
                header.comments.push(comment);
                continue;
            };
            let entry = Entry { key, value, line };
            if header.find(names[0]).is_some() {
                let found = format!("{} a second time", quoted(key));
                return Err(Fault::new("E-metaimage-duplicate", Place::Byte(line), found, "each key once").into());
            }
            header.all.push((names[0], entry));
            if names[0] == "ElementDataFile" {
                header.end = scan.offset();
                return Ok(header);
            }
        }
    }

    pub(super) fn find(&self, name: &str) -> Option<&Entry<'a>> {
        self.all.iter().find(|(known, _)| *known == name).map(|(_, entry)| entry)
    }

    pub(super) fn require(&self, name: &str) -> Result<&Entry<'a>, Box<Fault>> {
        self.find(name).ok_or_else(|| {
            let place = Place::Byte(self.end as u64);
            let advice = match name {
                "ElementDataFile" => {
                    "end the header with a line \"ElementDataFile = LOCAL\", or with the name of the file of samples"
                        .to_owned()
                }
                _ => format!("put a line \"{name} = ...\" into the header, before ElementDataFile"),
            };
            Fault::new("E-metaimage-header", place, "the end of the header", format!("the key {name}")).advice(advice)
        })
    }
}
