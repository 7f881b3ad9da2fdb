//! Reading PGM.

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Findings, Place, Severity};

use crate::heights::{NorthFirst, check_options, check_size, part_of, picture_scale, room, shape_of};
use crate::memory::Memory;
use crate::text::{line_place, parse_count, quoted};
use crate::{Fault, ReadContext, ReadError, ReadShape};

pub(super) fn read(input: &[u8], context: &ReadContext) -> Result<ReadShape, ReadError> {
    check_options(&context.options)?;
    let mut words = Words { input, at: 0 };
    let binary = match input.get(..2) {
        Some(b"P5") => true,
        Some(b"P2") => false,
        _ => {
            let place = Place::Byte(0);
            if input.len() < 2 {
                return Err(Fault::new("E-pgm-truncated", place, "the end of the file", "P2 or P5").into());
            }
            let found = quoted(&input[..2]);
            let fault = Fault::new("E-pgm-magic", place, found, "P2 or P5, the marks of grey pictures");
            return Err(fault.advice("save the picture as PGM; bits (PBM) and colours (PPM) are no heights").into());
        }
    };
    words.at = 2;
    let columns = words.header("the number of columns", "E-pgm-count")?;
    let rows = words.header("the number of rows", "E-pgm-count")?;
    let size_place = words.place();
    let full = words.header("the largest value", "E-pgm-maxval")?;
    if !(1..=65535).contains(&full) {
        let found = format!("{full} as the largest value");
        return Err(Fault::new("E-pgm-maxval", words.place(), found, "a number from 1 to 65535").into());
    }
    let (columns, rows) = check_size(columns, rows, size_place, "", input.len(), context)?;
    let count = columns as usize * rows as usize;
    let mut memory = Memory::new(&context.exec);
    let mut findings = Findings::default();
    let raw = if binary {
        words.binary(count, columns, full, context, &mut memory, &mut findings)?
    } else {
        words.text(count, columns, full, context, &mut memory, &mut findings)?
    };
    let (height, distance) = picture_scale(full as f64, columns, rows, None, context, &mut findings);
    let heights = raw.into_iter().map(|value| part_of(value, full as f64, height)).collect();
    let grid = NorthFirst { columns, rows, spacing: DVec2::splat(distance), south_west: DVec2::ZERO, heights };
    let field = grid.into_field(context, &mut findings)?;
    Ok(ReadShape { findings, ..ReadShape::new(shape_of(field)) })
}

/// The words of the file.
struct Words<'a> {
    input: &'a [u8],
    /// Behind the last word.
    at: usize,
}

impl<'a> Words<'a> {
    /// The line of the last word.
    fn place(&self) -> Place {
        line_place(self.input, Place::Byte(self.at.saturating_sub(1) as u64))
    }

    /// The next word, comments passed over; empty at the end of the file.
    fn next(&mut self) -> &'a [u8] {
        let input = self.input;
        while let Some(byte) = input.get(self.at) {
            match byte {
                b'#' => {
                    let line = &input[self.at..];
                    self.at += memchr::memchr2(b'\n', b'\r', line).unwrap_or(line.len());
                }
                byte if byte.is_ascii_whitespace() => self.at += 1,
                _ => break,
            }
        }
        let rest = &input[self.at..];
        let end = rest.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'#').unwrap_or(rest.len());
        self.at += end;
        &rest[..end]
    }

    fn truncated(&self, expected: &str) -> Box<Fault> {
        let place = Place::Byte(self.input.len() as u64);
        Fault::new("E-pgm-truncated", place, "the end of the file", expected)
    }

    fn header(&mut self, what: &str, code: &'static str) -> Result<u64, Box<Fault>> {
        let word = self.next();
        if word.is_empty() {
            return Err(self.truncated(what));
        }
        parse_count(word).map_err(|_| Fault::new(code, self.place(), quoted(word), format!("{what} in digits")))
    }

    fn binary(
        mut self,
        count: usize,
        columns: u32,
        full: u64,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Vec<f64>, ReadError> {
        // One byte of white space, whatever follows.
        match self.input.get(self.at) {
            Some(byte) if byte.is_ascii_whitespace() => self.at += 1,
            _ => return Err(self.truncated("white space and the samples after the header").into()),
        }
        let width = if full > 255 { 2 } else { 1 };
        let samples = &self.input[self.at..];
        if samples.len() / width < count {
            let there = samples.len() / width;
            return Err(self.truncated(&format!("{count} samples, of which {there} are there")).into());
        }
        let mut raw = room(count, memory)?;
        for (row, bytes) in samples[..count * width].chunks(columns as usize * width).enumerate() {
            context.exec.check()?;
            for (column, sample) in bytes.chunks_exact(width).enumerate() {
                let value = sample.iter().fold(0, |value, byte| value * 256 + u64::from(*byte));
                if value > full {
                    let offset = self.at + (row * columns as usize + column) * width;
                    return Err(too_bright(value, full, Place::Byte(offset as u64), row, column).into());
                }
                raw.push(value as f64);
            }
        }
        let rest = &samples[count * width..];
        if !rest.trim_ascii().is_empty() {
            let message = format!("{} bytes follow after the last sample; they were not read", rest.len());
            let place = Place::Byte((self.input.len() - rest.len()) as u64);
            findings.push("W-pgm-trailing", Severity::Warning, place, message);
        }
        Ok(raw)
    }

    fn text(
        mut self,
        count: usize,
        columns: u32,
        full: u64,
        context: &ReadContext,
        memory: &mut Memory<'_>,
        findings: &mut Findings,
    ) -> Result<Vec<f64>, ReadError> {
        // A digit and a blank each, but for the last.
        let most = (self.input.len() - self.at) / 2 + 1;
        if most < count {
            return Err(self.truncated(&format!("{count} samples, of which at most {most} are there")).into());
        }
        let mut raw = room(count, memory)?;
        while raw.len() < count {
            if raw.len() % 1024 == 0 {
                context.exec.check()?;
            }
            let word = self.next();
            if word.is_empty() {
                return Err(self.truncated(&format!("{count} samples, of which {} are there", raw.len())).into());
            }
            let (row, column) = (raw.len() / columns as usize, raw.len() % columns as usize);
            match parse_count(word) {
                Ok(value) if value <= full => raw.push(value as f64),
                Ok(value) => return Err(too_bright(value, full, self.place(), row, column).into()),
                Err(_) => {
                    let fault = Fault::new("E-pgm-number", self.place(), quoted(word), "a sample in digits");
                    return Err(fault.within(format!("row {row}, column {column}")).into());
                }
            }
        }
        if !self.next().is_empty() {
            let message = "more follows after the last sample; it was not read";
            findings.push("W-pgm-trailing", Severity::Warning, self.place(), message);
        }
        Ok(raw)
    }
}

