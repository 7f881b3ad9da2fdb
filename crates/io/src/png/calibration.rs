//! The registered chunks that say what samples mean: `pCAL`, the calibration of values, and `sCAL`, the size of pixels
//! (W3C, "Extensions to the PNG Third Edition Specification", 2025).

use shapeloom_core::glam::DVec2;
use shapeloom_core::{Findings, Place, Severity};

use crate::text::{parse_number, push_number};

/// Heights from samples: `base` at 0, `base + range` at the largest value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Calibration {
    pub(super) base: f64,
    pub(super) range: f64,
    /// The largest value that it is for.
    pub(super) full: u32,
}

/// What the chunk calls itself.
const PURPOSE: &[u8] = b"height";

impl Calibration {
    /// The calibration, if it is a linear one from 0 on: others are named and passed over.
    pub(super) fn parse(body: &[u8], place: Place, findings: &mut Findings) -> Option<Self> {
        let found = Self::linear(body);
        if found.is_none() {
            let message = "the calibration in the chunk pCAL is no linear one from 0 on: it was passed over";
            findings.push("W-png-calibration", Severity::Warning, place, message);
        }
        found
    }

    fn linear(body: &[u8]) -> Option<Self> {
        let purpose = memchr::memchr(0, body)?;
        let (numbers, rest) = body.get(purpose + 1..)?.split_at_checked(10)?;
        let integer = |at: usize| <[u8; 4]>::try_from(&numbers[at..at + 4]).ok().map(i32::from_be_bytes);
        let (first, last) = (integer(0)?, integer(4)?);
        if first != 0 || last < 1 || numbers[8..] != [0, 2] {
            return None;
        }
        let unit = memchr::memchr(0, rest)?;
        let mut parameters = rest[unit + 1..].split(|byte| *byte == 0);
        let base = parse_number(parameters.next()?).ok()?;
        let range = parse_number(parameters.next()?).ok()?;
        parameters.next().is_none().then_some(Self { base, range, full: last as u32 })
    }

    /// The body of the chunk.
    pub(super) fn to_chunk(self, unit: &str) -> Vec<u8> {
        let mut body = PURPOSE.to_vec();
        body.push(0);
        body.extend(0i32.to_be_bytes());
        body.extend((self.full as i32).to_be_bytes());
        // Linear, with two parameters.
        body.extend([0, 2]);
        body.extend(unit.as_bytes());
        body.push(0);
        push_number(&mut body, self.base);
        body.push(0);
        push_number(&mut body, self.range);
        body
    }
}

/// The size of a pixel in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct PixelSize(pub(super) DVec2);

impl PixelSize {
    /// The size, if it is one in metres: others are named and passed over.
    pub(super) fn parse(body: &[u8], place: Place, findings: &mut Findings) -> Option<Self> {
        let size = body.strip_prefix(&[1]).and_then(|text| {
            let (x, y) = text.split_at(memchr::memchr(0, text)?);
            let size = DVec2::new(parse_number(x).ok()?, parse_number(&y[1..]).ok()?);
            (size.min_element() > 0.0).then_some(Self(size))
        });
        if size.is_none() {
            let message = "the size of pixels in the chunk sCAL is none in metres: it was passed over";
            findings.push("W-png-calibration", Severity::Warning, place, message);
        }
        size
    }

    /// The body of the chunk.
    pub(super) fn to_chunk(self) -> Vec<u8> {
        let mut body = vec![1];
        push_number(&mut body, self.0.x);
        body.push(0);
        push_number(&mut body, self.0.y);
        body
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_come_back() {
        let mut findings = Findings::default();
        let calibration = Calibration { base: -12.5, range: 1e-3, full: 65535 };
        assert_eq!(Calibration::parse(&calibration.to_chunk("m"), Place::Whole, &mut findings), Some(calibration));
        let size = PixelSize(DVec2::new(30.0, 1.0 / 3.0));
        assert_eq!(PixelSize::parse(&size.to_chunk(), Place::Whole, &mut findings), Some(size));
        assert!(findings.is_empty());
        // Laid down by the specification: purpose, two numbers, kind, count, unit, parameters.
        let body = Calibration { base: 1.0, range: 2.0, full: 255 }.to_chunk("");
        assert_eq!(body, b"height\0\0\0\0\0\0\0\0\xff\0\x02\x001\x002");
    }

    #[test]
    fn other_chunks_are_passed_over() {
        let whole = Calibration { base: 1.0, range: 2.0, full: 255 }.to_chunk("m");
        let mut findings = Findings::default();
        for end in 0..whole.len() {
            assert_eq!(Calibration::parse(&whole[..end], Place::Whole, &mut findings), None, "{end}");
        }
        // An exponential one.
        let other: Vec<u8> = whole.iter().enumerate().map(|(at, byte)| if at == 15 { 1 } else { *byte }).collect();
        assert_eq!(Calibration::parse(&other, Place::Whole, &mut findings), None);
        for body in [&b""[..], b"\x021\x001", b"\x010\x001", b"\x011", b"\x01x\x001"] {
            assert_eq!(PixelSize::parse(body, Place::Whole, &mut findings), None);
        }
        assert_eq!(findings.iter().next().unwrap().code, "W-png-calibration");
    }
}
