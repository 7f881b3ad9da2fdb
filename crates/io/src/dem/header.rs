//! Record A, and the fixed columns of all records.

use shapeloom_core::{Category, Place};

use crate::Fault;
use crate::text::{parse_number, quoted};

/// The bytes of a block.
pub(super) const BLOCK: usize = 1024;

/// A block with where it begins. Blocks that end early, at the end of a line, go on in blanks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) start: usize,
}

impl<'a> Block<'a> {
    /// The block at an offset and where the next one begins; none at the end of the input. Ends of lines between blocks,
    /// which some programs add, belong to neither.
    pub(super) fn at(input: &'a [u8], start: usize) -> Option<(Self, usize)> {
        let rest = input.get(start..).filter(|rest| !rest.is_empty())?;
        let most = &rest[..rest.len().min(BLOCK)];
        let length = memchr::memchr2(b'\n', b'\r', most).unwrap_or(most.len());
        let mut next = start + length;
        while matches!(input.get(next), Some(b'\n' | b'\r')) {
            next += 1;
        }
        Some((Self { bytes: &most[..length], start }, next))
    }

    /// Columns without the blanks around what they hold.
    fn field(&self, from: usize, length: usize) -> &'a [u8] {
        let end = (from + length).min(self.bytes.len());
        self.bytes.get(from..end).unwrap_or_default().trim_ascii()
    }

    fn fault(&self, code: &'static str, from: usize, length: usize, expected: &str, what: &str) -> Box<Fault> {
        let field = self.field(from, length);
        let found = if field.is_empty() { "blanks".to_owned() } else { quoted(field) };
        Fault::new(code, Place::Byte((self.start + from) as u64), found, expected).within(what)
    }

    /// A whole number.
    pub(super) fn integer(&self, from: usize, length: usize, what: &str) -> Result<i64, Box<Fault>> {
        let text = std::str::from_utf8(self.field(from, length)).ok();
        let value = text.and_then(|text| text.strip_prefix('+').unwrap_or(text).parse().ok());
        value.ok_or_else(|| self.fault("E-dem-number", from, length, "a whole number", what))
    }

    /// A number in the style of Fortran.
    pub(super) fn real(&self, from: usize, length: usize, what: &str) -> Result<f64, Box<Fault>> {
        fortran(self.field(from, length))
            .ok_or_else(|| self.fault("E-dem-number", from, length, "a number, such as 0.3D+02", what))
    }

    /// The number of heights that fit behind so many columns.
    pub(super) fn heights_after(from: usize) -> usize {
        // The last four columns of each block are not used: heights take six.
        (BLOCK - 4 - from) / 6
    }
}

/// A number whose exponent may begin with a D, or with its sign alone as Fortran has it for exponents of three digits.
pub(super) fn fortran(text: &[u8]) -> Option<f64> {
    let mut plain = [0u8; 32];
    let plain = plain.get_mut(..text.len())?;
    plain.copy_from_slice(text);
    for byte in plain.iter_mut().filter(|byte| matches!(byte, b'D' | b'd')) {
        *byte = b'e';
    }
    parse_number(plain).ok()
}

/// The unit of places.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ground {
    Radians,
    Feet,
    Meters,
    ArcSeconds,
}

/// What record A says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) name: String,
    pub(super) ground: Ground,
    /// Whether heights are in feet, else in metres.
    pub(super) feet: bool,
    /// The lowest and the highest height, in the file's unit.
    pub(super) range: [f64; 2],
    /// The distances of profiles, of samples, and the unit of heights in theirs.
    pub(super) resolution: [f64; 3],
    pub(super) profiles: u64,
}

impl Header {
    pub(super) fn read(block: &Block<'_>) -> Result<Self, Box<Fault>> {
        let ground = match block.integer(528, 6, "unit of places")? {
            0 => Ground::Radians,
            1 => Ground::Feet,
            2 => Ground::Meters,
            3 => Ground::ArcSeconds,
            _ => return Err(block.fault("E-dem-header", 528, 6, "a unit from 0 to 3", "unit of places")),
        };
        let feet = match block.integer(534, 6, "unit of heights")? {
            1 => true,
            2 => false,
            _ => return Err(block.fault("E-dem-header", 534, 6, "1 for feet or 2 for metres", "unit of heights")),
        };
        let angle = if block.field(786, 24).is_empty() { 0.0 } else { block.real(786, 24, "angle of the profiles")? };
        if angle != 0.0 {
            let fault = block.fault("E-dem-feature", 786, 24, "0: profiles to the north", "angle of the profiles");
            return Err(fault.category(Category::Unsupported));
        }
        let mut resolution = [0.0; 3];
        for (axis, value) in resolution.iter_mut().enumerate() {
            let (from, what) =
                (816 + 12 * axis, ["distance of profiles", "distance of samples", "step of heights"][axis]);
            *value = block.real(from, 12, what)?;
            if *value <= 0.0 {
                return Err(block.fault("E-dem-header", from, 12, "a number above 0", what));
            }
        }
        let profiles = block.integer(858, 6, "number of profiles")?;
        let profiles = u64::try_from(profiles).ok().filter(|count| *count > 0);
        let none = || block.fault("E-dem-count", 858, 6, "a number of profiles above 0", "number of profiles");
        let name = String::from_utf8_lossy(block.field(0, 40)).into_owned();
        Ok(Self {
            name,
            ground,
            feet,
            range: [block.real(738, 24, "lowest height")?, block.real(762, 24, "highest height")?],
            resolution,
            profiles: profiles.ok_or_else(none)?,
        })
    }
}

/// Whether an input begins with a record A: small whole numbers and numbers with exponents in their columns.
pub(super) fn looks_right(input: &[u8]) -> bool {
    let Some((block, _)) = Block::at(input, 0).filter(|(block, _)| block.bytes.len() >= 864) else { return false };
    let small = |from| block.integer(from, 6, "").is_ok_and(|number| (0..=100).contains(&number));
    let pattern = small(528) && small(534) && small(540);
    pattern && (0..8).all(|corner| block.real(546 + 24 * corner, 24, "").is_ok()) && block.integer(858, 6, "").is_ok()
}