fn too_bright(value: u64, full: u64, place: Place, row: usize, column: usize) -> Box<Fault> {
    Fault::new(
        "E-pgm-value",
        place,
        value.to_string(),
        format!("at most {full}, the largest value that the header says"),
    )
    .within(format!("row {row}, column {column}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReadOptions;
    use shapeloom_core::{Diagnostic, Exec};
    use shapeloom_mesh::HeightField;
    use shapeloom_shape::Representation;

    fn pgm(input: &[u8], height: f64) -> Result<ReadShape, ReadError> {
        let options = ReadOptions { height, ..ReadOptions::new() };
        let exec = Exec::default().with_memory(1 << 20);
        crate::read(input, &super::super::FORMAT, &ReadContext { options, exec, ..ReadContext::named("x") })
    }

    fn heights(read: &ReadShape) -> Vec<f64> {
        HeightField::from_geometry(&read.shape.parts[0].geometry).unwrap().heights().to_vec()
    }

    #[test]
    fn text_and_binary_say_the_same() {
        let text = pgm(b"P2 # made by hand\n3 2\n# deep\n1000\n0 1 2 # row\n998 999 1000", 1000.0).unwrap();
        let binary = pgm(b"P5 3 2 1000\n\0\0\0\x01\0\x02\x03\xe6\x03\xe7\x03\xe8", 1000.0).unwrap();
        assert_eq!(text, binary);
        assert_eq!(heights(&text), [998.0, 999.0, 1000.0, 0.0, 1.0, 2.0]);
        assert!(text.findings.is_empty());
        // Of bytes that look like blanks and comments none is passed over.
        let blanks = pgm(b"P5 2 2 255 \n # ", 255.0).unwrap();
        assert_eq!(heights(&blanks), [35.0, 32.0, 10.0, 32.0]);
    }

    #[test]
    fn white_is_a_tenth_of_the_longer_side_unless_said() {
        let read = pgm(b"P2 11 2 9\n 0 0 0 0 0 0 0 0 0 0 9 0 0 0 0 0 0 0 0 0 0 0", 0.0).unwrap();
        assert_eq!(heights(&read)[21], 1.0);
        assert_eq!(read.findings.iter().map(|finding| finding.code).collect::<Vec<_>>(), ["W-heights-scale"]);
    }

    #[test]
    fn defects_are_told_where_they_are() {
        for (input, code, place) in [
            (&b"P"[..], "E-pgm-truncated", Place::Byte(0)),
            (b"P6 2 2 255\n", "E-pgm-magic", Place::Byte(0)),
            (b"P5\n# x\n2 2.5\n255\n", "E-pgm-count", Place::line(3)),
            (b"P5 1 4 255\n1234", "E-heights-size", Place::line(1)),
            (b"P5 2 2\n\n65536\n", "E-pgm-maxval", Place::line(3)),
            (b"P5 2 2 255", "E-pgm-truncated", Place::Byte(10)),
            (b"P5 2 2 9 1\x0a11", "E-pgm-value", Place::Byte(9)),
            (b"P5 2 2 9 \x09\x09\x0a\x09", "E-pgm-value", Place::Byte(11)),
            (b"P2 2 2 9 1 2 3\n10", "E-pgm-value", Place::line(2)),
            (b"P2 2 2 9 1 2 x 3", "E-pgm-number", Place::line(1)),
            (b"P2 2 2 9 1 2 3", "E-pgm-truncated", Place::Byte(14)),
            (b"P5 8000 8000 255\n1234", "E-pgm-truncated", Place::Byte(21)),
            (b"P2 8000 8000 255\n1234", "E-pgm-truncated", Place::Byte(21)),
            (b"P5 9000 9000 255\n1234", "E-heights-limit", Place::line(1)),
        ] {
            let error = pgm(input, 0.0).unwrap_err();
            let found = error.fault().map(|fault| (fault.code, fault.place.clone()));
            assert_eq!(found, Some((code, place)), "{error}");
            assert!(error.advice().is_some(), "{error}");
        }
        let trailing = pgm(b"P5 2 2 255\n1234 x", 1.0).unwrap();
        assert_eq!(trailing.findings.iter().next().unwrap().places, [Place::Byte(15)]);
    }
}
